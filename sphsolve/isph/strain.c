#include "sphsolve/isph/strain.h"

#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/vector.h"

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
