/* Particles that a wall hides from each other exchange nothing: neither pressure nor momentum
 * passes through a wall that is thinner than their support, or where two walls touch. They still
 * count as what fills each other's neighbourhood, as the wall's own particles would if it were
 * thicker. */
#include "sphsolve/isph/sight.h"

#include <math.h>

#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/vector.h"

#define SLACK 1e-6 /* spacings */

/* The image of a box that has moved. */
static struct isph_box image_of(const struct isph *s, const struct isph_image *image,
                                const double from[6], const double moved[3]) {
  const double slack = SLACK * s->spacing;
  struct isph_box box;
  for (int a = 0; a < 3; a++) {
    const double p = image->turn[a] * (from[a] + moved[a]) + image->shift[a];
    const double q = image->turn[a] * (from[a + 3] + moved[a]) + image->shift[a];
    const bool used = isph_uses_axis(s, a);
    box.low[a] = used ? fmin(p, q) - slack : -INFINITY;
    box.high[a] = used ? fmax(p, q) + slack : INFINITY;
  }
  return box;
}

/* Whether that image is farther than `reach` from the box low..high. */
static bool is_far(const struct isph *s, const struct isph_image *image, const double box[6],
                   const double moved[3], const double low[3], const double high[3], double reach) {
  const double near = reach + 2 * SLACK * s->spacing;
  for (int a = 0; a < 3; a++) {
    const double p = image->turn[a] * (box[a] + moved[a]) + image->shift[a];
    const double q = image->turn[a] * (box[a + 3] + moved[a]) + image->shift[a];
    if (isph_uses_axis(s, a) &&
        ((p > high[a] + near && q > high[a] + near) || (p < low[a] - near && q < low[a] - near)))
      return true;
  }
  return false;
}

/* Corners of a wall's box in the scene, from which it may have moved. */
static const double *scene_box(const struct isph_wall_box *wall) {
  return wall->outline != NULL ? wall->region->extent : wall->region->box;
}

bool isph_screens_find(const struct isph *s, const double low[3], const double high[3],
                       double reach, struct isph_screens *screens) {
  int from[3], to[3];
  screens->count = 0;
  for (int a = 0; a < 3; a++) {
    const bool below = s->periodic[a] || s->reflects[a][0];
    const bool above = s->periodic[a] || s->reflects[a][1];
    from[a] = below && low[a] - reach < s->low[a] ? -1 : 0;
    to[a] = above && high[a] + reach > s->high[a] ? 1 : 0;
  }
  for (int z = from[2]; z <= to[2]; z++)
    for (int y = from[1]; y <= to[1]; y++)
      for (int x = from[0]; x <= to[0]; x++) {
        const struct isph_image *image = &s->image[(x + 1) + 3 * (y + 1) + 9 * (z + 1)];
        for (size_t b = 1; b < s->wall_box_count; b++) {
          const struct isph_wall_box *wall = &s->wall_boxes[b];
          const struct region *region = wall->region;
          const double *own = scene_box(wall);
          double moved[3];
          for (int a = 0; a < 3; a++) moved[a] = wall->low[a] - own[a];
          const bool begins = wall->outline == NULL && region->end > region->first + 1 &&
                              region == &s->scene->regions[region->first];
          if (begins && is_far(s, image, region->extent, moved, low, high, reach)) {
            b += region->end - region->first - 1;
            continue;
          }
          if (is_far(s, image, own, moved, low, high, reach)) continue;
          if (screens->count == SCREENS_MOST) return false;
          screens->of[screens->count++] =
              (struct isph_screen){image_of(s, image, own, moved), wall, image};
        }
      }
  return true;
}

/* Whether the part from <= t <= to of the path x + t step crosses an edge of a polygon. */
static bool crosses(const struct polygon *p, const double x[2], const double step[2], double from,
                    double to) {
  for (size_t k = 0; k < p->count; k++) {
    const double *a = p->corner[k], *b = p->corner[(k + 1) % p->count];
    const double along[2] = {b[0] - a[0], b[1] - a[1]}, away[2] = {a[0] - x[0], a[1] - x[1]};
    const double across = step[0] * along[1] - step[1] * along[0];
    const double t = (away[0] * along[1] - away[1] * along[0]) / across;
    const double u = (away[0] * step[1] - away[1] * step[0]) / across;
    if (across != 0 && t >= from && t <= to && u >= 0 && u <= 1) return true;
  }
  return false;
}

static bool is_in(const struct isph_box *box, const double x[3]) {
  for (int a = 0; a < 3; a++)
    if (x[a] < box->low[a] || x[a] > box->high[a]) return false;
  return true;
}

/* The place of x, or if a box holds it, the nearest on its faces. */
static void out_of(const struct isph_box *box, const double x[3], double place[3]) {
  double least = INFINITY;
  int axis = 0;
  for (int a = 0; a < 3; a++) {
    const double off = fmin(x[a] - box->low[a], box->high[a] - x[a]);
    place[a] = x[a];
    if (off < least) least = off, axis = a;
  }
  const double low = box->low[axis], high = box->high[axis], x_axis = x[axis];
  if (is_in(box, x))
    place[axis] =
        x_axis - low < high - x_axis ? nextafter(low, -INFINITY) : nextafter(high, INFINITY);
}

/* x in the plane of the polygon of a screen. */
static void in_plane(const struct isph_screen *screen, const double x[3], double at[2]) {
  const struct isph_wall_box *wall = screen->wall;
  for (int c = 0; c < 2; c++) {
    const int a = wall->outline->plane[c];
    at[c] = screen->image->turn[a] * (x[a] - screen->image->shift[a]) -
            (wall->low[a] - scene_box(wall)[a]);
  }
}

/* Whether a wall is between x and y; sets `middle` to that of the part of the line in its box. A
 * point in a box counts as at its nearest face. */
static bool is_between(const struct isph_screen *screen, const double x[3], const double y[3],
                       double middle[3]) {
  const struct isph_box *box = &screen->box;
  double step[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, begin[3] = {x[0], x[1], x[2]};
  double from = 0, to = 1, at[2], along[2];
  if (!isph_box_clip(box, x, step, &from, &to)) return false;
  if (screen->wall->outline == NULL && (is_in(box, x) || is_in(box, y))) {
    double end[3];
    out_of(box, x, begin), out_of(box, y, end);
    for (int a = 0; a < 3; a++) step[a] = end[a] - begin[a];
    from = 0, to = 1;
    if (!isph_box_clip(box, begin, step, &from, &to)) return false;
  }
  for (int a = 0; a < 3; a++) middle[a] = begin[a] + 0.5 * (from + to) * step[a];
  if (screen->wall->outline == NULL) return true;
  in_plane(screen, x, at), in_plane(screen, y, along);
  for (int c = 0; c < 2; c++) along[c] -= at[c];
  return crosses(screen->wall->outline, at, along, from, to);
}

/* Moves x to the nearest edge of a box, off its two faces by `gap`. */
static void to_edge(const struct isph *s, const struct isph_box *box, double gap, double x[3]) {
  double out[3], near = INFINITY, next = INFINITY;
  for (int a = 0; a < 3; a++) {
    const double low = x[a] - box->low[a], high = box->high[a] - x[a], off = fmin(low, high);
    out[a] = low < high ? -low - gap : high + gap;
    if (!isph_uses_axis(s, a)) continue;
    next = fmin(next, fmax(near, off)), near = fmin(near, off);
  }
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a) && fabs(out[a]) <= next + gap) x[a] += out[a];
}

/* Moves x to the nearest corner of an outline, off its two edges by about `gap`. */
static void to_corner(const struct isph_screen *screen, double gap, double x[3]) {
  const struct polygon *p = screen->wall->outline;
  double at[2], least = INFINITY, area = 0, out[2] = {0};
  size_t nearest = 0;
  in_plane(screen, x, at);
  for (size_t k = 0; k < p->count; k++) {
    const double *a = p->corner[k], *b = p->corner[(k + 1) % p->count];
    const double off = hypot(a[0] - at[0], a[1] - at[1]);
    area += a[0] * b[1] - a[1] * b[0];
    if (off < least) least = off, nearest = k;
  }
  const double *corner = p->corner[nearest];
  for (size_t k = 0; k < 2; k++) {
    const double *a = p->corner[(nearest + p->count - k) % p->count];
    const double *b = p->corner[(nearest + p->count - k + 1) % p->count];
    const double length = copysign(hypot(b[0] - a[0], b[1] - a[1]), area);
    if (length != 0) out[0] += (b[1] - a[1]) / length, out[1] -= (b[0] - a[0]) / length;
  }
  for (int c = 0; c < 2; c++)
    x[p->plane[c]] += screen->image->turn[p->plane[c]] * (corner[c] + gap * out[c] - at[c]);
}

/* Whether the straight lines from x to y and on to z meet no wall, and are shorter than `reach`. */
static bool leads(const struct isph_screens *screens, const double x[3], const double y[3],
                  const double z[3], double reach) {
  double to[3], on[3], unused[3];
  for (int a = 0; a < 3; a++) to[a] = y[a] - x[a], on[a] = z[a] - y[a];
  if (!(sqrt(dot(to, to)) + sqrt(dot(on, on)) < reach)) return false;
  for (size_t n = 0; n < screens->count; n++) {
    const struct isph_screen *screen = &screens->of[n];
    if ((screen->wall->outline == NULL && is_in(&screen->box, y)) ||
        is_between(screen, x, y, unused) || is_between(screen, y, z, unused))
      return false;
  }
  return true;
}

/* Whether x comes before y in the order of their coordinates. */
static bool precedes(const double x[3], const double y[3]) {
  int first = 0;
  while (first < 2 && x[first] == y[first]) first++;
  return x[first] < y[first];
}

bool isph_is_hidden(const struct isph *s, const struct isph_screens *screens, const double x[3],
                    const double y[3], double reach, double clear) {
  const double *from = precedes(y, x) ? y : x, *to = precedes(y, x) ? x : y;
  const double step[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
  const bool passes = dot(step, step) < clear * clear; /* outlines */
  const double gap = 0.5 * WALL_GUARD * s->spacing;
  bool any = false;
  for (size_t n = 0; n < screens->count; n++) {
    const struct isph_screen *screen = &screens->of[n];
    double around[3];
    if (screen->wall->outline != NULL && passes) continue;
    if (!is_between(screen, from, to, around)) continue;
    if (screen->wall->outline != NULL)
      to_corner(screen, gap, around);
    else
      to_edge(s, &screen->box, gap, around);
    if (leads(screens, from, around, to, reach)) return false;
    any = true;
  }
  return any;
}

/* Across sides, the pair is looked at from the particle that precedes the other. */
bool isph_pair_is_hidden(const struct isph *s, const struct isph_screens *screens, size_t i,
                         uint32_t entry, double reach, double clear) {
  const uint32_t code = entry >> PAIR_BITS, digit[3] = {code % 3, code / 3 % 3, code / 9};
  const double *x = s->position[i], *y = s->position[entry & PAIR_MASK];
  const bool back = code != IMAGE_NONE && precedes(y, x);
  struct isph_screens there;
  uint32_t seen = 0, scale = 1; /* code of the image of the other particle */
  double image[3];
  for (int a = 0; a < 3; a++, scale *= 3)
    seen += scale * (back && s->image[code].turn[a] > 0 ? 2 - digit[a] : digit[a]);
  const double *from = back ? y : x, *to = back ? x : y;
  for (int a = 0; a < 3; a++) image[a] = to[a] * s->image[seen].turn[a] + s->image[seen].shift[a];
  if (back && !isph_screens_find(s, from, from, reach, &there)) return false;
  return isph_is_hidden(s, back ? &there : screens, from, image, reach, clear);
}
