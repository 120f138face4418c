#include "sphsolve/scene/lost_wall.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Of a point: whether the link to the next one along axis a is crossed, bit a, nearer to that one,
 * bit 4 + a; whether it is inside; whether it was filled. */
enum { WALL_POINT = 8, NEARER_NEXT = 16, FILLED = 128 };

enum status lost_wall_begin(const struct scene *scene, const double extent[6], int along,
                            struct lost_wall *wall) {
  size_t count = 1;
  *wall = (struct lost_wall){.scene = scene, .size = {1, 1, 1}};
  for (int a = 0; a < 3; a++) {
    if (a == along) continue;
    const double low = floor(extent[a] / scene->spacing);
    const double points = floor(extent[a + 3] / scene->spacing) - low + 3.0;
    if (!(fabs(low) < 1e9 && points < 1e9) || !size_multiply(count, (size_t)points, &count))
      return FAIL(STATUS_INPUT, "a wall is %g points long in %c, which is too many", points,
                  'x' + a);
    wall->first[a] = (long)low - 1;
    wall->size[a] = (size_t)points;
  }
  return memory_allocate(&wall->bits, count, 1, "the points around a wall");
}

static uint8_t *point(const struct lost_wall *w, const long at[3]) {
  size_t index = 0;
  for (int a = 2; a >= 0; a--) {
    const long i = at[a] - w->first[a];
    if (i < 0 || i >= (long)w->size[a]) return NULL;
    index = index * w->size[a] + (size_t)i;
  }
  return &w->bits[index];
}

void lost_wall_add(struct lost_wall *w, int axis, const long at[3], double from, double to) {
  const double dx = w->scene->spacing, near = 1e-9;
  const double begin = from / dx - 0.5 - near, end = to / dx - 0.5 + near;
  long to_mark[3] = {at[0], at[1], at[2]};
  const long inside = (long)ceil(begin), last = (long)floor(end);
  for (long i = inside; i <= last; i++) {
    to_mark[axis] = i;
    uint8_t *p = point(w, to_mark);
    if (p != NULL) *p |= WALL_POINT;
  }
  to_mark[axis] = last;
  uint8_t *p = last < inside ? point(w, to_mark) : NULL;
  if (p == NULL) return;
  *p |= (uint8_t)(1U << axis);
  if (begin + end > 2.0 * (double)last + 1.0) *p |= (uint8_t)(NEARER_NEXT << axis);
}

/* Whether a point is in the domain, and no wall. */
static bool is_open(const struct lost_wall *w, const long at[3]) {
  const uint8_t *p = point(w, at);
  for (int a = 0; a < 3; a++)
    if (w->size[a] > 1 &&
        (at[a] < 0 || ((double)at[a] + 0.5) * w->scene->spacing > w->scene->domain_size[a]))
      return false;
  return p == NULL || (*p & (WALL_POINT | FILLED)) == 0;
}

static bool is_crossed(const struct lost_wall *w, const long at[3], int axis) {
  const uint8_t *p = point(w, at);
  return p != NULL && (*p >> axis & 1) != 0;
}

static bool is_inside(const struct lost_wall *w, const long at[3]) {
  const uint8_t *p = point(w, at);
  return p != NULL && (*p & WALL_POINT) != 0;
}

/* Whether the link from `at` to the next point along an axis only clips a thick body: three links
 * lead around on one side of it, and on the other side there are points inside. */
static bool is_clipped(const struct lost_wall *w, const long at[3], int axis) {
  long next[3] = {at[0], at[1], at[2]};
  next[axis]++;
  for (int b = 0; b < 3; b++)
    for (int side = -1; side <= 1; side += 2) {
      if (b == axis || w->size[b] == 1) continue;
      long one[3] = {at[0], at[1], at[2]}, other[3] = {next[0], next[1], next[2]};
      one[b] -= side, other[b] -= side;
      if (!is_inside(w, one) && !is_inside(w, other)) continue;
      one[b] += 2 * side, other[b] += 2 * side;
      if (is_open(w, one) && is_open(w, other) && !is_crossed(w, one, axis) &&
          !is_crossed(w, side < 0 ? one : at, b) && !is_crossed(w, side < 0 ? other : next, b))
        return true;
    }
  return false;
}

/* Makes a point wall; `from`: first of the parts that were added here. */
static enum status add_point(struct lost_wall *w, const struct region *whole, const long at[3],
                             size_t from, struct scene_parts *parts) {
  const double dx = w->scene->spacing;
  double box[6];
  memcpy(box, whole->box, sizeof box);
  *point(w, at) |= FILLED;
  for (int a = 0; a < 3; a++)
    if (w->size[a] > 1) box[a] = (double)at[a] * dx, box[a + 3] = ((double)at[a] + 1.0) * dx;
  if (parts->count > from) { /* the next one of a row */
    double *last = parts->region[parts->count - 1].box;
    bool same = fabs(last[3] - box[0]) < 1e-6 * dx;
    for (int a = 1; a < 3; a++) same = same && fabs(last[a] - box[a]) < 1e-6 * dx;
    if (same) {
      last[3] = box[3];
      return STATUS_OK;
    }
  }
  return scene_parts_add(parts, whole, box);
}

enum status lost_wall_fill(struct lost_wall *w, const struct region *whole,
                           struct scene_parts *parts) {
  const size_t from = parts->count;
  for (size_t k = 0; k < w->size[2]; k++)
    for (size_t j = 0; j < w->size[1]; j++)
      for (size_t i = 0; i < w->size[0]; i++) {
        const long at[3] = {(long)i + w->first[0], (long)j + w->first[1], (long)k + w->first[2]};
        for (int a = 0; a < 3; a++) {
          long next[3] = {at[0], at[1], at[2]};
          next[a]++;
          if (!is_crossed(w, at, a) || !is_open(w, at) || !is_open(w, next) || is_clipped(w, at, a))
            continue;
          const bool is_next = (*point(w, at) & NEARER_NEXT << a) != 0;
          const enum status status = add_point(w, whole, is_next ? next : at, from, parts);
          if (status != STATUS_OK) return status;
        }
      }
  return STATUS_OK;
}
