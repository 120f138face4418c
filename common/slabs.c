#include "common/slabs.h"

#include <math.h>

#include "common/memory.h"
#include "common/ranks.h"

/* Cuts greedily with no slab heavier than `most`; returns how many come out, more than `ranks`
 * where that is not possible. */
static int cut(size_t planes, const double *work, size_t unit, double most, int ranks,
               size_t *start) {
  const size_t units = planes / unit > 0 ? planes / unit : 1;
  int slab = 0;
  double sum = 0.0;
  start[0] = 0;
  for (size_t u = 0; u < units; u++) {
    const size_t end = u + 1 == units ? planes : (u + 1) * unit;
    double next = 0.0;
    for (size_t p = u * unit; p < end; p++) next += work[p];
    if (sum > 0.0 && sum + next > most && slab + 1 < ranks) {
      start[++slab] = u * unit;
      sum = 0.0;
    }
    sum += next;
    if (sum > most) return ranks + 1;
  }
  for (int r = slab + 1; r <= ranks; r++) start[r] = planes;
  return slab + 1;
}

enum status slabs_make(size_t planes, const double *work, size_t unit, struct slabs *s) {
  enum status status = STATUS_OK;
  const int ranks = ranks_count();
  *s = (struct slabs){.planes = planes};
  TRY(memory_allocate(&s->start, (size_t)ranks + 1, sizeof *s->start, "slabs"));
  double total = 0.0, heaviest = 0.0;
  for (size_t p = 0; p < planes; p++) total += work[p];
  /* The least heaviest slab, by bisection; none can be lighter than the mean. */
  double low = total / ranks, high = total * (1 + 1e-9);
  for (int i = 0; i < 40; i++) {
    const double middle = 0.5 * (low + high);
    if (cut(planes, work, unit, middle, ranks, s->start) <= ranks)
      high = middle;
    else
      low = middle;
  }
  s->count = cut(planes, work, unit, high, ranks, s->start);
  for (int r = 0; r < s->count; r++) {
    double sum = 0.0;
    for (size_t p = s->start[r]; p < s->start[r + 1]; p++) sum += work[p];
    heaviest = fmax(heaviest, sum);
  }
  s->imbalance = total > 0.0 ? heaviest / (total / ranks) : 1.0;
  s->begin = s->start[ranks_own()];
  s->end = s->start[ranks_own() + 1];
cleanup:
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
