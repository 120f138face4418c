#include "sphsolve/solute/multigrid_rows.h"

#include "common/variants.h"

#define RUN 256 /* cells processed at a time */
#define INLINE static inline __attribute__((always_inline))

/* Coefficients of a face for the neighbours at its high and its low side are G' - s F / 2 and G' +
 * s F / 2, with G' = max(G, |s F| / 2). */
INLINE float hybrid_conductance(float g, float f) {
  const float size = f < 0 ? -f : f;
  return g > size ? g : size;
}

/* Sum of the contributions of the six neighbours of each cell of a run. */
INLINE void neighbour_sum(const struct solute_cells *c, float half, bool flows, size_t at,
                          int count, const float *x, float *restrict sum) {
  for (int i = 0; i < count; i++) sum[i] = 0;
  for (int a = 0; a < 3; a++) {
    const size_t d = c->stride[a];
    const float *g = c->conductance[a] + at, *f = flows ? c->flux[a] + at : NULL, *here = x + at;
    const float *low = here - d;
    if (flows)
      for (int i = 0; i < count; i++) {
        const float up = half * f[(size_t)i + d], down = half * f[i];
        sum[i] += (hybrid_conductance(g[(size_t)i + d], up) - up) * here[(size_t)i + d] +
                  (hybrid_conductance(g[i], down) + down) * low[i];
      }
    else
      for (int i = 0; i < count; i++)
        sum[i] += g[(size_t)i + d] * here[(size_t)i + d] + g[i] * low[i];
  }
}

TARGETS void multigrid_row_inverse(const struct solute_cells *c, float half, bool flows, size_t at,
                                   float *inverse) {
  for (size_t p = at; p < at + (size_t)c->n[0]; p++) {
    float sum = 0;
    for (int a = 0; a < 3; a++) {
      const size_t up = p + c->stride[a];
      const float high = flows ? half * c->flux[a][up] : 0, low = flows ? half * c->flux[a][p] : 0;
      sum += hybrid_conductance(c->conductance[a][up], high) - high;
      sum += hybrid_conductance(c->conductance[a][p], low) + low;
    }
    inverse[p] = sum > 0 ? 1 / sum : 0;
  }
}

/* All cells of a run are computed, but only every other one is stored: vector operations need
 * contiguous cells. */
TARGETS void multigrid_row_relax(const struct solute_cells *c, float half, bool flows, size_t at,
                                 int first, const float *inverse, const float *rest, float *x) {
  for (int begin = 0; begin < c->n[0]; begin += RUN, at += RUN) {
    const int count = c->n[0] - begin < RUN ? c->n[0] - begin : RUN;
    float value[RUN];
    neighbour_sum(c, half, flows, at, count, x, value);
    for (int i = 0; i < count; i++)
      value[i] = (rest[at + (size_t)i] + value[i]) * inverse[at + (size_t)i];
    for (int i = first; i < count; i += 2) x[at + (size_t)i] = value[i];
  }
}

TARGETS void multigrid_row_defect(const struct solute_cells *c, float half, bool flows, size_t at,
                                  const float *inverse, const float *rest, const float *x,
                                  float *out) {
  for (int begin = 0; begin < c->n[0]; begin += RUN, at += RUN) {
    const int count = c->n[0] - begin < RUN ? c->n[0] - begin : RUN;
    float value[RUN];
    neighbour_sum(c, half, flows, at, count, x, value);
    for (int i = 0; i < count; i++) {
      const size_t p = at + (size_t)i;
      out[p] = inverse[p] > 0 ? rest[p] + value[i] - x[p] / inverse[p] : 0;
    }
  }
}

/* Weighted sum of the four nearest coarse rows (9, 3, 3, 1), beginning one cell before the first.
 * `ones`: with 1 for the values of open cells. */
INLINE void weighted_rows(const float *y, size_t near, const ptrdiff_t steps[2], int from,
                          int count, bool ones, float *restrict row) {
  const float *a = y + near + from - 1, *b = a + steps[0], *c = a + steps[1],
              *d = a + steps[0] + steps[1];
  if (ones)
    for (int i = 0; i < count + 2; i++)
      row[i] = (float)((a[i] > 0 ? 9 : 0) + (b[i] > 0 ? 3 : 0) + (c[i] > 0 ? 3 : 0) +
                       (d[i] > 0 ? 1 : 0));
  else
    for (int i = 0; i < count + 2; i++) row[i] = 9 * a[i] + 3 * b[i] + 3 * c[i] + d[i];
}

TARGETS void multigrid_row_prolong(const float *y, size_t near, const ptrdiff_t steps[2], int count,
                                   const float *share, float *x) {
  for (int begin = 0; begin < count; begin += RUN) {
    const int left = count - begin < RUN ? count - begin : RUN;
    float row[RUN / 2 + 2];
    weighted_rows(y, near, steps, begin / 2, (left + 1) / 2, false, row);
    for (int i = 0; i < left; i++) {
      const float low = row[i / 2 + (i & 1)], high = row[i / 2 + 1 + (i & 1)];
      x[begin + i] += share[begin + i] * (i & 1 ? 3 * low + high : low + 3 * high);
    }
  }
}

TARGETS void multigrid_row_share(const float *coarse_inverse, size_t near, const ptrdiff_t steps[2],
                                 int count, const float *inverse, float *share) {
  for (int begin = 0; begin < count; begin += RUN) {
    const int left = count - begin < RUN ? count - begin : RUN;
    float row[RUN / 2 + 2];
    weighted_rows(coarse_inverse, near, steps, begin / 2, (left + 1) / 2, true, row);
    for (int i = 0; i < left; i++) {
      // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): weighted_rows has filled it
      const float low = row[i / 2 + (i & 1)], high = row[i / 2 + 1 + (i & 1)];
      const float sum = i & 1 ? 3 * low + high : low + 3 * high;
      share[begin + i] = inverse[begin + i] > 0 && sum > 0 ? 1 / sum : 0;
    }
  }
}
