#include "sphsolve/isph/isph_state.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"

/* Windows in the sides of the domain. Behind a window stand boundary particles: with a fixed head
 * they carry the hydrostatic pressure of that head, with a fixed flux they are a wall that moves
 * through the side without leaving its place. Water that crosses the window leaves the run; where
 * it draws away from the window a new particle comes in as soon as there is room for it. */

static bool used(const struct isph *s, int a) {
  return !(s->dimensions == 2 && a == 1);
}

enum status isph_open_create(struct isph *s) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  TRY(memory_allocate(&s->sides, scene->region_count, sizeof *s->sides, "inflow regions"));
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    if (region->type != REGION_INFLOW) continue;
    struct isph_open_side side = {.axis = -1};
    double thinnest = INFINITY, near = 1e-6 * s->spacing;
    for (int a = 0; a < 3; a++) {
      side.low[a] = region->box[a], side.high[a] = region->box[a + 3];
      double width = side.high[a] - side.low[a];
      bool at_low = side.low[a] <= s->low[a] + near, at_high = side.high[a] >= s->high[a] - near;
      if (!used(s, a) || s->periodic[a] || at_low == at_high || width >= thinnest) continue;
      thinnest = width;
      side.axis = a;
      side.inward = at_low ? 1 : -1;
    }
    if (side.axis < 0)
      TRY_FAIL(STATUS_INPUT,
               "%s:%d: an inflow region is a thin box on one side of the domain that is not "
               "periodic; this box touches none, or two opposite ones",
               scene->path, region->line);
    side.head = region->head, side.flux = region->flux;
    side.kind = region->boundary == BOUNDARY_FLUX ? BOUNDARY_OPEN_FLUX : BOUNDARY_OPEN_HEAD;
    s->sides[s->side_count++] = side;
  }
cleanup:
  return status;
}

double isph_open_pressure(const struct isph *s, const struct isph_open_side *side, double z) {
  const double *g = s->scene->gravity;
  double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (strength == 0) return s->density * GRAVITY_STANDARD * side->head;
  return fmax(0, s->density * strength * (side->head - z));
}

/* The head stands on the side itself, half a spacing and more before the boundary particles: their
 * pressure continues the line from particle to side, so that a pair counts 1 + d_j/d_i times with
 * its difference to the side. `r`: to the boundary particle; `to_side`: to its foot on the side. */
double isph_open_stretch(const struct isph *s, const double xi[3], size_t j, const double r[3],
                         double to_side[3]) {
  const struct isph_open_side *side = &s->sides[s->boundary_box[j]];
  int n = side->axis;
  double depth = side->inward > 0 ? xi[n] - s->low[n] : s->high[n] - xi[n];
  memcpy(to_side, r, 3 * sizeof *r);
  to_side[n] = depth * side->inward;
  return 1 + fmax(0, fabs(r[n]) - depth) / fmax(depth, 0.25 * s->spacing);
}

/* The open side through which x has left the domain, -1 for none. */
int isph_open_side_behind(const struct isph *s, const double x[3]) {
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    bool behind =
        side->inward > 0 ? x[side->axis] < s->low[side->axis] : x[side->axis] > s->high[side->axis];
    for (int a = 0; a < 3; a++)
      if (a != side->axis && used(s, a))
        behind = behind && x[a] > side->low[a] && x[a] < side->high[a];
    if (behind) return (int)k;
  }
  return -1;
}

void isph_remove_outside(struct isph *s) {
  size_t kept = 0;
  for (size_t i = 0; i < s->count; i++) {
    const double *x = s->position[i];
    bool outside = false;
    for (int a = 0; a < 3; a++)
      outside =
          outside || (used(s, a) && !s->periodic[a] && (x[a] < s->low[a] || x[a] > s->high[a]));
    if (outside) {
      double mass = s->mass[i] * s->thickness;
      if (isph_open_side_behind(s, x) >= 0) {
        s->left_count++, s->left_mass += mass;
      } else {
        if (s->lost_count == 0)
          log_warning("t = %.4g s: particle %llu went through a wall at (%.4g, %.4g, %.4g) m and "
                      "is taken out",
                      s->time, (unsigned long long)s->id[i], x[0], x[1], x[2]);
        s->lost_count++, s->lost_mass += mass;
      }
      continue;
    }
    if (kept != i) {
      memcpy(s->position[kept], s->position[i], sizeof *s->position);
      memcpy(s->velocity[kept], s->velocity[i], sizeof *s->velocity);
      s->pressure[kept] = s->pressure[i];
      s->mass[kept] = s->mass[i];
      s->id[kept] = s->id[i];
    }
    kept++;
  }
  s->count = kept;
}

/* How far x stands in front of a window, m; INFINITY where it does not. */
static double depth_before(const struct isph *s, const struct isph_open_side *side,
                           const double x[3]) {
  for (int a = 0; a < 3; a++)
    if (a != side->axis && used(s, a) && !(x[a] > side->low[a] && x[a] < side->high[a]))
      return INFINITY;
  return side->inward > 0 ? x[side->axis] - s->low[side->axis]
                          : s->high[side->axis] - x[side->axis];
}

/* A given pressure says nothing about the spin and the spread of the water that comes in, and a
 * window without more breeds jets and eddies: within a spacing of it free water goes straight, and
 * comes in evenly; within two, more and more. In soil the drag sees to it. */
void isph_open_straighten(struct isph *s) {
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    if (side->kind != BOUNDARY_OPEN_HEAD) continue;
    int n = side->axis;
    double reach = 2 * s->spacing, volume = 0, mean = 0;
    for (int pass = 0; pass < 2; pass++) {
      for (size_t i = 0; i < s->count; i++) {
        double depth = depth_before(s, side, s->position[i]);
        if (depth >= reach || (s->on.soil && s->soil_share[i] > 0)) continue;
        double *v = s->predicted[i], keep = fmin(1, fmax(0, depth / s->spacing - 1));
        if (pass == 0) {
          volume += s->volume[i], mean += s->volume[i] * v[n];
          continue;
        }
        for (int a = 0; a < 3; a++)
          if (a != n) v[a] *= keep;
        if (mean * side->inward > 0) v[n] = keep * v[n] + (1 - keep) * mean;
      }
      if (volume > 0) mean /= volume, volume = 0;
    }
  }
}

/* One place half a spacing inside each cell of a window is looked at; a particle comes in where
 * the water and the boundary leave room for it, moving as the water around does. */
enum status isph_admit(struct isph *s, size_t *admitted) {
  enum status status = STATUS_OK;
  size_t before = s->count;
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    /* A given flux is metered: one layer of particles each time it has filled a spacing. */
    if (side->kind == BOUNDARY_OPEN_FLUX && !(floor(side->flux * s->time / s->spacing) >
                                              floor(side->flux * s->time_admitted / s->spacing)))
      continue;
    int cells[3];
    double pitch[3];
    for (int a = 0; a < 3; a++) {
      double width = side->high[a] - side->low[a];
      cells[a] = a == side->axis || !used(s, a) ? 1 : (int)fmax(1, round(width / s->spacing));
      pitch[a] = width / cells[a];
    }
    for (int c = 0; c < cells[0] * cells[1] * cells[2]; c++) {
      int at[3] = {c % cells[0], c / cells[0] % cells[1], c / cells[0] / cells[1]};
      double x[3], velocity[3], filling;
      for (int a = 0; a < 3; a++) x[a] = side->low[a] + (at[a] + 0.5) * pitch[a];
      double edge = side->inward > 0 ? s->low[side->axis] : s->high[side->axis];
      x[side->axis] = edge + 0.5 * side->inward * s->spacing;
      double pressure = 0;
      if (side->kind == BOUNDARY_OPEN_HEAD) {
        pressure = isph_open_pressure(s, side, x[2]);
        if (!(pressure > 0)) continue;
      }
      TRY(isph_probe(s, x, &filling, velocity));
      if (side->kind == BOUNDARY_OPEN_HEAD && filling > 1.06 - s->filling_alone) continue;
      for (int a = 0; a < 3; a++)
        if (a != side->axis) velocity[a] = 0;
      if (side->kind == BOUNDARY_OPEN_FLUX) velocity[side->axis] = side->inward * side->flux;
      double porosity = 1;
      if (s->on.soil) {
        struct soil_point soil;
        isph_soil_at(s, x, &soil);
        porosity = soil.porosity;
      }
      double mass = porosity * s->density * s->wall_volume;
      TRY(isph_add_particle(s, x, velocity, mass));
      s->pressure[s->count - 1] = pressure;
      s->entered_count++, s->entered_mass += mass * s->thickness;
    }
  }
cleanup:
  s->time_admitted = s->time;
  *admitted = s->count - before;
  return status;
}
