/* ranks_balance: rows of few and many items, wherever they are told of, cut into runs; says on
 * stderr what is wrong with them. */
#include <stdio.h>

#include "common/balance.h"
#include "common/memory.h"
#include "common/ranks.h"

enum { MOST = 200 };

static double work_of(int kind, size_t item, size_t items) {
  return kind == 0   ? 1
         : kind == 1 ? 1 + (double)(item * 7919 % 13)
         : kind == 2 ? (item == items - 1 ? 1e9 : 1)
                     : (double)(item % 2);
}

/* `told`: evenly, by the first rank alone, or by the last. */
static enum status try_row(size_t items, int kind, int told, int *wrong) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  size_t first = items * own / ranks, end = items * (own + 1) / ranks, *cut = NULL;
  double work[MOST], total = 0, largest = 0;
  if (told == 1) first = own == 0 ? 0 : items, end = items;
  if (told == 2) first = own + 1 == ranks ? 0 : items, end = items;
  for (size_t i = 0; i < items; i++) {
    work[i] = work_of(kind, i, items);
    total += work[i];
    largest = work[i] > largest ? work[i] : largest;
  }
  TRY(memory_allocate(&cut, ranks + 1, sizeof *cut, "cuts"));
  TRY(balance_partition(items, first, end - first, work + first, cut));
  bool good = cut[0] == 0 && cut[ranks] == items;
  for (size_t r = 0; r < ranks; r++) {
    double sum = 0;
    const bool same = ranks_max((double)cut[r]) == -ranks_max(-(double)cut[r]);
    good = good && same && cut[r] <= cut[r + 1];
    for (size_t i = cut[r]; good && i < cut[r + 1]; i++) sum += work[i];
    /* Each of two bisections is off by an item at most. */
    good = good && sum <= total / (double)ranks + (ranks < 3 ? 1 : 1.5) * largest;
    if (kind == 0) good = good && sum <= (double)((items + ranks - 1) / ranks);
  }
  if (!good && own == 0) {
    fprintf(stderr, "%zu items, kind %d, told %d:", items, kind, told);
    for (size_t r = 0; r <= ranks; r++) fprintf(stderr, " %zu", cut[r]);
    fprintf(stderr, "\n");
  }
  *wrong += !good;
cleanup:
  memory_free(&cut);
  return status;
}

int main(int argc, char **argv) {
  enum status status = STATUS_OK;
  int wrong = 0;
  ranks_start(&argc, &argv);
  for (size_t items = 1; items <= MOST; items += items < 12 ? 1 : 47)
    for (int kind = 0; kind < 4; kind++)
      for (int told = 0; told < 3; told++)
        if (items > 1 || kind < 3) TRY(try_row(items, kind, told, &wrong));
  if (wrong > 0) status = FAIL(STATUS_NUMERIC, "%d rows are cut badly", wrong);
cleanup:
  return ranks_end(status);
}
