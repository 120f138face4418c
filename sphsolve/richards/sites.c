#include "sphsolve/richards/sites.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/richards/balance.h"
#include "sphsolve/richards/constants.h"
#include "sphsolve/richards/edges.h"
#include "sphsolve/scene/scene.h"

static const struct region *region_of(const struct richards *s, size_t site) {
  return &s->scene->regions[s->lattice->region[site] - 1];
}

/* Builds the soils; regions with the same properties share one. */
static enum status find_soils(struct richards *s, uint16_t *of_region) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  TRY(memory_allocate(&s->soils, scene->region_count, sizeof *s->soils, "soils"));
  for (size_t r = 0; r < scene->region_count; r++) {
    if (scene->regions[r].type != REGION_POROUS) continue;
    if (scene->regions[r].first != r) {
      of_region[r] = of_region[scene->regions[r].first];
      continue;
    }
    struct retention *soil = &s->soils[s->soil_count];
    status = retention_make(&scene->regions[r], soil);
    s->soil_count++;
    if (status != STATUS_OK) goto cleanup;
    size_t same = 0;
    while (!retention_is_same(&s->soils[same], soil)) same++;
    if (same + 1 < s->soil_count) retention_free(soil), s->soil_count--;
    of_region[r] = (uint16_t)same;
  }
cleanup:
  return status;
}

/* The site beyond a face of site `at`, or the lattice's count if there is none. */
static size_t beyond(const struct richards *s, size_t at, int axis, bool low) {
  const struct lattice *l = s->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  const size_t n = l->size[axis], here = at / stride[axis] % n;
  if (low ? here > 0 : here + 1 < n) return low ? at - stride[axis] : at + stride[axis];
  if (!s->scene->periodic[axis] || n == 1) return l->count;
  return low ? at + (n - 1) * stride[axis] : at - (n - 1) * stride[axis];
}

/* Share of the face of a site at `x`, normal to `axis`, that lies in a box. */
static double share_of(const struct richards *s, const double x[3], int axis, const double box[6]) {
  double share = 1;
  for (int a = 0; a < 3; a++) {
    if (a == axis || (s->lattice->dimensions == 2 && a == 1)) continue;
    const double low = fmax(x[a] - 0.5 * s->spacing, box[a]),
                 high = fmin(x[a] + 0.5 * s->spacing, box[a + 3]);
    share *= fmax(0, high - low) / s->spacing;
  }
  return share;
}

/* The inflow region at a boundary face on a side of the domain: the one that covers its centre or,
 * for given fluxes, most of it. */
static const struct region *inflow_at(const struct richards *s, const double x[3], int axis,
                                      bool low, double *share) {
  const struct region *found = NULL;
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *region = &s->scene->regions[r];
    bool at_low;
    if (region->type != REGION_INFLOW || scene_inflow_axis(s->scene, region, &at_low) != axis ||
        at_low != low)
      continue;
    const double covered = share_of(s, x, axis, region->box);
    if (region->boundary == BOUNDARY_FLUX ? !(covered > *share) : covered < COVERED_HALF) continue;
    found = region;
    *share = region->boundary == BOUNDARY_FLUX ? covered : 1;
  }
  return found;
}

/* The rain on an upper face, if nothing is above it. */
static const struct region *rain_at(const struct richards *s, size_t at, const double x[3],
                                    double *share) {
  for (size_t above = beyond(s, at, 2, false); above != s->lattice->count;
       above = beyond(s, above, 2, false))
    if (above == at || s->lattice->kind[above] != SITE_EMPTY) return NULL;
  const struct region *found = NULL;
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *region = &s->scene->regions[r];
    if (region->type != REGION_RAIN || x[2] > region->box[5]) continue;
    const double covered = share_of(s, x, 2, region->box);
    if (covered > *share) found = region, *share = covered;
  }
  return found;
}

/* Adds the face of site i at one side: between two sites, or to the outside; with `count` it is
 * only counted. */
static void add_face(struct richards *s, size_t i, int axis, bool low, bool count) {
  const struct lattice *l = s->lattice;
  const size_t at = s->site[i], next = beyond(s, at, axis, low);
  double x[3] = {0}, share = 0;
  if (next != l->count && l->kind[next] == SITE_WALL) return;
  if (next != l->count && thin_wall_on_face(l, low ? next : at, axis)) return;
  if (next != l->count && s->number[next] != SITE_NONE) {
    if (low || next == at) return; /* each only once */
    if (!count)
      s->faces[s->face_count] =
          (struct richards_face){.i = (uint32_t)i, .j = s->number[next], .axis = (uint8_t)axis};
    s->face_count++;
    return;
  }
  richards_place(s, i, x);
  struct richards_edge edge = {.site = (uint32_t)i,
                               .axis = (uint8_t)axis,
                               .low = low,
                               .share = 1,
                               .z = x[2] + (axis != 2 ? 0
                                            : low     ? -0.5
                                                      : 0.5) *
                                               s->spacing};
  if (next == l->count) edge.region = inflow_at(s, x, axis, low, &share);
  if (edge.region != NULL) {
    static const enum richards_edge_kind kinds[] = {[BOUNDARY_NONE] = EDGE_AIR,
                                                    [BOUNDARY_HEAD] = EDGE_HEAD,
                                                    [BOUNDARY_FLUX] = EDGE_FLUX,
                                                    [BOUNDARY_PRESSURE] = EDGE_PRESSURE};
    edge.kind = kinds[edge.region->boundary];
    edge.share = share;
  } else {
    if (axis == 2 && !low) edge.region = rain_at(s, at, x, &share);
    if (edge.region != NULL) edge.share = share;
    if (edge.region == NULL && next == l->count) return; /* a closed side */
  }
  if (!count) s->edges[s->edge_count] = edge;
  s->edge_count++;
}

/* Adds the well or drain that contains a site, if any. */
static void add_well(struct richards *s, size_t i, bool count) {
  double x[3];
  richards_place(s, i, x);
  for (size_t r = 0; r < s->scene->region_count; r++) {
    const struct region *part = &s->scene->regions[r];
    bool inside = part->type == REGION_WELL || part->type == REGION_DRAIN;
    for (int a = 0; a < 3; a++)
      if (!(s->lattice->dimensions == 2 && a == 1))
        inside = inside && x[a] >= part->box[a] && x[a] < part->box[a + 3];
    if (!inside) continue;
    if (!count)
      s->edges[s->edge_count] =
          (struct richards_edge){.site = (uint32_t)i,
                                 .kind = part->type == REGION_WELL ? EDGE_WELL : EDGE_DRAIN,
                                 .region = &s->scene->regions[part->first],
                                 .share = 1,
                                 .z = x[2]};
    s->edge_count++;
    return;
  }
}

static void add_faces(struct richards *s, bool count) {
  s->face_count = s->edge_count = 0;
  for (size_t i = 0; i < s->count; i++) add_well(s, i, count);
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++)
      for (int side = 0; side < 2; side++)
        if (!(s->lattice->dimensions == 2 && a == 1)) add_face(s, i, a, side == 0, count);
}

static size_t entry_of(const struct rows *rows, size_t row, uint32_t column) {
  size_t k = rows->start[row];
  while (rows->column[k] != column) k++;
  return k;
}

/* Sets up the matrix: a row for each site, with entries for itself and each neighbouring site, in
 * increasing order. */
static enum status make_rows(struct richards *s) {
  enum status status = STATUS_OK;
  struct rows *rows = &s->rows;
  TRY(rows_allocate(s->count, s->count + 2 * s->face_count, rows));
  for (size_t i = 0; i < s->count; i++) rows->start[i + 1] = 1;
  for (size_t f = 0; f < s->face_count; f++)
    rows->start[s->faces[f].i + 1]++, rows->start[s->faces[f].j + 1]++;
  for (size_t i = 0; i < s->count; i++) rows->start[i + 1] += rows->start[i];
  for (size_t i = 0; i < s->count; i++) rows->column[rows->start[i]] = (uint32_t)i;
  /* end of the entries so far */
  for (size_t i = 0; i < s->count; i++) rows->diagonal[i] = rows->start[i] + 1;
  for (size_t f = 0; f < s->face_count; f++)
    for (int side = 0; side < 2; side++) {
      const uint32_t i = side ? s->faces[f].j : s->faces[f].i,
                     j = side ? s->faces[f].i : s->faces[f].j;
      size_t k = rows->diagonal[i]++;
      for (; k > rows->start[i] && rows->column[k - 1] > j; k--)
        rows->column[k] = rows->column[k - 1];
      rows->column[k] = j;
    }
  for (size_t i = 0; i < s->count; i++) rows->diagonal[i] = entry_of(rows, i, (uint32_t)i);
  for (size_t f = 0; f < s->face_count; f++) {
    s->faces[f].ij = entry_of(rows, s->faces[f].i, s->faces[f].j);
    s->faces[f].ji = entry_of(rows, s->faces[f].j, s->faces[f].i);
    s->faces[f].soils_differ = s->soil[s->faces[f].i] != s->soil[s->faces[f].j];
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

enum status richards_create(const struct scene *scene, const struct lattice *lattice,
                            struct richards *s) {
  enum status status = STATUS_OK;
  uint16_t *of_region = NULL;
  *s = (struct richards){.scene = scene,
                         .lattice = lattice,
                         .spacing = lattice->spacing[0],
                         .tolerance = STEP_TOLERANCE};
  for (int a = 0; a < 3; a++) s->pull[a] = scene->driving[a] / GRAVITY_STANDARD;
  TRY(memory_allocate(&of_region, scene->region_count, sizeof *of_region, "soils"));
  TRY(find_soils(s, of_region));
  for (size_t at = 0; at < lattice->count; at++) s->count += lattice->kind[at] == SITE_FLUID;
  TRY(memory_allocate(&s->site, s->count, sizeof *s->site, "sites of soil"));
  TRY(memory_allocate(&s->number, lattice->count, sizeof *s->number, "sites of soil"));
  TRY(memory_allocate(&s->soil, s->count, sizeof *s->soil, "sites of soil"));
  s->count = 0;
  for (size_t at = 0; at < lattice->count; at++) {
    s->number[at] = SITE_NONE;
    if (lattice->kind[at] != SITE_FLUID) continue;
    s->soil[s->count] = of_region[lattice->region[at] - 1];
    s->site[s->count] = (uint32_t)at;
    s->number[at] = (uint32_t)s->count++;
  }
  add_faces(s, true);
  TRY(memory_allocate(&s->faces, s->face_count, sizeof *s->faces, "faces between sites"));
  TRY(memory_allocate(&s->edges, s->edge_count, sizeof *s->edges, "faces to the outside"));
  add_faces(s, false);
  TRY(make_rows(s));
  double **const arrays[] = {&s->h,      &s->water,    &s->before,    &s->target, &s->first,
                             &s->second, &s->residual, &s->term_size, &s->change};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++)
    TRY(memory_allocate(arrays[k], s->count, sizeof(double), "water in soil"));
  TRY(memory_allocate(&s->now, s->count, sizeof *s->now, "water in soil"));
  TRY(memory_allocate(&s->from, s->count, sizeof *s->from, "water in soil"));
  TRY(memory_allocate(&s->face_flux, s->face_count, sizeof *s->face_flux, "fluxes"));
  TRY(memory_allocate(&s->edge_flux, s->edge_count, sizeof *s->edge_flux, "fluxes"));
  TRY(memory_allocate(&s->edge_first, s->edge_count, sizeof *s->edge_first, "fluxes"));
  double **const sums[] = {&s->entered, &s->rained, &s->ran_off};
  for (size_t k = 0; k < sizeof sums / sizeof *sums; k++)
    TRY(memory_allocate(sums[k], scene->region_count, sizeof(double), "what came and went"));
  for (size_t i = 0; i < s->count; i++) s->h[i] = head_at_start(s, i);
  richards_share_wells(s);
  richards_evaluate(s, 0);
  for (size_t i = 0; i < s->count; i++) s->water[i] = s->now[i].theta;
  s->start = richards_water(s);
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
  memory_free(&s->site);
  memory_free(&s->number);
  memory_free(&s->soil);
  memory_free(&s->faces);
  memory_free(&s->edges);
  rows_free(&s->rows);
  double **const arrays[] = {&s->h,          &s->water,    &s->before,   &s->target,  &s->first,
                             &s->second,     &s->residual, &s->change,   &s->entered, &s->rained,
                             &s->edge_first, &s->ran_off,  &s->term_size};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) memory_free(arrays[k]);
  memory_free(&s->now);
  memory_free(&s->from);
  memory_free(&s->face_flux);
  memory_free(&s->edge_flux);
}
