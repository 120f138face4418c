/* Removes particles that have left the domain: through a window of an open side, or, which should
 * not happen, through a wall. */
#include "sphsolve/isph/outside.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/statistics.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/isph/constants.h"

/* A particle that has left at x in a step of length dt becomes the foremost of a column, whose
 * front continues from there. In free water it is that of its own column; in soil, where the number
 * of particles in a row that leaves differs from that of the columns, it is the nearest column
 * within a pitch that waits for a particle. None is chosen if the water has another spacing.
 * isph_open_move still moves the column by that step. */
static void extend_column(struct isph *s, int k, const double x[3], double volume, double dt) {
  const struct isph_open_side *side = &s->sides[k];
  const size_t end = side->first + (size_t)(side->cells[0] * side->cells[1] * side->cells[2]);
  const double reach = side->porosity < 1 ? 1 : 0.5;
  double nearest = INFINITY;
  size_t found = end;
  for (size_t c = side->first; c < end; c++) {
    const struct isph_column *column = &s->columns[c];
    bool beside = s->column_front[c] > 0.5 * column->pitch;
    double square = 0;
    for (int a = 0; a < 3; a++) {
      if (a == side->axis || !isph_uses_axis(s, a)) continue;
      const double off = x[a] - column->at[a];
      beside = beside && fabs(off) <= reach * side->pitch[a];
      square += off * off;
    }
    if (beside && square < nearest) nearest = square, found = c;
  }
  if (found == end) return;
  const struct isph_column *column = &s->columns[found];
  if (fabs(volume / column->volume - 1) < SAME_VOLUME)
    s->column_front[found] =
        fmin(fabs(x[side->axis] - side->edge), column->pitch) + column->speed * dt;
}

static bool is_outside(const struct isph *s, const double x[3]) {
  for (int a = 0; a < 3; a++)
    if (isph_uses_axis(s, a) && !s->periodic[a] && (x[a] < s->low[a] || x[a] > s->high[a]))
      return true;
  return false;
}

/* Whether particle i is out of the domain, or taken by a well. */
static bool is_removed(const struct isph *s, size_t i) {
  return is_outside(s, s->position[i]) || (s->on.wells && s->outlet[i].leaves);
}

/* Adds to the mass that left or was lost, which is subtracted from the water in the balance; its
 * rounding error is kept. */
static void add_passed(struct isph *s, double *sum, double mass) {
  double rounded = 0;
  add_compensated(sum, &rounded, mass);
  s->passed.rounded -= rounded;
}

static void count_removed(struct isph *s, const struct isph_removed *gone, double dt) {
  const double *x = gone->position, mass = gone->mass * s->thickness;
  int side = isph_window_behind(s, x);
  isph_budget_removed(s, side >= 0 || gone->pumped ? BUDGET_LEFT : BUDGET_LOST, gone);
  if (gone->pumped) {
    s->left_count++, add_passed(s, &s->passed.left, mass);
    return;
  }
  if (side >= 0) {
    s->left_count++, add_passed(s, &s->passed.left, mass);
    extend_column(s, side, x, gone->volume, dt);
    return;
  }
  if (s->lost_count == 0)
    log_warning("t = %.4g s: particle %llu went through a wall at (%.4g, %.4g, %.4g) m and is "
                "taken out",
                s->time, (unsigned long long)gone->id, x[0], x[1], x[2]);
  const double *v = gone->velocity;
  double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / gone->porosity;
  if (!(speed <= s->fastest_lost[0]))
    memcpy(s->fastest_lost, (double[5]){speed, x[0], x[1], x[2], (double)gone->id},
           sizeof s->fastest_lost);
  if (s->lost_count < CONSERVATION_LOSSES) {
    const double loss[6] = {(double)gone->id, s->time, x[0], x[1], x[2], mass};
    memcpy(s->losses[s->lost_count], loss, sizeof loss);
  }
  s->lost_count++, add_passed(s, &s->passed.lost, mass);
}

enum status isph_remove_outside(struct isph *s, double dt) {
  enum status status = STATUS_OK;
  struct isph_removed *here = NULL, *all = NULL;
  size_t kept = 0, gone = 0, total = 0;
  struct isph_kept state;
  isph_fields_kept(s, &state);
  s->fastest_lost[0] = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++) gone += is_removed(s, i);
  TRY(memory_allocate(&here, gone, sizeof *here, "particles that leave"));
  gone = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    if (is_removed(s, i)) {
      struct isph_removed *g = &here[gone++];
      memcpy(g->position, s->position[i], sizeof g->position);
      memcpy(g->velocity, s->velocity[i], sizeof g->velocity);
      g->mass = s->mass[i], g->volume = s->volume[i], g->id = s->id[i];
      g->pumped = s->on.wells && s->outlet[i].leaves;
      g->inertia = s->on.soil ? s->inertia[i] : 1, g->porosity = s->on.soil ? s->porosity[i] : 1;
      continue;
    }
    isph_kept_move(s, &state, kept, i, 1);
    kept++;
  }
  s->count = kept;
  if (!ranks_any(gone > 0)) goto cleanup;
  TRY(isph_gather(here, gone, sizeof *here, &all, &total));
  for (size_t k = 0; k < total; k++) count_removed(s, &all[k], dt);
cleanup:
  memory_free(&here);
  memory_free(&all);
  return status;
}
