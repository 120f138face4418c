#include "sphsolve/isph/linear.h"

#include <math.h>

#include "sphsolve/isph/moment.h"
#include "sphsolve/isph/vector.h"

/* Lower bound of m, the mean of M along a surface: it is .8 in the outermost row of a level
 * surface, and less in spray. */
#define ALONG_MIN 0.5

static void find_correction(const struct isph *s, size_t i, const double moment[6], float k[6]) {
  static const int upper[6] = {0, 1, 2, 4, 5, 8}; /* of a full tensor */
  const double w = s->surface[i], *n = s->gradient_sum[i];
  const double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  double inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, more = 0;
  isph_moment_inverse(s->dimensions, moment, inverse);
  if (square > 0) {
    const double trace = moment[0] + moment[3] + moment[5];
    const double along = (trace - symmetric_along(moment, n) / square) / (s->dimensions - 1);
    more = 1 / fmax(along, ALONG_MIN) - 1;
  }
  for (int a = 0, at = 0; a < 3; a++)
    for (int b = a; b < 3; b++, at++) {
      const double across = square > 0 ? n[a] * n[b] / square : 0;
      const double surface = (1 + more) * (a == b) - more * across;
      k[at] = (float)((1 - w) * inverse[upper[at]] + w * surface);
    }
}

void isph_linear_find(struct isph *s) {
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double moment[6];
    for (int n = 0; n < 6; n++) moment[n] = (double)s->linear[i][n];
    find_correction(s, i, moment, s->linear[i]);
  }
}

bool isph_strain_turn(const struct isph *s, size_t i, double d[6]) {
  if (s->linear == NULL || s->gradient == NULL || s->surface[i] >= 1) return false;
  const float *k = s->linear[i];
  const double *v = s->velocity[i];
  double carried[3];
  for (int a = 0; a < 3; a++) {
    const float *g = s->gradient[i] + 3 * a;
    carried[a] = (double)g[0] * v[0] + (double)g[1] * v[1] + (double)g[2] * v[2];
  }
  const double square = dot(carried, carried);
  const double share = (1 - s->surface[i]) * square / (square + dot(s->force, s->force));
  for (int n = 0; n < 6; n++) d[n] = share * (double)k[n];
  for (int a = 0; a < 3; a++) d[symmetric_diagonal[a]] += 1 - share;
  return true;
}
