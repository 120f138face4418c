#include "sphsolve/darcy/pond.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"

/* Largest depth on a face, of which rains may cover parts only. */
static double depth_most(const struct richards *s, const struct richards_edge *edge) {
  double sum = 0;
  for (size_t k = 0; k < edge->source_count && edge->region == NULL; k++) {
    const struct richards_source *source = &s->sources[edge->source + k];
    sum += source->share * source->region->ponding;
  }
  return sum;
}

enum status richards_pond_create(struct richards *s) {
  enum status status = STATUS_OK;
  bool any = false;
  for (size_t e = 0; e < s->edge_count; e++) any = any || depth_most(s, &s->edges[e]) > 0;
  if (!any) return STATUS_OK;
  double **const arrays[] = {&s->pond, &s->pond_before, &s->pond_from, &s->pond_first};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    TRY(memory_allocate(arrays[k], s->edge_count, sizeof(double), "water that stands on soil"));
cleanup:
  return status;
}

void richards_pond_free(struct richards *s) {
  memory_free(&s->pond);
  memory_free(&s->pond_before);
  memory_free(&s->pond_from);
  memory_free(&s->pond_first);
}

/* Finds the depth at the end of the stage, and the flux then. With
 *   g(d) = d0 + dt (r - q(d)) - d,
 * which falls, it is 0 where g(0) <= 0, the largest where g is positive there, else the root. */
static void solve_depth(struct richards *s, size_t e, double rain) {
  const struct richards_edge *edge = &s->edges[e];
  const double pull = -s->pull[2], most = depth_most(s, edge), dt = s->stage;
  const double supply = rain + s->pond_from[e] / dt;
  struct flux *flux = &s->edge_flux[e];
  double *depth = &s->pond[e];
  richards_flux_from_head(s, edge, 0, flux);
  if (flux->q >= supply) {
    *depth = 0;
    *flux = (struct flux){.q = supply};
    return;
  }
  *depth = most;
  richards_flux_from_head(s, edge, pull * most, flux);
  if (dt * (supply - flux->q) >= most) {
    flux->di = flux->dj;
    return;
  }
  for (int round = 0; round < POND_ROUNDS; round++) {
    const double change = (dt * (supply - flux->q) - *depth) / (1 + dt * pull * flux->di);
    *depth = fmin(fmax(*depth + change, 0), most);
    richards_flux_from_head(s, edge, pull * *depth, flux);
    if (fabs(change) <= POND_TOLERANCE * s->spacing) break;
  }
  *flux = (struct flux){.q = supply - *depth / dt, .di = flux->dj / (1 + dt * pull * flux->di)};
}

void richards_pond_fluxes(struct richards *s, double time) {
  if (s->pond == NULL) return;
#pragma omp parallel for schedule(static) if (s->edge_count > RICHARDS_SERIAL_MAX)
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    struct flux *flux = &s->edge_flux[e];
    if (!(depth_most(s, edge) > 0)) continue;
    const double rain = richards_given_at(s, edge, time);
    if (s->stage > 0) {
      solve_depth(s, e, rain);
    } else if (s->pond[e] > 0) {
      richards_flux_from_head(s, edge, -s->pull[2] * s->pond[e], flux);
      flux->di = flux->dj;
    }
  }
}

void richards_pond_begin(struct richards *s, double dt) {
  if (s->pond == NULL) return;
  s->stage = SDIRK_GAMMA * dt;
  memcpy(s->pond_before, s->pond, s->edge_count * sizeof *s->pond);
  memcpy(s->pond_from, s->pond, s->edge_count * sizeof *s->pond);
}

static double rate_of(const struct richards *s, size_t e) {
  return (s->pond[e] - s->pond_from[e]) / s->stage;
}

void richards_pond_second(struct richards *s, double dt) {
  for (size_t e = 0; s->pond != NULL && e < s->edge_count; e++) {
    const double most = depth_most(s, &s->edges[e]);
    s->pond_first[e] = rate_of(s, e);
    /* What is above the largest depth runs off. */
    s->pond_from[e] = fmin(s->pond_from[e] + (1 - SDIRK_GAMMA) * dt * s->pond_first[e], most);
  }
}

void richards_pond_back(struct richards *s) {
  if (s->pond == NULL) return;
  memcpy(s->pond, s->pond_before, s->edge_count * sizeof *s->pond);
  s->stage = 0;
}

void richards_pond_end(struct richards *s) {
  s->stage = 0;
}

double richards_pond_difference(const struct richards *s) {
  double most = 0;
  for (size_t e = 0; s->pond != NULL && e < s->edge_count; e++)
    most = fmax(most, fabs(rate_of(s, e) - s->pond_first[e]));
  return most;
}

double richards_pond_rise(const struct richards *s, size_t edge) {
  return s->pond == NULL ? 0 : s->pond[edge] - s->pond_before[edge];
}

double richards_pond_volume(const struct richards *s, const struct region *rain) {
  double sum = 0;
  for (size_t e = 0; s->pond != NULL && e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    const double most = rain == NULL ? 1 : depth_most(s, edge);
    double part = rain == NULL ? 1 : 0; /* of the largest depth */
    for (size_t k = 0; k < edge->source_count && rain != NULL; k++)
      if (s->sources[edge->source + k].region == rain)
        part += s->sources[edge->source + k].share * rain->ponding;
    if (part > 0) sum += s->pond[e] * part / most;
  }
  return sum * s->spacing * s->spacing;
}
