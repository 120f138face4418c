#include "sphsolve/darcy/permeameter.h"

#include <math.h>
#include <string.h>

#include "common/units.h"
#include "sphsolve/plan/reynolds.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"

/* Number of layers of sites across an axis that are all soil; those between them are free water. -1
 * if a layer is of both, or a site is neither. */
static long soil_layers(const struct richards *s, int axis) {
  const struct lattice *l = s->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]}, n = l->size[axis];
  const size_t across = l->count / n;
  long layers = 0;
  if (s->count < l->count) return -1;
  for (size_t layer = 0; layer < n; layer++) {
    size_t soil = 0;
    for (size_t i = 0; i < s->count; i++)
      soil += i / stride[axis] % n == layer && s->soil[i] + 1u < s->soil_count;
    if (soil != 0 && soil != across) return -1;
    layers += soil == across;
  }
  return layers;
}

/* A head at each of two opposite sides, all over them, and no other way in or out: the fall of head
 * along the axis, m; NAN if it is not so. */
static double fall_along(const struct richards *s, int *axis) {
  const struct richards_edge *first = s->edges;
  double head[2] = {NAN, NAN};
  if (s->edge_count == 0 || s->changes) return NAN;
  *axis = first->axis;
  const size_t across = s->lattice->count / s->lattice->size[*axis];
  if (s->edge_count != 2 * across) return NAN;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    double *side = &head[edge->low ? 0 : 1];
    const bool given = edge->kind == EDGE_HEAD || edge->kind == EDGE_PRESSURE;
    if (!given || edge->axis != *axis || edge->kind != first->kind || s->limited[e] > 0 ||
        (*side != edge->region->head && !isnan(*side)))
      return NAN;
    *side = edge->region->head;
  }
  return head[0] - head[1];
}

/* One soil, in layers between sites, has its k to the tolerance of the solution. */
static void set_errors(const struct richards *s, struct run_result *result) {
  result->k_error = 0; /* no mean over time */
  result->error.steadiness = SATURATED_TOLERANCE;
  result->error.resolution = s->soil_count <= 2 ? SATURATED_TOLERANCE : NAN;
}

void richards_find_k(const struct richards *s, struct run_result *result) {
  const double *drive = s->scene->driving, *g = s->scene->gravity;
  const double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  double mean[3] = {0};
  bool round = s->edge_count == 0;
  int axis = 0;
  for (size_t i = 0; i < s->count; i++) {
    double v[3];
    richards_velocity(s, i, v);
    for (int a = 0; a < 3; a++) mean[a] += v[a] / s->lattice->bulk_count;
  }
  for (int a = 0; a < 3; a++) round = round && (drive[a] == 0 || s->scene->periodic[a]);
  result_from_darcy(s->scene, mean, result);
  result->reynolds =
      reynolds_of_soil(s->scene, s->scene->fluid.viscosity / s->scene->fluid.density, mean);
  if (round) {
    set_errors(s, result);
    for (size_t i = 0; i < s->count; i++)
      if (s->soil[i] + 1u == s->soil_count) result->error.resolution = NAN; /* free water */
    return;
  }
  result->k = result->intrinsic_permeability = NAN;
  const double fall = fall_along(s, &axis);
  if (!(fabs(fall) > 0)) return;
  const long layers = soil_layers(s, axis);
  if (layers <= 0) return;
  const double gradient = fall / ((double)layers * s->spacing);
  memset(result->darcy_velocity, 0, sizeof result->darcy_velocity);
  result->darcy_velocity[axis] = mean[axis];
  result->hydraulic_gradient[axis] = gradient;
  result->k = mean[axis] / gradient;
  set_errors(s, result);
  const double water = (double)s->lattice->size[axis] / (double)layers; /* at most that much */
  if (water > 1) result->error.resolution += water / WATER_CONDUCTIVITY;
  result->intrinsic_permeability = result->k * s->scene->fluid.viscosity / s->scene->fluid.density /
                                   (strength > 0 ? strength : GRAVITY_STANDARD);
}
