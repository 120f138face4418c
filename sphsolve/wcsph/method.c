/* Method wcsph: weakly compressible SPH, explicit in time. */
#include <math.h>
#include <stdio.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/wcsph/plan.h"
#include "sphsolve/wcsph/run.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/wcsph/constants.h"

static void set_direction(struct wcsph_run *run) {
  const struct scene *scene = run->scene;
  double driving = run->plan->context.driving;
  for (int a = 0; a < 3 && driving > 0; a++) run->direction[a] = scene->driving[a] / driving;
  for (size_t r = 0; r < scene->region_count && !(driving > 0); r++) {
    const double *v = scene->regions[r].velocity;
    double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    for (int a = 0; a < 3 && speed > 0; a++) run->direction[a] = v[a] / speed;
    if (speed > 0) break;
  }
}

/* The absolute pressure c^2 rho can lock the particles into a lattice that only strains
 * (docs/physics/wcsph.md). They are locked if the flow expected by Kozeny and Carman would have
 * moved them by four spacings, but they have moved by less than half a spacing. */
static bool is_locked(const struct wcsph_run *run) {
  const struct wcsph_state *state = &run->state;
  const struct effect_context *context = &run->plan->context;
  if (run->scene->wcsph.equation_of_state != EOS_ABSOLUTE ||
      run->scene->wcsph.wall != WALL_FROZEN || state->monitor.count == 0)
    return false;
  double pores = (double)run->lattice->fluid_count / run->lattice->bulk_count, sum = 0;
  for (size_t i = 0; i < state->monitor.count; i++) sum += state->monitor.rows[i][0];
  double time = wcsph_run_time(run),
         displacement = sum / (double)state->monitor.count * time / pores;
  return context->velocity_scale * time / pores > 4 * context->spacing &&
         fabs(displacement) < 0.5 * context->spacing;
}

static enum status march(struct wcsph_run *run, struct run_result *result) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct monitor_verdict verdict = wcsph_verdict(run);
  result->status = "end_time";
  while (state->step < run->last_step) {
    /* With several ranks this needs communication, so it is not done at every step. */
    bool asked = ranks_count() == 1 || state->step % WATCH_STEPS == 0;
    if (asked && recorder_checkpoint_due(run->recorder)) {
      bool stop = recorder_interrupted(run->recorder);
      TRY(wcsph_write_checkpoint(run));
      if (stop) {
        result->status = "interrupted";
        status = FAIL(STATUS_INTERRUPTED, "interrupted at step %lld, t = %g s; go on with --resume",
                      (long long)state->step, wcsph_run_time(run));
        break;
      }
    }
    bool due;
    TRY(wcsph_step(run, &due));
    if (due) {
      TRY(wcsph_sample(run, &verdict));
      if (run->scene->steady_tolerance > 0 && verdict.steady) {
        result->status = "steady";
        break;
      }
    }
  }
  if (status == STATUS_OK) TRY(wcsph_budget_now(run));
  result_from_darcy(run->scene, verdict.mean + 1, result);
  result->k_error = isfinite(verdict.error) ? verdict.error : NAN;
  if (isfinite(verdict.error)) {
    result->error.steadiness = verdict.drift;
    result->error.averaging =
        sqrt(fmax(0, verdict.error * verdict.error - verdict.drift * verdict.drift));
  }
  if (status == STATUS_OK && is_locked(run)) {
    log_warning("the particles have locked into a crystal that does not flow, as the pressure "
                "c^2 rho makes them below its strength; there is no k: write "
                "wcsph.equation_of_state = \"gauge\"");
    result->status = "crystal";
    result->k = result->k_error = result->intrinsic_permeability = NAN;
  }
cleanup:
  return status;
}

/* Maximum work / mean work of the ranks, with the last neighbour lists. */
static double imbalance_of(const struct engine *engine) {
  const double work = engine->ranks.work_sum, total = ranks_sum(work);
  return total > 0 ? ranks_max(work) * ranks_count() / total : 1;
}

static void finish(struct wcsph_run *run, struct run_result *result) {
  const struct engine *engine = &run->state.engine;
  const double *s = engine->seconds;
  double pair_time = s[PHASE_DENSITY] + s[PHASE_WALL] + s[PHASE_FORCE] + s[PHASE_CONTINUITY];
  result->steps = run->state.step;
  result->conservation = (struct conservation){.known = true, .start = run->lattice->fluid_count};
  for (size_t i = engine_first_slot(engine); i < engine_end_slot(engine); i++)
    result->conservation.end += engine->particles.id[i] != NO_PARTICLE;
  result->conservation.end = (uint64_t)ranks_sum((double)result->conservation.end);
  if (run->state.budget.samples > 0) result->conservation.budget = run->state.budget.total;
  result->wall_time = clock_seconds() - run->started;
  result->pair_interactions = engine->pair_interactions;
  result->pair_interactions_per_second = pair_time > 0 ? engine->pair_interactions / pair_time : 0;
  result->reynolds = wcsph_reynolds(run, result->darcy_velocity);
  bool frozen = engine->settings.wall == PASS_FROZEN;
  recorder_add_time(run->recorder, frozen ? "density_summation" : "density_continuity",
                    s[PHASE_DENSITY] + s[PHASE_CONTINUITY]);
  if (s[PHASE_WALL] > 0)
    recorder_add_time(run->recorder,
                      engine->settings.wall == PASS_ADAMI ? "wall_adami" : "wall_subvoxel",
                      s[PHASE_WALL]);
  recorder_add_time(run->recorder, "forces", s[PHASE_FORCE]);
  recorder_add_time(run->recorder, "drift", s[PHASE_DRIFT]);
  recorder_add_time(run->recorder, "neighbour_lists", s[PHASE_LISTS]);
  recorder_add_time(run->recorder, "ledger", s[PHASE_BUDGET]);
  recorder_count_traffic(run->recorder);
  if (RANKS) recorder_set_fact(run->recorder, "imbalance", imbalance_of(engine));
  /* Checkpoints and a resume make lists anew: they are of this machine's work, not of the flow. */
  recorder_set_measured(run->recorder, "list_rebuilds", (double)engine->rebuilds);
  recorder_set_measured(run->recorder, "method_peak_bytes", ranks_max((double)memory_peak()));
  recorder_set_fact(run->recorder, "pairs_per_pass", (double)engine->pairs_fluid);
}

/* Particles on fixed sites, as in method stokes, have no defined pressure in pores without flow. */
static enum status close_pores(struct lattice *lattice, const struct scene *scene, bool *flows) {
  size_t closed;
  const enum status status = percolation_close(lattice, scene->driving, &closed, flows);
  if (status == STATUS_OK && closed > 0)
    log_verbose("%zu of %zu pore points lead nowhere: their fluid is at rest", closed,
                closed + lattice->fluid_count);
  return status;
}

static enum status run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  struct wcsph_run run = {.scene = scene, .plan = plan, .lattice = lattice, .recorder = recorder};
  double(*region_velocity)[3] = NULL;
  struct engine_settings settings;
  struct wcsph_totals totals;
  struct lattice_spill spill = {0};
  bool flows = true, resumed, again;
  run.started = clock_seconds();
  result->k = result->k_error = NAN;
  TRY(memory_allocate(&region_velocity, scene->region_count + 1, sizeof *region_velocity,
                      "region velocities"));
  TRY(wcsph_settings(scene, plan, region_velocity, &settings));
  /* Before the engine is made, as both need memory. */
  if (settings.wall == PASS_EULERIAN && plan->context.driving > 0)
    TRY(close_pores(lattice, scene, &flows));
  else if (plan->context.driving > 0)
    TRY(percolation_find(lattice, scene->driving, true, NULL, &flows));
  run.copy.beside = recorder_checkpoint_name(recorder);
  if (settings.wall != PASS_SUBVOXEL && settings.wall != PASS_EULERIAN)
    TRY(lattice_spill_distances(lattice, run.copy.beside, &spill));
  TRY(engine_make(lattice, &settings, &run.state.engine));
  TRY(lattice_spill_regions(lattice, run.copy.beside, &spill));
  wcsph_budget_begin(&run.state.engine, plan_budget(plan), &run.state.budget);
  set_direction(&run);
  double gap = wcsph_gap(lattice) + (settings.wall == PASS_FROZEN ? 1 : 0);
  run.pore_width = gap * plan->context.spacing;
  run.diameter = hydraulic_diameter(lattice);
  double pore_time = run.pore_width * run.pore_width / plan->context.kinematic_viscosity;
  if (!isfinite(pore_time)) pore_time = scene->end_time;
  run.state.sample_steps = (int64_t)fmax(1, pore_time / SAMPLES_PER_PORE_TIME / plan->dt);
  run.row_interval = recorder_row_interval(recorder);
  run.state.next_row = isnan(run.row_interval) ? INFINITY : run.row_interval;
  for (size_t r = 0; r < scene->region_count; r++) {
    const double *v = scene->regions[r].velocity;
    if (scene->regions[r].type == REGION_WALL)
      run.wall_speed = fmax(run.wall_speed, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
  }
  TRY(wcsph_read_checkpoint(&run, &resumed));
  TRY(wcsph_watch(&run, &again));
  if (!resumed) {
    TRY(wcsph_sum(&run.state.engine, true, &totals));
    TRY(wcsph_write_row(&run, &totals));
  }
  if (flows) {
    status = march(&run, result);
    if (status != STATUS_OK && status != STATUS_INTERRUPTED) goto cleanup;
  } else {
    log_warning("%s: %s", scene->path, percolation_none(lattice));
    const double none[3] = {0};
    result_from_darcy(scene, none, result);
    result->status = "blocked";
    result->k_error = 0;
  }
  /* An interrupted run should end quickly: its checkpoint contains the particles, and the resumed
   * run writes the snapshot. */
  if (status == STATUS_OK) status = wcsph_write_snapshot(&run);
  finish(&run, result);
cleanup:
  monitor_free(&run.state.monitor);
  engine_free(&run.state.engine);
  const enum status back = lattice_restore(lattice, &spill);
  if (status == STATUS_OK) status = back;
  wcsph_copy_free(&run.copy);
  memory_free(&region_velocity);
  return status;
}

/* Takes all scenes that the methods asked before it reject. */
static bool takes(const struct effect_context *context, char why[EFFECT_WHY]) {
  if (!context->has_wall)
    snprintf(why, EFFECT_WHY, "no walls: a transient flow");
  else if (context->scene->steady_tolerance == 0)
    snprintf(why, EFFECT_WHY, "a run to end_time is wanted, not the steady state");
  else if (context->has_moving_wall)
    snprintf(why, EFFECT_WHY, "a wall moves");
  else
    snprintf(why, EFFECT_WHY, "Re about %.2g: inertia counts", context->reynolds);
  return true;
}

static bool joins_corners(const struct effect_context *context) {
  return wcsph_pass_wall(context) != PASS_EULERIAN;
}

static enum wall_scheme wall(const struct scene *scene) {
  return scene->wcsph.wall;
}

static const char *wall_name(const struct scene *scene) {
  return wall_scheme_names[scene->wcsph.wall];
}

const struct method method_wcsph = {
    .name = "wcsph",
    .effects = wcsph_effects,
    .constants = wcsph_constants,
    .resolves_pores = true,
    .marches = true,
    .wall_layers = 4,
    .walls_need_sites = true,
    .takes = takes,
    .expect = error_expect,
    .scales = wcsph_scales,
    .cost = wcsph_cost,
    .wall_name = wall_name,
    .wall = wall,
    .joins_corners = joins_corners,
    .error_flat = 5e-4, /* remaining change of a run that counts as steady */
    .error_flat_why = "parallel flat walls: exact but for what is left of the start",
    .error_narrow = 0.0115,
    .error_narrow_order = 3.0,
    .error_uneven = 0.01, /* gradients are not exact next to walls */
    .run = run};
