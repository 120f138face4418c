#include "sphsolve/geometry/thin_wall.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/distance.h"
#include "sphsolve/geometry/wall_cuts.h"
#include "sphsolve/scene/scene_geometry.h"

/* The wall distance bounds how far a point is from any wall, so that the walk may advance by it
 * (sphere tracing, Hart 1996), less the error of its interpolation; and at least by half a spacing
 * of the surface, which no wall of its sites is thinner than. Both in spacings of the surface. */
#define STEP_MIN 0.5
#define INTERPOLATION_ERROR 0.5
/* A link that only clips a convex grain has fluid beside the wall on one side, this share of the
 * way in the wall off, and deeper wall on the other. On a ball these are chords up to 1.6 radii. */
#define BYPASS 0.25
/* How far from a face, on its fluid side, its normal is taken: in a wall as thin as the surface's
 * spacing the distances inside have no direction. */
#define BESIDE_FACE 0.05

/* A link in the coordinates of the surface: index space, where its site (0, 0, 0) is at 0. */
struct walk {
  const struct lattice *surface;
  double moved;              /* m, see lattice.surface_moved */
  const size_t *folded;      /* see lattice.folded */
  double start[3], along[3]; /* first site, and the way along each axis per m of the link */
  double length, unit;       /* m: of the link; shortest spacing of the surface */
  double error;              /* m: of the distances */
  double direction[3];       /* unit vector, x, y, z */
};

/* Index of a site of the surface along one axis. */
static inline size_t wrap(long i, size_t n, size_t folded) {
  if (i >= 0 && i < (long)n) return (size_t)i;
  const long whole = (long)(folded ? folded * n : n), period = folded ? 2 * whole : whole;
  long at = i % period;
  if (at < 0) at += period;
  return (size_t)(at < whole ? at : period - 1 - at) % n;
}

/* The eight sites around a place `t` m from the first site and `aside` (m, x, y, z; may be NULL)
 * from there, and its position between them. */
static void find_corners(const struct walk *w, double t, const double *aside, float corner[8],
                         double at[3]) {
  const struct lattice *s = w->surface;
  size_t index[3][2];
  for (int a = 0; a < 3; a++) {
    const double x = w->start[a] + t * w->along[a] + (aside ? aside[a] / s->spacing[a] : 0.0);
    const long whole = (long)x - (x < 0.0); /* not far below 0 */
    at[a] = x - (double)whole;
    index[a][0] = wrap(whole, s->size[a], w->folded[a]);
    index[a][1] = wrap(whole + 1, s->size[a], w->folded[a]);
  }
  for (int c = 0; c < 8; c++)
    corner[c] =
        s->wall_distance[(index[2][c >> 2] * s->size[1] + index[1][c >> 1 & 1]) * s->size[0] +
                         index[0][c & 1]];
}

/* Wall distance (m) there: that of the regions, or between sites trilinear. */
static double distance_beside(const struct walk *w, double t, const double *aside) {
  const struct lattice *s = w->surface;
  float corner[8];
  if (s->boxes != NULL) {
    double place[3];
    for (int a = 0; a < 3; a++)
      place[a] =
          s->origin[a] + (w->start[a] + t * w->along[a]) * s->spacing[a] + (aside ? aside[a] : 0.0);
    return distance_to_boxes(s->boxes, place) + w->moved;
  }
  double x[3], d = w->moved;
  find_corners(w, t, aside, corner, x);
  for (int c = 0; c < 8; c++)
    d += (double)corner[c] * (c & 1 ? x[0] : 1.0 - x[0]) * (c & 2 ? x[1] : 1.0 - x[1]) *
         (c & 4 ? x[2] : 1.0 - x[2]);
  return d;
}

static double distance_at(const struct walk *w, double t) {
  return distance_beside(w, t, NULL);
}

/* Gradient of that distance between sites. */
static void gradient_between_sites(const struct walk *w, double t, double gradient[3]) {
  float corner[8];
  double x[3];
  find_corners(w, t, NULL, corner, x);
  for (int a = 0; a < 3; a++) {
    gradient[a] = 0.0;
    for (int c = 0; c < 8; c++) {
      double weight = c >> a & 1 ? 1.0 : -1.0;
      for (int b = 0; b < 3; b++)
        if (b != a) weight *= c >> b & 1 ? x[b] : 1.0 - x[b];
      gradient[a] += weight * (double)corner[c] / w->surface->spacing[a];
    }
  }
}

/* The same of regions, but for its length. */
static void gradient_of_boxes(const struct walk *w, double t, double gradient[3]) {
  for (int a = 0; a < 3; a++) {
    double up[3] = {0.0}, down[3] = {0.0};
    up[a] = BESIDE_FACE * w->unit, down[a] = -up[a];
    gradient[a] = distance_beside(w, t, up) - distance_beside(w, t, down);
  }
}

/* Direction in which that distance increases; 0 where it does not change. */
static void normal_at(const struct walk *w, double t, double normal[3]) {
  double length = 0.0;
  if (w->surface->boxes != NULL)
    gradient_of_boxes(w, t, normal);
  else
    gradient_between_sites(w, t, normal);
  for (int a = 0; a < 3; a++) length = hypot(length, normal[a]);
  for (int a = 0; a < 3; a++) normal[a] = length > 0.0 ? normal[a] / length : 0.0;
}

/* The place between `from` and `to` where the distance changes its sign: by bisection, as the
 * distance has kinks in thin walls, and linear at last. */
#define BISECTIONS 5
static double find_face(const struct walk *w, double from, double d_from, double to, double d_to) {
  for (int i = 0; i < BISECTIONS; i++) {
    const double middle = 0.5 * (from + to), d = distance_at(w, middle);
    if ((d >= 0.0) == (d_from >= 0.0))
      from = middle, d_from = d;
    else
      to = middle, d_to = d;
  }
  return from + (to - from) * d_from / (d_from - d_to);
}

static double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct thin_wall_side face_of(const struct walk *w, double from_near,
                                     const double normal[3]) {
  const double slope = fabs(dot(w->direction, normal));
  struct thin_wall_side face = {.before = slope * from_near,
                                .behind = slope * (w->length - from_near)};
  memcpy(face.normal, normal, sizeof face.normal);
  return face;
}

/* From a place in the wall on along the link, or back: where the wall ends, and the normal of its
 * face there. False if it does not within the length of the link. */
static bool leave_wall(const struct walk *w, double from, double sign, double *face,
                       double normal[3]) {
  const double unit = w->unit;
  double t = 0.0, d = distance_at(w, from);
  while (t < w->length) {
    const double next = t + fmax(STEP_MIN * unit, fabs(d) - w->error);
    const double ahead = distance_at(w, from + sign * next);
    if (ahead >= 0.0) {
      *face = find_face(w, from + sign * t, d, from + sign * next, ahead);
      normal_at(w, *face + sign * BESIDE_FACE * unit, normal);
      return true;
    }
    t = next, d = ahead;
  }
  return false;
}

/* Whether the wall from `entered` to `left` is only a piece of a convex grain. */
static bool is_clipped(const struct walk *w, double entered, double left) {
  const double middle = 0.5 * (entered + left), way = BYPASS * (left - entered);
  double up[3], down[3], length = 0.0;
  normal_at(w, middle, up);
  const double along = dot(up, w->direction);
  for (int a = 0; a < 3; a++) {
    up[a] -= along * w->direction[a];
    length = hypot(length, up[a]);
  }
  if (!(length > 0.0)) return false;
  for (int a = 0; a < 3; a++) {
    up[a] *= way / length;
    down[a] = -up[a];
  }
  return distance_beside(w, middle, up) > 0.0 &&
         distance_beside(w, middle, down) < distance_at(w, middle) - 0.5 * way;
}

/* Follows the link from its first site; fills the first face of the first wall that separates the
 * sites, and the last face of the last one. An end of the link in the wall, as the interpolation at
 * a site and here may differ, belongs to the wall through which it lies. */
static bool follow(const struct walk *w, struct thin_wall_side *near, struct thin_wall_side *far) {
  double t = 0.0, d = distance_at(w, 0.0);
  bool found = false;
  while (t < w->length) {
    double entered = t, left, entry[3], exit[3];
    if (d >= 0.0) { /* on to the next wall */
      const double next = fmin(t + fmax(STEP_MIN * w->unit, d - w->error), w->length);
      const double ahead = distance_at(w, next);
      if (ahead < 0.0) {
        entered = find_face(w, t, d, next, ahead);
        normal_at(w, entered - BESIDE_FACE * w->unit, entry);
      }
      t = next, d = ahead;
      if (ahead >= 0.0) continue;
    } else if (!leave_wall(w, t, -1.0, &entered, entry)) {
      return found; /* thick */
    }
    if (!leave_wall(w, t, 1.0, &left, exit)) return found;
    if (!is_clipped(w, entered, left)) {
      if (!found && near) *near = face_of(w, fmax(entered, 0.0), entry);
      if (far) *far = face_of(w, fmax(w->length - left, 0.0), exit);
      found = true;
    }
    t = left + BESIDE_FACE * w->unit, d = distance_at(w, t);
    if (d < 0.0) d = 0.0; /* beside the face by rounding */
  }
  return found;
}

/* Whether the link meets a wall between two places, at distances d_from and d_to from the walls.
 * The distance falls by at most the way, so that half ways without room for a wall are not looked
 * at. slack: m, error of the distances. */
static bool meets_wall(const struct walk *w, double from, double d_from, double to, double d_to,
                       double slack) {
  if (d_from < 0.0 || d_to < 0.0) return true;
  if (d_from + d_to > to - from + slack || to - from < STEP_MIN * w->unit) return false;
  const double middle = 0.5 * (from + to), d = distance_at(w, middle);
  return meets_wall(w, from, d_from, middle, d, slack) || meets_wall(w, middle, d, to, d_to, slack);
}

/* The site of a box `i`, `j`, `k` steps from its lowest corner. */
static size_t site_in_box(const struct lattice *l, const size_t first[3], int i, int j, int k) {
  return (wrap((long)first[2] + k, l->size[2], 0) * l->size[1] +
          wrap((long)first[1] + j, l->size[1], 0)) *
             l->size[0] +
         wrap((long)first[0] + i, l->size[0], 0);
}

/* Sites along each axis of the box in which a way around is looked for. */
#define WAY_MAX 11

/* Whether walls of a domain separate two sites whatever lies on the link: no way over open faces
 * leads from one to the other within the box that they span, grown by one site less than the
 * longest step. So no ways exist but those over faces, and walls that touch in a point are tight.
 */
static bool is_pinched(const struct lattice *l, const size_t at[3], const int step[3]) {
  bool reached[WAY_MAX * WAY_MAX * WAY_MAX] = {false};
  uint16_t stack[WAY_MAX * WAY_MAX * WAY_MAX];
  int longest = 0, size[3], first[3], depth = 0;
  if (l->shapes == NULL) return false;
  for (int a = 0; a < 3; a++) longest = longest > abs(step[a]) ? longest : abs(step[a]);
  for (int a = 0; a < 3; a++) {
    const int room = (WAY_MAX - 1 - abs(step[a])) / 2;
    const int grown = l->size[a] == 1 ? 0 : longest - 1 < room ? longest - 1 : room;
    first[a] = (step[a] < 0 ? step[a] : 0) - grown;
    size[a] = abs(step[a]) + 1 + 2 * grown;
  }
  const int begin = (-first[2] * size[1] - first[1]) * size[0] - first[0];
  const int end = begin + (step[2] * size[1] + step[1]) * size[0] + step[0];
  stack[depth++] = (uint16_t)begin, reached[begin] = true;
  while (depth > 0 && !reached[end]) {
    const int here = stack[--depth];
    const int place[3] = {here % size[0], here / size[0] % size[1], here / size[0] / size[1]};
    for (int f = 0; f < 6; f++) {
      const int a = f / 2, stride = a == 0 ? 1 : a == 1 ? size[0] : size[0] * size[1];
      const int next = here + (f % 2 ? stride : -stride);
      size_t site[2] = {0};
      if ((f % 2 ? place[a] + 1 == size[a] : place[a] == 0) || reached[next]) continue;
      for (int n = 0; n < 2; n++)
        for (int b = 2; b >= 0; b--)
          site[n] = site[n] * l->size[b] + wrap((long)at[b] + first[b] + place[b] +
                                                    (n == 0 || b != a ? 0
                                                     : f % 2          ? 1
                                                                      : -1),
                                                l->size[b], 0);
      if (l->kind[site[1]] == SITE_WALL || thin_wall_on_face(l, site[f % 2 ? 0 : 1], a)) continue;
      reached[next] = true, stack[depth++] = (uint16_t)next;
    }
  }
  return !reached[end];
}

/* Whether a link lies in one cell of a lattice that is the surface itself. */
static bool in_own_cell(const struct lattice *l, const int step[3]) {
  return l->surface == NULL && l->boxes == NULL && abs(step[0]) <= 1 && abs(step[1]) <= 1 &&
         abs(step[2]) <= 1;
}

bool thin_wall_open_box(const struct lattice *l, const size_t at[3], const int step[3]) {
  const int n[3] = {abs(step[0]), abs(step[1]), abs(step[2])};
  size_t first[3];
  for (int a = 0; a < 3; a++)
    first[a] = wrap((long)at[a] + (step[a] < 0 ? step[a] : 0), l->size[a], 0);
  if (in_own_cell(l, step)) return !is_pinched(l, at, step);
  for (int k = 0; k <= n[2]; k++)
    for (int j = 0; j <= n[1]; j++)
      for (int i = 0; i <= n[0]; i++) {
        const size_t s = site_in_box(l, first, i, j, k);
        if (l->kind[s] != SITE_FLUID || (l->cut != NULL && l->cut[s] != 0)) return false;
      }
  return true;
}

bool thin_wall_cuts(const struct lattice *l, const size_t at[3], const int step[3],
                    struct thin_wall_side *near, struct thin_wall_side *far) {
  const struct lattice *s = l->surface ? l->surface : l;
  struct walk w = {.surface = s, .moved = l->surface_moved, .folded = l->folded};
  /* One of the two directions is always followed, so that rounding cannot make them differ. */
  const bool back = step[2] < 0 || (step[2] == 0 && (step[1] < 0 || (step[1] == 0 && step[0] < 0)));
  size_t here = 0, there = 0;
  double square = 0.0, coarsest = 0.0;
  for (int a = 2; a >= 0; a--) {
    const long n = (long)l->size[a];
    long to = ((long)at[a] + step[a]) % n;
    if (to < 0) to += n;
    here = here * l->size[a] + at[a];
    there = there * l->size[a] + (size_t)to;
    const double x =
        (l->origin[a] + (double)(back ? to : (long)at[a]) * l->spacing[a] - s->origin[a]);
    const double length = (back ? -step[a] : step[a]) * l->spacing[a];
    w.start[a] = x / s->spacing[a];
    w.along[a] = length / s->spacing[a];
    w.direction[a] = length;
    square += length * length;
    coarsest = fmax(coarsest, s->spacing[a]);
  }
  w.length = sqrt(square);
  w.unit = fmin(s->spacing[0], fmin(s->spacing[1], s->spacing[2]));
  w.error = INTERPOLATION_ERROR * w.unit;
  if (s->boxes != NULL) {
    w.unit = fmax(s->thinnest, SCENE_WALL_THICKNESS_MIN * w.unit);
    w.error = 0.0;
  }
  const bool pinched = is_pinched(l, at, step);
  const double slack = l->surface || l->boxes ? INTERPOLATION_ERROR * coarsest : 0.0;
  const double d_here = (double)l->wall_distance[here], d_there = (double)l->wall_distance[there];
  if (d_here + d_there > w.length + slack && !pinched) return false;
  for (int a = 0; a < 3; a++) w.direction[a] /= w.length, w.along[a] /= w.length;
  struct thin_wall_side *first = back ? far : near, *last = back ? near : far;
  if (meets_wall(&w, 0.0, back ? d_there : d_here, w.length, back ? d_here : d_there, slack) &&
      follow(&w, first, last))
    return true;
  if (!pinched) return false;
  for (int end = 0; end < 2; end++) {
    struct thin_wall_side *side = end ? last : first;
    if (side == NULL) continue;
    side->before = side->behind = 0.5 * w.length;
    for (int a = 0; a < 3; a++) side->normal[a] = end ? w.direction[a] : -w.direction[a];
  }
  return true;
}

/* Faces are stored as those of a lattice that is periodic along all axes. */
static const bool around[3] = {true, true, true};

enum status thin_wall_find_faces(struct lattice *l) {
  enum status status = STATUS_OK;
  const size_t plane = l->size[0] * l->size[1];
  uint8_t *cut = NULL, *closed = NULL;
  size_t count = 0;
  TRY(memory_allocate(&cut, l->count, 1, "walls between sites"));
  if (l->shapes != NULL) TRY(wall_cuts_closed_faces(l->shapes, l, &closed));
#pragma omp parallel for schedule(dynamic, 1) reduction(+ : count)
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t s = k * plane; s < (k + 1) * plane && !interrupt_alone(); s++) {
      const size_t at[3] = {s % l->size[0], s / l->size[0] % l->size[1], k};
      if (l->kind[s] == SITE_WALL) continue;
      for (int a = 0; a < 3; a++) {
        if (l->size[a] == 1) continue;
        const int step[3] = {a == 0, a == 1, a == 2};
        const size_t next = lattice_beyond(around, l, s, a, false);
        if (l->kind[next] == SITE_WALL) continue;
        if (!(closed != NULL && (closed[s] >> a & 1) != 0) &&
            !thin_wall_cuts(l, at, step, NULL, NULL))
          continue;
        cut[s] |= (uint8_t)(1U << a);
        count++;
      }
    }
  TRY(interrupt_look());
  memory_free(&l->cut);
  if (count > 0) l->cut = cut, cut = NULL;
cleanup:
  MEMORY_FREE(&cut, &closed);
  return status;
}

enum status thin_wall_fill(struct lattice *l) {
  enum status status = STATUS_OK;
  uint8_t *wall = NULL;
  if (l->cut == NULL) return STATUS_OK;
  TRY(memory_allocate(&wall, l->count, 1, "walls between sites"));
  for (size_t s = 0; s < l->count; s++)
    for (int a = 0; a < 3; a++) {
      if (!thin_wall_on_face(l, s, a)) continue;
      const size_t next = lattice_beyond(around, l, s, a, false);
      if (l->kind[s] != SITE_FLUID || l->kind[next] != SITE_FLUID) continue;
      wall[l->wall_distance[next] < l->wall_distance[s] ? next : s] = 1;
    }
  /* The ranks of a machine share these arrays, and write the same values. */
  ranks_wait();
  for (size_t s = 0; s < l->count; s++) {
    if (!wall[s]) continue;
    l->kind[s] = SITE_WALL;
    l->wall_distance[s] = -fabsf(l->wall_distance[s]);
    l->fluid_count--, l->wall_count++;
  }
  ranks_wait();
  l->filled = true;
  memory_free(&l->cut);
cleanup:
  memory_free(&wall);
  return status;
}

static size_t site_beside(const struct lattice *l, const size_t at[3], int axis, int step) {
  size_t to[3] = {at[0], at[1], at[2]};
  to[axis] = (to[axis] + l->size[axis] + (size_t)step) % l->size[axis];
  return (to[2] * l->size[1] + to[1]) * l->size[0] + to[0];
}

/* Whether fluid sites lead around a wall site along an axis, in a row beside it: it is the tip of a
 * grain then, no wall between two pores. */
static bool leads_around(const struct lattice *l, const size_t at[3], int axis) {
  for (int b = 0; b < 3; b++)
    for (int side = -1; side <= 1 && b != axis && l->size[b] > 1; side += 2) {
      bool open = true;
      for (int along = -1; along <= 1; along++) {
        size_t here[3] = {at[0], at[1], at[2]};
        here[axis] = (here[axis] + l->size[axis] + (size_t)along) % l->size[axis];
        const size_t row = site_beside(l, here, b, side);
        const size_t below =
            side > 0 ? (here[2] * l->size[1] + here[1]) * l->size[0] + here[0] : row;
        open = open && l->kind[row] == SITE_FLUID &&
               (along == 1 || !thin_wall_on_face(l, row, axis)) &&
               (along == 0 || !thin_wall_on_face(l, below, b));
      }
      if (open) return true;
    }
  return false;
}

enum status thin_wall_closed_faces(const struct lattice *l, uint8_t **closed) {
  enum status status = STATUS_OK;
  const size_t plane = l->size[0] * l->size[1];
  size_t count = 0;
  *closed = NULL;
  if (l->wall_distance == NULL) return STATUS_OK;
  TRY(memory_allocate(closed, l->count, 1, "walls between sites"));
  if (l->cut != NULL) memcpy(*closed, l->cut, l->count);
  for (size_t s = 0; s < l->count; s++) {
    const size_t at[3] = {s % l->size[0], s / l->size[0] % l->size[1], s / plane};
    const size_t stride[3] = {1, l->size[0], plane};
    count += (*closed)[s] != 0;
    for (int a = 0; a < 3 && l->kind[s] == SITE_WALL; a++) {
      const size_t all = l->size[a] * stride[a];
      const size_t last = at[a] > 0 ? s - stride[a] : s + all - stride[a];
      const size_t next = lattice_beyond(around, l, s, a, false);
      size_t from[3] = {at[0], at[1], at[2]};
      const int step[3] = {a == 0 ? 2 : 0, a == 1 ? 2 : 0, a == 2 ? 2 : 0};
      from[a] = at[a] > 0 ? at[a] - 1 : l->size[a] - 1;
      if (l->kind[last] != SITE_FLUID || l->kind[next] != SITE_FLUID || leads_around(l, at, a) ||
          !thin_wall_cuts(l, from, step, NULL, NULL))
        continue;
      (*closed)[last] |= (uint8_t)(1U << a);
      (*closed)[s] |= (uint8_t)(1U << a);
      count++;
    }
  }
cleanup:
  if (status == STATUS_OK && count == 0) memory_free(closed);
  return status;
}
