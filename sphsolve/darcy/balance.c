#include "sphsolve/darcy/balance.h"

#include <math.h>

#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/hole.h"
#include "sphsolve/darcy/pond.h"

void richards_place(const struct richards *s, size_t i, double x[3]) {
  const struct lattice *l = s->lattice;
  const size_t at = s->site[i], row = at / l->size[0];
  const size_t site[3] = {at % l->size[0], row % l->size[1], row / l->size[1]};
  for (int a = 0; a < 3; a++) x[a] = l->origin[a] + (double)site[a] * l->spacing[a];
}

void richards_flow(const struct richards *s, size_t i, double v[3]) {
  for (size_t a = 0; a < 3; a++) {
    v[a] = 0;
    for (size_t high = 0; high < 2; high++) {
      const uint32_t b = s->beside[6 * i + 2 * a + high];
      if (b == SITE_NONE) continue;
      v[a] += 0.5 * (b < BESIDE_EDGE ? s->face_flux[b].q
                     : high          ? -s->edge_flux[b - BESIDE_EDGE].q
                                     : s->edge_flux[b - BESIDE_EDGE].q);
    }
  }
}

void richards_velocity(const struct richards *s, size_t i, double v[3]) {
  const size_t site = s->site[i];
  richards_flow(s, i, v);
  for (int a = 0; a < 3 && wall_cuts_volume(&s->walls, site) != 1; a++) {
    const double open =
        wall_cuts_face(&s->walls, site, a, false) + wall_cuts_face(&s->walls, site, a, true);
    if (open > 0) v[a] *= 2 / open;
  }
}

void richards_fall(const struct richards *s, size_t i, double fall[3]) {
  const struct retention *soil = &s->soils[s->soil[i]];
  const double *k = soil->conductivity, shear = soil->shear;
  double v[3];
  richards_velocity(s, i, v);
  const double drag = soil->forchheimer * sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  const double root = k[0] * k[2] - shear * shear;
  fall[0] = (k[2] * v[0] - shear * v[2]) / root + drag * v[0];
  fall[1] = v[1] / k[1] + drag * v[1];
  fall[2] = (k[0] * v[2] - shear * v[0]) / root + drag * v[2];
}

void richards_evaluate(struct richards *s, double time) {
  if (s->full) return; /* richards_saturated_solve */
#pragma omp parallel for schedule(static) if (s->count > RICHARDS_SERIAL_MAX)
  for (size_t i = 0; i < s->count; i++) retention_at(&s->soils[s->soil[i]], s->h[i], &s->now[i]);
#pragma omp parallel for schedule(static) if (s->count > RICHARDS_SERIAL_MAX)
  for (size_t f = 0; f < s->face_count; f++) {
    const struct richards_face *face = &s->faces[f];
    const struct retention *soil = &s->soils[s->soil[face->i]];
    const struct retention_state *i = &s->now[face->i], *j = &s->now[face->j];
    if (face->soils_differ)
      flux_between_soils(soil, &s->soils[s->soil[face->j]], face->axis, s->spacing,
                         s->pull[face->axis], i, j, &s->face_flux[f]);
    else
      flux_in_soil(soil->conductivity[face->axis], s->spacing, s->pull[face->axis], i, j,
                   &s->face_flux[f]);
    flux_scale(&s->face_flux[f], wall_cuts_face(&s->walls, s->site[face->i], face->axis, true));
  }
  richards_holes_flux(s, time);
  richards_edge_fluxes(s, time);
  richards_pond_fluxes(s, time);
}

double richards_water(const struct richards *s) {
  double sum = 0;
  for (size_t i = 0; i < s->count; i++) sum += s->now[i].theta * richards_volume(s, i);
  return sum * s->spacing * s->spacing * s->spacing;
}

double richards_net_inflow(const struct richards *s) {
  double sum = -s->seeped - richards_pond_volume(s, NULL);
  for (size_t r = 0; r < s->scene->region_count; r++)
    sum += s->entered[r] + s->rained[r] - s->ran_off[r];
  return sum;
}
