#include "sphsolve/richards/balance.h"

#include "sphsolve/richards/edges.h"

void richards_place(const struct richards *s, size_t i, double x[3]) {
  const struct lattice *l = s->lattice;
  const size_t at = s->site[i], row = at / l->size[0];
  const size_t site[3] = {at % l->size[0], row % l->size[1], row / l->size[1]};
  for (int a = 0; a < 3; a++) x[a] = l->origin[a] + (double)site[a] * l->spacing[a];
}

void richards_evaluate(struct richards *s, double time) {
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
  }
  richards_edge_fluxes(s, time);
}

double richards_water(const struct richards *s) {
  double sum = 0;
  for (size_t i = 0; i < s->count; i++) sum += s->now[i].theta;
  return sum * s->spacing * s->spacing * s->spacing;
}

double richards_net_inflow(const struct richards *s) {
  double sum = -s->seeped;
  for (size_t r = 0; r < s->scene->region_count; r++)
    sum += s->entered[r] + s->rained[r] - s->ran_off[r];
  return sum;
}
