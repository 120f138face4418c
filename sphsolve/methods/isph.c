/* Method isph: stabilised incompressible SPH for the unified Navier-Stokes / extended Darcy
 * equation (Morimoto et al. 2015, corrected; docs/physics.md). */
#include "sphsolve/methods/isph.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/isph/isph_output.h"
#include "sphsolve/method.h"

enum status isph_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  context->support = scene->isph.support_ratio * context->spacing;
  context->smoothing_length = context->support / kernel_support_ratio(scene->isph.kernel);
  double height = 0;
  for (int a = 0; a < 3; a++)
    if (scene->gravity[a] != 0) height = fmax(height, scene->domain_size[a]);
  context->velocity_scale = sqrt(2 * context->driving * height);
  return STATUS_OK;
}

/* Seconds a particle and step take on one core, measured; of a step's least iterations. */
#define SECONDS_PER_STEP 8e-6

enum status isph_plan(struct plan *plan, int threads) {
  const struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  double n = (double)context->lattice->fluid_count;
  double neighbours = context->lattice->dimensions == 3 ? 4.19 * pow(scene->isph.support_ratio, 3)
                                                        : 3.14 * pow(scene->isph.support_ratio, 2);
  double speed = context->velocity_scale, guess = INFINITY;
  if (speed > 0) guess = 0.25 * context->spacing / speed;
  if (context->driving > 0) guess = fmin(guess, 0.25 * sqrt(context->spacing / context->driving));
  guess = fmin(guess, plan->dt_limit);
  if (!isnan(scene->isph.dt) && scene->isph.dt > plan->dt_limit)
    return FAIL(STATUS_INPUT,
                "%s: isph.dt: %g s is beyond the limit of %g s that %s sets; use "
                "dt = \"auto\"",
                scene->path, scene->isph.dt, plan->dt_limit, plan->dt_limited_by);
  plan->dt = scene->isph.dt; /* NAN: chosen each step */
  if (!isnan(plan->dt)) guess = plan->dt;
  plan->bytes_fluid = 420 + 1.3 * neighbours * 12;
  plan->bytes_wall = 0;
  plan->bytes_total = n * plan->bytes_fluid;
  plan->steps = isfinite(scene->end_time) ? ceil(scene->end_time / guess) : NAN;
  plan->seconds = plan->steps * n * SECONDS_PER_STEP / fmin(threads, 8);
  plan->error = NAN;
  snprintf(plan->error_why, sizeof plan->error_why,
           "first order in time; make verify shows it for scenes with known answers");
  return STATUS_OK;
}

void isph_switches_of(const struct plan *plan, struct isph_switches *on) {
  *on = (struct isph_switches){
      .soil = plan_has(plan, "isph_porosity"),
      .moving_soil = plan_has(plan, "isph_soil_moving"),
      .drag_linear = plan_has(plan, "isph_drag_linear"),
      .drag_forchheimer = plan_has(plan, "isph_drag_forchheimer"),
      .viscosity = plan_has(plan, "isph_viscosity"),
      .turbulence = plan_has(plan, "isph_turbulence"),
      .relaxation = plan_has(plan, "isph_relaxation"),
      .surface = plan_has(plan, "isph_surface"),
      .shifting = plan_has(plan, "isph_shifting"),
      .calming = plan_has(plan, "isph_calming"),
      .no_slip = plan_has(plan, "isph_wall_no_slip"),
      .moving_walls = plan_has(plan, "isph_wall_moving"),
      .open_sides = plan_has(plan, "isph_open_side"),
  };
}

/* Whether the Darcy velocity has stayed within the tolerance over the last tenth of the time. */
struct settling {
  double since, reference[3];
};

static bool settled(struct settling *settling, double tolerance, double time,
                    const double velocity[3]) {
  double change = 0, size = 0;
  for (int a = 0; a < 3; a++) {
    change = fmax(change, fabs(velocity[a] - settling->reference[a]));
    size = fmax(size, fabs(velocity[a]));
  }
  if (time > 0 && change <= tolerance * size) return time - settling->since > 0.1 * time;
  memcpy(settling->reference, velocity, sizeof settling->reference);
  settling->since = time;
  return false;
}

static enum status check_finite(const struct isph *s) {
  for (size_t i = 0; i < s->count; i++)
    for (int a = 0; a < 3; a++)
      if (!isfinite(s->velocity[i][a]) || !isfinite(s->position[i][a]))
        return FAIL(STATUS_NUMERIC,
                    "t = %.4g s: particle %llu at (%.4g, %.4g, %.4g) m is no "
                    "longer finite; use a smaller isph.dt",
                    s->time, (unsigned long long)s->id[i], s->position[i][0], s->position[i][1],
                    s->position[i][2]);
  return STATUS_OK;
}

static enum status march(struct isph *s, const struct plan *plan, struct recorder *recorder,
                         struct run_result *result) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  double row_interval = recorder_row_interval(recorder);
  double next_row = s->step == 0 ? 0 : INFINITY, fixed_dt = plan->dt, dt = fixed_dt;
  struct settling settling = {0};
  if (isnan(row_interval)) row_interval = isfinite(scene->end_time) ? scene->end_time / 500 : 0;
  if (s->step > 0 && row_interval > 0)
    next_row = (floor(s->time / row_interval) + 1) * row_interval;
  if (s->step > 0 && row_interval == 0) next_row = 0;
  result->status = "end_time";
  for (;;) {
    bool last = s->time >= scene->end_time * (1 - 1e-12);
    double velocity[3];
    isph_darcy_velocity(s, velocity);
    if (scene->steady_tolerance > 0 &&
        settled(&settling, scene->steady_tolerance, s->time, velocity)) {
      last = true;
      result->status = "steady";
    }
    if (recorder_interrupted(recorder)) result->status = "interrupted";
    if (s->time >= next_row * (1 - 1e-12) || last) {
      TRY(check_finite(s));
      TRY(isph_write_row(s, recorder, isnan(dt) ? 0 : dt));
      while (next_row <= s->time * (1 + 1e-12) && row_interval > 0) next_row += row_interval;
    }
    if (s->time >= recorder_next_snapshot(recorder) * (1 - 1e-12) || last)
      TRY(isph_write_snapshot(s, recorder));
    if (recorder_checkpoint_due(recorder) && s->step > 0) TRY(isph_write_checkpoint(s, recorder));
    if (recorder_interrupted(recorder)) {
      status = FAIL(STATUS_INTERRUPTED, "interrupted at t = %.4g s; go on with --resume", s->time);
      goto cleanup;
    }
    if (last) break;
    const char *limited_by;
    dt = isnan(fixed_dt) ? isph_stable_dt(s, &limited_by) : fixed_dt;
    double left = scene->end_time - s->time;
    if (dt > left) dt = left;
    TRY(isph_advance(s, dt));
    char note[96];
    snprintf(note, sizeof note, "t %.4g s, %d iterations", s->time, s->solve.iterations);
    recorder_progress(recorder, s->time / scene->end_time, note);
  }
cleanup:
  if (status == STATUS_NUMERIC) result->status = "failed";
  return status;
}

/* A k only where the force drives water round a periodic box full of it; in a tank or between given
 * heads v / i along gravity means nothing. */
static bool through_flow(const struct plan *plan) {
  const struct scene *scene = plan->context.scene;
  bool through = !plan->context.has_surface && !plan->context.has_inflow;
  for (int a = 0; a < 3; a++) through = through && (scene->driving[a] == 0 || scene->periodic[a]);
  return through;
}

enum status isph_run(const struct scene *scene, const struct plan *plan,
                     const struct lattice *lattice, struct recorder *recorder,
                     struct run_result *result) {
  enum status status = STATUS_OK;
  struct isph state = {0}, *s = &state;
  struct isph_switches on;
  struct h5_file *file = NULL;
  isph_switches_of(plan, &on);
  TRY(isph_create(scene, lattice, &on, s));
  TRY(isph_add_columns(s, recorder));
  TRY(recorder_resume(recorder, &file));
  if (file != NULL) TRY(isph_read_checkpoint(s, file));
  TRY(march(s, plan, recorder, result));
cleanup:
  if (status == STATUS_OK || status == STATUS_INTERRUPTED) {
    double velocity[3];
    isph_darcy_velocity(s, velocity);
    result_from_darcy(scene, velocity, result);
    if (!through_flow(plan)) result->k = result->intrinsic_permeability = NAN;
    result->steps = s->step;
    result->pair_interactions = s->pair_interactions;
    result->pair_interactions_per_second = s->pair_interactions / fmax(s->seconds_lists, 1e-9);
    recorder_add_time(recorder, "neighbours", s->seconds_lists);
    recorder_add_time(recorder, "predictor", s->seconds_predict);
    recorder_add_time(recorder, "pressure", s->seconds_solve);
    recorder_add_time(recorder, "corrector", s->seconds_correct);
    recorder_set_fact(recorder, "iterations_mean",
                      s->solve.iterations_total / fmax(1, s->solve.solves));
    recorder_set_fact(recorder, "residual", s->solve.residual);
    recorder_set_fact(recorder, "particles", (double)s->count);
    recorder_set_fact(recorder, "particles_lost", (double)s->lost_count);
    recorder_set_fact(recorder, "particles_left", (double)s->left_count);
    recorder_set_fact(recorder, "particles_entered", (double)s->entered_count);
  }
  h5_close(file);
  isph_free(s);
  return status;
}
