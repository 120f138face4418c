#include "sphsolve/isph/wall.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/isph/constants.h"

/* Walls are exact boxes. Each is filled with wall particles that start half a spacing behind its
 * faces, whether or not the faces lie on the lattice of the water; the tank is filled outside the
 * domain, except behind reflecting sides (isph/reflection.h). A wall particle has no unknowns: it
 * is the mirror image of whichever water particle has it as a neighbour, about the face between
 * them. */

enum status isph_wall_fill_tank(struct isph *s, size_t *capacity) {
  int n[3], from[3], to[3];
  double pitch[3];
  for (int a = 0; a < 3; a++) {
    n[a] = (int)fmax(1, round((s->high[a] - s->low[a]) / s->spacing));
    pitch[a] = (s->high[a] - s->low[a]) / n[a];
    const int layers = s->periodic[a] || !isph_uses_axis(s, a) ? 0 : isph_boundary_layers(s);
    from[a] = s->reflects[a][0] ? 0 : -layers;
    to[a] = n[a] + (s->reflects[a][1] ? 0 : layers);
  }
  for (int k = from[2]; k < to[2]; k++)
    for (int j = from[1]; j < to[1]; j++)
      for (int i = from[0]; i < to[0]; i++) {
        int at[3] = {i, j, k};
        bool outside = false;
        double x[3];
        for (int a = 0; a < 3; a++) {
          x[a] = s->low[a] + (at[a] + 0.5) * pitch[a];
          outside = outside || at[a] < 0 || at[a] >= n[a];
        }
        if (!outside || isph_window_behind(s, x) >= 0) continue;
        enum status status = isph_boundary_add(s, capacity, x, BOUNDARY_WALL, 0, s->wall_volume);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

static bool in_box(const struct isph *s, const struct isph_wall_box *box, const double x[3]) {
  double normal[3];
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a) && (x[a] <= box->low[a] || x[a] >= box->high[a])) return false;
  return box->outline == NULL || isph_outline_distance(s, box, x, normal) < 0;
}

bool isph_wall_holds(const struct isph *s, const double x[3]) {
  bool any = false;
  for (size_t b = 1; b < s->wall_box_count; b++) any = any || in_box(s, &s->wall_boxes[b], x);
  return any;
}

/* Fills the cells of the lattice by the share of the wall in them. */
static enum status fill_outline(struct isph *s, size_t index, size_t *capacity) {
  const struct isph_wall_box *box = &s->wall_boxes[index];
  int from[3] = {0}, to[3] = {1, 1, 1};
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a)) {
      from[a] = (int)floor(box->low[a] / s->spacing);
      to[a] = (int)ceil(box->high[a] / s->spacing);
    }
  for (int k = from[2]; k < to[2]; k++)
    for (int j = from[1]; j < to[1]; j++)
      for (int i = from[0]; i < to[0]; i++) {
        const double centre[3] = {(i + 0.5) * s->spacing, (j + 0.5) * s->spacing,
                                  (k + 0.5) * s->spacing};
        double x[3], middle[3] = {0}, inside = 0;
        for (int n = 0; n < OUTLINE_PLACES; n++) {
          isph_outline_place(s, centre, n, x);
          bool taken = !in_box(s, box, x);
          for (size_t later = index + 1; later < s->wall_box_count; later++)
            taken = taken || in_box(s, &s->wall_boxes[later], x);
          if (taken) continue;
          inside++;
          for (int a = 0; a < 3; a++) middle[a] += x[a];
        }
        if (inside == 0) continue;
        for (int a = 0; a < 3; a++) middle[a] /= inside;
        enum status status = isph_boundary_add(s, capacity, middle, BOUNDARY_WALL, index,
                                               s->wall_volume * inside / OUTLINE_PLACES);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

enum status isph_wall_fill_box(struct isph *s, size_t index, size_t *capacity) {
  const struct isph_wall_box *box = &s->wall_boxes[index];
  if (box->outline != NULL) return fill_outline(s, index, capacity);
  int n[3];
  double pitch[3], volume = 1;
  for (int a = 0; a < 3; a++) {
    n[a] =
        isph_uses_axis(s, a) ? (int)fmax(1, round((box->high[a] - box->low[a]) / s->spacing)) : 1;
    pitch[a] = (box->high[a] - box->low[a]) / n[a];
    if (isph_uses_axis(s, a)) volume *= pitch[a];
  }
  for (int k = 0; k < n[2]; k++)
    for (int j = 0; j < n[1]; j++)
      for (int i = 0; i < n[0]; i++) {
        double x[3] = {box->low[0] + (i + 0.5) * pitch[0], box->low[1] + (j + 0.5) * pitch[1],
                       box->low[2] + (k + 0.5) * pitch[2]};
        bool taken = false;
        for (int a = 0; a < 3; a++)
          if (isph_uses_axis(s, a) && !s->periodic[a])
            taken = taken || x[a] < s->low[a] || x[a] > s->high[a];
        for (size_t later = index + 1; later < s->wall_box_count; later++)
          taken = taken || in_box(s, &s->wall_boxes[later], x);
        if (taken) continue;
        enum status status = isph_boundary_add(s, capacity, x, BOUNDARY_WALL, index, volume);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

/* Removes from the mirror the faces that a box of a polygon shares entirely with another box, since
 * no water faces them. */
static void join_parts(struct isph *s, struct isph_wall_box *box) {
  const struct region *own = box->region, *regions = s->scene->regions;
  const double near = 1e-6 * s->spacing;
  memcpy(box->mirror_low, box->low, sizeof box->low);
  memcpy(box->mirror_high, box->high, sizeof box->high);
  for (size_t j = own->first; own->is_part && j < own->end; j++)
    for (int e = 0; e < 6; e++) {
      bool covers = fabs(own->box[e] - regions[j].box[(e + 3) % 6]) < near;
      for (int a = 0; a < 3; a++)
        if (a != e % 3)
          covers = covers && regions[j].box[a] < own->box[a] + near &&
                   regions[j].box[a + 3] > own->box[a + 3] - near;
      if (covers && e < 3) box->mirror_low[e] = -INFINITY;
      if (covers && e >= 3) box->mirror_high[e - 3] = INFINITY;
    }
}

enum status isph_wall_find(struct isph *s) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  TRY(memory_allocate(&s->wall_boxes, 1 + scene->region_count, sizeof *s->wall_boxes, "walls"));
  struct isph_wall_box *tank = &s->wall_boxes[s->wall_box_count++];
  tank->tank = true;
  tank->slip = scene->isph.slip;
  memcpy(tank->low, s->low, sizeof tank->low);
  memcpy(tank->high, s->high, sizeof tank->high);
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    const bool outline = isph_has_outline(s, region);
    if (region->type != REGION_WALL || (outline && k != region->first)) continue;
    struct isph_wall_box *box = &s->wall_boxes[s->wall_box_count++];
    box->slip = region->slip;
    for (int a = 0; a < 3; a++) {
      const double *corners = outline ? region->extent : region->box;
      box->low[a] = isph_uses_axis(s, a) ? corners[a] : s->low[a];
      box->high[a] = isph_uses_axis(s, a) ? corners[a + 3] : s->high[a];
      box->velocity[a] = region->velocity[a];
    }
    box->region = region;
    if (outline) box->outline = region->polygon;
    join_parts(s, box);
  }
  s->wall_volume = pow(s->spacing, s->dimensions);
cleanup:
  return status;
}

bool isph_wall_is_inside(const struct isph *s, const struct isph_wall_box *box) {
  for (int a = 0; a < 3; a++)
    if (box->low[a] > s->high[a] || box->high[a] < s->low[a]) return false;
  return true;
}

void isph_wall_move(struct isph *s, double dt) {
  for (size_t b = 1; b < s->wall_box_count; b++)
    for (int a = 0; a < 3; a++) {
      s->wall_boxes[b].low[a] += s->wall_boxes[b].velocity[a] * dt;
      s->wall_boxes[b].high[a] += s->wall_boxes[b].velocity[a] * dt;
      s->wall_boxes[b].mirror_low[a] += s->wall_boxes[b].velocity[a] * dt;
      s->wall_boxes[b].mirror_high[a] += s->wall_boxes[b].velocity[a] * dt;
    }
  for (size_t j = 0; j < s->boundary_count; j++) {
    size_t box = s->boundary_box[j];
    if (s->boundary_kind[j] == BOUNDARY_WALL) {
      for (int a = 0; a < 3; a++) s->boundary_position[j][a] += s->wall_boxes[box].velocity[a] * dt;
    } else if (s->boundary_kind[j] == BOUNDARY_OPEN_HEAD) {
      const struct isph_open_side *side = &s->sides[box];
      double z = side->axis == 2 ? side->edge : s->boundary_position[j][2];
      s->boundary_pressure[j] = isph_window_pressure(s, side, z); /* that on the side itself */
    }
  }
}

/* Whether the tank has a window along axis a where boundary particle j at xj continues a wall:
 * behind the corner between a window and a wall only the wall is continued. */
static bool window_beside(const struct isph *s, const double xj[3], int a) {
  double x[3];
  bool corner = false;
  memcpy(x, xj, sizeof x);
  for (int b = 0; b < 3; b++) {
    if (b == a || s->periodic[b] || !isph_uses_axis(s, b)) continue;
    const double inside = fmin(0.5 * s->spacing, 0.5 * (s->high[b] - s->low[b]));
    corner = corner || x[b] < s->low[b] || x[b] > s->high[b];
    x[b] = fmin(fmax(x[b], s->low[b] + inside), s->high[b] - inside);
  }
  return corner && isph_window_behind(s, x) >= 0;
}

/* isph_wall_mirror of a wall with an outline. */
static void mirror_outline(const struct isph *s, size_t i, size_t j, const double xj[3],
                           double mirror[6], double *ratio) {
  const double *xi = s->position[i];
  const size_t box = s->boundary_box[j];
  struct isph_facing facing = s->facing[i];
  double depth = 0;
  if ((size_t)facing.box != box)
    facing.distance = isph_outline_distance(s, &s->wall_boxes[box], xi, facing.normal);
  for (int a = 0, k = 0; a < 3; a++) {
    depth += (xi[a] - xj[a]) * facing.normal[a];
    for (int b = a; b < 3; b++, k++) mirror[k] = facing.normal[a] * facing.normal[b];
  }
  if (ratio != NULL)
    *ratio = fmax(0, depth - facing.distance) / fmax(facing.distance, WALL_NEAREST * s->spacing);
}

/* Radius, in spacings, by which edges of boxes are rounded for the mirror in soil. */
#define EDGE 0.5

/* A box that water flows around is convex: the mirror is the plane through the box's nearest point,
 * at an edge or a corner too. With one mirror for each face in sight instead, the effect of a
 * particle's image would jump where the particle passes the end of a face. A particle that slides
 * along a face at the guard's distance still passes an edge in a few steps, in which its mirror
 * turns by a right angle, and the pressures beside it by 2 %: in soil the box has rounded edges for
 * the mirror, which then begins to turn earlier. */
void isph_wall_mirror(const struct isph *s, size_t i, size_t j, const double xj[3],
                      double mirror[6], double *ratio) {
  double near = 0, far = 0, turned = 0, normal[3] = {0};
  const double *xi = s->position[i];
  const double edge = s->on.soil ? EDGE * s->spacing : 0;
  memset(mirror, 0, 6 * sizeof *mirror);
  if (s->boundary_kind[j] != BOUNDARY_WALL) {
    mirror[symmetric_diagonal[s->sides[s->boundary_box[j]].axis]] = 1;
    if (ratio != NULL) *ratio = 1;
    return;
  }
  const struct isph_wall_box *box = &s->wall_boxes[s->boundary_box[j]];
  if (box->outline != NULL) {
    mirror_outline(s, i, j, xj, mirror, ratio);
    return;
  }
  for (int a = 0; a < 3; a++) {
    if (!isph_uses_axis(s, a)) continue;
    double out = 0, j_distance = 0;
    if (box->tank) {
      if (s->periodic[a]) continue;
      if (xj[a] < box->low[a])
        out = xi[a] - box->low[a], j_distance = box->low[a] - xj[a];
      else if (xj[a] > box->high[a])
        out = box->high[a] - xi[a], j_distance = xj[a] - box->high[a];
      else
        continue;
      if (s->on.open_sides && window_beside(s, xj, a)) continue;
      mirror[symmetric_diagonal[a]] = 1;
    } else {
      const double low = box->mirror_low[a], high = box->mirror_high[a];
      if (xi[a] < low)
        out = xi[a] - low, j_distance = xj[a] - low;
      else if (xi[a] > high)
        out = xi[a] - high, j_distance = high - xj[a];
      const double round = fmin(edge, 0.5 * (high - low));
      normal[a] = xi[a] - fmin(fmax(xi[a], low + round), high - round);
      turned += normal[a] * normal[a];
    }
    near += out * out, far += j_distance * j_distance;
  }
  for (int a = 0, k = 0; a < 3 && !box->tank && near > 0; a++)
    for (int b = a; b < 3; b++, k++) mirror[k] = normal[a] * normal[b] / turned;
  if (ratio != NULL) *ratio = sqrt(far) / fmax(sqrt(near), WALL_NEAREST * s->spacing);
}

static void guard_plane(double distance, double dt, double gap, double sign, double wall_velocity,
                        double scale, double *velocity) {
  /* Speed towards the wall (pore velocity: scale * v_D) that would use up half of the remaining
   * distance. */
  double allowed = fmax(0, distance - gap) * 0.5 / dt;
  double towards = -sign * (*velocity * scale - wall_velocity);
  if (towards > allowed) *velocity = (wall_velocity - sign * allowed) / scale;
}

/* The same at an outline. */
static void guard_outline(const struct isph *s, const struct isph_wall_box *box, const double x[3],
                          double dt, double scale, double v[3]) {
  double normal[3], along = 0, wall = 0;
  const double distance = isph_outline_distance(s, box, x, normal);
  if (!(distance < s->spacing)) return;
  for (int a = 0; a < 3; a++) along += v[a] * normal[a], wall += box->velocity[a] * normal[a];
  double held = along;
  guard_plane(distance, dt, WALL_GUARD * s->spacing, 1, wall, scale, &held);
  for (int a = 0; a < 3; a++) v[a] += (held - along) * normal[a];
}

void isph_wall_guard(const struct isph *s, const double x[3], double scale, double dt,
                     double v[3]) {
  double gap = WALL_GUARD * s->spacing, reach = s->spacing;
  for (int a = 0; a < 3; a++) {
    if (s->periodic[a] || !isph_uses_axis(s, a)) continue;
    double below = x[a] - s->low[a], above = s->high[a] - x[a];
    double outside[3] = {x[0], x[1], x[2]};
    if (below < reach) {
      outside[a] = s->low[a] - reach;
      if (isph_window_behind(s, outside) < 0) guard_plane(below, dt, gap, 1, 0, scale, &v[a]);
    }
    if (above < reach) {
      outside[a] = s->high[a] + reach;
      if (isph_window_behind(s, outside) < 0) guard_plane(above, dt, gap, -1, 0, scale, &v[a]);
    }
  }
  for (size_t b = 1; b < s->wall_box_count; b++) {
    const struct isph_wall_box *box = &s->wall_boxes[b];
    int face = -1;
    double most = -INFINITY, sign = 0;
    bool near = true;
    if (box->outline != NULL) {
      guard_outline(s, box, x, dt, scale, v);
      continue;
    }
    for (int a = 0; a < 3; a++) {
      if (!isph_uses_axis(s, a)) continue;
      double low = box->low[a] - x[a], high = x[a] - box->high[a];
      double out = fmax(low, high);
      near = near && out < reach;
      if (out > most) most = out, face = a, sign = low > high ? -1 : 1;
    }
    /* Only the face in front of the particle counts: past an edge it is free to move. */
    if (near && face >= 0) guard_plane(most, dt, gap, sign, box->velocity[face], scale, &v[face]);
  }
}
