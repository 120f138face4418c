#include "sphsolve/darcy/edges.h"

#include <math.h>

static double given_at(const struct region *region, double steady, double time) {
  return region->table.count > 0 ? time_table_at(&region->table, time, 0) : steady;
}

double richards_rain_at(const struct richards_edge *edge, double time) {
  if (edge->kind != EDGE_AIR || edge->region == NULL) return 0;
  return edge->share * given_at(edge->region, edge->region->rate, time);
}

void richards_flux_from_head(const struct richards *s, const struct richards_edge *edge,
                             double head, struct flux *flux) {
  const struct retention *soil = &s->soils[s->soil[edge->site]];
  struct retention_state outside;
  retention_at(soil, head, &outside);
  flux_in_soil(soil->conductivity[edge->axis], 0.5 * s->spacing,
               edge->low ? s->pull[edge->axis] : -s->pull[edge->axis], &outside,
               &s->now[edge->site], flux);
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
 * than its rate: nothing is sucked out of unsaturated soil. A face to the air lets out what comes
 * under pressure and takes in nothing but rain, as much of it as soil takes from no depth of water
 * (with a depth: darcy/pond.h).
 * Evaporation is limited to what air-dry soil at the face draws. */
struct richards_law richards_law_at(const struct richards *s, const struct richards_edge *edge,
                                    double time) {
  const struct region *region = edge->region;
  const double pull = -s->pull[2];
  double given = 0;
  switch (edge->kind) {
  case EDGE_AIR:
    return (struct richards_law){0, -INFINITY, richards_rain_at(edge, time)};
  case EDGE_HEAD:
    given = given_at(region, region->head, time);
    if (pull == 0) return (struct richards_law){given, -INFINITY, INFINITY};
    return (struct richards_law){pull * fmax(given - edge->z, 0), -INFINITY,
                                 given < edge->z - 1e-9 * s->spacing ? 0 : INFINITY};
  case EDGE_PRESSURE:
    return (struct richards_law){given_at(region, region->head, time), -INFINITY, INFINITY};
  case EDGE_FLUX:
    given = edge->share * given_at(region, region->flux, time);
    return (struct richards_law){s->soils[s->soil[edge->site]].driest, given,
                                 given < 0 ? INFINITY : given};
  case EDGE_WELL:
    given = -richards_well_at(s, edge, time);
    return (struct richards_law){0, given, s->full ? given : 0};
  case EDGE_DRAIN:
    given = given_at(region, region->head, time);
    return (struct richards_law){pull == 0 ? given : pull * fmax(given - edge->z, 0), -INFINITY, 0};
  }
  return (struct richards_law){0, 0, 0};
}

static void flux_at(const struct richards *s, const struct richards_edge *edge, double time,
                    struct flux *flux) {
  const struct richards_law law = richards_law_at(s, edge, time);
  richards_flux_from_head(s, edge, law.head, flux);
  flux->di = flux->dj;
  if (flux->q < law.least) *flux = (struct flux){law.least, 0, 0};
  if (flux->q > law.most) *flux = (struct flux){law.most, 0, 0};
}

void richards_edge_fluxes(struct richards *s, double time) {
#pragma omp parallel for schedule(static) if (s->edge_count > RICHARDS_SERIAL_MAX)
  for (size_t e = 0; e < s->edge_count; e++) flux_at(s, &s->edges[e], time, &s->edge_flux[e]);
}
