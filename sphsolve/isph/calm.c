#include "sphsolve/isph/calm.h"

#include <math.h>

#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/near_surface.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/vector.h"

bool isph_has_calm(const struct isph *s) {
  return isph_is_free_water(s) && s->on.artificial_viscosity && s->on.viscous;
}

/* Collective isph_neighbourhood_maximum. */
static void neighbourhood_maximum(struct isph *s, double *from, double *to) {
  isph_send(s, 1, &(struct ghost_field){from, sizeof *from});
  isph_neighbourhood_maximum(s, from, to);
}

void isph_calm_thickness(struct isph *s) {
  double *from = s->calm, *to = s->thick; /* calm is found later, in the step */
  for (size_t i = s->local.begin; i < s->local.end; i++) from[i] = s->surface[i];
  for (int hop = 0; hop <= 2 * THICKNESS_HOPS; hop++) { /* an odd number: ends in s->thick */
    for (size_t i = s->local.begin; i < s->local.end && hop == THICKNESS_HOPS; i++)
      from[i] = 1 - from[i];
    neighbourhood_maximum(s, from, to);
    double *found = to;
    to = from, from = found;
  }
  double *loose = s->work[0], *loosest = s->calm;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const double lacks = s->kernel_top - s->kernel_sum[i] - LOOSE_FROM;
    loose[i] = s->surface[i] * fmax(0, fmin(1, lacks / (LOOSE_FULL - LOOSE_FROM)));
  }
  neighbourhood_maximum(s, loose, loosest);
  for (size_t i = s->local.begin; i < s->local.end; i++) s->thick[i] *= 1 - loosest[i];
}

void isph_calm_find(struct isph *s) {
  const double strength = sqrt(dot(s->force, s->force)), rate = strength / s->spacing;
  const double least = CALM_CONVECTION * strength;
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const float *g = s->gradient[i];
    const double *v = s->velocity[i];
    const double closes = fmax(0, -((double)g[0] + (double)g[4] + (double)g[8]));
    double carried[3]; /* v . grad v */
    for (int a = 0; a < 3; a++)
      carried[a] =
          (double)g[3 * a] * v[0] + (double)g[3 * a + 1] * v[1] + (double)g[3 * a + 2] * v[2];
    s->calm[i] = s->thick[i] * least * least / (least * least + dot(carried, carried)) * rate /
                 (closes * closes + rate);
  }
}
