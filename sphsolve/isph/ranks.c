#include "sphsolve/isph/ranks.h"

#include <string.h>

#include "common/memory.h"

enum { TAG_SUMS = 6 };

void isph_send(struct isph *s, int count, const struct ghost_field *fields) {
  if (!isph_is_distributed(s)) return;
  ghosts_post(&s->local, count, fields);
  ghosts_finish(&s->local);
}

/* Sums are passed from rank to rank, each of which adds its own between the two calls; then all
 * ranks have them. */
static void sums_arrive(double *sums, size_t n) {
  if (ranks_own() == 0) return;
  ranks_receive(sums, n * sizeof *sums, ranks_own() - 1, TAG_SUMS);
  ranks_wait();
}
static void sums_go_on(double *sums, size_t n) {
  if (ranks_count() == 1) return;
  if (ranks_own() + 1 < ranks_count()) {
    ranks_send(sums, n * sizeof *sums, ranks_own() + 1, TAG_SUMS);
    ranks_wait();
    memset(sums, 0, n * sizeof *sums);
  }
  ranks_sum_all(sums, n);
}

void isph_sum_chunks(const struct isph *s, int width, double *total) {
  for (int k = 0; k < width; k++) total[k] = 0;
  sums_arrive(total, (size_t)width);
  for (size_t c = 0; c < s->chunk_count; c++)
    for (int k = 0; k < width; k++) total[k] += s->sums[c][k];
  sums_go_on(total, (size_t)width);
}

void isph_sum_budgets(struct isph *s) {
  struct budget_sums *sums = &s->budget.sums;
  double numbers[sizeof *sums / sizeof(double)];
  const size_t n = sizeof numbers / sizeof *numbers;
  memcpy(numbers, sums, sizeof numbers);
  sums_arrive(numbers, n);
  memcpy(sums, numbers, sizeof numbers);
  for (size_t c = 0; c < s->chunk_count; c++) budget_add(sums, &s->chunks[c].budget);
  memcpy(numbers, sums, sizeof numbers);
  sums_go_on(numbers, n);
  memcpy(sums, numbers, sizeof numbers);
}

void isph_gather_chunks(struct isph *s, double *numbers) {
  if (isph_is_distributed(s)) ranks_gather(numbers, s->chunk_partition, sizeof *numbers);
}

enum status isph_gather(const void *list, size_t count, size_t size, void *gathered,
                        size_t *total) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  size_t *send = NULL, *start = NULL;
  char *all;
  TRY(memory_allocate(&send, ranks, sizeof *send, "messages from ranks"));
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "messages from ranks"));
  for (size_t r = 0; r < ranks; r++) send[r] = count;
  ranks_swap_counts(send, start + 1);
  for (size_t r = 0; r < ranks; r++) start[r + 1] += start[r];
  *total = start[ranks];
  TRY(memory_allocate(gathered, *total + 1, size, "messages from ranks"));
  memcpy(&all, gathered, sizeof all);
  if (count > 0) memcpy(all + start[own] * size, list, count * size);
  ranks_gather(all, start, size);
cleanup:
  memory_free(&send);
  memory_free(&start);
  return status;
}
