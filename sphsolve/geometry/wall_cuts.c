#include "sphsolve/geometry/wall_cuts.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/geometry/cell_parts.h"
#include "sphsolve/scene/scene_shapes.h"

/* Shares within it of 1 count as open: rounding of places. */
#define SHARE_LEAST 1e-6
/* Sites further from the boxes of the walls, in spacings, have no wall in their cells: half a
 * diagonal of the cell, and what a shape differs from its boxes. */
#define REACH 2.0

/* A cell with the surface of a wall in it. */
struct cut {
  struct cell_parts parts;
  /* Of the face at its high end: open to a part of it and of the next cell, or the outside. */
  float area[3][CELL_PARTS][CELL_PARTS];
  /* Of the face at its low end, to a part of it; where no cut cell is beside it. */
  float low[3][CELL_PARTS];
};
/* A cell's number: one of these, or CUT and its index among the cut ones. */
enum { WALL, OPEN, CUT };
struct cells {
  size_t region_count;
  const struct region **region; /* those that count, from the first wall on */
  uint32_t *number;             /* [sites] */
  size_t cut_count;
  struct cut *cut;
};

static const struct cell_parts *parts_of(const struct cells *cells, size_t site) {
  static const struct cell_parts whole[] = {
      [WALL] = {.volume = {0}},
      [OPEN] = {
          .volume = {1},
          .holds_centre = true,
          .reached = {
              {UINT64_MAX}, {UINT64_MAX}, {UINT64_MAX}, {UINT64_MAX}, {UINT64_MAX}, {UINT64_MAX}}}};
  const uint32_t number = cells->number[site];
  return number < CUT ? &whole[number] : &cells->cut[number - CUT].parts;
}

static void begin(const struct scene *scene, const struct lattice *l, const struct cells *cells,
                  size_t site, struct cell *cell) {
  cell_begin(scene, l, cells->region, cells->region_count, site, cell);
}

/* Numbers the cells. */
static enum status find_cut(const struct scene *scene, const struct lattice *l,
                            struct cells *cells) {
  enum status status = STATUS_OK;
  const double reach = REACH * fmax(l->spacing[0], fmax(l->spacing[1], l->spacing[2]));
  TRY(memory_allocate(&cells->region, scene->region_count, sizeof *cells->region,
                      "cells cut by walls"));
  for (size_t n = 0; n < scene->region_count; n++) {
    const struct region *r = &scene->regions[n];
    if (cell_counts(scene, r) && (cells->region_count > 0 || r->type == REGION_WALL))
      cells->region[cells->region_count++] = r;
  }
  TRY(memory_allocate(&cells->number, l->count, sizeof *cells->number, "cells cut by walls"));
#pragma omp parallel for schedule(dynamic, 256)
  for (size_t site = 0; site < l->count; site++) {
    struct cell c;
    cells->number[site] = l->kind[site] == SITE_WALL ? WALL : OPEN;
    if (!(fabs((double)l->wall_distance[site]) < reach)) continue;
    begin(scene, l, cells, site, &c);
    cells->number[site] = c.is_cut ? CUT : cell_is_open(&c) ? OPEN : WALL;
  }
  for (size_t site = 0; site < l->count; site++)
    if (cells->number[site] == CUT) cells->number[site] += (uint32_t)cells->cut_count++;
  TRY(memory_allocate(&cells->cut, cells->cut_count, sizeof *cells->cut, "cells cut by walls"));
cleanup:
  return status;
}

/* Finds the parts of cut cells. */
static enum status find_parts(const struct scene *scene, const struct lattice *l,
                              struct cells *cells) {
  size_t crowded = l->count;
#pragma omp parallel for schedule(dynamic, 256) reduction(min : crowded)
  for (size_t site = 0; site < l->count; site++) {
    struct cell c;
    if (cells->number[site] < CUT) continue;
    begin(scene, l, cells, site, &c);
    cell_find_parts(&c, &cells->cut[cells->number[site] - CUT].parts);
    if (c.crowded && site < crowded) crowded = site;
  }
  if (crowded == l->count) return STATUS_OK;
  const size_t row = crowded / l->size[0];
  return FAIL(
      STATUS_INPUT,
      "%s: the cell around (%g m, %g m, %g m) is cut by more than %d regions, or by one that "
      "has more than %d faces in it or %d on a line; use a smaller domain.spacing, or "
      "smoother walls",
      scene->path, l->origin[0] + (double)(crowded % l->size[0]) * l->spacing[0],
      l->origin[1] + (double)(row % l->size[1]) * l->spacing[1],
      l->origin[2] + (double)(row / l->size[1]) * l->spacing[2], CELL_REGIONS_MAX, CELL_ENDS_MAX,
      POLYGON_CORNERS_MAX);
}

/* Whether a lattice has more than one site along an axis. */
static bool is_used(const struct lattice *l, int axis) {
  return l->dimensions == 3 || axis != 1;
}

/* Finds the open shares of the faces of cut cells. */
static void find_faces(const struct scene *scene, const struct lattice *l, struct cells *cells) {
#pragma omp parallel for schedule(dynamic, 256)
  for (size_t site = 0; site < l->count; site++) {
    struct cell own, other;
    float area[CELL_PARTS][CELL_PARTS];
    if (cells->number[site] < CUT) continue;
    struct cut *cut = &cells->cut[cells->number[site] - CUT];
    begin(scene, l, cells, site, &own);
    for (int a = 0; a < 3; a++) {
      if (!is_used(l, a)) continue;
      const size_t next = lattice_beyond(scene->periodic, l, site, a, false),
                   last = lattice_beyond(scene->periodic, l, site, a, true);
      if (next != l->count) begin(scene, l, cells, next, &other);
      cell_find_areas(&own, &cut->parts, next != l->count ? &other : NULL,
                      next != l->count ? parts_of(cells, next) : NULL, a, cut->area[a]);
      if (last != l->count && cells->number[last] >= CUT) continue;
      if (last != l->count) begin(scene, l, cells, last, &other);
      cell_find_areas(last != l->count ? &other : NULL,
                      last != l->count ? parts_of(cells, last) : NULL, &own, &cut->parts, a, area);
      memcpy(cut->low[a], area[CELL_OWN], sizeof cut->low[a]);
    }
  }
}

/* Whether walls leave a site, and its faces but those to walls, open. */
static bool is_whole(const struct scene *scene, const struct lattice *l,
                     const struct wall_cuts *cuts, size_t site) {
  const float least = 1 - (float)SHARE_LEAST;
  bool whole = cuts->volume[site] >= least;
  for (int a = 0; a < 3 && whole; a++) {
    const size_t next = lattice_beyond(scene->periodic, l, site, a, false);
    whole = (next != l->count && l->kind[next] == SITE_WALL) || cuts->face[site][a][1] >= least;
  }
  return whole;
}

static enum status find_cells(const struct scene *scene, const struct lattice *l,
                              struct cells *cells) {
  enum status status = STATUS_OK;
  TRY(find_cut(scene, l, cells));
  TRY(find_parts(scene, l, cells));
  find_faces(scene, l, cells);
cleanup:
  return status;
}

static void free_cells(struct cells *cells) {
  MEMORY_FREE(&cells->region, &cells->number, &cells->cut);
}

/* Share of the face between a site and the next along an axis that is open to these parts of their
 * cells. Either site may be the outside, l->count, which is one part. */
static float area_between(const struct lattice *l, const struct cells *cells, size_t site,
                          enum cell_part p, size_t next, enum cell_part q, int axis) {
  const uint32_t of_site = site != l->count ? cells->number[site] : OPEN,
                 of_next = next != l->count ? cells->number[next] : OPEN;
  if (of_site >= CUT) return cells->cut[of_site - CUT].area[axis][p][q];
  if (of_next >= CUT) return p == CELL_OWN ? cells->cut[of_next - CUT].low[axis][q] : 0;
  return p == CELL_OWN && q == CELL_OWN && of_site == OPEN && of_next == OPEN;
}

/* The site that takes the other part of a cell: the one beside it to whose own part it is most
 * open; l->count: none. */
static size_t taker_of(const struct scene *scene, const struct lattice *l,
                       const struct cells *cells, size_t site) {
  size_t taker = l->count;
  float most = 0;
  if (!(parts_of(cells, site)->volume[CELL_OTHER] > 0)) return taker;
  for (int n = 0; n < 6; n++) {
    const size_t next = lattice_beyond(scene->periodic, l, site, n / 2, n % 2 == 0);
    if (!is_used(l, n / 2) || next == l->count || next == site) continue;
    const float area = n % 2 ? area_between(l, cells, site, CELL_OTHER, next, CELL_OWN, n / 2)
                             : area_between(l, cells, next, CELL_OWN, site, CELL_OTHER, n / 2);
    if (area > most) most = area, taker = next;
  }
  return taker;
}

/* Adds to the open share of a face that is open already, so that no wall is opened. */
static bool widen(const struct scene *scene, const struct lattice *l, size_t site, int axis,
                  float area, struct wall_cuts *cuts) {
  const size_t next =
      site != l->count ? lattice_beyond(scene->periodic, l, site, axis, false) : l->count;
  if (next == l->count || !(cuts->face[site][axis][1] > 0)) return false;
  cuts->face[site][axis][1] += area, cuts->face[next][axis][0] += area;
  return true;
}

/* Adds what of a face is open to the other part of a cell on either side to the face of the sites
 * that take it. */
static void take_face(const struct scene *scene, const struct lattice *l, const struct cells *cells,
                      size_t site, int axis, struct wall_cuts *cuts) {
  const size_t next = lattice_beyond(scene->periodic, l, site, axis, false);
  const size_t of_site = taker_of(scene, l, cells, site), of_next = taker_of(scene, l, cells, next);
  for (enum cell_part p = CELL_OWN; p < CELL_PARTS; p++)
    for (enum cell_part q = CELL_OWN; q < CELL_PARTS; q++) {
      const float area = area_between(l, cells, site, p, next, q, axis);
      const size_t low = p == CELL_OWN ? site : of_site, high = q == CELL_OWN ? next : of_next;
      if ((p == CELL_OWN && q == CELL_OWN) || !(area > 0) || low == l->count || high == l->count ||
          low == high)
        continue;
      const size_t before = lattice_beyond(scene->periodic, l, high, axis, true);
      if (before == low || !widen(scene, l, before, axis, area, cuts))
        widen(scene, l, low, axis, area, cuts);
    }
}

/* Gives the other parts of cells to the sites that take them. */
static void take_parts(const struct scene *scene, const struct lattice *l,
                       const struct cells *cells, struct wall_cuts *cuts) {
  for (size_t site = 0; site < l->count; site++) {
    const size_t taker = taker_of(scene, l, cells, site);
    if (taker != l->count) cuts->volume[taker] += parts_of(cells, site)->volume[CELL_OTHER];
    for (int a = 0; a < 3; a++) {
      if (!is_used(l, a)) continue;
      for (int high = 0; high < 2 && taker != l->count; high++)
        if (lattice_beyond(scene->periodic, l, taker, a, !high) == l->count &&
            lattice_beyond(scene->periodic, l, site, a, !high) == l->count &&
            cuts->face[taker][a][high] > 0)
          cuts->face[taker][a][high] +=
              high ? area_between(l, cells, site, CELL_OTHER, l->count, CELL_OWN, a)
                   : area_between(l, cells, l->count, CELL_OWN, site, CELL_OTHER, a);
      if (lattice_beyond(scene->periodic, l, site, a, false) != l->count)
        take_face(scene, l, cells, site, a, cuts);
    }
  }
}

/* Joins a wall site to the site beside it to which its face is most open, once that counts. */
static bool join(const struct scene *scene, const struct lattice *l, struct wall_cuts *cuts,
                 size_t site) {
  float most = 0;
  for (int n = 0; n < 6; n++) {
    const size_t next = lattice_beyond(scene->periodic, l, site, n / 2, n % 2 == 0);
    if (!is_used(l, n / 2) || next == l->count || next == site) continue;
    const float share = cuts->face[site][n / 2][n % 2];
    if ((l->kind[next] == SITE_WALL && cuts->joined[next] == 0) || !(share > most)) continue;
    most = share;
    cuts->joined[site] = (uint8_t)(1 + n);
  }
  return most > 0;
}

/* In 3-D a corner of a cell may be open to wall sites alone, which join first. Sites that a thin
 * wall takes up (scene/lost_wall.h) and whose centres are in no wall are filled by what is there.
 */
static bool join_all(const struct scene *scene, const struct lattice *l, const struct cells *cells,
                     struct wall_cuts *cuts) {
  bool any = false;
  for (size_t site = 0; site < l->count; site++)
    if (l->kind[site] == SITE_WALL && parts_of(cells, site)->holds_centre)
      cuts->joined[site] = WALL_CUTS_OWN, any = true;
  for (int round = 0; round < l->dimensions; round++)
    for (size_t site = 0; site < l->count; site++)
      if (l->kind[site] == SITE_WALL && cuts->volume[site] > 0 && cuts->joined[site] == 0)
        any = join(scene, l, cuts, site) || any;
  return any;
}

/* What is open of cells and faces to the own parts of sites. */
static void open_own(const struct scene *scene, const struct lattice *l, const struct cells *cells,
                     struct wall_cuts *cuts) {
  for (size_t site = 0; site < l->count; site++) {
    cuts->volume[site] = parts_of(cells, site)->volume[CELL_OWN];
    for (int a = 0; a < 3; a++) {
      const size_t next = lattice_beyond(scene->periodic, l, site, a, false),
                   last = lattice_beyond(scene->periodic, l, site, a, true);
      cuts->face[site][a][0] = cuts->face[site][a][1] = 1;
      if (!is_used(l, a)) continue;
      cuts->face[site][a][0] = area_between(l, cells, last, CELL_OWN, site, CELL_OWN, a);
      cuts->face[site][a][1] = area_between(l, cells, site, CELL_OWN, next, CELL_OWN, a);
    }
  }
}

enum status wall_cuts_find(const struct scene *scene, const struct lattice *l,
                           struct wall_cuts *cuts) {
  enum status status = STATUS_OK;
  struct cells cells = {0};
  bool cut = false;
  *cuts = (struct wall_cuts){0};
  if (l->wall_distance == NULL || l->region == NULL) return STATUS_OK;
  TRY(memory_allocate(&cuts->face, l->count, sizeof *cuts->face, "cells cut by walls"));
  TRY(memory_allocate(&cuts->volume, l->count, sizeof *cuts->volume, "cells cut by walls"));
  TRY(memory_allocate(&cuts->joined, l->count, 1, "cells cut by walls"));
  TRY(find_cells(scene, l, &cells));
  open_own(scene, l, &cells, cuts);
  take_parts(scene, l, &cells, cuts);
  cut = join_all(scene, l, &cells, cuts);
  for (size_t site = 0; site < l->count && !cut; site++)
    cut = l->kind[site] != SITE_WALL && !is_whole(scene, l, cuts, site);
cleanup:
  if (!cut) wall_cuts_free(cuts);
  free_cells(&cells);
  return status;
}

enum status wall_cuts_closed_faces(const struct scene *scene, const struct lattice *l,
                                   uint8_t **closed) {
  enum status status = STATUS_OK;
  struct cells cells = {0};
  *closed = NULL;
  TRY(memory_allocate(closed, l->count, 1, "walls between sites"));
  TRY(find_cells(scene, l, &cells));
  for (size_t site = 0; site < l->count; site++)
    for (int a = 0; a < 3; a++) {
      const size_t next = lattice_beyond(scene->periodic, l, site, a, false);
      if (is_used(l, a) && next != l->count &&
          !(area_between(l, &cells, site, CELL_OWN, next, CELL_OWN, a) > 0))
        (*closed)[site] |= (uint8_t)(1U << a);
    }
cleanup:
  free_cells(&cells);
  return status;
}

void wall_cuts_free(struct wall_cuts *cuts) {
  MEMORY_FREE(&cuts->face, &cuts->volume, &cuts->joined);
}

size_t wall_cuts_site(const struct wall_cuts *cuts, const struct scene *scene,
                      const struct lattice *l, size_t site) {
  while (l->kind[site] == SITE_WALL && cuts->joined != NULL && cuts->joined[site] > 0 &&
         cuts->joined[site] != WALL_CUTS_OWN) {
    const int n = cuts->joined[site] - 1;
    site = lattice_beyond(scene->periodic, l, site, n / 2, n % 2 == 0);
  }
  return site;
}
