#include "sphsolve/isph/near_surface.h"

#include <math.h>

#include "common/variants.h"
#include "sphsolve/isph/images.h"

TARGETS static void find_maxima(const struct isph *s, const struct isph_chunk *chunk,
                                const double *restrict from, double *restrict to) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const uint32_t *pair = chunk->pair + s->pair_first[i];
    const size_t n = s->pair_number[i];
    double most = from[i], other = most; /* by turns: one need not wait for the other */
    for (size_t p = 0; p + 1 < n; p += 2) {
      const double a = from[pair[p] & PAIR_MASK], b = from[pair[p + 1] & PAIR_MASK];
      most = a > most ? a : most, other = b > other ? b : other;
    }
    if (n % 2 != 0) most = fmax(most, from[pair[n - 1] & PAIR_MASK]);
    to[i] = fmax(most, other);
  }
}

void isph_neighbourhood_maximum(const struct isph *s, const double *from, double *to) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) find_maxima(s, &s->chunks[c], from, to);
}

/* Neighbours' contribution to isph_surface_normal. */
ROW void surface_around(enum isph_images images, const struct isph *s,
                        const struct isph_chunk *chunk, size_t i, double normal[3]) {
  four sum = {0}, out;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    uint32_t j = chunk->pair[p] & PAIR_MASK;
    isph_turn_four(images, s, chunk->pair[p], s->gradient_sum[j], &out);
    sum += s->surface[j] * out;
  }
  for (int a = 0; a < 3; a++) normal[a] += sum[a];
}

TARGETS void isph_surface_normal(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                                 double normal[3]) {
  for (int a = 0; a < 3; a++) normal[a] = s->surface[i] * s->gradient_sum[i][a];
  ISPH_ROW(s, i, surface_around, s, chunk, i, normal);
  const double length = fmax(sqrt(dot(normal, normal)), 1e-30);
  for (int a = 0; a < 3; a++) normal[a] /= length;
}
