#include "sphsolve/darcy/pond.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/darcy/basin.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/edges.h"

/* ---- level and volume ---- */

/* Volume up to a level. Below the floor it goes on as above it: a stage may end there. */
static double volume_at(const struct richards *s, const struct richards_pool *p, double level,
                        double *area) {
  const double *areas = s->pool_areas + p->layer;
  double above = level - p->floor, sum = 0;
  size_t k = 0;
  for (; k + 1 < p->layer_count && above > s->spacing; k++)
    sum += areas[k] * s->spacing, above -= s->spacing;
  *area = areas[k];
  return sum + areas[k] * above;
}

static double level_of(const struct richards *s, const struct richards_pool *p, double volume) {
  const double *areas = s->pool_areas + p->layer;
  size_t k = 0;
  for (; k + 1 < p->layer_count && volume > areas[k] * s->spacing; k++)
    volume -= areas[k] * s->spacing;
  return p->floor + (double)k * s->spacing + volume / areas[k];
}

/* ---- one stage ---- */

/* A level, and whether water stands on faces at it. */
struct stand {
  double level;
  bool wet;
};

/* Flux through a face of a pool; di: by the level, dj: by the head of the site. */
static void flux_at(const struct richards *s, size_t e, const struct stand *stand, double time,
                    struct flux *flux) {
  const struct richards_edge *edge = &s->edges[e];
  const double depth = stand->level - edge->z, pull = -s->pull[2];
  const bool at = fabs(depth) <= LEVEL_ROUNDING * s->spacing;
  if (at ? stand->wet : depth > 0) {
    richards_flux_from_head(s, edge, pull * fmax(depth, 0), flux);
    *flux = (struct flux){flux->q, pull * fmax(flux->di, 0), flux->dj};
    return;
  }
  richards_edge_flux(s, edge, time, flux);
  flux->di = 0;
}

/* Sum of the fluxes out of a pool, m^3/s, and its derivative by the level. */
static double outflow(const struct richards *s, const struct richards_pool *p,
                      const struct stand *stand, double time, double *by) {
  double sum = 0;
  *by = 0;
  for (size_t k = 0; k < p->edge_count; k++) {
    struct flux flux;
    flux_at(s, s->pool_edges[p->edge + k].edge, stand, time, &flux);
    sum += flux.q, *by += flux.di;
  }
  *by *= s->spacing * s->spacing;
  return sum * s->spacing * s->spacing;
}

static double caught(const struct richards *s, const struct richards_pool *p, double time) {
  double sum = 0;
  for (size_t k = 0; k < p->source_count; k++)
    sum += richards_source_at(&s->sources[p->source + k], time);
  return sum * s->spacing * s->spacing;
}

/* What a pool has too much at a level at the end of the stage, m^3; it rises with the level.
 * `supply`: what it had and has caught. */
static double excess(const struct richards *s, const struct richards_pool *p,
                     const struct stand *stand, double supply, double time, double *slope) {
  double area;
  const double volume = volume_at(s, p, stand->level, &area),
               out = outflow(s, p, stand, time, slope);
  *slope = area + s->stage * *slope;
  return volume - supply + s->stage * out;
}

/* The level between two at which nothing is in excess, by Newton's method within a bracket; at the
 * lower one faces are wet, at the higher one not. */
static struct stand find_root(const struct richards *s, const struct richards_pool *p, double low,
                              double high, double supply, double time) {
  const double middle = 0.5 * (low + high);
  struct stand stand = {.level = fmin(fmax(p->level, low), high)};
  double slope;
  for (int round = 0; round < POND_ROUNDS; round++) {
    stand.wet = stand.level < middle;
    const double much = excess(s, p, &stand, supply, time, &slope);
    *(much > 0 ? &high : &low) = stand.level;
    double next = stand.level - much / slope;
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    const bool near = fabs(next - stand.level) <= POND_TOLERANCE * s->spacing;
    stand.level = next;
    if (near) break;
  }
  return stand;
}

/* Finds the level of a pool at the end of the stage, between the heights of faces; or at the height
 * of some, if more is in excess with water on them and less without: *share of them is wet then. At
 * the floor this share may be below 0: what a first stage has taken too much of comes back. */
static struct stand find_level(const struct richards *s, const struct richards_pool *p,
                               double supply, double time, double *share) {
  const double *height = s->pool_heights + p->height;
  size_t low = 0, high = p->height_count; /* the first at which too much is in excess if wet */
  double slope, with = 0;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    const struct stand stand = {height[middle], true};
    const double much = excess(s, p, &stand, supply, time, &slope);
    if (much >= 0)
      high = middle, with = much;
    else
      low = middle + 1;
  }
  *share = 1;
  if (high < p->height_count) {
    const struct stand stand = {height[high], false};
    const double without = excess(s, p, &stand, supply, time, &slope);
    if ((without <= 0 || high == 0) && with > without) {
      *share = without / (without - with);
      return stand;
    }
  }
  /* The level is at most that which the outflow at the height below leaves. */
  const struct stand below = {high > 0 ? height[high - 1] : -INFINITY, true};
  const double most = level_of(s, p, supply - s->stage * outflow(s, p, &below, time, &slope));
  const double top = high < p->height_count ? fmin(height[high], most) : most;
  if (high == 0) return (struct stand){top, false};
  return find_root(s, p, below.level, top, supply, time);
}

/* Fluxes of a pool with a share of the faces at its level wet. */
static void set_fluxes(struct richards *s, const struct richards_pool *p, const struct stand *stand,
                       double share, double time) {
  const struct stand wet = {stand->level, true}, dry = {stand->level, false};
  for (size_t k = 0; k < p->edge_count; k++) {
    const size_t e = s->pool_edges[p->edge + k].edge;
    struct flux on, off;
    if (share == 1) {
      flux_at(s, e, stand, time, &on);
      s->edge_flux[e] = (struct flux){on.q, on.dj, on.di};
      continue;
    }
    flux_at(s, e, &wet, time, &on);
    flux_at(s, e, &dry, time, &off);
    s->edge_flux[e] = (struct flux){.q = off.q + share * (on.q - off.q),
                                    .di = off.dj + share * (on.dj - off.dj),
                                    .dj = fmax(on.q - off.q, 0)};
  }
}

static void solve_pool(struct richards *s, struct richards_pool *p, double time) {
  const double supply = p->from + s->stage * caught(s, p, time);
  double slope, out = 0, volume;
  struct stand stand = {level_of(s, p, p->most), true};
  const bool over = isfinite(p->most) && excess(s, p, &stand, supply, time, &slope) <= 0;
  p->share = 1;
  if (!over) stand = find_level(s, p, supply, time, &p->share);
  set_fluxes(s, p, &stand, p->share, time);
  volume = volume_at(s, p, stand.level, &p->storage);
  for (size_t k = 0; k < p->edge_count; k++) out += s->edge_flux[s->pool_edges[p->edge + k].edge].q;
  out *= s->stage * s->spacing * s->spacing;
  *p->volume = over ? p->most : p->share < 1 ? volume : supply - out;
  p->level = stand.level;
  if (p->share < 1) p->storage = 0;
  if (over) p->storage = INFINITY; /* it stays */
}

/* ---- setting up ---- */

/* Adds a face to the last pool. */
static void add_edge(struct richards *s, size_t e) {
  struct richards_pool *p = &s->pools[s->pool_count - 1];
  struct richards_edge *edge = &s->edges[e];
  const uint32_t row = (uint32_t)(s->count + s->pool_count - 1);
  double *height = s->pool_heights + p->height;
  size_t k = p->height_count;
  edge->pool = (uint32_t)s->pool_count;
  s->pool_edges[s->pool_edge_count++].edge = e, p->edge_count++;
  if (p->edge_count == 1 || s->pool_pairs[s->pool_pair_count - 1][0] != edge->site) {
    s->pool_pairs[s->pool_pair_count][0] = edge->site;
    s->pool_pairs[s->pool_pair_count++][1] = row;
  }
  while (k > 0 && height[k - 1] > edge->z + LEVEL_ROUNDING * s->spacing) k--;
  if (k > 0 && height[k - 1] > edge->z - LEVEL_ROUNDING * s->spacing) return;
  memmove(height + k + 1, height + k, (p->height_count - k) * sizeof *height);
  height[k] = edge->z, p->height_count++;
}

static struct richards_pool *add_pool(struct richards *s, size_t layer, size_t source) {
  struct richards_pool *p = &s->pools[s->pool_count];
  *p = (struct richards_pool){.edge = s->pool_edge_count,
                              .height = s->pool_edge_count,
                              .layer = layer,
                              .layer_count = 1,
                              .source = source,
                              .share = 1,
                              .volume = &s->pool_volumes[s->pool_count]};
  s->pool_count++;
  return p;
}

/* Largest depth on a face of what rains leave there, of which each may cover a part. */
static double depth_most(const struct richards *s, const struct richards_edge *edge) {
  double sum = 0;
  for (size_t k = 0; k < edge->source_count && edge->region == NULL; k++) {
    const struct richards_source *source = &s->sources[edge->source + k];
    sum += source->share * source->region->ponding;
  }
  return sum;
}

static void add_face(struct richards *s, size_t e, size_t layer) {
  const struct richards_edge *edge = &s->edges[e];
  struct richards_pool *p = add_pool(s, layer, edge->source);
  s->pool_areas[layer] = s->spacing * s->spacing;
  p->source_count = edge->source_count;
  p->floor = p->level = edge->z;
  p->most = s->pool_areas[layer] * depth_most(s, edge);
  add_edge(s, e);
}

/* What falls or flows into a basin at one of its places. */
static enum status add_catch(struct richards *s, struct richards_pool *p, size_t at, size_t layer) {
  const struct lattice *l = s->lattice;
  const size_t below = lattice_beyond(s->scene->periodic, l, at, 2, true);
  const bool floor = below == l->count || s->open[below] != s->open[at];
  s->pool_areas[layer] += s->spacing * s->spacing;
  for (int side = 0; side < 6; side++) {
    struct richards_source source;
    if (l->dimensions == 2 && side / 2 == 1) continue;
    for (size_t r = 0;; r++) {
      r = domain_source_at(s->scene, l, at, side / 2, side % 2 == 0, r, &source.share);
      if (r == s->scene->region_count) break;
      source.region = &s->scene->regions[r];
      if (source.region->type == REGION_RAIN && !floor) continue;
      const size_t count = p->source + p->source_count + 1;
      const enum status status =
          memory_resize(&s->sources, count, sizeof *s->sources, "free water");
      if (status != STATUS_OK) return status;
      s->sources[count - 1] = source, p->source_count++;
    }
  }
  return STATUS_OK;
}

/* Adds the body of water that a region belongs to. *layer, *source: the first free ones. */
static enum status add_body(struct richards *s, size_t r, size_t *layer, size_t *source) {
  const struct lattice *l = s->lattice;
  const size_t plane = l->size[0] * l->size[1];
  const struct basin *basin = &s->basins[r];
  size_t lowest = l->count;
  double area;
  if (!basin->found) return STATUS_OK;
  struct richards_pool *p = add_pool(s, *layer, *source);
  p->region = &s->scene->regions[r];
  for (size_t at = 0; at < l->count; at++) {
    if (s->open[at] != r + 1) continue;
    if (lowest == l->count) lowest = at / plane;
    p->layer_count = at / plane - lowest + 1;
    const enum status status = add_catch(s, p, at, *layer + p->layer_count - 1);
    if (status != STATUS_OK) return status;
  }
  *layer += p->layer_count, *source += p->source_count;
  p->floor = l->origin[2] + ((double)lowest - 0.5) * l->spacing[2];
  p->most = INFINITY;
  p->most = volume_at(s, p, basin->brim, &area);
  *p->volume = fmin(volume_at(s, p, basin->level, &area), p->most);
  p->level = level_of(s, p, *p->volume);
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->edges[e].kind == EDGE_POOL && s->edges[e].region == p->region) add_edge(s, e);
  return STATUS_OK;
}

enum status richards_pond_create(struct richards *s) {
  enum status status = STATUS_OK;
  const size_t layers = s->lattice->size[2];
  size_t faces = 0, edges = 0, bodies = 0, layer = 0, source = s->source_count;
  for (size_t e = 0; e < s->edge_count; e++) {
    const bool face = s->edges[e].kind == EDGE_AIR && depth_most(s, &s->edges[e]) > 0;
    faces += face, edges += face || s->edges[e].kind == EDGE_POOL;
  }
  for (size_t r = 0; r < s->scene->region_count && s->basins != NULL; r++)
    bodies += s->basins[r].found;
  if (faces + bodies == 0) return STATUS_OK;
  TRY(memory_allocate(&s->pools, faces + bodies, sizeof *s->pools, "free water"));
  TRY(memory_allocate(&s->pool_volumes, faces + bodies, sizeof(double), "free water"));
  TRY(memory_allocate(&s->pool_areas, faces + bodies * layers, sizeof(double), "free water"));
  TRY(memory_allocate(&s->pool_heights, edges, sizeof(double), "free water"));
  TRY(memory_allocate(&s->pool_edges, edges, sizeof *s->pool_edges, "free water"));
  TRY(memory_allocate(&s->pool_pairs, edges, sizeof *s->pool_pairs, "free water"));
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->edges[e].kind == EDGE_AIR && depth_most(s, &s->edges[e]) > 0) add_face(s, e, layer++);
  for (size_t r = 0; r < s->scene->region_count && bodies > 0; r++)
    TRY(add_body(s, r, &layer, &source));
cleanup:
  return status;
}

void richards_pond_free(struct richards *s) {
  memory_free(&s->pools);
  memory_free(&s->pool_volumes);
  memory_free(&s->pool_areas);
  memory_free(&s->pool_heights);
  memory_free(&s->pool_edges);
  memory_free(&s->pool_pairs);
}

/* ---- fluxes ---- */

void richards_pond_fluxes(struct richards *s, double time) {
#pragma omp parallel for schedule(static) if (s->pool_edge_count > RICHARDS_SERIAL_MAX)
  for (size_t k = 0; k < s->pool_count; k++) {
    struct richards_pool *p = &s->pools[k];
    const struct stand stand = {p->level, *p->volume > 0};
    if (s->stage > 0)
      solve_pool(s, p, time);
    else
      set_fluxes(s, p, &stand, p->share, time);
  }
}

void richards_pond_assemble(struct richards *s) {
  struct rows *rows = &s->rows;
  const double area = s->spacing * s->spacing, scale = s->stage / s->spacing;
  for (size_t n = 0; n < s->pool_count; n++) {
    const struct richards_pool *p = &s->pools[n];
    double diagonal = p->storage;
    for (size_t k = 0; k < p->edge_count; k++)
      diagonal += s->stage * area * s->edge_flux[s->pool_edges[p->edge + k].edge].dj;
    rows->value[rows->diagonal[s->count + n]] = 1;
    for (size_t k = 0; k < p->edge_count && diagonal > 0; k++) {
      const struct richards_pool_edge *at = &s->pool_edges[p->edge + k];
      const struct flux *flux = &s->edge_flux[at->edge];
      rows->value[at->ij] -= scale * flux->dj;
      rows->value[at->ji] += s->stage * area * fmin(flux->di, 0) / diagonal;
    }
  }
}

/* ---- steps ---- */

static double rate_of(const struct richards *s, const struct richards_pool *p) {
  return (*p->volume - p->from) / s->stage;
}

void richards_pond_begin(struct richards *s, double dt) {
  s->stage = SDIRK_GAMMA * dt;
  for (size_t k = 0; k < s->pool_count; k++) {
    struct richards_pool *p = &s->pools[k];
    p->before = p->from = *p->volume, p->level = level_of(s, p, *p->volume);
  }
}

void richards_pond_second(struct richards *s, double dt) {
  for (size_t k = 0; k < s->pool_count; k++) {
    struct richards_pool *p = &s->pools[k];
    p->first = rate_of(s, p);
    /* What is too much runs off. */
    p->from = fmin(p->from + (1 - SDIRK_GAMMA) * dt * p->first, p->most);
  }
}

void richards_pond_back(struct richards *s) {
  for (size_t k = 0; k < s->pool_count; k++) {
    struct richards_pool *p = &s->pools[k];
    *p->volume = p->before, p->level = level_of(s, p, *p->volume);
  }
  s->stage = 0;
}

void richards_pond_end(struct richards *s) {
  s->stage = 0;
}

void richards_pond_balance(struct richards *s, const double weight[2], const double time[2]) {
  for (size_t n = 0; n < s->pool_count; n++) {
    const struct richards_pool *p = &s->pools[n];
    double left = p->before - *p->volume, covered = 0;
    for (size_t k = 0; k < p->edge_count; k++) {
      const size_t e = s->pool_edges[p->edge + k].edge;
      left -= weight[0] * s->edge_first[e] + weight[1] * s->edge_flux[e].q;
    }
    for (size_t k = 0; k < p->source_count; k++) {
      const struct richards_source *source = &s->sources[p->source + k];
      const double given = weight[0] * richards_source_at(source, time[0]) +
                           weight[1] * richards_source_at(source, time[1]);
      const bool rain = source->region->type == REGION_RAIN;
      (rain ? s->rained : s->entered)[source->region->first] += given;
      left += given, covered += source->share;
    }
    if (p->region != NULL) {
      s->ran_off[p->region->first] += left;
      continue;
    }
    for (size_t k = 0; k < p->source_count; k++) {
      const struct richards_source *source = &s->sources[p->source + k];
      s->ran_off[source->region->first] += left * source->share / covered;
    }
  }
}

double richards_pond_difference(const struct richards *s) {
  double most = 0, area;
  for (size_t k = 0; k < s->pool_count; k++) {
    const struct richards_pool *p = &s->pools[k];
    volume_at(s, p, p->level, &area);
    most = fmax(most, fabs(rate_of(s, p) - p->first) / area);
  }
  return most;
}

double richards_pond_rate(const struct richards *s, double dt) {
  double most = 0, area;
  for (size_t k = 0; k < s->pool_count; k++) {
    const struct richards_pool *p = &s->pools[k];
    volume_at(s, p, p->level, &area);
    most = fmax(most, fabs(*p->volume - p->before) / (dt * area));
  }
  return most;
}

double richards_pond_volume(const struct richards *s, const struct region *region) {
  double sum = 0;
  for (size_t n = 0; n < s->pool_count; n++) {
    const struct richards_pool *p = &s->pools[n];
    double part = region == NULL || p->region == region ? *p->volume : 0;
    for (size_t k = 0; k < p->source_count && p->region == NULL && region != NULL; k++) {
      const struct richards_source *source = &s->sources[p->source + k];
      const double deep = source->share * source->region->ponding;
      if (source->region == region) part += *p->volume * deep * s->spacing * s->spacing / p->most;
    }
    sum += part;
  }
  return sum;
}

double richards_pond_level(const struct richards *s, const struct region *region) {
  for (size_t k = 0; k < s->pool_count; k++)
    if (s->pools[k].region == region) return s->pools[k].level;
  return NAN;
}
