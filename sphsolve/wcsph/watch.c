#include "sphsolve/wcsph/run.h"

#include <math.h>
#include <stdio.h>

#include "common/log.h"
#include "sphsolve/wcsph/constants.h"

static enum watch_bound check_bounds(struct wcsph_run *run, const struct wcsph_totals *totals,
                                     double *used) {
  struct watch_reading reading = {{0}};
  double c = run->state.engine.settings.sound_speed;
  double count = (double)run->lattice->fluid_count;
  double energy = sqrt((totals->square + c * c * totals->compression) / count);
  reading.used[WATCH_DENSITY] =
      fmax(totals->density_max - 1, 1 - totals->density_min) / DENSITY_BAND;
  reading.used[WATCH_VELOCITY] = totals->speed_max / c;
  reading.used[WATCH_ENERGY] =
      watchdog_energy(&run->state.dog, energy, wcsph_run_time(run), run->plan->context.driving,
                      run->wall_speed, ENERGY_FLOOR * c);
  if (!totals->finite) reading.used[WATCH_DENSITY] = INFINITY;
  return watchdog_worst(&reading, used);
}

/* Describes which quantity exceeded its bound, and for which particle. */
static void describe_violation(const struct wcsph_run *run, enum watch_bound bound,
                               const struct wcsph_totals *totals, char what[160]) {
  const struct engine *engine = &run->state.engine;
  double high = totals->density_max - 1, low = 1 - totals->density_min;
  const size_t number = bound != WATCH_DENSITY ? totals->fastest
                        : low > high           ? totals->thinnest
                                               : totals->densest;
  /* Position and id, from the rank that owns the particle. */
  const size_t first = engine_first_slot(engine),
               slot = number - engine_number(engine, first) + first;
  double found[4] = {0};
  if (slot >= first && slot < engine_end_slot(engine)) {
    particles_position(&engine->particles, run->lattice, slot, found);
    found[3] = engine->particles.id[slot];
  }
  ranks_sum_all(found, 4);
  if (bound == WATCH_DENSITY)
    snprintf(what, 160, "density of particle %u at (%.4g, %.4g, %.4g) m is %.3g times that at rest",
             (unsigned)found[3], found[0], found[1], found[2], low > high ? 1 - low : 1 + high);
  else
    snprintf(what, 160, "%s: particle %u at (%.4g, %.4g, %.4g) m moves at %.3g m/s",
             watchdog_name(bound), (unsigned)found[3], found[0], found[1], found[2],
             totals->speed_max);
}

enum status wcsph_step_back(struct wcsph_run *run, double time, const char *what) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct step_back back = {.time = time};
  const struct plan *plan = run->plan;
  const size_t backs = recorder_step_log(run->recorder)->back_count;
  bool go_on = watchdog_trip(&state->dog, time, backs), kept = state->dog.kept;
  if (kept) {
    TRY(wcsph_go_back(&run->copy, state));
    TRY(recorder_go_back(run->recorder, run->copy.time));
  }
  if (go_on) {
    wcsph_halve(state);
    back.back_to = run->copy.time;
    back.dt = state->engine.settings.dt;
    snprintf(back.cause, sizeof back.cause, "%s", what);
    TRY(step_log_back(recorder_step_log(run->recorder), &back));
    log_warning("t = %g s: %s; back to t = %g s, time step now %g s", time, what, run->copy.time,
                back.dt);
    goto cleanup;
  }
  const struct engine_settings *settings = &state->engine.settings;
  const double cell =
      state->engine.speed_max * state->engine.pass.spacing / settings->kinematic_viscosity;
  const char *cause =
      settings->wall == PASS_EULERIAN && cell > ADVECTION_CELL_REYNOLDS
          ? "the flow is too fast for particles that stay on their lattice points; write "
            "effects.shifting = \"on\""
      : plan->dt > NEAR_DT_LIMIT * plan->dt_limit
          ? "the time step is near or beyond its limit; use wcsph.dt = \"auto\""
      : plan->context.driving * plan->dt > FORCE_STRONG * state->engine.settings.sound_speed
          ? "the force is too strong for this sound speed; raise wcsph.sound_speed"
          : "the sound speed is too low for this force; raise wcsph.sound_speed";
  char saved[4200] = "";
  if (kept) {
    TRY(wcsph_write_checkpoint(run));
    snprintf(saved, sizeof saved, "; %s holds the last good state, t = %g s",
             recorder_checkpoint_name(run->recorder), run->copy.time);
  }
  status =
      FAIL(STATUS_NUMERIC,
           "step %lld, t = %g s: %s, after %zu halvings of the time step: %s (dt %g s, limit %g "
           "s, sound speed %g m/s)%s",
           (long long)state->step, time, what, backs, cause, state->engine.settings.dt,
           plan->dt_limit, state->engine.settings.sound_speed, saved);
cleanup:
  return status;
}

/* Adapts the step to the velocities, such that particles do not pass each other in one step. */
static void adapt_step(struct wcsph_run *run) {
  struct wcsph_state *state = &run->state;
  double h = state->engine.settings.smoothing_length, speed = state->engine.speed_max;
  if (!isnan(run->scene->wcsph.dt)) return;
  if (speed * state->engine.settings.dt > ADVECTION_MAX * h)
    wcsph_halve(state);
  else if (state->halvings > state->dog.halvings &&
           3 * speed * state->engine.settings.dt < ADVECTION_MAX * h)
    wcsph_double(state);
}

const char *wcsph_limiting_effect(const struct wcsph_run *run) {
  const struct wcsph_state *state = &run->state;
  return state->halvings == 0                    ? run->plan->dt_by
         : state->halvings > state->dog.halvings ? "advection"
                                                 : "watchdog";
}

void wcsph_set_last_step(struct wcsph_run *run) {
  double last =
      ceil((run->scene->end_time - run->state.time_from) / run->state.engine.settings.dt - 1e-6);
  run->last_step = run->state.step_from + (last < 9e15 ? (int64_t)last : (int64_t)9e15);
}

enum status wcsph_watch(struct wcsph_run *run, bool *again) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct wcsph_totals totals;
  double used;
  char what[160];
  *again = false;
  TRY(wcsph_sum(&state->engine, false, &totals));
  enum watch_bound worst = check_bounds(run, &totals, &used);
  if (used >= 1) {
    describe_violation(run, worst, &totals, what);
    *again = true;
    TRY(wcsph_step_back(run, wcsph_run_time(run), what));
  } else {
    bool keep = used > KEEP_FROM || run->plan->dt > KEEP_NEAR_LIMIT * run->plan->dt_limit;
    if (keep && watchdog_wants(&state->dog, state->step, used)) {
      TRY(wcsph_keep(state, &run->copy));
      watchdog_keep(&state->dog, state->step, used);
    }
    adapt_step(run);
  }
  wcsph_set_last_step(run);
cleanup:
  return status;
}
