/* One step of a run, and what is due after it: watchdog, history row, snapshot, sample of the Darcy
 * velocity. The update of the particles is in engine/engine_step.c. */
#include "common/units.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/run.h"

#include <math.h>
#include <stdio.h>

struct monitor_verdict wcsph_verdict(const struct wcsph_run *run) {
  return monitor_judge(&run->state.monitor, run->scene->steady_tolerance, WCSPH_SAMPLES_LEAST);
}

/* First the Darcy velocity along the force, which decides on steadiness, then its components. */
static void sample_of(const struct wcsph_run *run, const struct wcsph_totals *totals,
                      double value[MONITOR_COMPONENTS]) {
  double n = run->lattice->bulk_count;
  value[0] = 0;
  for (int a = 0; a < 3; a++) {
    value[1 + a] = totals->flux[a] / n;
    value[0] += value[1 + a] * run->direction[a];
  }
}

/* The progress line: present k and its trend, density, speed. Without an end time the completed
 * fraction is that of the planned steps, or of the orders of magnitude by which the error has
 * decreased. */
static void show_progress(const struct wcsph_run *run, double velocity,
                          const struct monitor_verdict *verdict,
                          const struct wcsph_totals *totals) {
  char note[128], error[40] = "", text[32];
  const double mean = verdict->mean[0], tolerance = run->scene->steady_tolerance;
  const double *s = run->state.engine.seconds;
  const double seconds = s[PHASE_DENSITY] + s[PHASE_WALL] + s[PHASE_FORCE] + s[PHASE_CONTINUITY];
  if (isfinite(verdict->error))
    snprintf(error, sizeof error, " +- %s %%", percent_format(verdict->error, text));
  const char *trend = !(fabs(velocity - mean) > verdict->error * fabs(mean)) ? ""
                      : velocity > mean                                      ? " rising"
                                                                             : " falling";
  snprintf(note, sizeof note, "k %.4g cm/s%s%s, density %+.2f %%, %.0f M pairs/s",
           100 * mean / scene_hydraulic_gradient(run->scene), error, trend,
           100 * (totals->density_max - 1),
           seconds > 0 ? run->state.engine.pair_interactions / seconds / 1e6 : 0);
  const double steps = fmin((double)run->last_step, run->plan->steps);
  double done = fmin((double)run->state.step / steps, PROGRESS_STEPS);
  if (tolerance > 0 && verdict->error < 1) done = fmax(done, log(verdict->error) / log(tolerance));
  recorder_progress(run->recorder, fmin(done, PROGRESS_MOST), note);
}

enum status wcsph_sample(struct wcsph_run *run, struct monitor_verdict *verdict) {
  enum status status = STATUS_OK;
  struct wcsph_totals totals;
  double value[MONITOR_COMPONENTS];
  TRY(wcsph_sum(&run->state.engine, true, &totals));
  sample_of(run, &totals, value);
  TRY(monitor_add(&run->state.monitor, value));
  if (isnan(run->row_interval)) TRY(wcsph_write_row(run, &totals));
  *verdict = wcsph_verdict(run);
  show_progress(run, value[0], verdict, &totals);
cleanup:
  return status;
}

enum status wcsph_budget_now(struct wcsph_run *run) {
  const double *dx = run->lattice->spacing;
  return wcsph_budget_sample(&run->state.engine, run->scene->fluid.density * dx[0] * dx[1] * dx[2],
                             wcsph_run_time(run), &run->state.budget);
}

enum status wcsph_step(struct wcsph_run *run, bool *due) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  bool again = false;
  *due = false;
  if (wcsph_budget_due(state->step)) TRY(wcsph_budget_now(run));
  step_log_limit(recorder_step_log(run->recorder), wcsph_limiting_effect(run));
  status = engine_step(&state->engine);
  state->step++;
  if (status == STATUS_NUMERIC) {
    char what[160];
    snprintf(what, sizeof what, "%.*s", 159, error_message());
    error_clear();
    TRY(wcsph_step_back(run, wcsph_run_time(run), what));
    wcsph_set_last_step(run);
    return STATUS_OK;
  }
  if (status != STATUS_OK) goto cleanup;
  /* The watchdog may change the step, and with it the times of samples. */
  const bool sample_due = wcsph_sample_due(state);
  if (state->step % WATCH_STEPS == 0 || sample_due || state->step == run->last_step)
    TRY(wcsph_watch(run, &again));
  if (again) return STATUS_OK;
  *due = sample_due || state->step == run->last_step;
  const double time = wcsph_run_time(run), half = 0.5 * state->engine.settings.dt;
  if (!isnan(run->row_interval) && time >= state->next_row - half) {
    struct wcsph_totals totals;
    TRY(wcsph_sum(&state->engine, true, &totals));
    TRY(wcsph_write_row(run, &totals));
    while (state->next_row <= time + half) state->next_row += run->row_interval;
  }
  if (time >= recorder_next_snapshot(run->recorder) - half && state->step < run->last_step)
    TRY(wcsph_write_snapshot(run));
cleanup:
  return status;
}
