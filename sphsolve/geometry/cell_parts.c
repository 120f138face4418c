#include "sphsolve/geometry/cell_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sphsolve/scene/scene_parts.h"
#include "sphsolve/scene/scene_shapes.h"
#include "sphsolve/scene/stl.h"

/* Small cubes of a cell along each axis, on the lines by which volumes are found, and areas in 3-D:
 * odd numbers, so that one has the cell's centre in its middle. */
#define CUBES_2D 17
#define CUBES_3D 7
#define CUBES_MAX CUBES_2D
/* The lines lie this far beside the middles of the cubes, in spacings: not in the faces of walls
 * whose places are round numbers of a spacing's parts, where walls that touch would not be seen. */
#define BESIDE_MIDDLE 1e-7
/* Beside a face, in spacings: of a wall that ends at the face, one side is in the wall. */
#define BESIDE 1e-9
/* Shares below count as closed, and within it of 1 as open: rounding of places. */
#define SHARE_LEAST 1e-6
/* Most ends of pieces on a line in a face, seen from both sides. */
#define PIECES_MAX (2 * CELL_REGIONS_MAX * CELL_ENDS_MAX + 2)
#define UNSEEN UINT8_MAX /* an open cube whose part has no number yet */

/* A region on a line: whether it holds the low end of the line, and where that changes. */
struct stretch {
  bool wall, inside;
  size_t count;
  double end[CELL_ENDS_MAX]; /* m from the middle of the cell */
};
struct line {
  size_t count;
  struct stretch region[CELL_REGIONS_MAX];
};

/* A cell in small cubes by x, y, z, and the connected parts of it that no wall fills. */
struct cubes {
  /* The straight ways from the middle of a cube to its six faces that no wall crosses: bits of
   * way(). */
  uint8_t ways[CUBES_MAX][CUBES_MAX][CUBES_MAX];
  uint8_t part[CUBES_MAX][CUBES_MAX][CUBES_MAX]; /* number of a part from 1; 0: wall */
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

/* Middle of a cube, m from the centre of the cell. */
static double middle_of(const struct lattice *l, int axis, int cube) {
  return ((cube + 0.5) / lines_along(l, axis) - 0.5 + BESIDE_MIDDLE) * l->spacing[axis];
}
static uint8_t *cube_at(uint8_t of[CUBES_MAX][CUBES_MAX][CUBES_MAX], const int at[3]) {
  return &of[at[0]][at[1]][at[2]];
}

/* Whether a region counts by the polygon or body that it is a part of. */
static bool has_shape(const struct scene *scene, const struct region *r) {
  const struct region *first = &scene->regions[r->first];
  return first->polygon != NULL || first->stl != NULL;
}

bool cell_counts(const struct scene *scene, const struct region *r) {
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
  line->count = c->region_count;
  for (size_t k = 0; k < c->region_count; k++) {
    struct stretch *on = &line->region[k];
    double at[POLYGON_CORNERS_MAX];
    const size_t n = find_ends(c, c->region[k], x, axis, at);
    c->crowded = c->crowded || n == POLYGON_CORNERS_MAX;
    on->wall = c->region[k]->type == REGION_WALL, on->inside = false, on->count = 0;
    for (size_t m = 0; m < n; m++) {
      const double t = at[m] - c->centre[axis];
      on->inside = on->inside != (t > -reach);
      if (!(fabs(t) < reach)) continue;
      if (on->count == CELL_ENDS_MAX)
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
    for (size_t m = 0; m < line->region[k].count; m++) end[n++] = line->region[k].end[m];
  qsort(end, n, sizeof *end, scene_parts_by_value);
  return n;
}

/* Whether the surface of a region may be in a box. What is beyond the domain is not looked at. */
static bool may_meet(const struct cell *c, const struct region *r, const double from[3],
                     const double to[3]) {
  const double *extent = extent_of(c->scene, r), *size = c->scene->domain_size;
  const struct polygon *p = r->polygon;
  for (int a = 0; a < 3; a++)
    if (is_used(c->lattice, a) && (p != NULL ? a == p->axis : !has_shape(c->scene, r)) &&
        ((from[a] <= extent[a] && extent[a] > 0) ||
         (to[a] >= extent[a + 3] && extent[a + 3] < size[a])))
      return true;
  if (p != NULL)
    return polygon_may_meet(p, (double[2]){from[p->plane[0]], from[p->plane[1]]},
                            (double[2]){to[p->plane[0]], to[p->plane[1]]});
  return has_shape(c->scene, r) && stl_may_meet(r->stl, from, to);
}

/* Whether a region holds the centre of a cell. */
static bool holds_centre(const struct cell *c, const struct region *r) {
  double at[POLYGON_CORNERS_MAX];
  const size_t n = find_ends(c, r, c->centre, 0, at);
  bool holds = false;
  for (size_t k = 0; k < n; k++) holds = holds != (at[k] < c->centre[0]);
  return holds;
}

/* Adds a region that reaches into a cell; one that fills it covers those before it. */
static void add_region(struct cell *c, const struct region *r, const double from[3],
                       const double to[3]) {
  const bool meets = may_meet(c, r, from, to);
  if (!meets && !holds_centre(c, r)) return;
  if (!meets) c->region_count = 0, c->is_cut = c->crowded = false;
  c->is_cut = c->is_cut || meets;
  if (c->region_count == CELL_REGIONS_MAX)
    c->crowded = true;
  else
    c->region[c->region_count++] = r;
}

void cell_begin(const struct scene *scene, const struct lattice *l,
                const struct region *const *regions, size_t count, size_t site, struct cell *c) {
  const size_t row = site / l->size[0],
               place[3] = {site % l->size[0], row % l->size[1], row / l->size[1]};
  double from[3], to[3];
  c->scene = scene, c->lattice = l, c->region_count = 0, c->is_cut = c->crowded = false;
  for (int a = 0; a < 3; a++) {
    const double reach = (0.5 + BESIDE_MIDDLE) * l->spacing[a];
    c->centre[a] = l->origin[a] + (double)place[a] * l->spacing[a];
    from[a] = c->centre[a] - reach, to[a] = c->centre[a] + reach;
  }
  for (size_t n = 0; n < count; n++) {
    const double *extent = extent_of(scene, regions[n]);
    bool reaches = true;
    for (int a = 0; a < 3 && reaches; a++)
      reaches = !is_used(l, a) || (to[a] > extent[a] && from[a] < extent[a + 3]);
    if (reaches) add_region(c, regions[n], from, to);
  }
}

bool cell_is_open(struct cell *c) {
  struct line line;
  cast_line(c, c->centre, 0, c->lattice->spacing[0], &line);
  return !is_wall(&line, 0);
}

/* Numbers the part of open cubes that one belongs to, each step by a straight way that no wall
 * crosses, however thin; returns how many they are. */
static int number_part(const struct lattice *l, struct cubes *c, const int from[3],
                       uint8_t number) {
  int stack[CUBES_MAX * CUBES_MAX * CUBES_MAX][3], depth = 1, count = 0;
  memcpy(stack[0], from, sizeof stack[0]);
  *cube_at(c->part, from) = number;
  while (depth > 0) {
    const int at[3] = {stack[depth - 1][0], stack[depth - 1][1], stack[depth - 1][2]};
    depth--, count++;
    for (int f = 0; f < 6; f++) {
      const int a = f / 2, high = f % 2;
      int to[3] = {at[0], at[1], at[2]};
      to[a] += high ? 1 : -1;
      if (to[a] < 0 || to[a] >= lines_along(l, a) || *cube_at(c->part, to) != UNSEEN ||
          !(*cube_at(c->ways, at) & way(a, high)) || !(*cube_at(c->ways, to) & way(a, !high)))
        continue;
      *cube_at(c->part, to) = number;
      memcpy(stack[depth++], to, sizeof to);
    }
  }
  return count;
}

/* The parts that are kept: that which holds the centre, else the largest; and the largest other.
 * `volume`: that of all, over the cell's. */
static void choose_parts(const struct lattice *l, struct cubes *c, double volume,
                         uint8_t kept[CELL_PARTS], struct cell_parts *parts) {
  int all = 0, count[UNSEEN] = {0};
  uint8_t numbers = 0;
  kept[CELL_OWN] = kept[CELL_OTHER] = 0;
  for (int i = 0; i < lines_along(l, 0); i++)
    for (int j = 0; j < lines_along(l, 1); j++)
      for (int k = 0; k < lines_along(l, 2); k++) {
        const int at[3] = {i, j, k};
        if (*cube_at(c->part, at) != UNSEEN || numbers == UNSEEN - 1) continue;
        numbers++;
        all += count[numbers] = number_part(l, c, at, numbers);
        if (count[numbers] > count[kept[CELL_OWN]]) kept[CELL_OWN] = numbers;
      }
  const int centre[3] = {lines_along(l, 0) / 2, lines_along(l, 1) / 2, lines_along(l, 2) / 2};
  parts->holds_centre = *cube_at(c->part, centre) > 0;
  if (parts->holds_centre) kept[CELL_OWN] = *cube_at(c->part, centre);
  for (uint8_t n = 1; n <= numbers; n++)
    if (n != kept[CELL_OWN] && count[n] > count[kept[CELL_OTHER]]) kept[CELL_OTHER] = n;
  for (int p = 0; p < CELL_PARTS && all > 0; p++)
    parts->volume[p] = (float)(volume * count[kept[p]] / all);
}

/* Closes the ways that walls cross on a line of cubes along an axis, and marks the cubes whose
 * middles are in walls; returns which share of the line in the cell is open. `ends`: as many as the
 * line meets are added. */
static double fill_line(struct cell *c, struct cubes *cubes, int axis, int line_at[3],
                        size_t *ends) {
  const struct lattice *l = c->lattice;
  const double half = 0.5 * l->spacing[axis], width = l->spacing[axis] / lines_along(l, axis);
  double open = 0, x[3], end[PIECES_MAX];
  struct line line;
  for (int a = 0; a < 3; a++) x[a] = c->centre[a] + middle_of(l, a, line_at[a]);
  cast_line(c, x, axis, half, &line);
  end[0] = -half, end[1] = half;
  const size_t n = add_ends(&line, 2, end);
  *ends += n - 2;
  for (size_t m = 0; m + 1 < n; m++) {
    if (!(end[m] < end[m + 1])) continue;
    if (!is_wall(&line, 0.5 * (end[m] + end[m + 1]))) {
      open += (end[m + 1] - end[m]) / l->spacing[axis];
      continue;
    }
    for (int i = 0; i < lines_along(l, axis); i++) {
      const double middle = middle_of(l, axis, i);
      line_at[axis] = i;
      for (int high = 0; high < 2; high++)
        if (end[m] < middle + 0.5 * high * width && end[m + 1] > middle - 0.5 * !high * width)
          *cube_at(cubes->ways, line_at) &= (uint8_t)~way(axis, high);
      if (middle >= end[m] && middle <= end[m + 1]) *cube_at(cubes->part, line_at) = 0;
    }
  }
  return open;
}

/* Whether a wall that ends in a cell shades a cube at its face from the middle of the cell: the
 * line from there crosses the wall, and comes to the same part again. */
static bool is_shaded(const struct lattice *l, struct cubes *c, int axis, int high, int at[3]) {
  const int n = lines_along(l, axis), face = at[axis], inward = high ? -1 : 1;
  const uint8_t part = *cube_at(c->part, at);
  bool crossed = false, shaded = false;
  for (int i = face; i != n / 2; i += inward) {
    at[axis] = i;
    crossed = crossed || !(*cube_at(c->ways, at) & way(axis, !high));
    at[axis] = i + inward;
    crossed = crossed || !(*cube_at(c->ways, at) & way(axis, high));
    shaded = shaded || (crossed && *cube_at(c->part, at) == part);
  }
  at[axis] = face;
  return shaded;
}

/* The volume is that along the lines which meet most ends, as those that run beside a thin wall
 * miss it. */
void cell_find_parts(struct cell *c, struct cell_parts *parts) {
  const struct lattice *l = c->lattice;
  double volume = 0;
  size_t most = 0;
  uint8_t kept[CELL_PARTS];
  struct cubes cubes;
  int at[3];
  memset(cubes.part, UNSEEN, sizeof cubes.part);
  memset(cubes.ways, UINT8_MAX, sizeof cubes.ways);
  for (int axis = 0; axis < 3; axis++) {
    if (!is_used(l, axis)) continue;
    const int j = axis == 0 ? 1 : 0, k = 3 - axis - j;
    double open = 0;
    size_t ends = 0;
    for (at[j] = 0; at[j] < lines_along(l, j); at[j]++)
      for (at[k] = 0; at[k] < lines_along(l, k); at[k]++)
        open += fill_line(c, &cubes, axis, at, &ends) / (lines_along(l, j) * lines_along(l, k));
    if (axis == 0 || ends > most) volume = open, most = ends;
  }
  choose_parts(l, &cubes, volume, kept, parts);
  for (int axis = 0; axis < 3; axis++)
    for (int high = 0; high < 2 && is_used(l, axis); high++)
      for (int row = 0; row < lines_along(l, across_face(axis)); row++)
        for (int column = 0; column < lines_along(l, along_face(axis)); column++) {
          at[axis] = high ? lines_along(l, axis) - 1 : 0;
          at[across_face(axis)] = row, at[along_face(axis)] = column;
          for (int p = 0; p < CELL_PARTS; p++) {
            if (kept[p] == 0 || *cube_at(cubes.part, at) != kept[p]) continue;
            if (*cube_at(cubes.ways, at) & way(axis, high))
              parts->reached[2 * axis + high][p] |= bit_of(l, axis, row, column);
            if (is_shaded(l, &cubes, axis, high, at))
              parts->shaded[2 * axis + high] |= bit_of(l, axis, row, column);
          }
        }
}

/* The lines of cubes that meet a piece of a line in a face. */
static uint64_t lines_in(const struct lattice *l, int axis, int row, double from, double to) {
  const int along = along_face(axis);
  uint64_t lines = 0;
  for (int n = 0; n < lines_along(l, along); n++) {
    const double middle = middle_of(l, along, n);
    if (middle >= from && middle <= to) lines |= bit_of(l, axis, row, n);
  }
  return lines;
}

/* The part of a cell to which such a piece is open: one that reaches the face there, as the piece
 * is connected. CELL_PARTS: none. Pieces between two lines of cubes count as closed. */
static enum cell_part part_at(const struct cell_parts *parts, int side, uint64_t lines) {
  for (enum cell_part p = CELL_OWN; p < CELL_PARTS; p++)
    if (parts->reached[side][p] & lines) return p;
  return CELL_PARTS;
}

void cell_find_areas(struct cell *low, const struct cell_parts *low_parts, struct cell *high,
                     const struct cell_parts *high_parts, int axis,
                     float area[CELL_PARTS][CELL_PARTS]) {
  struct cell *const cells[2] = {low, high};
  const struct cell_parts *const parts[2] = {low_parts, high_parts};
  const struct lattice *l = (low != NULL ? low : high)->lattice;
  const int along = along_face(axis), across = across_face(axis), rows = lines_along(l, across);
  const double half = 0.5 * l->spacing[along];
  double sum[CELL_PARTS][CELL_PARTS] = {{0}};
  for (int row = 0; row < rows; row++) {
    double end[PIECES_MAX], x[3] = {0};
    struct line line[2];
    size_t n = 2;
    end[0] = -half, end[1] = half;
    for (int s = 0; s < 2; s++) {
      if (cells[s] == NULL) continue;
      x[axis] = cells[s]->centre[axis] + (s == 0 ? 0.5 - BESIDE : BESIDE - 0.5) * l->spacing[axis];
      x[across] = cells[s]->centre[across] + middle_of(l, across, row);
      cast_line(cells[s], x, along, half, &line[s]);
      n = add_ends(&line[s], n, end);
    }
    for (size_t m = 0; m + 1 < n; m++) {
      enum cell_part part[2] = {CELL_OWN, CELL_OWN};
      const uint64_t lines = lines_in(l, axis, row, end[m], end[m + 1]);
      uint64_t shaded = 0;
      bool open = end[m] < end[m + 1];
      for (int s = 0; s < 2 && open; s++) {
        if (cells[s] == NULL) continue;
        open = !is_wall(&line[s], 0.5 * (end[m] + end[m + 1]));
        if (open) part[s] = part_at(parts[s], 2 * axis + (s == 0), lines);
        open = open && part[s] != CELL_PARTS;
        shaded |= parts[s]->shaded[2 * axis + (s == 0)] & lines;
      }
      if (open)
        sum[part[0]][part[1]] +=
            (end[m + 1] - end[m]) / (2 * half * rows) *
            (1 - (double)__builtin_popcountll(shaded) / __builtin_popcountll(lines));
    }
  }
  for (int p = 0; p < CELL_PARTS; p++)
    for (int q = 0; q < CELL_PARTS; q++) {
      const double share = sum[p][q];
      area[p][q] = (float)(share < SHARE_LEAST ? 0 : share > 1 - SHARE_LEAST ? 1 : share);
    }
}
