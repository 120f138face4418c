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
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/permeameter.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/output/recorder.h"

enum status isph_switches_of(const struct plan *plan, struct isph_switches *on) {
  *on = (struct isph_switches){.budget = plan_budget(plan), .dt_most = INFINITY};
  plan_switch(plan, on);
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    if (!planned->on) continue;
    if (planned->dt_max < on->dt_most)
      on->dt_most = planned->dt_max, on->dt_most_by = planned->effect->name;
    if (planned->effect->force == NULL && planned->effect->surface_pressure == NULL) continue;
    if (on->own_count == ISPH_OWN)
      return FAIL(STATUS_RUN, "more than %d effects with a force of their own", ISPH_OWN);
    on->own[on->own_count++] = planned->effect;
  }
  return STATUS_OK;
}

/* Whether the Darcy velocity has stayed within the tolerance over the last tenth of the time. */
static bool settled(struct isph_settling *settling, double tolerance, double time,
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

/* Filling (sum of V W, 1 in the bulk) up to twice, a spacing a step, and the pressure solve's own
 * bound on its residual, beyond which it fails. */
#define KERNEL_SUM_MOST 2.0
/* Filling beyond which a run says so, once: impacts reach 1.1. */
#define KERNEL_SUM_TOLD 1.3
/* Energy beyond this speed in spacings a step: see watchdog.h. */
#define ENERGY_FLOOR 0.02
/* Good steps after which a step that the effects choose may double again. */
#define RECOVERY 200

/* What drives water beside the force: walls, soil, heads and fluxes, as a speed, m/s. */
static double given_speed(const struct isph *s) {
  double speed = 0;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    const double *v = region->velocity, *u = region->soil_velocity;
    double own = fmax(sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
                      sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]));
    if (region->boundary == BOUNDARY_FLUX) own = fmax(own, fabs(region->flux));
    if (region->boundary == BOUNDARY_HEAD)
      own = fmax(own, sqrt(2 * s->scene->driving[2] * -region->head));
    if (own > speed) speed = own;
  }
  return speed;
}

/* A particle that leads: of a rank, then of all. */
struct leader {
  double value, position[3], kernel_sum, square;
  uint64_t id;
};

static enum status lead(struct leader leaders[2]) {
  enum status status = STATUS_OK;
  struct leader *all = NULL;
  size_t n = 0;
  TRY(isph_gather(leaders, 2, sizeof *leaders, &all, &n));
  for (size_t k = 0; k < n; k++)
    if (k < 2 || all[k].value > leaders[k % 2].value) leaders[k % 2] = all[k];
cleanup:
  memory_free(&all);
  return status;
}

/* The state after a step of length dt: the share it uses of the bounds, and what in words. */
static enum status judge(struct isph *s, double dt, double *share, char what[160]) {
  enum status status = STATUS_OK;
  struct watch_reading reading = {{0}};
  const double *f = s->force;
  struct leader leaders[2] = {{0}}; /* densest, fastest */
  double squares;
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum = 0;
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      const double *v = s->velocity[i], *x = s->position[i];
      double eps = s->porosity != NULL ? s->porosity[i] : 1;
      double square = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / (eps * eps);
      const double values[2] = {s->kernel_sum[i], square};
      sum += square;
      for (int k = 0; k < 2; k++)
        if (values[k] > leaders[k].value)
          leaders[k] =
              (struct leader){values[k], {x[0], x[1], x[2]}, s->kernel_sum[i], square, s->id[i]};
    }
    s->sums[c][0] = sum;
  }
  isph_add_up(s, 1, &squares);
  TRY(lead(leaders));
  const double *flung = s->flung;
  if (flung[0] * flung[0] > leaders[1].value)
    leaders[1] = (struct leader){flung[0] * flung[0],
                                 {flung[1], flung[2], flung[3]},
                                 0,
                                 flung[0] * flung[0],
                                 (uint64_t)flung[4]};
  const double fastest = leaders[1].value;
  if (leaders[0].value > KERNEL_SUM_TOLD && s->crowded == 0)
    log_warning(
        "t = %.4g s: water is pressed to %.3g of its density at (%.4g, %.4g, %.4g) m; pressures "
        "there mean nothing: walls or inflows leave it less room than it needs, or are too "
        "fast for the spacing",
        s->time, leaders[0].value, leaders[0].position[0], leaders[0].position[1],
        leaders[0].position[2]);
  if (leaders[0].value > KERNEL_SUM_TOLD) s->crowded = fmax(s->crowded, leaders[0].value);
  reading.share[WATCH_DENSITY] = (leaders[0].value - 1) / (KERNEL_SUM_MOST - 1);
  reading.share[WATCH_VELOCITY] = sqrt(fastest) * dt / s->spacing;
  if (s->total > 0)
    reading.share[WATCH_ENERGY] =
        watchdog_energy(&s->dog, sqrt(squares / (double)s->total), s->time,
                        sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), given_speed(s),
                        ENERGY_FLOOR * s->spacing / dt);
  reading.share[WATCH_RESIDUAL] = s->solve.residual / (1e3 * s->scene->isph.tolerance);
  enum watch_bound worst = watchdog_worst(&reading, share);
  const struct leader *first = &leaders[worst == WATCH_DENSITY ? 0 : 1];
  if (s->total > 0)
    snprintf(what, 160,
             "%s: particle %llu at (%.4g, %.4g, %.4g) m, kernel sum %.3g, speed %.3g m/s",
             watchdog_name(worst), (unsigned long long)first->id, first->position[0],
             first->position[1], first->position[2], first->kernel_sum, sqrt(fastest));
cleanup:
  return status;
}

/* Back to the last good state with half the step, or the end with that state in the checkpoint. */
static enum status step_back(struct isph *s, const struct isph_copy *copy, double dt,
                             const char *what, struct recorder *recorder) {
  enum status status = STATUS_OK;
  double time = s->time;
  bool go_on = watchdog_trip(&s->dog, time);
  char saved[4200] = "";
  if (s->dog.kept) {
    TRY(isph_go_back(s, copy));
    TRY(recorder_go_back(recorder, copy->time));
  }
  if (go_on) {
    struct step_back back = {.time = time, .back_to = copy->time, .dt = dt / 2};
    snprintf(back.cause, sizeof back.cause, "%s", what);
    log_warning("t = %.4g s: %s; back to t = %.4g s, time steps halved to %.3g s", time, what,
                copy->time, back.dt);
    TRY(step_log_back(recorder_step_log(recorder), &back));
    goto cleanup;
  }
  bool unsolved = !(s->solve.residual <= 1e3 * s->scene->isph.tolerance);
  const char *cause =
      unsolved && s->on.soil
          ? "neighbours differ too much in how freely water moves, as beside soil so "
            "fine that it holds the water; make it a wall, or its grain_size larger"
      : s->scene->shifting == SWITCH_OFF
          ? "without shifting particles clump; leave effects.shifting at \"auto\""
      : !isnan(s->scene->isph.dt)
          ? "the time step is too long for these speeds; use isph.dt = \"auto\""
          : "the spacing is too coarse for what drives the water here; use a "
            "smaller domain.spacing or a smaller isph.dt";
  if (s->dog.kept) {
    TRY(isph_write_checkpoint(s, recorder));
    snprintf(saved, sizeof saved, "; %s holds the last good state, t = %.4g s",
             recorder_checkpoint_name(recorder), copy->time);
  }
  status = FAIL(STATUS_NUMERIC,
                "step %lld, t = %.4g s: %s, after %d halvings of the time step "
                "(now %.3g s): %s%s",
                (long long)s->step, time, what, s->dog.halvings, dt, cause, saved);
cleanup:
  return status;
}

/* The first multiple of the interval after a time; 0, which is always due, for an interval of 0. */
static double row_after(double time, double interval) {
  return interval > 0 ? (floor(time / interval * (1 + 1e-12)) + 1) * interval : 0;
}

static enum status march(struct isph *s, const struct plan *plan, struct isph_copy *copy,
                         struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  double row_interval = recorder_row_interval(recorder);
  double fixed_dt = plan->dt, dt = fixed_dt, share = 0;
  bool resumed = s->step > 0; /* row and snapshot of this step were there before the checkpoint */
  char what[160] = "";
  if (isnan(row_interval)) row_interval = isfinite(scene->end_time) ? scene->end_time / 500 : 0;
  double next_row = resumed ? row_after(s->time, row_interval) : 0;
  result->status = "end_time";
  for (;;) {
    bool last = s->time >= scene->end_time * (1 - 1e-12);
    double velocity[3];
    isph_darcy_velocity(s, velocity);
    if (scene->steady_tolerance > 0 &&
        settled(&s->settling, scene->steady_tolerance, s->time, velocity)) {
      last = true;
      result->status = "steady";
    }
    if (recorder_interrupted(recorder)) result->status = "interrupted";
    if (!resumed && (s->time >= next_row * (1 - 1e-12) || last)) {
      TRY(isph_write_row(s, recorder, isnan(dt) ? 0 : dt));
      next_row = row_after(s->time, row_interval);
    }
    if (!resumed && (s->time >= recorder_next_snapshot(recorder) * (1 - 1e-12) || last))
      TRY(isph_write_snapshot(s, recorder));
    if (recorder_checkpoint_due(recorder) && s->step > 0) TRY(isph_write_checkpoint(s, recorder));
    resumed = false;
    if (recorder_interrupted(recorder)) {
      status = FAIL(STATUS_INTERRUPTED, "interrupted at t = %.4g s; go on with --resume", s->time);
      goto cleanup;
    }
    if (last) break;
    if (s->step % WATCH_STEPS == 0 && watchdog_wants(&s->dog, s->step, share)) {
      TRY(isph_keep(s, copy));
      watchdog_keep(&s->dog, s->step, share);
    }
    if (s->dog.halvings > 0 && isnan(fixed_dt) && s->time > s->dog.trip_time &&
        s->step >= s->calm_from + RECOVERY) {
      s->dog.halvings--;
      s->calm_from = s->step;
    }
    const char *limited_by = "scene";
    dt = isnan(fixed_dt) ? isph_stable_dt(s, &limited_by) : fixed_dt;
    if (s->dog.halvings > 0) dt = ldexp(dt, -s->dog.halvings), limited_by = "watchdog";
    double left = scene->end_time - s->time;
    /* Equal steps at the end: a crumb of a step would turn what rounding leaves of div v into
     * pressure. */
    if (dt > left * (1 - 1e-6))
      dt = left, limited_by = "end_time";
    else if (dt > 0.5 * left * (1 + 1e-6))
      dt = 0.5 * left, limited_by = "end_time";
    step_log_limit(recorder_step_log(recorder), limited_by);
    status = isph_advance(s, dt);
    if (status == STATUS_NUMERIC) {
      snprintf(what, sizeof what, "%.*s", 159, error_message());
      error_clear();
      share = INFINITY;
    } else {
      if (status != STATUS_OK) goto cleanup;
      TRY(judge(s, dt, &share, what));
    }
    if (!(share < 1)) {
      TRY(step_back(s, copy, dt, what, recorder));
      share = s->dog.kept_share;
      s->calm_from = s->step;
      s->settling = (struct isph_settling){.since = s->time};
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

/* Pairs of the busiest rank over the mean. */
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
    result_from_darcy(scene, velocity, result);
    isph_find_k(s, plan, recorder, result);
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
    if (s->crowded > 0) recorder_set_fact(recorder, "kernel_sum_most", s->crowded);
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
                                                 .entered_mass = s->entered_mass,
                                                 .left_mass = s->left_mass,
                                                 .lost_mass = s->lost_mass};
    memcpy(result->conservation.losses, s->losses, sizeof s->losses);
    isph_budget_end(s);
    result->conservation.budget = s->budget;
  }
  h5_close(file);
  isph_copy_free(&copy);
  isph_free(s);
  return status;
}

/* Soil and inflow, and a free surface once the lattice shows one. */
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
                                   .takes = takes,
                                   .scales = isph_scales,
                                   .cost = isph_cost,
                                   .ranks_cost = isph_ranks_cost,
                                   .wall_name = wall_name,
                                   .run = run};
