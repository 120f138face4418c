#include "sphsolve/isph/matrix.h"

#include <math.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/ranks.h"

/* Sum over blocks of fixed size, added in their order: it is the same to the bit for any number of
 * threads and ranks, since a rank's particles begin with a block. */
double isph_dot(struct isph *s, const double *a, const double *b) {
  const size_t first = s->local.begin, n = s->local.end;
  double total = 0, *own = s->partial + isph_first_chunk(s);
#pragma omp parallel for schedule(static)
  for (size_t k = 0; k < (n - first + CHUNK - 1) / CHUNK; k++) {
    size_t begin = first + k * CHUNK, end = begin + CHUNK < n ? begin + CHUNK : n;
    double sum = 0;
    for (size_t i = begin; i < end; i++) sum += a[i] * b[i];
    own[k] = sum;
  }
  isph_gather_chunks(s, s->partial);
  for (size_t k = 0; k < (s->total + CHUNK - 1) / CHUNK; k++) total += s->partial[k];
  return total;
}

#define LANES 4 /* sums of a row that do not wait for each other */

TARGETS static void multiply_rows(const struct isph *s, const struct isph_chunk *chunk,
                                  const double *restrict x, double *restrict y) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const uint32_t *pair = chunk->pair + s->pair_first[i];
    const float *a = chunk->matrix + s->pair_first[i];
    const size_t n = s->pair_number[i], whole = n - n % LANES;
    double sum[LANES] = {0};
    for (size_t p = 0; p < n; p += 64 / sizeof *pair) { /* the lines of rows a few further on */
      __builtin_prefetch(pair + p + PAIRS_AHEAD);
      __builtin_prefetch(a + p + PAIRS_AHEAD);
    }
    for (size_t p = 0; p < whole; p += LANES)
      for (size_t k = 0; k < LANES; k++) sum[k] += (double)a[p + k] * x[pair[p + k] & PAIR_MASK];
    for (size_t p = whole; p < n; p++) sum[p - whole] += (double)a[p] * x[pair[p] & PAIR_MASK];
    y[i] = s->diagonal[i] * x[i] - ((sum[0] + sum[1]) + (sum[2] + sum[3]));
  }
}

static void multiply_chunks(const struct isph *s, bool outer, const double *x, double *y) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++)
    if (s->chunks[c].outer == outer) multiply_rows(s, &s->chunks[c], x, y);
}

void isph_multiply(struct isph *s, double *x, double *y) {
  if (isph_is_distributed(s)) ghosts_post(&s->local, 1, &ISPH_FIELD(x));
  multiply_chunks(s, false, x, y);
  if (!isph_is_distributed(s)) return;
  ghosts_finish(&s->local);
  multiply_chunks(s, true, x, y);
}

enum status isph_solve_failed(struct isph *s, double error, int iterations) {
  double *q = s->work[1], most = -1, own, worst[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
  size_t at = s->local.begin;
  isph_multiply(s, s->pressure, q);
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double off = fabs(s->source[i] - q[i]) / sqrt(s->diagonal[i]);
    if (off > most) most = off, at = i;
  }
  own = most;
  ranks_max_all(&most, 1);
  if (own == most && s->local.end > s->local.begin) {
    memcpy(worst, s->position[at], sizeof *s->position);
    worst[3] = (double)s->id[at];
  }
  ranks_max_all(worst, 4);
  return FAIL(STATUS_NUMERIC,
              "residual: particle %.0f at (%.4g, %.4g, %.4g) m: relative error %.2g of the "
              "pressure solve after %d iterations",
              worst[3], worst[0], worst[1], worst[2], error, iterations);
}
