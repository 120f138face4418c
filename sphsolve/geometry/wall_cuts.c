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
/* The lines lie this far beside the middles of the cubes, in spacings: not in the faces of walls
 * whose places are round numbers of a spacing's parts, where walls that touch would not be seen. */
#define BESIDE_MIDDLE 1.618e-7
/* Beside a face, in spacings: of a wall that ends at the face, one side is in the wall. */
#define BESIDE 1e-9
/* Shares below count as closed, and within it of 1 as open: rounding of places. */
#define SHARE_LEAST 1e-6
/* Sites further from the boxes of the walls, in spacings, have no wall in their cells: half a
 * diagonal of the cell, and what a shape differs from its boxes. */
#define REACH 2.0
/* Most regions that reach into one cell, and ends of one on a line there. */
#define NEAR_MAX 32
#define ENDS_MAX 32
#define PIECES_MAX (2 * NEAR_MAX * ENDS_MAX + 2)
#define UNSEEN UINT8_MAX /* an open cube whose part has no number yet */
/* The parts of a cell that are kept: that of its site, and one more. */
enum part { OWN, OTHER, PARTS };

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

/* A cell in small cubes by x, y, z, and the connected parts of it that no wall fills. */
struct cell {
  const struct scene *scene;
  const struct lattice *lattice;
  double centre[3];
  bool crowded; /* more regions or ends than there is room for */
  bool is_cut;  /* whether any surface of a region may be in it, or within a cube of it */
  size_t near_count;
  const struct region *near[NEAR_MAX]; /* those that may reach into it, in order */
  /* The straight ways from the middle of a cube to its six faces that no wall crosses: bits of
   * way(). */
  uint8_t ways[CUBES_MAX][CUBES_MAX][CUBES_MAX];
  uint8_t part[CUBES_MAX][CUBES_MAX][CUBES_MAX]; /* number of a part from 1; 0: wall */
};

/* What is kept of a cell near walls. */
struct cut {
  bool is_whole;       /* no surface is in it: it is of one part, or of none */
  float volume[PARTS]; /* of its parts, over the cell's */
  float area[3][PARTS][PARTS]; /* of the face at its high end: open to a part of it and of the next */
  float outside[3][2][PARTS];  /* the same of faces to the outside */
  /* By 2 axis + high: bits of the cubes at a face from which a part reaches the face, by bit_of() */
  uint64_t reached[6][PARTS];
};
struct near_cells {
  size_t region_count;
  const struct region **region; /* those that count, from the first wall on */
  size_t count;
  uint32_t *number; /* [sites]: 1 + that of a cell; 0: no wall is near */
  struct cut *cut;
};

static unsigned way(int axis, int high) {
  return 1U << (2 * axis + high);
}

static int lines_along(const struct lattice *l, int axis) {
  return l->dimensions == 3 ? CUBES_3D : axis == 1 ? 1 : CUBES_2D;
}

static bool is_used(const struct lattice *l, int axis) {
  return lines_along(l, axis) > 1;
}

/* Lines in the face across an axis go along one of the others, beside one another along the third.
 */
static int along_face(int axis) {
  return axis == 0 ? 2 : 0;
}
static int across_face(int axis) {
  return 3 - axis - along_face(axis);
}
static uint64_t bit_of(const struct lattice *l, int axis, int row, int column) {
  return (uint64_t)1 << (row * lines_along(l, along_face(axis)) + column);
}

/* Cubes along an axis, from `first` on; and the middle of one, m from the centre of the cell. */
static int first_cube(const struct lattice *l, int axis) {
  return is_used(l, axis) ? -1 : 0;
}
static int cubes_end(const struct lattice *l, int axis) {
  return lines_along(l, axis) + is_used(l, axis);
}
static double middle_of(const struct lattice *l, int axis, int cube) {
  return ((cube + 0.5) / lines_along(l, axis) - 0.5 + BESIDE_MIDDLE) * l->spacing[axis];
}
static uint8_t *cube_at(uint8_t of[CUBES_MAX][CUBES_MAX][CUBES_MAX], const int at[3]) {
  return &of[at[0] + 1][at[1] + 1][at[2] + 1];
}
static bool is_inner(const struct lattice *l, const int at[3]) {
  bool inner = true;
  for (int a = 0; a < 3; a++) inner = inner && at[a] >= 0 && at[a] < lines_along(l, a);
  return inner;
}

/* Whether a region counts by the polygon or body that it is a part of. */
static bool has_shape(const struct scene *scene, const struct region *r) {
  const struct region *first = &scene->regions[r->first];
  return first->polygon != NULL || first->stl != NULL;
}

/* Whether a region counts here, and not by another part of its shape. */
static bool counts(const struct scene *scene, const struct region *r) {
  const bool fills = r->type == REGION_WALL || r->type == REGION_POROUS ||
                     r->type == REGION_WATER || r->type == REGION_EMPTY;
  return fills && (!has_shape(scene, r) || r == &scene->regions[r->first]);
}

static const double *extent_of(const struct scene *scene, const struct region *r) {
  return has_shape(scene, r) ? r->extent : r->box;
}

/* Where a region begins and ends on the line through x along an axis. */
static size_t find_ends(const struct cell *c, const struct region *r, const double x[3], int axis,
                        double at[POLYGON_CORNERS_MAX]) {
  const double *extent = extent_of(c->scene, r);
  const struct polygon *p = r->polygon;
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
static void cast_line(struct cell *c, const double x[3], int axis, double reach,
                      struct line *line) {
  line->count = c->near_count;
  for (size_t k = 0; k < c->near_count; k++) {
    struct stretch *on = &line->region[k];
    double at[POLYGON_CORNERS_MAX];
    const size_t n = find_ends(c, c->near[k], x, axis, at);
    on->wall = c->near[k]->type == REGION_WALL, on->inside = false, on->count = 0;
    for (size_t m = 0; m < n; m++) {
      const double t = at[m] - c->centre[axis];
      on->inside = on->inside != (t > -reach);
      if (!(fabs(t) < reach)) continue;
      if (on->count == ENDS_MAX)
        c->crowded = true;
      else
        on->end[on->count++] = t;
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
    for (size_t m = 0; m < line->region[k].count; m++)
      end[n++] = line->region[k].end[m];
  qsort(end, n, sizeof *end, scene_parts_by_value);
  return n;
}

/* Whether the surface of a region may be in a box. */
static bool may_meet(const struct cell *c, const struct region *r, const double from[3],
                     const double to[3]) {
  const double *extent = extent_of(c->scene, r);
  const struct polygon *p = r->polygon;
  for (int a = 0; a < 3; a++)
    if (is_used(c->lattice, a) && (p != NULL ? a == p->axis : !has_shape(c->scene, r)) &&
        !(from[a] > extent[a] && to[a] < extent[a + 3]))
      return true;
  if (p != NULL)
    return polygon_may_meet(p, (double[2]){from[p->plane[0]], from[p->plane[1]]},
                            (double[2]){to[p->plane[0]], to[p->plane[1]]});
  return has_shape(c->scene, r) && stl_may_meet(r->stl, from, to);
}

static void begin_cell(const struct near_cells *near, const struct scene *scene,
                       const struct lattice *l, size_t site, struct cell *c) {
  const size_t row = site / l->size[0],
               place[3] = {site % l->size[0], row % l->size[1], row / l->size[1]};
  double from[3], to[3];
  c->scene = scene, c->lattice = l, c->near_count = 0, c->crowded = c->is_cut = false;
  for (int a = 0; a < 3; a++) {
    c->centre[a] = l->origin[a] + (double)place[a] * l->spacing[a];
    const double reach = (0.5 + 1.0 / lines_along(l, a)) * l->spacing[a];
    from[a] = c->centre[a] - reach, to[a] = c->centre[a] + reach;
  }
  for (size_t n = 0; n < near->region_count; n++) {
    const struct region *r = near->region[n];
    const double *extent = extent_of(scene, r);
    bool reaches = true;
    for (int a = 0; a < 3 && reaches; a++)
      reaches = !is_used(l, a) || (to[a] > extent[a] && from[a] < extent[a + 3]);
    if (!reaches) continue;
    c->is_cut = c->is_cut || may_meet(c, r, from, to);
    if (c->near_count == NEAR_MAX)
      c->crowded = true;
    else
      c->near[c->near_count++] = r;
  }
}

/* Numbers the part of open cubes that one belongs to, each step by a straight way that no wall
 * crosses, however thin; returns how many of them are in the cell. */
static int number_part(struct cell *c, const int from[3], uint8_t number) {
  int stack[CUBES_MAX * CUBES_MAX * CUBES_MAX][3], depth = 1, count = 0;
  memcpy(stack[0], from, sizeof stack[0]);
  *cube_at(c->part, from) = number;
  while (depth > 0) {
    const int at[3] = {stack[depth - 1][0], stack[depth - 1][1], stack[depth - 1][2]};
    depth--, count += is_inner(c->lattice, at);
    for (int f = 0; f < 6; f++) {
      const int a = f / 2, high = f % 2;
      int to[3] = {at[0], at[1], at[2]};
      to[a] += high ? 1 : -1;
      if (to[a] < first_cube(c->lattice, a) || to[a] >= cubes_end(c->lattice, a) ||
          *cube_at(c->part, to) != UNSEEN || !(*cube_at(c->ways, at) & way(a, high)) ||
          !(*cube_at(c->ways, to) & way(a, !high)))
        continue;
      *cube_at(c->part, to) = number;
      memcpy(stack[depth++], to, sizeof to);
    }
  }
  return count;
}

/* The parts that are kept: that which holds the centre, else the largest; and the largest other.
 * `volume`: that of all, over the cell's. */
static void choose_parts(struct cell *c, double volume, uint8_t kept[PARTS], struct cut *cut) {
  const struct lattice *l = c->lattice;
  int all = 0, count[UNSEEN] = {0};
  uint8_t numbers = 0;
  kept[OWN] = kept[OTHER] = 0;
  for (int i = 0; i < lines_along(l, 0); i++)
    for (int j = 0; j < lines_along(l, 1); j++)
      for (int k = 0; k < lines_along(l, 2); k++) {
        const int at[3] = {i, j, k};
        if (*cube_at(c->part, at) != UNSEEN || numbers == UNSEEN - 1) continue;
        numbers++;
        all += count[numbers] = number_part(c, at, numbers);
        if (count[numbers] > count[kept[OWN]]) kept[OWN] = numbers;
      }
  for (int n = 7; n >= 0; n--) {
    int at[3];
    for (int a = 0; a < 3; a++) at[a] = is_used(l, a) ? lines_along(l, a) / 2 - (n >> a & 1) : 0;
    if (*cube_at(c->part, at) > 0) kept[OWN] = *cube_at(c->part, at);
  }
  for (uint8_t n = 1; n <= numbers; n++)
    if (n != kept[OWN] && count[n] > count[kept[OTHER]]) kept[OTHER] = n;
  for (int p = 0; p < PARTS && all > 0; p++)
    cut->volume[p] = (float)(volume * count[kept[p]] / all);
}

/* Closes the ways that walls cross on a line of cubes along an axis, and marks the cubes whose
 * middles are in walls; returns which share of the line in the cell is open. */
static double fill_line(struct cell *c, int axis, int line_at[3]) {
  const struct lattice *l = c->lattice;
  const double half = 0.5 * l->spacing[axis], width = l->spacing[axis] / lines_along(l, axis);
  double open = 0, x[3], end[PIECES_MAX] = {-half - width, half + width};
  struct line line;
  line_at[axis] = 0;
  const bool inner = is_inner(l, line_at);
  for (int a = 0; a < 3; a++) x[a] = c->centre[a] + middle_of(l, a, line_at[a]);
  cast_line(c, x, axis, half + width, &line);
  const size_t n = add_ends(&line, 2, end);
  for (size_t m = 0; m + 1 < n; m++) {
    if (!(end[m] < end[m + 1])) continue;
    if (!is_wall(&line, 0.5 * (end[m] + end[m + 1]))) {
      open += fmax(0, fmin(end[m + 1], half) - fmax(end[m], -half));
      continue;
    }
    for (int i = -1; i < cubes_end(l, axis); i++) {
      const double middle = middle_of(l, axis, i);
      line_at[axis] = i;
      for (int high = 0; high < 2; high++)
        if (end[m] < middle + 0.5 * high * width && end[m + 1] > middle - 0.5 * !high * width)
          *cube_at(c->ways, line_at) &= (uint8_t)~way(axis, high);
      if (middle >= end[m] && middle <= end[m + 1]) *cube_at(c->part, line_at) = 0;
    }
  }
  return inner ? open / l->spacing[axis] : 0;
}

/* Finds the open parts of a cell. Beyond the domain all is wall, also where it is periodic. */
static void fill_cell(struct cell *c, struct cut *cut) {
  const struct lattice *l = c->lattice;
  const double *size = c->scene->domain_size;
  double volume = 0;
  uint8_t kept[PARTS];
  int at[3];
  memset(c->part, 0, sizeof c->part);
  memset(c->ways, UINT8_MAX, sizeof c->ways);
  for (at[0] = first_cube(l, 0); at[0] < cubes_end(l, 0); at[0]++)
    for (at[1] = first_cube(l, 1); at[1] < cubes_end(l, 1); at[1]++)
      for (at[2] = first_cube(l, 2); at[2] < cubes_end(l, 2); at[2]++) {
        bool inside = true;
        for (int a = 0; a < 3; a++) {
          const double place = c->centre[a] + middle_of(l, a, at[a]);
          inside = inside && (!is_used(l, a) || (place > 0 && place < size[a]));
        }
        if (inside || is_inner(l, at)) *cube_at(c->part, at) = UNSEEN;
      }
  for (int axis = 0; axis < 3; axis++) {
    if (!is_used(l, axis)) continue;
    const int j = axis == 0 ? 1 : 0, k = 3 - axis - j;
    for (at[j] = first_cube(l, j); at[j] < cubes_end(l, j); at[j]++)
      for (at[k] = first_cube(l, k); at[k] < cubes_end(l, k); at[k]++) {
        const double open = fill_line(c, axis, at);
        if (axis == 0) volume += open / (lines_along(l, 1) * lines_along(l, 2));
      }
  }
  choose_parts(c, volume, kept, cut);
  for (int axis = 0; axis < 3; axis++)
    for (int high = 0; high < 2 && is_used(l, axis); high++)
      for (int row = 0; row < lines_along(l, across_face(axis)); row++)
        for (int column = 0; column < lines_along(l, along_face(axis)); column++) {
          at[axis] = high ? lines_along(l, axis) - 1 : 0;
          at[across_face(axis)] = row, at[along_face(axis)] = column;
          for (int p = 0; p < PARTS; p++)
            if (kept[p] > 0 && *cube_at(c->part, at) == kept[p] &&
                (*cube_at(c->ways, at) & way(axis, high)))
              cut->reached[2 * axis + high][p] |= bit_of(l, axis, row, column);
        }
}

/* A cell without a surface in it. */
static void fill_whole(struct cell *c, struct cut *cut) {
  struct line line;
  cut->is_whole = true;
  cast_line(c, c->centre, 0, c->lattice->spacing[0], &line);
  if (is_wall(&line, 0)) return;
  cut->volume[OWN] = 1;
  for (int n = 0; n < 6; n++) cut->reached[n][OWN] = UINT64_MAX;
}

/* The part of a cell to which a piece of a line in its face is open: one that reaches the face
 * there, as the piece is connected. PARTS: none. Pieces between two lines of cubes count as closed.
 */
static enum part part_at(const struct cut *cut, const struct lattice *l, int axis, int high,
                         int row, double from, double to) {
  const int along = along_face(axis);
  uint64_t columns = 0;
  for (int n = 0; n < lines_along(l, along); n++) {
    const double middle = middle_of(l, along, n);
    if (middle >= from && middle <= to) columns |= bit_of(l, axis, row, n);
  }
  for (enum part p = OWN; p < PARTS; p++)
    if (cut->reached[2 * axis + high][p] & columns) return p;
  return PARTS;
}

/* Shares of a face that are open to the parts of the cells at its low and its high side. NULL: the
 * outside, which is one part. */
static void find_areas(struct cell *low, const struct cut *low_cut, struct cell *high,
                       const struct cut *high_cut, int axis, float area[PARTS][PARTS]) {
  struct cell *const cells[2] = {low, high};
  const struct cut *const cuts[2] = {low_cut, high_cut};
  const struct lattice *l = (low != NULL ? low : high)->lattice;
  const int along = along_face(axis), across = across_face(axis), rows = lines_along(l, across);
  const double half = 0.5 * l->spacing[along];
  double sum[PARTS][PARTS] = {{0}};
  for (int row = 0; row < rows; row++) {
    double end[PIECES_MAX] = {-half, half}, x[3] = {0};
    struct line line[2];
    size_t n = 2;
    for (int s = 0; s < 2; s++) {
      if (cells[s] == NULL) continue;
      x[axis] = cells[s]->centre[axis] + (s == 0 ? 0.5 - BESIDE : BESIDE - 0.5) * l->spacing[axis];
      x[across] = cells[s]->centre[across] + middle_of(l, across, row);
      cast_line(cells[s], x, along, half, &line[s]);
      n = add_ends(&line[s], n, end);
    }
    for (size_t m = 0; m + 1 < n; m++) {
      enum part part[2] = {OWN, OWN};
      bool open = end[m] < end[m + 1];
      for (int s = 0; s < 2 && open; s++) {
        if (cells[s] == NULL) continue;
        open = !is_wall(&line[s], 0.5 * (end[m] + end[m + 1]));
        if (open) part[s] = part_at(cuts[s], l, axis, s == 0, row, end[m], end[m + 1]);
        open = open && part[s] != PARTS;
      }
      if (open) sum[part[0]][part[1]] += (end[m + 1] - end[m]) / (2 * half * rows);
    }
  }
  for (int p = 0; p < PARTS; p++)
    for (int q = 0; q < PARTS; q++) {
      const double share = sum[p][q];
      area[p][q] = (float)(share < SHARE_LEAST ? 0 : share > 1 - SHARE_LEAST ? 1 : share);
    }
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

/* The cell of a site, which has no other part where no wall is near. */
static const struct cut *cut_of(const struct near_cells *near, const struct lattice *l,
                                size_t site) {
  static const struct cut open = {.is_whole = true,
                                  .volume = {1},
                                  .reached = {{UINT64_MAX},
                                              {UINT64_MAX},
                                              {UINT64_MAX},
                                              {UINT64_MAX},
                                              {UINT64_MAX},
                                              {UINT64_MAX}}};
  static const struct cut closed = {.is_whole = true};
  if (near->number[site] > 0) return &near->cut[near->number[site] - 1];
  return l->kind[site] == SITE_WALL ? &closed : &open;
}

static enum status find_parts(const struct scene *scene, const struct lattice *l,
                              struct near_cells *near, size_t *crowded) {
  enum status status = STATUS_OK;
  size_t worst = l->count;
  const double reach = REACH * fmax(l->spacing[0], fmax(l->spacing[1], l->spacing[2]));
  TRY(memory_allocate(&near->region, scene->region_count, sizeof *near->region,
                      "cells cut by walls"));
  for (size_t n = 0; n < scene->region_count; n++) {
    const struct region *r = &scene->regions[n];
    if (counts(scene, r) && (near->region_count > 0 || r->type == REGION_WALL))
      near->region[near->region_count++] = r;
  }
  TRY(memory_allocate(&near->number, l->count, sizeof *near->number, "cells cut by walls"));
  for (size_t site = 0; site < l->count; site++)
    if (fabs((double)l->wall_distance[site]) < reach)
      near->number[site] = (uint32_t)++near->count;
  TRY(memory_allocate(&near->cut, near->count, sizeof *near->cut, "cells cut by walls"));
#pragma omp parallel for schedule(dynamic, 256) reduction(min : worst)
  for (size_t site = 0; site < l->count; site++) {
    struct cell c;
    if (near->number[site] == 0) continue;
    struct cut *cut = &near->cut[near->number[site] - 1];
    begin_cell(near, scene, l, site, &c);
    if (c.is_cut)
      fill_cell(&c, cut);
    else
      fill_whole(&c, cut);
    if (c.crowded && site < worst) worst = site;
  }
  *crowded = worst;
cleanup:
  return status;
}

static void find_faces(const struct scene *scene, const struct lattice *l,
                       struct near_cells *near) {
#pragma omp parallel for schedule(dynamic, 256)
  for (size_t site = 0; site < l->count; site++) {
    struct cell own, other;
    if (near->number[site] == 0) continue;
    struct cut *cut = &near->cut[near->number[site] - 1];
    begin_cell(near, scene, l, site, &own);
    for (int a = 0; a < 3; a++) {
      if (!is_used(l, a)) continue;
      float area[PARTS][PARTS];
      for (int high = 0; high < 2; high++) {
        const size_t next = beside(scene, l, site, a, high);
        if (cut->is_whole && (next == l->count || cut_of(near, l, next)->is_whole)) {
          const bool open = cut->volume[OWN] > 0;
          if (next == l->count)
            cut->outside[a][high][OWN] = open;
          else if (high)
            cut->area[a][OWN][OWN] = open && cut_of(near, l, next)->volume[OWN] > 0;
        } else if (next == l->count) {
          find_areas(high ? &own : NULL, cut, high ? NULL : &own, cut, a, area);
          for (int p = 0; p < PARTS; p++)
            cut->outside[a][high][p] = high ? area[p][OWN] : area[OWN][p];
        } else if (high) {
          begin_cell(near, scene, l, next, &other);
          find_areas(&own, cut, &other, cut_of(near, l, next), a, cut->area[a]);
        }
      }
    }
  }
}

/* Share of the face between a site and the next along an axis that is open to these parts of their
 * cells. */
static float area_between(const struct near_cells *near, size_t site, enum part p, enum part q,
                          int axis) {
  if (near->number[site] > 0) return near->cut[near->number[site] - 1].area[axis][p][q];
  return p == OWN && q == OWN;
}

/* The site that takes the other part of a cell: the one beside it to whose own part it is most
 * open; l->count: none. */
static size_t taker_of(const struct scene *scene, const struct lattice *l,
                       const struct near_cells *near, size_t site) {
  size_t taker = l->count;
  float most = 0;
  if (near->number[site] == 0 || !(near->cut[near->number[site] - 1].volume[OTHER] > 0))
    return taker;
  for (int n = 0; n < 6; n++) {
    const size_t next = beside(scene, l, site, n / 2, n % 2);
    if (!is_used(l, n / 2) || next == l->count || next == site) continue;
    const float area = n % 2 ? area_between(near, site, OTHER, OWN, n / 2)
                             : area_between(near, next, OWN, OTHER, n / 2);
    if (area > most) most = area, taker = next;
  }
  return taker;
}

/* Adds to the open share of a face that is open already, so that no wall is opened. */
static bool widen(struct wall_cuts *cuts, const struct scene *scene, const struct lattice *l,
                  size_t site, int axis, float area) {
  const size_t next = beside(scene, l, site, axis, true);
  if (next == l->count || !(cuts->face[site][axis][1] > 0)) return false;
  cuts->face[site][axis][1] += area, cuts->face[next][axis][0] += area;
  return true;
}

/* Adds what of a face is open to the other part of a cell on either side to the face of the sites
 * that take it. */
static void take_face(const struct scene *scene, const struct lattice *l,
                      const struct near_cells *near, size_t site, int axis,
                      struct wall_cuts *cuts) {
  const size_t next = beside(scene, l, site, axis, true);
  const size_t of_site = taker_of(scene, l, near, site), of_next = taker_of(scene, l, near, next);
  for (enum part p = OWN; p < PARTS; p++)
    for (enum part q = OWN; q < PARTS; q++) {
      const float area = area_between(near, site, p, q, axis);
      const size_t low = p == OWN ? site : of_site, high = q == OWN ? next : of_next;
      if ((p == OWN && q == OWN) || !(area > 0) || low == l->count || high == l->count ||
          low == high)
        continue;
      const size_t before = beside(scene, l, high, axis, false);
      if (before == low || before == l->count ||
          !widen(cuts, scene, l, before, axis, area))
        widen(cuts, scene, l, low, axis, area);
    }
}

/* Gives the other parts of cells to the sites that take them. */
static void take_parts(const struct scene *scene, const struct lattice *l,
                       const struct near_cells *near, struct wall_cuts *cuts) {
  for (size_t site = 0; site < l->count; site++) {
    if (near->number[site] == 0) continue;
    const struct cut *cut = &near->cut[near->number[site] - 1];
    const size_t taker = taker_of(scene, l, near, site);
    if (taker != l->count) cuts->volume[taker] += cut->volume[OTHER];
    for (int a = 0; a < 3; a++) {
      if (!is_used(l, a)) continue;
      for (int high = 0; high < 2 && taker != l->count; high++)
        if (beside(scene, l, taker, a, high) == l->count && cuts->face[taker][a][high] > 0)
          cuts->face[taker][a][high] += cut->outside[a][high][OTHER];
      if (beside(scene, l, site, a, true) != l->count)
        take_face(scene, l, near, site, a, cuts);
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

/* What is open of cells and faces to the own parts of sites. */
static void open_own(const struct scene *scene, const struct lattice *l,
                     const struct near_cells *near, struct wall_cuts *cuts) {
  for (size_t n = 0; n < 6 * l->count; n++) (&cuts->face[0][0][0])[n] = 1;
  for (size_t site = 0; site < l->count; site++) {
    const struct cut *cut = cut_of(near, l, site);
    cuts->volume[site] = cut->volume[OWN];
    for (int a = 0; a < 3 && near->number[site] > 0; a++) {
      const size_t next = beside(scene, l, site, a, true);
      if (!is_used(l, a)) continue;
      for (int high = 0; high < 2; high++)
        if (beside(scene, l, site, a, high) == l->count)
          cuts->face[site][a][high] = cut->outside[a][high][OWN];
      if (next != l->count)
        cuts->face[site][a][1] = cuts->face[next][a][0] = cut->area[a][OWN][OWN];
    }
  }
}

static enum status find_cells(const struct scene *scene, const struct lattice *l,
                              struct near_cells *near) {
  enum status status = STATUS_OK;
  size_t crowded;
  TRY(find_parts(scene, l, near, &crowded));
  if (crowded < l->count) {
    const size_t row = crowded / l->size[0];
    TRY_FAIL(STATUS_INPUT,
             "%s: more than %d walls, or %d faces of one, are within a spacing of (%g m, %g m, %g "
             "m); a smaller domain.spacing parts them",
             scene->path, NEAR_MAX, ENDS_MAX,
             l->origin[0] + (double)(crowded % l->size[0]) * l->spacing[0],
             l->origin[1] + (double)(row % l->size[1]) * l->spacing[1],
             l->origin[2] + (double)(row / l->size[1]) * l->spacing[2]);
  }
  find_faces(scene, l, near);
cleanup:
  return status;
}

static void free_cells(struct near_cells *near) {
  MEMORY_FREE(&near->region, &near->number, &near->cut);
}

enum status wall_cuts_find(const struct scene *scene, const struct lattice *l,
                           struct wall_cuts *cuts) {
  enum status status = STATUS_OK;
  struct near_cells near = {0};
  bool cut = false;
  *cuts = (struct wall_cuts){0};
  if (l->wall_distance == NULL || l->region == NULL) return STATUS_OK;
  TRY(memory_allocate(&cuts->face, l->count, sizeof *cuts->face, "cells cut by walls"));
  TRY(memory_allocate(&cuts->volume, l->count, sizeof *cuts->volume, "cells cut by walls"));
  TRY(memory_allocate(&cuts->joined, l->count, 1, "cells cut by walls"));
  TRY(find_cells(scene, l, &near));
  open_own(scene, l, &near, cuts);
  take_parts(scene, l, &near, cuts);
  cut = join_all(scene, l, cuts);
  for (size_t site = 0; site < l->count && !cut; site++)
    cut = l->kind[site] != SITE_WALL && cuts->volume[site] < 1 - (float)SHARE_LEAST;
cleanup:
  if (!cut) wall_cuts_free(cuts);
  free_cells(&near);
  return status;
}

enum status wall_cuts_closed_faces(const struct scene *scene, const struct lattice *l,
                                   uint8_t **closed) {
  enum status status = STATUS_OK;
  struct near_cells near = {0};
  *closed = NULL;
  TRY(memory_allocate(closed, l->count, 1, "walls between sites"));
  TRY(find_cells(scene, l, &near));
  for (size_t site = 0; site < l->count; site++)
    for (int a = 0; a < 3 && near.number[site] > 0; a++)
      if (is_used(l, a) && !(area_between(&near, site, OWN, OWN, a) > 0))
        (*closed)[site] |= (uint8_t)(1U << a);
cleanup:
  free_cells(&near);
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
