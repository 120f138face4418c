#include "sphsolve/darcy/sites.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/darcy/balance.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/hole.h"
#include "sphsolve/darcy/open_water.h"
#include "sphsolve/darcy/pond.h"
#include "sphsolve/darcy/saturated.h"
#include "sphsolve/scene/scene.h"

#define NO_SOIL UINT16_MAX /* in of_region: free water, or soil without drag */

static const struct region *region_of(const struct richards *s, size_t site) {
  const size_t at = wall_cuts_site(&s->walls, s->scene, s->lattice, site);
  return &s->scene->regions[s->lattice->region[at] - 1];
}

/* Free water beside soil that is full: its flow has no resistance to speak of. */
static void make_water(struct retention *water, const struct retention *soils, size_t count) {
  double most = 0;
  for (size_t k = 0; k < count; k++)
    for (int a = 0; a < 3; a++) most = fmax(most, soils[k].conductivity[a]);
  most *= WATER_CONDUCTIVITY;
  *water =
      (struct retention){.theta_s = 1, .conductivity = {most, most, most}, .driest = -INFINITY};
}

/* Builds the soils; regions with the same properties share one. */
static enum status find_soils(struct richards *s, uint16_t *of_region) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  const double nu = scene->fluid.viscosity / scene->fluid.density;
  TRY(memory_allocate(&s->soils, scene->region_count + 1, sizeof *s->soils, "soils"));
  for (size_t r = 0; r < scene->region_count; r++) {
    if (scene->regions[r].type != REGION_POROUS) continue;
    if (scene->regions[r].first != r) {
      of_region[r] = of_region[scene->regions[r].first];
      continue;
    }
    struct retention *soil = &s->soils[s->soil_count];
    if (s->full && !retention_full(&scene->regions[r], nu, soil)) {
      of_region[r] = NO_SOIL;
      continue;
    }
    if (!s->full) status = retention_make(&scene->regions[r], soil);
    s->soil_count++;
    if (status != STATUS_OK) goto cleanup;
    s->turned = s->turned || soil->shear != 0;
    size_t same = 0;
    while (!retention_is_same(&s->soils[same], soil)) same++;
    if (same + 1 < s->soil_count) retention_free(soil), s->soil_count--;
    of_region[r] = (uint16_t)same;
  }
  if (s->full) make_water(&s->soils[s->soil_count], s->soils, s->soil_count), s->soil_count++;
cleanup:
  return status;
}

/* Whether a site takes part, as one of a wall does whose cell is open to soil; free water beside
 * soil that need not be full does not. */
static bool is_soil(const struct richards *s, size_t site) {
  const size_t at = wall_cuts_site(&s->walls, s->scene, s->lattice, site);
  if (!(wall_cuts_volume(&s->walls, site) > 0)) return false;
  if (wall_cuts_own(&s->walls, at)) {
    const enum region_type type = domain_filled_at(s->scene, s->lattice, at);
    return type == REGION_POROUS || (s->full && type == REGION_WATER);
  }
  return s->lattice->kind[at] == SITE_FLUID && !domain_is_water(s->scene, s->lattice, at);
}

static size_t beyond(const struct richards *s, size_t at, int axis, bool low) {
  return lattice_beyond(s->scene->periodic, s->lattice, at, axis, low);
}

/* Adds what is given at the face of a site to its edge. */
static void add_sources(struct richards *s, size_t at, struct richards_edge *edge, bool count) {
  const struct scene *scene = s->scene;
  struct richards_source source;
  edge->source = (uint32_t)s->source_count;
  for (size_t r = 0;; r++) {
    r = domain_source_at(scene, s->lattice, at, edge->axis, edge->low, r, &source.share);
    if (r == scene->region_count) return;
    source.share *= edge->open;
    source.region = &scene->regions[r];
    if (source.region->type == REGION_INFLOW && edge->source_count == 0) edge->kind = EDGE_FLUX;
    if (source.region->type == REGION_RAIN) edge->kind = EDGE_AIR;
    if (!count) s->sources[s->source_count] = source;
    s->source_count++, edge->source_count++;
  }
}

/* Adds the face of site i at one side: between two sites, or to the outside; with `count` it is
 * only counted. */
static void add_face(struct richards *s, size_t i, int axis, bool low, bool count) {
  static const enum richards_edge_kind kinds[] = {
      [BOUNDARY_NONE] = EDGE_AIR, [BOUNDARY_HEAD] = EDGE_HEAD, [BOUNDARY_PRESSURE] = EDGE_PRESSURE};
  const struct lattice *l = s->lattice;
  const size_t at = s->site[i], next = beyond(s, at, axis, low);
  const double open = wall_cuts_face(&s->walls, at, axis, !low);
  double x[3];
  if (open == 0) return;
  if (next != l->count && l->kind[next] == SITE_WALL && s->number[next] == SITE_NONE) return;
  if (next != l->count && s->number[next] != SITE_NONE) {
    if (low || next == at) return; /* each only once */
    if (!count) {
      const uint32_t f = (uint32_t)s->face_count, j = s->number[next];
      s->faces[f] = (struct richards_face){.i = (uint32_t)i, .j = j, .axis = (uint8_t)axis};
      if (s->full)
        s->beside[6 * i + 2 * (size_t)axis + 1] = s->beside[6 * j + 2 * (size_t)axis] = f;
    }
    s->face_count++;
    return;
  }
  /* The surface of free water is at the level that its windows hold. */
  if (s->full && next != l->count && s->soil[i] + 1u == s->soil_count) return;
  richards_place(s, i, x);
  struct richards_edge edge = {.site = (uint32_t)i,
                               .axis = (uint8_t)axis,
                               .low = low,
                               .open = open,
                               .z = x[2] + (axis != 2 ? 0
                                            : low     ? -0.5
                                                      : 0.5) *
                                               s->spacing};
  add_sources(s, at, &edge, count);
  if (next == l->count) edge.region = domain_window_at(s->scene, l, x, axis, low);
  if (next != l->count && s->open != NULL && s->open[next] != 0)
    edge.region = &s->scene->regions[s->open[next] - 1];
  if (edge.region != NULL)
    edge.kind = edge.region->type == REGION_WATER ? EDGE_POOL : kinds[edge.region->boundary];
  if (edge.region == NULL && next == l->count && edge.source_count == 0) return; /* closed */
  if (!count) s->edges[s->edge_count] = edge;
  if (!count) s->beside[6 * i + 2 * (size_t)axis + !low] = BESIDE_EDGE | (uint32_t)s->edge_count;
  s->edge_count++;
}

/* Adds the well or drain that contains a site, if any. */
static void add_well(struct richards *s, size_t i, bool count) {
  double x[3];
  if (s->lattice->kind[s->site[i]] == SITE_WALL) return;
  richards_place(s, i, x);
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *part = &s->scene->regions[r];
    if ((part->type != REGION_WELL && part->type != REGION_DRAIN) ||
        !domain_holds(s->scene, part->box, x))
      continue;
    if (s->full) s->soil[i] = (uint16_t)(s->soil_count - 1); /* free water stands in it */
    if (!count)
      s->edges[s->edge_count] =
          (struct richards_edge){.site = (uint32_t)i,
                                 .kind = part->type == REGION_WELL ? EDGE_WELL : EDGE_DRAIN,
                                 .region = &s->scene->regions[part->first],
                                 .open = 1,
                                 .share = 1,
                                 .z = x[2]};
    s->edge_count++;
    return;
  }
}

static void add_faces(struct richards *s, bool count) {
  s->face_count = s->edge_count = s->source_count = 0;
  for (size_t i = 0; i < s->count; i++) add_well(s, i, count);
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++)
      for (int side = 0; side < 2; side++)
        if (!(s->lattice->dimensions == 2 && a == 1)) add_face(s, i, a, side == 0, count);
}

/* The two rows of pair p: of the sites of a face, or of a corner, or of a site and its pool. */
static void pair_at(const struct richards *s, size_t p, uint32_t pair[2]) {
  if (p < s->face_count)
    pair[0] = s->faces[p].i, pair[1] = s->faces[p].j;
  else if (p < s->face_count + s->corner_count)
    memcpy(pair, s->corners[p - s->face_count], 2 * sizeof *pair);
  else
    memcpy(pair, s->pool_pairs[p - s->face_count - s->corner_count], 2 * sizeof *pair);
}

/* Sets up the matrix: a row for each site and pool, with entries for itself and each neighbour, in
 * increasing order. */
static enum status make_rows(struct richards *s) {
  enum status status = STATUS_OK;
  struct rows *rows = &s->rows;
  const size_t pairs = s->face_count + s->corner_count + s->pool_pair_count,
               count = s->count + s->pool_count;
  uint32_t pair[2];
  TRY(rows_allocate(count, count + 2 * pairs, rows));
  for (size_t i = 0; i < count; i++) rows->start[i + 1] = 1;
  for (size_t p = 0; p < pairs; p++) {
    pair_at(s, p, pair);
    rows->start[pair[0] + 1]++, rows->start[pair[1] + 1]++;
  }
  for (size_t i = 0; i < count; i++) rows->start[i + 1] += rows->start[i];
  for (size_t i = 0; i < count; i++) rows->column[rows->start[i]] = (uint32_t)i;
  /* end of the entries so far */
  for (size_t i = 0; i < count; i++) rows->diagonal[i] = rows->start[i] + 1;
  for (size_t p = 0; p < pairs; p++) {
    pair_at(s, p, pair);
    for (int side = 0; side < 2; side++) {
      const uint32_t i = pair[side], j = pair[1 - side];
      size_t k = rows->diagonal[i]++;
      for (; k > rows->start[i] && rows->column[k - 1] > j; k--)
        rows->column[k] = rows->column[k - 1];
      rows->column[k] = j;
    }
  }
  for (size_t i = 0; i < count; i++) rows->diagonal[i] = rows_entry(rows, i, (uint32_t)i);
  for (size_t f = 0; f < s->face_count; f++) {
    s->faces[f].ij = rows_entry(rows, s->faces[f].i, s->faces[f].j);
    s->faces[f].ji = rows_entry(rows, s->faces[f].j, s->faces[f].i);
    s->faces[f].soils_differ = s->soil[s->faces[f].i] != s->soil[s->faces[f].j];
  }
  for (size_t k = 0; k < s->pool_edge_count; k++) {
    struct richards_pool_edge *at = &s->pool_edges[k];
    const struct richards_edge *edge = &s->edges[at->edge];
    at->ij = rows_entry(rows, edge->site, s->count + edge->pool - 1);
    at->ji = rows_entry(rows, s->count + edge->pool - 1, edge->site);
  }
cleanup:
  return status;
}

/* Initial pressure head of a site: water at rest below a level, a uniform pressure head, or a
 * uniform water content. */
static double head_at_start(const struct richards *s, size_t i) {
  const struct region *region = region_of(s, s->site[i]);
  const struct retention_curve *given = &region->retention;
  const struct retention *soil = &s->soils[s->soil[i]];
  double x[3], h = given->start;
  richards_place(s, i, x);
  if (given->starts_by == START_HEAD) h = -s->pull[2] * (given->start - x[2]);
  if (given->starts_by == START_WATER && given->start < soil->theta_s)
    h = retention_head(soil, retention_saturation(soil, given->start));
  if (given->starts_by == START_WATER && !(given->start < soil->theta_s)) h = 0;
  return fmax(h, soil->driest);
}

/* Whether an inflow has an open face of soil, fills empty space, or feeds a body of water. */
static bool comes_in(const struct richards *s, const struct region *inflow) {
  const size_t number = (size_t)(inflow - s->scene->regions);
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->edges[e].region == inflow) return true;
  for (size_t n = 0; n < s->source_count; n++)
    if (s->sources[n].region == inflow) return true;
  for (size_t at = 0; at < s->lattice->count && s->open != NULL; at++)
    if (s->open[at] == number + 1) return true;
  for (size_t p = 0; p < s->pool_count; p++)
    for (size_t n = 0; n < s->pools[p].source_count; n++)
      if (s->sources[s->pools[p].source + n].region == inflow) return true;
  return false;
}

/* Refuses an inflow of which walls that cut cells, or later inflows, leave no face open. */
static enum status check_inflows(const struct richards *s) {
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *region = &s->scene->regions[r];
    if (region->type == REGION_INFLOW && !comes_in(s, region))
      return FAIL(
          STATUS_INPUT,
          "%s:%d: a wall or a later inflow covers the whole of this inflow, so nothing comes "
          "in by it: leave a part of its side open, or leave it out",
          s->scene->path, region->line);
  }
  return STATUS_OK;
}

enum status richards_create(const struct scene *scene, const struct lattice *lattice,
                            struct richards *s) {
  enum status status = STATUS_OK;
  uint16_t *of_region = NULL;
  *s = (struct richards){.scene = scene,
                         .lattice = lattice,
                         .spacing = lattice->spacing[0],
                         .full = domain_is_full(scene),
                         .tolerance = STEP_TOLERANCE};
  for (int a = 0; a < 3; a++) s->pull[a] = scene->driving[a] / GRAVITY_STANDARD;
  for (size_t r = 0; r < scene->region_count; r++)
    s->changes = s->changes || scene->regions[r].table.count > 0;
  TRY(memory_allocate(&of_region, scene->region_count, sizeof *of_region, "soils"));
  TRY(find_soils(s, of_region));
  TRY(wall_cuts_find(scene, lattice, &s->walls));
  for (size_t at = 0; at < lattice->count; at++) s->count += is_soil(s, at);
  TRY(memory_allocate(&s->site, s->count, sizeof *s->site, "sites of soil"));
  TRY(memory_allocate(&s->number, lattice->count, sizeof *s->number, "sites of soil"));
  TRY(memory_allocate(&s->soil, s->count, sizeof *s->soil, "sites of soil"));
  s->count = 0;
  for (size_t at = 0; at < lattice->count; at++) {
    s->number[at] = SITE_NONE;
    if (!is_soil(s, at)) continue;
    s->site[s->count] = (uint32_t)at;
    s->number[at] = (uint32_t)s->count++;
  }
  for (size_t i = 0; i < s->count; i++) {
    double x[3];
    const size_t at = wall_cuts_site(&s->walls, scene, lattice, s->site[i]);
    domain_place(lattice, at, x);
    const size_t r = s->full || wall_cuts_own(&s->walls, at) ? domain_soil_at(scene, x)
                                                             : (size_t)(lattice->region[at] - 1);
    s->soil[i] = r < scene->region_count ? of_region[r] : NO_SOIL;
    if (s->soil[i] == NO_SOIL) s->soil[i] = (uint16_t)(s->soil_count - 1);
  }
  TRY(memory_allocate(&s->beside, s->count, 6 * sizeof *s->beside, "faces of sites"));
  memset(s->beside, 0xff, 6 * s->count * sizeof *s->beside);
  if (!s->full) {
    TRY(open_water_find(scene, lattice, false, &s->open));
    TRY(memory_allocate(&s->basins, scene->region_count, sizeof *s->basins, "free water"));
    TRY(basin_find(scene, lattice, s->open, s->basins));
  }
  add_faces(s, true);
  TRY(memory_allocate(&s->faces, s->face_count, sizeof *s->faces, "faces between sites"));
  TRY(memory_allocate(&s->edges, s->edge_count, sizeof *s->edges, "faces to the outside"));
  TRY(memory_allocate(&s->sources, s->source_count, sizeof *s->sources, "faces to the outside"));
  add_faces(s, false);
  s->turned = s->turned || (s->full && s->soil_count > 2);
  TRY(richards_holes_create(s));
  if (s->full) TRY(richards_saturated_bodies(s));
  if (s->turned) TRY(richards_saturated_corners(s));
  TRY(richards_pond_create(s));
  TRY(check_inflows(s));
  TRY(make_rows(s));
  double **const arrays[] = {&s->h,      &s->water,    &s->before,    &s->target, &s->first,
                             &s->second, &s->residual, &s->term_size, &s->change};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    TRY(memory_allocate(arrays[k], s->count + s->pool_count, sizeof(double), "water in soil"));
  TRY(memory_allocate(&s->now, s->count, sizeof *s->now, "water in soil"));
  TRY(memory_allocate(&s->from, s->count, sizeof *s->from, "water in soil"));
  TRY(memory_allocate(&s->face_flux, s->face_count, sizeof *s->face_flux, "fluxes"));
  TRY(memory_allocate(&s->edge_flux, s->edge_count, sizeof *s->edge_flux, "fluxes"));
  TRY(memory_allocate(&s->edge_first, s->edge_count, sizeof *s->edge_first, "fluxes"));
  if (s->full) TRY(memory_allocate(&s->speed, s->count, sizeof *s->speed, "fluxes"));
  if (s->full) TRY(memory_allocate(&s->limited, s->edge_count, sizeof *s->limited, "fluxes"));
  double **const sums[] = {&s->entered, &s->rained, &s->ran_off};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
    TRY(memory_allocate(sums[k], scene->region_count, sizeof(double), "what came and went"));
  for (size_t i = 0; i < s->count && !s->full; i++) s->h[i] = head_at_start(s, i);
  richards_share_wells(s);
  if (s->full)
    TRY(richards_saturated_solve(s, 0));
  else
    richards_evaluate(s, 0);
  for (size_t i = 0; i < s->count; i++) s->water[i] = s->now[i].theta;
  s->start = richards_water(s) + richards_pond_volume(s, NULL);
  for (size_t k = 0; k < s->soil_count; k++)
    for (int a = 0; a < 3; a++)
      s->fastest = fmax(s->fastest, s->soils[k].conductivity[a] / s->spacing /
                                        (s->soils[k].theta_s - s->soils[k].theta_r));
  s->next_dt = FIRST_STEP / s->fastest;
cleanup:
  memory_free(&of_region);
  return status;
}

void richards_free(struct richards *s) {
  for (size_t k = 0; k < s->soil_count; k++) retention_free(&s->soils[k]);
  memory_free(&s->soils);
  wall_cuts_free(&s->walls);
  memory_free(&s->site);
  memory_free(&s->number);
  memory_free(&s->soil);
  memory_free(&s->open);
  memory_free(&s->basins);
  memory_free(&s->faces);
  memory_free(&s->edges);
  memory_free(&s->sources);
  rows_free(&s->rows);
  double **const arrays[] = {&s->h,          &s->water,    &s->before,   &s->target,  &s->first,
                             &s->second,     &s->residual, &s->change,   &s->entered, &s->rained,
                             &s->edge_first, &s->ran_off,  &s->term_size};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) memory_free(arrays[k]);
  richards_pond_free(s);
  memory_free(&s->beside);
  memory_free(&s->corners);
  memory_free(&s->body);
  memory_free(&s->outside);
  memory_free(&s->cuts);
  memory_free(&s->speed);
  memory_free(&s->limited);
  memory_free(&s->now);
  memory_free(&s->from);
  memory_free(&s->face_flux);
  memory_free(&s->edge_flux);
}
