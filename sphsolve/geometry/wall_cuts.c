#include "sphsolve/geometry/wall_cuts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/scene/scene_geometry.h"
#include "sphsolve/scene/scene_parts.h"
#include "sphsolve/scene/scene_shapes.h"
#include "sphsolve/scene/stl.h"

/* Small cubes of a cell along each axis, on the lines by which volumes are found, and areas in 3-D.
 * With a layer of them around: parts that a round wall divides by its crown alone lead to one
 * another there. */
#define CUBES_2D 16
#define CUBES_3D 8
#define CUBES_MAX (CUBES_2D + 2)
#define CUBES_ALL (CUBES_3D * CUBES_3D * CUBES_3D) /* as many as in 2-D, or more */
/* What is open of a face belongs to a part of a cell with a cube so near, in spacings: more than
 * the wedges that hold no cube, and less than any wall that cuts cells is thick. */
#define BELONGS 0.25
/* Beside a face, in spacings: of a wall that ends at the face, one side is in the wall. */
#define BESIDE 1e-9
/* Shares below count as closed, and within it of 1 as open: rounding of places. */
#define SHARE_LEAST 1e-6
/* Sites further from the boxes of the walls, in spacings, have no wall in their cells: half a
 * diagonal of the cell, and what a shape differs from its boxes. */
#define REACH 2.0
/* Most regions that reach into one cell, of which the last count; most ends of one on a line there,
 * and of all. */
#define NEAR_MAX 32
#define ENDS_MAX 16
#define PIECES_MAX 128
#define UNSEEN UINT8_MAX /* an open cube whose part has no number yet */

/* A region on a line: whether it holds the low end of the line, and where that changes. */
struct stretch {
  bool wall, inside;
  size_t count;
  double end[ENDS_MAX]; /* m from the middle of the cell */
};
struct line {
  size_t count;
  struct stretch region[NEAR_MAX];
};

/* A cell, and the connected parts of it that no wall fills, in small cubes by x, y, z. */
struct cell {
  const struct scene *scene;
  const struct lattice *lattice;
  double centre[3];
  size_t near_count;
  const struct region *near[NEAR_MAX];           /* those that may reach into it, in order */
  uint8_t part[CUBES_MAX][CUBES_MAX][CUBES_MAX]; /* number of a part from 1; 0: wall */
  uint8_t own;                                   /* that of the site; 0: none */
  double volume;                                 /* of its part, over the cell's */
  uint8_t own_cubes[CUBES_ALL / 8];              /* bits of the cubes of its part, by z, y, x */
};

static int lines_along(const struct lattice *l, int axis) {
  return l->dimensions == 3 ? CUBES_3D : axis == 1 ? 1 : CUBES_2D;
}

static bool is_used(const struct lattice *l, int axis) {
  return lines_along(l, axis) > 1;
}

/* Cubes along an axis, from `first` on; and the middle of one, m from the centre of the cell. */
static int first_cube(const struct lattice *l, int axis) {
  return is_used(l, axis) ? -1 : 0;
}
static int cubes_end(const struct lattice *l, int axis) {
  return lines_along(l, axis) + is_used(l, axis);
}
static double middle_of(const struct lattice *l, int axis, int cube) {
  return ((cube + 0.5) / lines_along(l, axis) - 0.5) * l->spacing[0];
}
static uint8_t *cube_at(struct cell *c, const int at[3]) {
  return &c->part[at[0] + 1][at[1] + 1][at[2] + 1];
}
static bool is_inner(const struct lattice *l, const int at[3]) {
  bool inner = true;
  for (int a = 0; a < 3; a++) inner = inner && at[a] >= 0 && at[a] < lines_along(l, a);
  return inner;
}

/* Whether a region counts by the polygon or body that it is a part of. */
static bool has_shape(const struct scene *scene, const struct region *r) {
  const struct region *first = &scene->regions[r->first];
  return (first->polygon != NULL || first->stl != NULL) && !r->filled;
}

/* Whether a region counts here, and not by another part of its shape. */
static bool counts(const struct scene *scene, const struct region *r) {
  if (r->type != REGION_WALL && r->type != REGION_POROUS && r->type != REGION_WATER &&
      r->type != REGION_EMPTY)
    return false;
  if (has_shape(scene, r)) return r == &scene->regions[r->first];
  return r->type != REGION_WALL || r->is_part ||
         scene_region_thickness(scene, r) > (1 + 1e-6) * scene->spacing;
}

static const double *extent_of(const struct scene *scene, const struct region *r) {
  return has_shape(scene, r) ? r->extent : r->box;
}

/* Where a region begins and ends on the line through x along an axis. */
static size_t find_ends(const struct cell *c, const struct region *r, const double x[3], int axis,
                        double at[POLYGON_CORNERS_MAX]) {
  const double *extent = extent_of(c->scene, r);
  const struct polygon *p = has_shape(c->scene, r) ? r->polygon : NULL;
  size_t n = 0;
  for (int a = 0; a < 3; a++)
    if (a != axis && is_used(c->lattice, a) && !(x[a] > extent[a] && x[a] < extent[a + 3]))
      return 0;
  if (has_shape(c->scene, r) && p == NULL)
    return stl_scan(r->stl, axis, x, at, POLYGON_CORNERS_MAX);
  if (p != NULL && p->axis != axis) {
    const int across = p->plane[0] == axis;
    return polygon_scan(p, across, x[p->plane[across]], at);
  }
  if (p != NULL) {
    bool inside = false;
    n = polygon_scan(p, 1, x[p->plane[1]], at);
    for (size_t k = 0; k < n; k++) inside = inside != (at[k] > x[p->plane[0]]);
    if (!inside) return 0;
  }
  at[0] = extent[axis], at[1] = extent[axis + 3];
  return 2;
}

/* What regions are on a line along an axis, up to `reach` from the middle of a cell. */
static void cast_line(const struct cell *c, const double x[3], int axis, double reach,
                      struct line *line) {
  line->count = c->near_count;
  for (size_t k = 0; k < c->near_count; k++) {
    struct stretch *on = &line->region[k];
    double at[POLYGON_CORNERS_MAX];
    const size_t n = find_ends(c, c->near[k], x, axis, at);
    *on = (struct stretch){.wall = c->near[k]->type == REGION_WALL};
    for (size_t m = 0; m < n; m++) {
      const double t = at[m] - c->centre[axis];
      on->inside = on->inside != (t > -reach);
      if (fabs(t) < reach && on->count < ENDS_MAX) on->end[on->count++] = t;
    }
  }
}

/* Whether a place on a line is in a wall: in the last region that holds it. */
static bool is_wall(const struct line *line, double t) {
  for (size_t k = line->count; k-- > 0;) {
    const struct stretch *on = &line->region[k];
    bool inside = on->inside;
    for (size_t m = 0; m < on->count; m++) inside = inside != (on->end[m] < t);
    if (inside) return on->wall;
  }
  return false;
}

/* Adds where regions begin and end to the ends of pieces, sorted. */
static size_t add_ends(const struct line *line, size_t n, double end[PIECES_MAX]) {
  for (size_t k = 0; k < line->count; k++)
    for (size_t m = 0; m < line->region[k].count && n < PIECES_MAX; m++)
      end[n++] = line->region[k].end[m];
  qsort(end, n, sizeof *end, scene_parts_by_value);
  return n;
}

static void begin_cell(const struct scene *scene, const struct lattice *l, size_t site,
                       struct cell *c) {
  const double reach = (0.5 + 1.0 / lines_along(l, 0)) * l->spacing[0];
  const size_t row = site / l->size[0],
               place[3] = {site % l->size[0], row % l->size[1], row / l->size[1]};
  c->scene = scene, c->lattice = l, c->near_count = 0;
  for (int a = 0; a < 3; a++) c->centre[a] = l->origin[a] + (double)place[a] * l->spacing[a];
  for (size_t n = 0; n < scene->region_count; n++) {
    const struct region *r = &scene->regions[n];
    const double *extent = extent_of(scene, r);
    bool near = counts(scene, r);
    for (int a = 0; a < 3 && near; a++)
      near = !is_used(l, a) ||
             (c->centre[a] + reach > extent[a] && c->centre[a] - reach < extent[a + 3]);
    if (!near) continue;
    if (c->near_count == NEAR_MAX) memmove(c->near, c->near + 1, --c->near_count * sizeof *c->near);
    c->near[c->near_count++] = r;
  }
}

/* Numbers the part of open cubes that one belongs to; returns how many of them are in the cell. */
static int number_part(struct cell *c, const int from[3], uint8_t number) {
  int stack[CUBES_MAX * CUBES_MAX * CUBES_MAX][3], depth = 1, count = 0;
  memcpy(stack[0], from, sizeof stack[0]);
  *cube_at(c, from) = number;
  while (depth > 0) {
    const int at[3] = {stack[depth - 1][0], stack[depth - 1][1], stack[depth - 1][2]};
    depth--, count += is_inner(c->lattice, at);
    for (int f = 0; f < 6; f++) {
      int to[3] = {at[0], at[1], at[2]};
      to[f / 2] += f % 2 ? 1 : -1;
      if (to[f / 2] < first_cube(c->lattice, f / 2) || to[f / 2] >= cubes_end(c->lattice, f / 2) ||
          *cube_at(c, to) != UNSEEN)
        continue;
      *cube_at(c, to) = number;
      memcpy(stack[depth++], to, sizeof to);
    }
  }
  return count;
}

/* The part that holds the centre, else the largest. */
static void choose_part(struct cell *c) {
  const struct lattice *l = c->lattice;
  int most = 0, all = 0, own = 0, count[UNSEEN] = {0};
  uint8_t numbers = 0;
  for (int i = 0; i < lines_along(l, 0); i++)
    for (int j = 0; j < lines_along(l, 1); j++)
      for (int k = 0; k < lines_along(l, 2); k++) {
        const int at[3] = {i, j, k};
        if (*cube_at(c, at) != UNSEEN) continue;
        const uint8_t number = ++numbers;
        all += count[number] = number_part(c, at, number);
        if (count[number] > most) most = count[number], c->own = number;
      }
  for (int n = 7; n >= 0; n--) {
    int at[3];
    for (int a = 0; a < 3; a++) at[a] = is_used(l, a) ? lines_along(l, a) / 2 - (n >> a & 1) : 0;
    if (*cube_at(c, at) > 0) c->own = *cube_at(c, at);
  }
  own = count[c->own];
  if (all > 0) c->volume *= (double)own / all;
}

/* Marks the open pieces of a line of cubes along x, and adds what of them is in the cell. */
static void fill_line(struct cell *c, int j, int k) {
  const struct lattice *l = c->lattice;
  const double half = 0.5 * l->spacing[0], reach = half + l->spacing[0] / lines_along(l, 0);
  const double share = l->spacing[0] * lines_along(l, 1) * lines_along(l, 2);
  const double x[3] = {0, c->centre[1] + middle_of(l, 1, j), c->centre[2] + middle_of(l, 2, k)};
  double end[PIECES_MAX] = {-reach, reach};
  struct line line;
  const int edge[3] = {0, j, k};
  for (int a = 1; a < 3; a++)
    if (is_used(l, a) && !(x[a] > 0 && x[a] < c->scene->domain_size[a]) && !is_inner(l, edge))
      return;
  cast_line(c, x, 0, reach, &line);
  const size_t n = add_ends(&line, 2, end);
  for (size_t m = 0; m + 1 < n; m++) {
    if (!(end[m] < end[m + 1]) || is_wall(&line, 0.5 * (end[m] + end[m + 1]))) continue;
    if (is_inner(l, edge))
      c->volume += fmax(0, fmin(end[m + 1], half) - fmax(end[m], -half)) / share;
    for (int i = -1; i < cubes_end(l, 0); i++) {
      const int at[3] = {i, j, k};
      const double middle = middle_of(l, 0, i), place = c->centre[0] + middle;
      const bool inside = (place > 0 && place < c->scene->domain_size[0]) || is_inner(l, at);
      if (inside && middle >= end[m] && middle <= end[m + 1]) *cube_at(c, at) = UNSEEN;
    }
  }
}

/* Finds the open parts of a cell. Beyond the domain all is wall, also where it is periodic. */
static void fill_cell(struct cell *c) {
  for (int k = -1; k < cubes_end(c->lattice, 2); k++)
    for (int j = first_cube(c->lattice, 1); j < cubes_end(c->lattice, 1); j++) fill_line(c, j, k);
  choose_part(c);
}

/* Whether the piece from..to of line `row` in a face belongs to the part of the cell that counts;
 * the line is along `along`, beside others along `across`. */
static bool is_own(const struct cell *c, int axis, bool high, int along, int across, int row,
                   double from, double to) {
  const struct lattice *l = c->lattice;
  const double d = l->spacing[0];
  for (int n = 0; n < CUBES_ALL; n++) {
    if (!(c->own_cubes[n / 8] >> n % 8 & 1)) continue;
    const int nx = lines_along(l, 0), ny = lines_along(l, 1),
              at[3] = {n % nx, n / nx % ny, n / nx / ny};
    const double middle = middle_of(l, along, at[along]),
                 off = fmax(0, fmax(from - middle, middle - to)),
                 deep = (high ? 0.5 : -0.5) * d - middle_of(l, axis, at[axis]),
                 aside = middle_of(l, across, at[across]) - middle_of(l, across, row);
    if (off * off + deep * deep + aside * aside < BELONGS * BELONGS * d * d) return true;
  }
  return false;
}

/* Share of a face that is open to the cell at its low side and that at its high side; NULL: the
 * outside. */
static double open_share(const struct cell *low, const struct cell *high, int axis) {
  const struct cell *cells[2] = {low, high};
  const struct cell *any = low != NULL ? low : high;
  const double d = any->lattice->spacing[0];
  const int along = axis == 0 ? 2 : 0, across = 3 - axis - along;
  const int rows = lines_along(any->lattice, across);
  double sum = 0;
  for (int row = 0; row < rows; row++) {
    double end[PIECES_MAX] = {-0.5 * d, 0.5 * d}, x[3];
    struct line line[2];
    size_t n = 2;
    for (int s = 0; s < 2; s++) {
      const struct cell *c = cells[s];
      if (c == NULL) continue;
      x[axis] = c->centre[axis] + (s == 0 ? 0.5 - BESIDE : BESIDE - 0.5) * d;
      x[across] = c->centre[across] + middle_of(c->lattice, across, row);
      cast_line(c, x, along, 0.5 * d, &line[s]);
      n = add_ends(&line[s], n, end);
    }
    for (size_t m = 0; m + 1 < n; m++) {
      bool open = end[m] < end[m + 1];
      for (int s = 0; s < 2 && open; s++) {
        const struct cell *c = cells[s];
        if (c == NULL) continue;
        open = !is_wall(&line[s], 0.5 * (end[m] + end[m + 1])) &&
               is_own(c, axis, s == 0, along, across, row, end[m], end[m + 1]);
      }
      if (open) sum += (end[m + 1] - end[m]) / (d * rows);
    }
  }
  return sum < SHARE_LEAST ? 0 : sum > 1 - SHARE_LEAST ? 1 : sum;
}

/* The site beside another; the lattice's count outside of a domain that ends there. */
static size_t beside(const struct scene *scene, const struct lattice *l, size_t site, int axis,
                     bool high) {
  const size_t stride = axis == 0 ? 1 : axis == 1 ? l->size[0] : l->size[0] * l->size[1];
  const size_t n = l->size[axis], at = site / stride % n;
  if (high ? at + 1 < n : at > 0) return high ? site + stride : site - stride;
  if (!scene->periodic[axis]) return l->count;
  return high ? site - (n - 1) * stride : site + (n - 1) * stride;
}

/* Whether the centre of a cell lies in the shape of a wall, or on its surface. */
static bool is_shaped(const struct cell *c) {
  const double near = BESIDE * c->lattice->spacing[0];
  bool wall = false;
  for (int n = 0; n < 8 && !wall; n++) {
    struct line line;
    double x[3];
    for (int a = 0; a < 3; a++) x[a] = c->centre[a] + (n >> a & 1 ? near : -near);
    cast_line(c, x, 0, 0.5 * c->lattice->spacing[0], &line);
    wall = is_wall(&line, x[0] - c->centre[0]);
  }
  return wall;
}

/* Finds the part of a cell that counts. That of a wall site does only where its centre lies in a
 * shape. */
static void open_cell(struct cell *c, bool wall) {
  const struct lattice *l = c->lattice;
  const int nx = lines_along(l, 0), ny = lines_along(l, 1);
  memset(c->part, 0, sizeof c->part);
  memset(c->own_cubes, 0, sizeof c->own_cubes);
  c->own = 0, c->volume = 0;
  if (wall && !is_shaped(c)) return;
  fill_cell(c);
  for (int n = 0; n < nx * ny * lines_along(l, 2); n++) {
    const int at[3] = {n % nx, n / nx % ny, n / nx / ny};
    if (c->own > 0 && *cube_at(c, at) == c->own) c->own_cubes[n / 8] |= (uint8_t)(1U << n % 8);
  }
}

/* What is kept of the cells near walls while their faces are found. */
struct near_cells {
  size_t count;
  uint32_t *number; /* [sites]: 1 + that of a cell; 0: no wall is near */
  uint8_t (*own_cubes)[CUBES_ALL / 8];
};

static enum status find_volumes(const struct scene *scene, const struct lattice *l, float *volume,
                                struct near_cells *near) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(&near->number, l->count, sizeof *near->number, "cells cut by walls"));
  for (size_t site = 0; site < l->count; site++)
    if (fabs((double)l->wall_distance[site]) < REACH * l->spacing[0])
      near->number[site] = (uint32_t)++near->count;
  TRY(memory_allocate(&near->own_cubes, near->count, sizeof *near->own_cubes,
                      "cells cut by walls"));
#pragma omp parallel for schedule(dynamic, 256)
  for (size_t site = 0; site < l->count; site++) {
    struct cell c;
    volume[site] = l->kind[site] != SITE_WALL;
    if (near->number[site] == 0) continue;
    begin_cell(scene, l, site, &c);
    open_cell(&c, l->kind[site] == SITE_WALL);
    volume[site] = (float)c.volume;
    memcpy(near->own_cubes[near->number[site] - 1], c.own_cubes, sizeof c.own_cubes);
  }
cleanup:
  return status;
}

static void load_cell(const struct scene *scene, const struct lattice *l, size_t site,
                      const struct near_cells *near, struct cell *c) {
  begin_cell(scene, l, site, c);
  if (near->number[site] > 0)
    memcpy(c->own_cubes, near->own_cubes[near->number[site] - 1], sizeof c->own_cubes);
  else
    memset(c->own_cubes, l->kind[site] == SITE_WALL ? 0 : UINT8_MAX, sizeof c->own_cubes);
}

static void find_faces(const struct scene *scene, const struct lattice *l,
                       const struct near_cells *near, float (*face)[3][2]) {
#pragma omp parallel for schedule(dynamic, 256)
  for (size_t site = 0; site < l->count; site++) {
    struct cell own, other;
    if (near->number[site] == 0) continue;
    load_cell(scene, l, site, near, &own);
    for (int a = 0; a < 3; a++) {
      if (!is_used(l, a)) continue;
      const size_t next = beside(scene, l, site, a, true);
      if (next != l->count) load_cell(scene, l, next, near, &other);
      const double share = open_share(&own, next != l->count ? &other : NULL, a);
      face[site][a][1] = (float)share;
      if (next != l->count) face[next][a][0] = (float)share;
      if (beside(scene, l, site, a, false) == l->count)
        face[site][a][0] = (float)open_share(NULL, &own, a);
    }
  }
}

/* Joins a wall site to the site beside it to which its face is most open, once that counts. */
static bool join(const struct scene *scene, const struct lattice *l, struct wall_cuts *cuts,
                 size_t site) {
  float most = 0;
  for (int n = 0; n < 6; n++) {
    const size_t next = beside(scene, l, site, n / 2, n % 2);
    if (!is_used(l, n / 2) || next == l->count || next == site) continue;
    const float share = cuts->face[site][n / 2][n % 2];
    if ((l->kind[next] == SITE_WALL && cuts->joined[next] == 0) || !(share > most)) continue;
    most = share;
    cuts->joined[site] = (uint8_t)(1 + n);
  }
  return most > 0;
}

/* In 3-D a corner of a cell may be open to wall sites alone, which join first. */
static bool join_all(const struct scene *scene, const struct lattice *l, struct wall_cuts *cuts) {
  bool any = false;
  for (int round = 0; round < l->dimensions; round++)
    for (size_t site = 0; site < l->count; site++)
      if (l->kind[site] == SITE_WALL && cuts->volume[site] > 0 && cuts->joined[site] == 0)
        any = join(scene, l, cuts, site) || any;
  return any;
}

/* Whether the lattice holds a wall by its links, or by points that were added (thin_wall.h). */
static bool has_thin_walls(const struct scene *scene) {
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    if (r->type == REGION_WALL && (r->filled || !counts(scene, &scene->regions[r->first])))
      return true;
  }
  return false;
}

enum status wall_cuts_find(const struct scene *scene, const struct lattice *l,
                           struct wall_cuts *cuts) {
  enum status status = STATUS_OK;
  struct near_cells near = {0};
  *cuts = (struct wall_cuts){0};
  if (l->wall_distance == NULL || l->region == NULL || has_thin_walls(scene)) return STATUS_OK;
  TRY(memory_allocate(&cuts->face, l->count, sizeof *cuts->face, "cells cut by walls"));
  TRY(memory_allocate(&cuts->volume, l->count, sizeof *cuts->volume, "cells cut by walls"));
  TRY(memory_allocate(&cuts->joined, l->count, 1, "cells cut by walls"));
  for (size_t n = 0; n < 6 * l->count; n++) (&cuts->face[0][0][0])[n] = 1;
  TRY(find_volumes(scene, l, cuts->volume, &near));
  find_faces(scene, l, &near, cuts->face);
  bool cut = join_all(scene, l, cuts);
  for (size_t site = 0; site < l->count && !cut; site++)
    cut = l->kind[site] != SITE_WALL && cuts->volume[site] < 1 - (float)SHARE_LEAST;
  if (!cut) wall_cuts_free(cuts);
cleanup:
  MEMORY_FREE(&near.number, &near.own_cubes);
  return status;
}

void wall_cuts_free(struct wall_cuts *cuts) {
  MEMORY_FREE(&cuts->face, &cuts->volume, &cuts->joined);
}

size_t wall_cuts_site(const struct wall_cuts *cuts, const struct scene *scene,
                      const struct lattice *l, size_t site) {
  while (l->kind[site] == SITE_WALL && cuts->joined != NULL && cuts->joined[site] > 0) {
    const int n = cuts->joined[site] - 1;
    site = beside(scene, l, site, n / 2, n % 2);
  }
  return site;
}
