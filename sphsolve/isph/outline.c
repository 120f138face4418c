#include "sphsolve/isph/outline.h"

#include <math.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/mobility.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/vector.h"

bool isph_may_have_outline(const struct scene *scene, const struct region *region) {
  return region->type == REGION_WALL && scene->regions[region->first].polygon != NULL;
}

bool isph_has_outline(const struct isph *s, const struct region *region) {
  return s->on.outlines && isph_may_have_outline(s->scene, region);
}

/* Whether both ends of an edge lie on a side of the domain. */
static bool is_on_side(const struct isph *s, const struct polygon *p, const double a[2],
                       const double b[2]) {
  const double near = 1e-6 * s->spacing;
  bool on = false;
  for (int c = 0; c < 2; c++)
    on = on || fmax(a[c], b[c]) < s->low[p->plane[c]] + near ||
         fmin(a[c], b[c]) > s->high[p->plane[c]] - near;
  return on;
}

/* Distance to a polygon in its plane, negative inside, and the normal there. */
static double to_polygon(const struct isph *s, const struct polygon *p, const double at[2],
                         double normal[2]) {
  double nearest = INFINITY, area = 0, out[2] = {0}, turned[2] = {0};
  bool inside = false;
  for (size_t i = 0; i < p->count; i++) {
    const double *a = p->corner[i], *b = p->corner[(i + 1) % p->count];
    const double along[2] = {b[0] - a[0], b[1] - a[1]}, to[2] = {at[0] - a[0], at[1] - a[1]};
    const double square = along[0] * along[0] + along[1] * along[1];
    const double part = square > 0 ? (to[0] * along[0] + to[1] * along[1]) / square : 0;
    const double off[2] = {to[0] - fmin(1, fmax(0, part)) * along[0],
                           to[1] - fmin(1, fmax(0, part)) * along[1]};
    const double gap = off[0] * off[0] + off[1] * off[1];
    area += a[0] * b[1] - a[1] * b[0];
    if ((a[1] > at[1]) != (b[1] > at[1]) && at[0] < a[0] + along[0] * (at[1] - a[1]) / along[1])
      inside = !inside;
    if (!(gap < nearest) || !(square > 0) || is_on_side(s, p, a, b)) continue;
    nearest = gap;
    for (int c = 0; c < 2; c++) out[c] = off[c] / fmax(sqrt(gap), 1e-300);
    turned[0] = along[1] / sqrt(square), turned[1] = -along[0] / sqrt(square);
  }
  const double least = sqrt(nearest);
  const bool touches = least < 1e-9 * s->spacing;
  for (int c = 0; c < 2; c++)
    normal[c] = touches ? copysign(1, area) * turned[c] : inside ? -out[c] : out[c];
  return inside ? -least : least;
}

/* The same for the prism over it; an end on a side of the domain does not count. */
static double to_prism(const struct isph *s, const struct isph_wall_box *box, const double x[3],
                       double normal[3]) {
  const struct polygon *p = box->outline;
  const double *extent = box->region->extent, slack = 1e-6 * s->spacing;
  const int u = p->plane[0], v = p->plane[1], w = p->axis;
  const double at[2] = {x[u] - (box->low[u] - extent[u]), x[v] - (box->low[v] - extent[v])};
  double in_plane[2], beside = to_polygon(s, p, at, in_plane), beyond = -INFINITY;
  double direction = 0;
  if (box->low[w] > s->low[w] + slack) beyond = box->low[w] - x[w], direction = -1;
  if (box->high[w] < s->high[w] - slack && x[w] - box->high[w] > beyond)
    beyond = x[w] - box->high[w], direction = 1;
  const bool corner = beside > 0 && beyond > 0;
  const double distance = corner ? hypot(beside, beyond) : fmax(beside, beyond);
  const double across = corner ? beside / distance : beside >= beyond;
  normal[u] = across * in_plane[0], normal[v] = across * in_plane[1];
  normal[w] = direction * (corner ? beyond / distance : beside < beyond);
  return distance;
}

double isph_outline_distance(const struct isph *s, const struct isph_wall_box *box,
                             const double x[3], double normal[3]) {
  double least = INFINITY, own[3];
  for (int n = 0; n < 27; n++) {
    const int step[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
    double at[3];
    bool near = true;
    for (int a = 0; a < 3 && near; a++) {
      at[a] = x[a] + step[a] * (s->high[a] - s->low[a]);
      near = (step[a] == 0 || s->periodic[a]) &&
             (!isph_uses_axis(s, a) ||
              (at[a] > box->low[a] - s->support_max && at[a] < box->high[a] + s->support_max));
    }
    const double distance = near ? to_prism(s, box, at, own) : INFINITY;
    if (!(distance < least)) continue;
    least = distance;
    for (int a = 0; a < 3; a++) normal[a] = own[a];
  }
  return least;
}

struct isph_facing isph_outline_facing(const struct isph *s, const double x[3]) {
  struct isph_facing facing = {.distance = s->support_max};
  double normal[3];
  for (size_t b = 1; b < s->wall_box_count; b++) {
    if (s->wall_boxes[b].outline == NULL) continue;
    const double distance = isph_outline_distance(s, &s->wall_boxes[b], x, normal);
    if (distance < facing.distance)
      facing = (struct isph_facing){(int32_t)b, distance, {normal[0], normal[1], normal[2]}};
  }
  return facing;
}

void isph_outline_place(const struct isph *s, const double centre[3], int n, double x[3]) {
  const int each = isph_outline_places(s);
  for (int a = 0; a < 3; a++) {
    x[a] = centre[a];
    if (!isph_uses_axis(s, a)) continue;
    x[a] += ((n % each + 0.5) / each - 0.5) * s->spacing;
    n /= each;
  }
}

/* slope' of pair p of particle i, 0 without an image; sets r_t then. */
static double image_of(const struct isph *s, const struct isph_chunk *chunk, size_t i, size_t p,
                       double along[3]) {
  const size_t j = chunk->pair[p] & PAIR_MASK;
  const struct isph_facing *own = &s->facing[i], *other = &s->facing[j];
  double r[3], turned[3], normal[3], w, slope;
  if (own->box != other->box || !(chunk->slope[p] > 0)) return 0; /* or behind a wall */
  isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
  isph_turn(IMAGES_REFLECTED, s, chunk->pair[p], other->normal, turned);
  const double reach = 0.5 * (s->support[i] + s->support[j]);
  const double square = dot(r, r) + 4 * fmax(0, own->distance) * fmax(0, other->distance);
  if (!(square < reach * reach) || !(dot(own->normal, turned) > 0)) return 0;
  for (int a = 0; a < 3; a++) normal[a] = own->normal[a] + turned[a];
  const double across = dot(r, normal) / dot(normal, normal);
  for (int a = 0; a < 3; a++) along[a] = r[a] - across * normal[a];
  isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(square), reach, &w, &slope);
  return slope * s->kernel_slope;
}

double isph_outline_row(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                        const double f[3], double *fall, double *whole) {
  double sum = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const size_t j = chunk->pair[p] & PAIR_MASK;
    double along[3], r[3];
    const double weight = 2 * s->volume[i] * s->volume[j] * image_of(s, chunk, i, p, along);
    if (!(weight > 0)) continue;
    const double before = (double)chunk->matrix[p];
    chunk->matrix[p] = (float)(before + weight * isph_mobility_between(s, chunk, p, i, j));
    const double more = (double)chunk->matrix[p] - before; /* a row adds up to 0 exactly */
    four way;
    isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
    isph_fall_way(IMAGES_REFLECTED, s, i, chunk->pair[p], &(four){r[0], r[1], r[2]}, &way);
    sum += more, *whole += weight;
    *fall += more * FOUR_DOT(way, f);
  }
  return sum;
}

double isph_outline_divergence(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                               double (*v)[3]) {
  double sum = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const size_t j = chunk->pair[p] & PAIR_MASK;
    double along[3], vj[3];
    const double weight = s->volume[j] * image_of(s, chunk, i, p, along);
    if (!(weight > 0)) continue;
    isph_turn(IMAGES_REFLECTED, s, chunk->pair[p], v[j], vj);
    sum += weight * (dot(v[i], along) - dot(vj, along));
  }
  return sum;
}

void isph_outline_gradient(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                           const double *q, const double *across, double gradient[3],
                           double flux[3]) {
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    double along[3];
    const double weight = s->volume[j] * image_of(s, chunk, i, p, along);
    if (!(weight > 0)) continue;
    const double fall = weight * (q[i] - q[j] - across[entry >> PAIR_BITS]);
    const double ratio = isph_mobility_between(s, chunk, p, i, j) / s->mobility[i];
    for (int a = 0; a < 3; a++) gradient[a] += fall * along[a], flux[a] += ratio * fall * along[a];
  }
}
