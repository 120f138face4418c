#include "sphsolve/darcy/edges.h"

#include <math.h>

#include "sphsolve/darcy/constants.h"

static double given_at(const struct region *region, double steady, double time) {
  return region->table.count > 0 ? time_table_at(&region->table, time, 0) : steady;
}

double richards_head_given(const struct region *region, double time) {
  return given_at(region, region->head, time);
}

double richards_source_at(const struct richards_source *source, double time) {
  const struct region *region = source->region;
  return source->share *
         given_at(region, region->type == REGION_RAIN ? region->rate : region->flux, time);
}

bool richards_is_covered(const struct richards *s, const struct richards_edge *edge, double time) {
  double level = -INFINITY;
  if (edge->kind == EDGE_POOL) level = s->pools[edge->pool - 1].level;
  if (edge->kind == EDGE_HEAD && s->pull[2] != 0) level = richards_head_given(edge->region, time);
  return !(level < edge->z - LEVEL_ROUNDING * s->spacing);
}

double richards_given_at(const struct richards *s, const struct richards_edge *edge, double time) {
  double sum = 0;
  for (size_t k = 0; k < edge->source_count; k++)
    sum += richards_source_at(&s->sources[edge->source + k], time);
  return sum;
}

void richards_flux_from_head(const struct richards *s, const struct richards_edge *edge,
                             double head, struct flux *flux) {
  const struct retention *soil = &s->soils[s->soil[edge->site]];
  struct retention_state outside;
  retention_at(soil, head, &outside);
  /* what goes through the face of a drain is in it (darcy/hole.c) */
  const double part = edge->kind == EDGE_DRAIN ? HOLE_PART_LEAST : 0.5;
  flux_in_soil(soil->conductivity[edge->axis], part * s->spacing,
               edge->low ? s->pull[edge->axis] : -s->pull[edge->axis], &outside,
               &s->now[edge->site], flux);
  flux_scale(flux, edge->open);
}

double richards_well_at(const struct richards *s, const struct richards_edge *edge, double time) {
  /* a rate in 2-D is per metre along y */
  const double wide = s->lattice->dimensions == 2 ? s->spacing : 1;
  return edge->share * wide * given_at(edge->region, edge->region->rate, time) /
         (s->spacing * s->spacing);
}

void richards_share_wells(struct richards *s) {
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *well = &s->scene->regions[r];
    size_t all = 0, wet = 0;
    if (well->type != REGION_WELL || well->first != r) continue;
    for (size_t e = 0; e < s->edge_count; e++)
      if (s->edges[e].region == well) all++, wet += s->h[s->edges[e].site] > 0;
    for (size_t e = 0; e < s->edge_count; e++)
      if (s->edges[e].region == well)
        s->edges[e].share = wet == 0                     ? 1.0 / (double)all
                            : s->h[s->edges[e].site] > 0 ? 1.0 / (double)wet
                                                         : 0;
  }
}

/* Without gravity a head is a pressure head. A well holds atmospheric pressure where it takes less
 * than its rate: nothing is sucked out of unsaturated soil. A face to the air, also above the water
 * of a head, lets out what comes under pressure and takes in nothing but rain, as much of it as
 * soil takes from no depth of water (with a depth: darcy/pond.h). Evaporation is limited to what
 * air-dry soil at the face draws. */
struct richards_law richards_law_at(const struct richards *s, const struct richards_edge *edge,
                                    double time) {
  const struct region *region = edge->region;
  const double pull = -s->pull[2], driest = s->soils[s->soil[edge->site]].driest;
  double given = 0;
  switch (edge->kind) {
  case EDGE_AIR:
    given = richards_given_at(s, edge, time);
    if (given < 0) return (struct richards_law){driest, given, INFINITY};
    return (struct richards_law){0, -INFINITY, given};
  case EDGE_HEAD:
    given = richards_head_given(region, time);
    if (pull == 0) return (struct richards_law){given, -INFINITY, INFINITY};
    if (richards_is_covered(s, edge, time))
      return (struct richards_law){pull * fmax(given - edge->z, 0), -INFINITY, INFINITY};
    return (struct richards_law){0, -INFINITY, richards_given_at(s, edge, time)};
  case EDGE_POOL:
    return (struct richards_law){0, -INFINITY,
                                 richards_given_at(s, edge, time)}; /* if it is bare */
  case EDGE_PRESSURE:
    return (struct richards_law){richards_head_given(region, time), -INFINITY, INFINITY};
  case EDGE_FLUX:
    given = richards_given_at(s, edge, time);
    return (struct richards_law){driest, given, given < 0 ? INFINITY : given};
  case EDGE_WELL:
    given = -richards_well_at(s, edge, time);
    return (struct richards_law){0, given, s->full ? given : 0};
  case EDGE_DRAIN:
    given = richards_head_given(region, time);
    return (struct richards_law){pull == 0 ? given : pull * fmax(given - edge->z, 0), -INFINITY, 0};
  }
  return (struct richards_law){0, 0, 0};
}

void richards_edge_flux(const struct richards *s, const struct richards_edge *edge, double time,
                        struct flux *flux) {
  const struct richards_law law = richards_law_at(s, edge, time);
  richards_flux_from_head(s, edge, law.head, flux);
  flux->di = flux->dj;
  if (flux->q < law.least) *flux = (struct flux){law.least, 0, 0};
  if (flux->q > law.most) *flux = (struct flux){law.most, 0, 0};
}

void richards_edge_fluxes(struct richards *s, double time) {
#pragma omp parallel for schedule(static) if (s->edge_count > RICHARDS_SERIAL_MAX)
  for (size_t e = 0; e < s->edge_count; e++)
    richards_edge_flux(s, &s->edges[e], time, &s->edge_flux[e]);
}
