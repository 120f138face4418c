#include "sphsolve/isph/viscosity.h"

#include <math.h>

#include "common/variants.h"
#include "sphsolve/isph/effects/artificial_viscosity.h"
#include "sphsolve/isph/effects/turbulence.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/wall.h"

void isph_viscosity_find(struct isph *s) {
  const double constant = s->scene->isph.smagorinsky;
  s->artificial_viscosity = s->on.artificial_viscosity ? artificial_viscosity(s) : 0;
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double eps = s->on.soil ? s->porosity[i] : 1, soil = s->on.soil ? s->soil_fraction[i] : 0;
    double eddies = 0;
    if (s->on.turbulence)
      eddies = eddy_viscosity(constant, s->support[i], strain_rate(s->gradient[i]), soil);
    s->eddy[i] = (s->kinematic_viscosity + fmax(eddies, isph_artificial_viscosity_at(s, i))) / eps;
  }
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->eddy)});
  s->viscosity_most = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++)
    s->viscosity_most = fmax(s->viscosity_most, s->eddy[i] * (s->on.soil ? s->porosity[i] : 1));
  s->viscosity_most = ranks_max(s->viscosity_most);
}

/* Viscosity of the friction between particle i and a wall, half a spacing away. */
static double wall_friction_viscosity(const struct isph *s, size_t i, const double wall[3]) {
  double eps = s->on.soil ? s->porosity[i] : 1, soil = s->on.soil ? s->soil_fraction[i] : 0;
  double square = 0, nu = s->kinematic_viscosity;
  if (s->on.turbulence && soil < 1) {
    for (int a = 0; a < 3; a++) square += pow(s->velocity[i][a] - wall[a], 2);
    nu += (1 - soil) * (wall_viscosity(nu, sqrt(square), 0.5 * s->spacing) - nu);
  }
  return nu / eps;
}

/* Viscous force nu_E lap v from pairs, and friction at reflecting sides. */
ROW void viscous_pairs(enum isph_images images, const struct isph *s,
                       const struct isph_chunk *chunk, size_t i, double force[3],
                       double friction[3]) {
  const double *xi = s->position[i], *vi = s->velocity[i], nu = s->eddy[i];
  const bool held = isph_sides_hold(s);
  four sum = {0};
  double tank = -1; /* the viscosity of the friction at sides that reflect, once it is known */
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    uint32_t j = chunk->pair[p] & PAIR_MASK;
    double both = nu + s->eddy[j];
    four vj;
    if (held && isph_is_reflected(images, s, chunk->pair[p])) {
      double r[3];
      isph_separation(s, xi, s->position, chunk->pair[p], r);
      if (tank < 0) tank = wall_friction_viscosity(s, i, s->wall_boxes[0].velocity);
      double weight = 2 * s->volume[j] * tank * (double)chunk->slope[p] *
                      (1 + isph_reflection_ratio(s, xi, chunk->pair[p], r));
      for (int a = 0; a < 3; a++) friction[a] -= weight * vi[a];
      continue;
    }
    isph_turn_four(images, s, chunk->pair[p], s->velocity[j], &vj);
    if (s->on.links)
      both = (nu * s->porosity[i] + s->eddy[j] * s->porosity[j]) / (double)chunk->path_porosity[p];
    double weight = s->volume[j] * both * (double)chunk->slope[p];
    sum -= weight * (FOUR(vi) - vj);
  }
  for (int a = 0; a < 3; a++) force[a] = sum[a];
}

/* Viscous force nu_E lap v of particle i: pairs after M15 eq. 22; no-slip walls by the image
 * velocity v_w + (v_w - v_i) d_j/d_i (Takeda, Miyama, Sekiya 1994; Morris et al. 1997). */
TARGETS void isph_viscous(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                          double force[3], double friction[3]) {
  const double *xi = s->position[i], *vi = s->velocity[i];
  ISPH_ROW(s, i, viscous_pairs, s, chunk, i, force, friction);
  if (!s->on.no_slip) return;
  int last = -1; /* wall box for which `hold` was found */
  double hold = 0;
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    uint32_t entry = chunk->wall[p], j = entry & PAIR_MASK;
    if (s->boundary_kind[j] != BOUNDARY_WALL || s->wall_boxes[s->boundary_box[j]].slip) continue;
    if (s->boundary_box[j] != last)
      last = s->boundary_box[j], hold = wall_friction_viscosity(s, i, isph_wall_velocity(s, j));
    double r[3], mirror[6], ratio,
        weight = 2 * isph_wall_volume(s, j) * hold * (double)chunk->wall_slope[p];
    isph_separation(s, xi, s->boundary_position, entry, r);
    double xj[3] = {xi[0] - r[0], xi[1] - r[1], xi[2] - r[2]};
    isph_wall_mirror(s, i, j, xj, mirror, &ratio);
    for (int a = 0; a < 3; a++)
      friction[a] -= weight * (1 + ratio) * (vi[a] - isph_wall_velocity(s, j)[a]);
  }
}
