/* Method isph: stabilised incompressible SPH for the unified Navier-Stokes / extended Darcy
 * equation (Morimoto et al. 2015, corrected; docs/physics/isph.md). */
#include "sphsolve/isph/method.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/copy.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/watch.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/isph/create.h"
#include "sphsolve/isph/snapshot.h"
#include "sphsolve/isph/step.h"
#include "sphsolve/isph/time_step.h"
#include "sphsolve/isph/switches.h"

/* Number of good steps after which a halved time step may double again. */
#define RECOVERY 200

/* The first multiple of the interval after a time; for an interval of 0 it is 0, which is always
 * due. */
static double row_after(double time, double interval) {
  return interval > 0 ? (floor(time / interval * (1 + 1e-12)) + 1) * interval : 0;
}

/* The pressure at the start, of the first row and snapshot, is that in the first step, and *first
 * the length that its velocities allow it. All else that the step has changed is taken back. If it
 * fails, the run goes on: its first step fails as well, and is then tried with a shorter dt.
 *
 * In a step a wall has its mean velocity, so that water and walls keep their volumes. From one step
 * to the next that rises by the wall's acceleration times dt, but in the first step by half of it:
 * the pressure of that step is short of half the force that water exerts on a wall that accelerates
 * from rest (added mass: Westergaard 1933, Trans. ASCE 98). On trial the wall's velocity is that at
 * the end of the step, and the pressure of the first step remains the one on trial (isph_advance).
 */
static enum status find_first_pressure(struct isph *s, double dt, struct isph_copy *copy,
                                       double *first) {
  enum status status = STATUS_OK;
  struct isph_ending ending = s->ending;
  const char *unused;
  if (isnan(dt)) dt = isph_stable_dt(s, &unused);
  dt = isph_dt_to_end(&ending, s->scene->end_time - s->time, dt);
  TRY(isph_copy_state(s, copy));
  s->on_trial = true, s->trial_dt = dt;
  status = isph_project(s, dt);
  s->on_trial = false;
  const bool found = status == STATUS_OK;
  if (!found && status != STATUS_NUMERIC) goto cleanup;
  if (!found) error_clear();
  if (found) *first = isph_first_dt(s, dt);
  if (found) isph_copy_pressure(s, copy);
  TRY(isph_restore_state(s, copy));
cleanup:
  return status;
}

static enum status march(struct isph *s, const struct plan *plan, struct isph_copy *copy,
                         struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  double row_interval = recorder_row_interval(recorder);
  double fixed_dt = plan->dt, dt = fixed_dt, first_dt = INFINITY, used = 0;
  bool resumed = s->step > 0; /* row and snapshot of this step were there before the checkpoint */
  struct isph_trip trip = {.bound = WATCH_RESIDUAL};
  if (isnan(row_interval)) row_interval = isfinite(scene->end_time) ? scene->end_time / 500 : 0;
  double next_row = resumed ? row_after(s->time, row_interval) : 0;
  result->status = "end_time";
  if (s->step == 0) TRY(find_first_pressure(s, fixed_dt, copy, &first_dt));
  for (;;) {
    bool last = s->time >= scene->end_time * (1 - 1e-12);
    double velocity[3];
    isph_darcy_velocity(s, velocity);
    if (scene->steady_tolerance > 0 &&
        monitor_settled(&s->settling, scene->steady_tolerance, s->time, velocity)) {
      last = true;
      result->status = "steady";
    }
    const bool stopped = recorder_interrupted(recorder);
    if (stopped) result->status = "interrupted";
    if (!resumed && (s->time >= next_row * (1 - 1e-12) || last)) {
      TRY(isph_write_row(s, recorder, isnan(dt) ? 0 : dt));
      next_row = row_after(s->time, row_interval);
    }
    if (!resumed && (s->time >= recorder_next_snapshot(recorder) * (1 - 1e-12) || last))
      TRY(isph_write_snapshot(s, recorder));
    if ((stopped || recorder_checkpoint_due(recorder)) && s->step > 0)
      TRY(isph_write_checkpoint(s, recorder));
    resumed = false;
    if (stopped) {
      status = FAIL(STATUS_INTERRUPTED, "interrupted at t = %.4g s; go on with --resume", s->time);
      goto cleanup;
    }
    if (last) break;
    if (s->step % WATCH_STEPS == 0 && watchdog_wants(&s->dog, s->step, used)) {
      TRY(isph_copy_state(s, copy));
      watchdog_keep(&s->dog, s->step, used);
    }
    if (s->dog.halvings > 0 && isnan(fixed_dt) && s->time > s->dog.trip_time &&
        s->step >= s->stable_from + RECOVERY) {
      s->dog.halvings--;
      s->stable_from = s->step;
    }
    const char *limited_by = "scene";
    dt = isnan(fixed_dt) ? isph_stable_dt(s, &limited_by) : fixed_dt;
    if (s->step == 0 && isnan(fixed_dt) && first_dt < dt) dt = first_dt, limited_by = "advection";
    if (s->dog.halvings > 0) dt = ldexp(dt, -s->dog.halvings), limited_by = "watchdog";
    dt = isph_dt_to_end(&s->ending, scene->end_time - s->time, dt);
    if (s->ending.steps > 0 && s->ending.steps <= 2) limited_by = "end_time";
    step_log_limit(recorder_step_log(recorder), limited_by);
    status = isph_advance(s, dt);
    if (status == STATUS_NUMERIC) {
      trip.bound = WATCH_RESIDUAL;
      snprintf(trip.what, sizeof trip.what, "%.*s", (int)sizeof trip.what - 1, error_message());
      error_clear();
      used = INFINITY;
    } else {
      if (status != STATUS_OK) goto cleanup;
      TRY(isph_check_bounds(s, dt, &used, &trip));
    }
    if (!(used < 1)) {
      TRY(isph_step_back(s, copy, dt, &trip, recorder));
      used = s->dog.kept_used;
      s->stable_from = s->step;
      s->ending = (struct isph_ending){.steps = 0};
      s->settling = (struct monitor_settling){.since = s->time};
      next_row = row_after(s->time, row_interval);
      continue;
    }
    char note[96];
    snprintf(note, sizeof note, "t %.4g s, %d iterations", s->time, s->solve.iterations);
    recorder_progress(recorder, s->time / scene->end_time, note);
  }
cleanup:
  if (status == STATUS_NUMERIC) result->status = "failed";
  return status;
}

/* Load imbalance: pairs of the busiest rank over the mean. */
static double imbalance_of(const struct isph *s) {
  const double total = ranks_sum(s->pairs_now);
  return total > 0 ? ranks_max(s->pairs_now) * ranks_count() / total : 1;
}

static enum status run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  struct isph state = {0}, *s = &state;
  struct isph_copy copy = {0};
  struct isph_switches on;
  struct h5_file *file = NULL;
  TRY(isph_switches_of(plan, &on));
  TRY(isph_create(scene, lattice, &on, s));
  TRY(isph_add_columns(s, recorder));
  TRY(recorder_resume(recorder, &file));
  if (file != NULL) TRY(isph_read_checkpoint(s, file));
  TRY(march(s, plan, &copy, recorder, result));
cleanup:
  if (status == STATUS_OK || status == STATUS_INTERRUPTED) {
    double velocity[3];
    isph_darcy_velocity(s, velocity);
    memcpy(result->darcy_velocity, velocity, sizeof velocity);
    result->k = result->intrinsic_permeability = NAN; /* k of soil is found by method darcy */
    result->reynolds = isph_reynolds(s, result->darcy_velocity);
    result->steps = s->step;
    s->pair_interactions = ranks_sum(s->pair_interactions);
    result->pair_interactions = s->pair_interactions;
    result->pair_interactions_per_second = s->pair_interactions / fmax(s->seconds_lists, 1e-9);
    recorder_add_time(recorder, "neighbours", s->seconds_lists);
    recorder_add_time(recorder, "predictor", s->seconds_predict);
    recorder_add_time(recorder, "pressure", s->seconds_solve);
    recorder_add_time(recorder, "corrector", s->seconds_correct);
    recorder_count_traffic(recorder);
    if (RANKS) recorder_set_fact(recorder, "imbalance", imbalance_of(s));
    if (RANKS) recorder_set_measured(recorder, "pressure_setup_seconds", s->seconds_setup);
    recorder_set_fact(recorder, "iterations_mean",
                      s->solve.iterations_total / fmax(1, s->solve.solves));
    if (s->kernel_sum_peak > 0) recorder_set_fact(recorder, "kernel_sum_most", s->kernel_sum_peak);
    recorder_set_fact(recorder, "residual", s->solve.residual);
    recorder_set_fact(recorder, "particles", (double)s->total);
    recorder_set_fact(recorder, "particles_lost", (double)s->lost_count);
    recorder_set_fact(recorder, "particles_left", (double)s->left_count);
    recorder_set_fact(recorder, "particles_entered", (double)s->entered_count);
    result->conservation = (struct conservation){.known = true,
                                                 .start = s->start_count,
                                                 .entered = s->entered_count,
                                                 .left = s->left_count,
                                                 .lost = s->lost_count,
                                                 .end = s->total,
                                                 .passed = s->passed};
    memcpy(result->conservation.losses, s->losses, sizeof s->losses);
    isph_budget_end(s);
    const double *f = s->force, row = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]) * s->spacing;
    double mass = 0;
    for (size_t i = s->local.begin; i < s->local.end; i++) mass += s->mass[i] * s->thickness;
    mass = ranks_sum(mass);
    budget_warn(&s->budget, WORK_GIVEN, WORK_LEAST * mass * row);
    result->conservation.budget = s->budget;
  }
  h5_close(file);
  isph_copy_free(&copy);
  isph_free(s);
  return status;
}

/* Whether the method is for this scene: one with soil, an inflow, or a free surface. */
static bool takes(const struct effect_context *context, char why[EFFECT_WHY]) {
  const bool soil = context->has_porous || context->has_inflow;
  if (soil || context->has_surface)
    snprintf(why, EFFECT_WHY,
             soil ? "the scene holds soil or an inflow" : "the water has a free surface");
  return soil || context->has_surface;
}

static const char *wall_name(const struct scene *scene) {
  return scene->isph.slip ? "slip" : "no-slip";
}

static const char *const fields[] = {"porosity", "volume", "surface", NULL};

const struct method method_isph = {.name = "isph",
                                   .effects = isph_effects,
                                   .marches = true,
                                   .moves_walls = true,
                                   .has_turbulence = true,
                                   .fields = fields,
                                   .constants = isph_constants,
                                   .takes = takes,
                                   .scales = isph_scales,
                                   .cost = isph_cost,
                                   .wall_name = wall_name,
                                   .run = run};
