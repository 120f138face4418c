#include "common/slabs.h"

#include <math.h>

#include "common/balance.h"
#include "common/memory.h"
#include "common/ranks.h"

enum status slabs_make(size_t planes, const double *work, size_t unit, struct slabs *s) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  const size_t units = planes / unit > 0 ? planes / unit : 1;
  const size_t first = units * own / ranks, end = units * (own + 1) / ranks;
  double *heavy = NULL, total = 0, heaviest = 0;
  size_t *partition = NULL;
  *s = (struct slabs){.planes = planes};
  status = memory_allocate(&s->start, ranks + 1, sizeof *s->start, "slabs");
  if (status == STATUS_OK)
    status = memory_allocate(&partition, ranks + 1, sizeof *partition, "slabs");
  if (status == STATUS_OK) status = memory_allocate(&heavy, units, sizeof *heavy, "slabs");
  /* Zoltan duplicates the communicator, so that no rank may return before. */
  TRY(ranks_agree(status));
  for (size_t p = 0; p < planes; p++) {
    heavy[p / unit < units ? p / unit : units - 1] += work[p];
    total += work[p];
  }
  /* Each rank passes a part of the items to Zoltan. */
  TRY(balance_partition(units, first, end - first, heavy + first, partition));
  for (size_t r = 0; r < ranks; r++) {
    double sum = 0;
    for (size_t u = partition[r]; u < partition[r + 1]; u++) sum += heavy[u];
    heaviest = fmax(heaviest, sum);
    if (partition[r + 1] > partition[r]) s->start[s->count++] = partition[r] * unit;
  }
  for (size_t r = (size_t)s->count; r <= ranks; r++) s->start[r] = planes;
  s->imbalance = total > 0 ? heaviest / (total / (double)ranks) : 1;
  s->begin = s->start[own];
  s->end = s->start[own + 1];
cleanup:
  MEMORY_FREE(&heavy, &partition);
  return status;
}

void slabs_free(struct slabs *slabs) {
  memory_free(&slabs->start);
}

enum { TAG_UP = 1, TAG_DOWN = 2 };

void slabs_post(const struct slabs *s, int shift, void *data, size_t bytes, size_t depth) {
  if (s->count < 2 || s->begin == s->end) return;
  const int own = ranks_own(), above = (own + 1) % s->count;
  const int below = (own + s->count - 1) % s->count;
  const size_t begin = slabs_coarse(s->begin, shift), end = slabs_coarse(s->end, shift);
  const size_t planes = slabs_coarse(s->planes, shift);
  char *base = data;
  ranks_receive(base + (end == planes ? 0 : end) * bytes, depth * bytes, above, TAG_DOWN);
  ranks_receive(base + ((begin == 0 ? planes : begin) - depth) * bytes, depth * bytes, below,
                TAG_UP);
  ranks_send(base + begin * bytes, depth * bytes, below, TAG_DOWN);
  ranks_send(base + (end - depth) * bytes, depth * bytes, above, TAG_UP);
}
