#include "sphsolve/isph/window.h"

#include <math.h>
#include <string.h>

#include "common/units.h"

double isph_window_highest(const struct region *inflow) {
  double head = inflow->table.count > 0 ? -INFINITY : inflow->head;
  for (size_t n = 0; n < inflow->table.count; n++) head = fmax(head, inflow->table.value[n][0]);
  return head;
}

bool isph_window_has_site(const struct lattice *lattice, const struct region *inflow, int axis,
                          bool at_low, const size_t at[3]) {
  if (at[axis] != (at_low ? 0 : lattice->size[axis] - 1)) return false;
  for (int a = 0; a < 3; a++) {
    const double x = lattice->origin[a] + (double)at[a] * lattice->spacing[a];
    if (a == axis || (lattice->dimensions == 2 && a == 1)) continue;
    if (!(x > inflow->box[a] && x < inflow->box[a + 3])) return false;
  }
  return true;
}

double isph_window_pressure(const struct isph *s, const struct isph_open_side *side, double z) {
  const double *g = s->scene->gravity;
  double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  if (strength == 0) return s->density * GRAVITY_STANDARD * side->head;
  return fmax(0, s->density * strength * (side->head - z));
}

double isph_window_stretch(const struct isph *s, const double xi[3], uint32_t entry,
                           const double r[3], double to_side[3]) {
  const size_t j = entry & PAIR_MASK;
  const double *turn = s->image[entry >> PAIR_BITS].turn;
  const struct isph_open_side *side = &s->sides[s->boundary_box[j]];
  int n = side->axis;
  double depth = side->inward > 0 ? xi[n] - s->low[n] : s->high[n] - xi[n];
  for (int a = 0; a < 3; a++) to_side[a] = turn[a] < 0 ? xi[a] - s->boundary_position[j][a] : r[a];
  to_side[n] = depth * side->inward;
  return 1 + fmax(0, fabs(r[n]) - depth) / fmax(depth, 0.25 * s->spacing);
}

int isph_window_behind(const struct isph *s, const double x[3]) {
  for (size_t k = 0; k < s->side_count; k++) {
    const struct isph_open_side *side = &s->sides[k];
    bool behind =
        side->inward > 0 ? x[side->axis] < s->low[side->axis] : x[side->axis] > s->high[side->axis];
    for (int a = 0; a < 3; a++)
      if (a != side->axis && isph_uses_axis(s, a))
        behind = behind && x[a] > side->low[a] && x[a] < side->high[a];
    if (behind) return (int)k;
  }
  return -1;
}

double isph_window_depth(const struct isph *s, const struct isph_open_side *side,
                         const double x[3]) {
  for (int a = 0; a < 3; a++)
    if (a != side->axis && isph_uses_axis(s, a) && !(x[a] > side->low[a] && x[a] < side->high[a]))
      return INFINITY;
  return side->inward > 0 ? x[side->axis] - s->low[side->axis]
                          : s->high[side->axis] - x[side->axis];
}

bool isph_window_is_near(const struct isph *s, const double x[3]) {
  for (size_t k = 0; k < s->side_count; k++)
    if (isph_window_depth(s, &s->sides[k], x) < s->spacing) return true;
  return false;
}
