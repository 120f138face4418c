/* Method stokes: steady creeping flow; the SPH-Stokes system is solved on a cascade of lattices. */
#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/error/cascade_add.h"
#include "sphsolve/error/cascade_next.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/geometry/percolation.h"
#include "sphsolve/geometry/throats.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/plan/reynolds.h"
#include "sphsolve/stokes/soil_response.h"
#include "sphsolve/stokes/output.h"
#include "sphsolve/stokes/solver/step.h"

/* Rounds without progress after which a solve is given up. */
#define STALLED_ROUNDS_MAX 20

/* State of a run, shared by its parts. */
struct stokes_job {
  const struct scene *scene;
  struct recorder *recorder;
  struct run_result *result;
  struct cascade cascade;
  struct lattice lattice;     /* of the most recent solve */
  bool lattice_is_base;       /* `lattice` is the scene's own (base) lattice: not freed here */
  struct h5_file *checkpoint; /* to resume from; NULL: none, or already read */
  long iterations;            /* total on the preceding lattices */
  bool kept;                  /* a checkpoint was written after the interrupt signal */
  double diameter;            /* hydraulic diameter of the pores of `lattice`, m */
  double darcy[3], reynolds, solving, pairs;
};

/* Sets the Darcy velocity (m/s) and the Reynolds number of the job from the solver's solution. */
static void scale_darcy(struct stokes_job *job, const struct stokes_solver *s) {
  const struct fluid *fluid = &job->scene->fluid;
  const struct lattice *l = &job->lattice;
  for (int a = 0; a < 3; a++) job->darcy[a] = s->mean[a] * s->velocity_unit;
  job->reynolds = reynolds_number(job->darcy, (double)l->fluid_count / l->bulk_count, job->diameter,
                                  fluid->viscosity / fluid->density);
}

static enum status write_row(struct stokes_job *job, const struct stokes_solver *s) {
  const struct lattice *lattice = &job->lattice;
  const double rho = job->scene->fluid.density;
  const double volume = lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2];
  const size_t n = s->grid.active;
  struct history_row row = {
      .step = job->iterations + s->iterations, .density_max = rho, .density_mean = rho};
  double square = 0.0;
  for (size_t r = s->grid.row_begin; n > 0 && r < s->grid.row_end; r++)
    for (size_t a = 0; a < (size_t)s->stencil.axis_count; a++)
      for (size_t i = s->grid.row_start[r]; i < s->grid.row_start[r + 1]; i++)
        square += stokes_grid_weight(&s->grid, r) * s->x[a * n + i] * s->x[a * n + i];
  square = ranks_sum(square);
  row.mass = rho * volume * (double)lattice->fluid_count;
  scale_darcy(job, s);
  for (int a = 0; a < 3; a++) {
    row.darcy_velocity[a] = job->darcy[a];
    row.momentum[a] = job->darcy[a] * rho * volume * lattice->bulk_count;
  }
  row.kinetic_energy = 0.5 * rho * volume * square * s->velocity_unit * s->velocity_unit;
  row.reynolds = job->reynolds;
  const double extra[] = {s->residual_now, s->divergence};
  return recorder_row(job->recorder, &row, extra);
}

/* Progress of a solve; a checkpoint stores it with the solution. */
struct progress_state {
  double best; /* smallest relative residual so far */
  int stalled; /* rounds since `best` last fell by 10 % */
};

/* Pair interactions of a solve so far. */
static double pairs_of(const struct stokes_solver *s) {
  return (double)s->iterations * (double)s->grid.active_all * (double)s->stencil.offset_count;
}

/* The numbers of a checkpoint. */
#define NUMBERS 13
static void numbers_of(struct stokes_job *job, struct stokes_solver *s,
                       struct progress_state *state, struct h5_number numbers[NUMBERS]) {
  struct conservation *balance = &job->result->conservation;
  const struct h5_number all[NUMBERS] = {{"mean", H5_F64, 3, s->mean},
                                         {"change", H5_F64, 1, &s->change},
                                         {"residual_before", H5_F64, 1, &s->residual_before},
                                         {"residual_start", H5_F64, 1, &s->residual_start},
                                         {"residual_now", H5_F64, 1, &s->residual_now},
                                         {"divergence", H5_F64, 1, &s->divergence},
                                         {"best", H5_F64, 1, &state->best},
                                         {"stalled", H5_I32, 1, &state->stalled},
                                         {"iterations", H5_I64, 1, &s->iterations},
                                         {"flux_open", H5_F64, 1, &balance->flux_open},
                                         {"force_open", H5_F64, 1, &balance->force_open},
                                         {"power_open", H5_F64, 1, &balance->power_open},
                                         {"k_error", H5_F64, 1, &job->result->k_error}};
  memcpy(numbers, all, sizeof all);
}

/* Writes a checkpoint of a solve in progress or, with `solved`, of the last completed solve. */
static enum status write_checkpoint(struct stokes_job *job, struct stokes_solver *s,
                                    struct progress_state *state, bool solved) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  size_t n = s->grid.active;
  char name[32];
  struct h5_number numbers[NUMBERS];
  const int64_t before = job->iterations - (solved ? s->iterations : 0);
  const double pairs = job->pairs - (solved ? pairs_of(s) : 0.0);
  TRY(recorder_checkpoint_begin(job->recorder, &file));
  for (size_t c = 0; c <= (size_t)s->stencil.axis_count; c++) {
    snprintf(name, sizeof name, "/state/x%zu", c);
    TRY(h5_write_rows(file, name, H5_F64, 1, &n, s->x + c * n, false));
    if (solved) continue;
    snprintf(name, sizeof name, "/state/residual%zu", c);
    TRY(h5_write_rows(file, name, H5_F32, 1, &n, s->residual + c * n, false));
  }
  numbers_of(job, s, state, numbers);
  TRY(h5_write_numbers(file, "/state", NUMBERS, numbers));
  TRY(h5_write_attribute(file, "/state", "before", H5_I64, 1, &before));
  TRY(h5_write_attribute(file, "/state", "pairs", H5_F64, 1, &pairs));
  TRY(cascade_write(&job->cascade, solved, file));
  status = recorder_checkpoint_commit(job->recorder, file); /* takes the file over */
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

/* Reads the solve stored in job->checkpoint, and closes that file. *solved: the solve was
 * complete. */
static enum status read_checkpoint(struct stokes_job *job, struct stokes_solver *s,
                                   struct progress_state *state, bool *solved) {
  enum status status = STATUS_OK;
  struct h5_file *file = job->checkpoint;
  double *x = NULL;
  float *residual = NULL;
  size_t length = s->grid.active;
  char name[32];
  struct h5_number numbers[NUMBERS];
  int rank;
  size_t rows[1];
  TRY(h5_shape(file, "/state/x0", 1, &rank, rows));
  if (rank != 1 || rows[0] != s->grid.active_all)
    TRY_FAIL(STATUS_INPUT,
             "%s: is of a run on other lattices; go on with the --error, --time or lattice.spacing "
             "that it had, or remove it to start anew",
             h5_path(file));
  *solved = !h5_exists(file, "/state/residual0");
  for (size_t c = 0; c <= (size_t)s->stencil.axis_count; c++) {
    snprintf(name, sizeof name, "/state/x%zu", c);
    TRY(h5_read_rows(file, name, H5_F64, 1, s->grid.active_all, s->grid.offset, &length, &x));
    if (length > 0) memcpy(s->x + c * length, x, length * sizeof *x);
    memory_free(&x);
    if (*solved) continue;
    snprintf(name, sizeof name, "/state/residual%zu", c);
    TRY(h5_read_rows(file, name, H5_F32, 1, s->grid.active_all, s->grid.offset, &length,
                     &residual));
    if (length > 0) memcpy(s->residual + c * length, residual, length * sizeof *residual);
    memory_free(&residual);
  }
  numbers_of(job, s, state, numbers);
  TRY(h5_read_numbers(file, "/state", NUMBERS, numbers));
  TRY(h5_read_attribute(file, "/state", "before", H5_I64, 1, &job->iterations));
  TRY(h5_read_attribute(file, "/state", "pairs", H5_F64, 1, &job->pairs));
  job->result->conservation.steady = *solved;
cleanup:
  MEMORY_FREE(&x, &residual);
  h5_close(file);
  job->checkpoint = NULL;
  return status;
}

/* Whether an interrupted solve itself provides the reported k: only on the first lattice. On later
 * lattices k is the estimate from the preceding ones, whose error is known. */
static bool is_reported(const struct stokes_job *job) {
  return job->cascade.uncertainty.level_count == 0;
}

/* Iterates in rounds until the solve converges, is interrupted or stalls. *solved: the checkpoint
 * held a completed solve, whose conservation budget is known. */
static enum status solve(struct stokes_job *job, struct stokes_solver *s, bool *solved) {
  enum status status = STATUS_OK;
  const struct stokes_goal goal = cascade_goal(&job->cascade);
  const struct stokes_solver *coarse = &job->cascade.coarse;
  struct progress_state state = {.best = INFINITY};
  *solved = false;
  if (job->checkpoint != NULL) {
    TRY(read_checkpoint(job, s, &state, solved));
    scale_darcy(job, s);
    if (*solved) return STATUS_OK;
  } else {
    TRY(write_row(job, s));
  }
  while (!stokes_solver_converged(s, &goal)) {
    const bool stopped = recorder_interrupted(job->recorder);
    /* Interrupted before the first round: the coarser solution is as good, and is written
     * faster. */
    if (stopped && s->iterations == 0 && coarse->grid.active_all > 0) {
      TRY(recorder_drop_row(job->recorder));
      scale_darcy(job, coarse);
      return FAIL(STATUS_INTERRUPTED, "interrupted");
    }
    if (stopped || recorder_checkpoint_due(job->recorder))
      TRY(write_checkpoint(job, s, &state, false));
    if (stopped) {
      job->kept = true;
      return FAIL(STATUS_INTERRUPTED, "interrupted at a residual of %.1e; go on with --resume",
                  s->residual_now);
    }
    char note[80];
    const double started = clock_seconds();
    if (!stokes_solver_round(s)) continue; /* interrupted */
    job->solving += clock_seconds() - started;
    recorder_add_time(job->recorder, "stokes_solve", clock_seconds() - started);
    TRY(write_row(job, s));
    const double error = fmin(1.0, stokes_solver_mean_error(s));
    snprintf(note, sizeof note, "k to %.1e, residual %.1e, Darcy velocity %.4g m/s", error,
             s->residual_now, hypot(hypot(job->darcy[0], job->darcy[1]), job->darcy[2]));
    recorder_progress(job->recorder,
                      fmin(1.0, goal.residual > 0.0 ? log(s->residual_now) / log(goal.residual)
                                                    : log(error) / log(goal.mean)),
                      note);
    state.stalled = s->residual_now < STALLED_REDUCTION * state.best ? 0 : state.stalled + 1;
    state.best = fmin(state.best, s->residual_now);
    if (state.stalled == STALLED_ROUNDS_MAX) {
      char soil[STOKES_HINT];
      stokes_solver_soil_hint(s, soil);
      TRY_FAIL(STATUS_NUMERIC,
               "%s: no progress after %ld iterations at a residual of %.1e%s; stokes.tolerance = "
               "%.1g accepts it",
               job->scene->path, s->iterations, s->residual_now, soil, 2.0 * s->residual_now);
    }
  }
cleanup:
  return status;
}

static void report_level(const struct cascade *c) {
  const struct uncertainty *u = &c->uncertainty;
  if (c->fixed > 0 || u->level_count == 0) return;
  const struct error_level *l = &u->levels[u->level_count - 1];
  const struct effect_context *context = &c->plan->context;
  const double to_speed =
      context->driving / context->kinematic_viscosity / scene_hydraulic_gradient(c->scene);
  char known[80] = " cm/s, no estimate from one lattice";
  if (isfinite(l->low)) {
    const double low = 100 * fmin(u->resolution_low, 1.0), high = 100 * u->resolution_high;
    const int n =
        snprintf(known, sizeof known, ", estimate %.4g cm/s ", 100 * to_speed * l->estimate);
    const int digits = fmax(low, high) < 99.5 ? 2 : 3;
    if (fabs(low - high) < 0.05 * high)
      snprintf(known + n, sizeof known - (size_t)n, "+- %.*g %%", digits, high);
    else
      snprintf(known + n, sizeof known - (size_t)n, "-%.*g +%.*g %%", digits, low, digits, high);
  }
  log_info("lattice %d: %.4g um, %.3g M points: k %.4g%s; %.2g s, the next about %.2g s",
           u->level_count, 1e6 * l->spacing, 1e-6 * l->sites, 100 * to_speed * l->permeability,
           known, l->seconds, cascade_next_seconds(c));
  level_bar_show(u, to_speed);
}

/* Computes the response of k to the permeability of the soil, and its contribution to the
 * uncertainty of k. */
static enum status measure_soil(struct stokes_job *job, struct stokes_solver *s) {
  struct uncertainty *u = &job->cascade.uncertainty;
  struct micropores_point *point = &job->result->micropores.own;
  const enum status status = soil_response_measure(s, &job->lattice, point);
  u->slope_micro = point->slope;
  const double unsure = soil_response_uncertainty(job->scene, &job->lattice.model);
  if (unsure > 0.0) u->micro = (1.0 + SOIL_SLOPE_SMALL) * fabs(point->slope) * unsure;
  return status;
}

/* Solves one lattice of the cascade, from its sites to its k. The cascade takes the solver's
 * solution, also from an interrupted solve that was checkpointed; otherwise the solution of the
 * preceding lattice remains. */
static enum status solve_level(struct stokes_job *job, double spacing) {
  enum status status = STATUS_OK;
  struct cascade *c = &job->cascade;
  struct stokes_solver s = {0};
  struct lattice next = {0};
  bool is_base, solved, built = false;
  const double started = clock_processor_seconds();
  TRY(cascade_lattice(c, spacing, &next, &is_base));
  if (!lattice_holds_fluid(&next)) {
    cascade_skip(c);
    if (!is_base) lattice_free(&next);
    return STATUS_OK;
  }
  if (!job->lattice_is_base) lattice_free(&job->lattice);
  job->lattice = next;
  job->lattice_is_base = is_base;
  job->diameter = hydraulic_diameter(&job->lattice);
  TRY(cascade_solver(c, &job->lattice, &s));
  built = true;
  if (s.grid.flowing < job->lattice.fluid_count && s.grid.flowing > 0)
    log_verbose("%zu of %zu pore points lie in pores that do not lead through",
                job->lattice.fluid_count - s.grid.flowing, job->lattice.fluid_count);
  if (s.grid.active_all > 0) {
    status = solve(job, &s, &solved);
    if (status == STATUS_INTERRUPTED && !job->kept) built = false; /* keep the coarser solution */
    if ((status == STATUS_OK && !solved) || (job->kept && is_reported(job))) {
      const enum status balanced = stokes_balance(&s, &job->result->conservation);
      if (status == STATUS_OK) status = balanced;
    }
    TRY(status);
  } else {
    TRY(write_row(job, &s));
  }
  TRY(cascade_add(c, &job->lattice, spacing, &s, clock_processor_seconds() - started));
  report_level(c);
cleanup:
  if (built && (status == STATUS_OK || status == STATUS_INTERRUPTED)) {
    job->iterations += s.iterations;
    job->pairs += pairs_of(&s);
    recorder_set_fact(job->recorder, "residual", s.residual_now);
    recorder_set_fact(job->recorder, "divergence", s.divergence);
    recorder_set_fact(job->recorder, "iterations", (double)s.iterations);
    recorder_set_fact(job->recorder, "sites_solved", (double)s.grid.active_all);
    if (RANKS)
      recorder_set_fact(job->recorder, "imbalance",
                        s.grid.slabs.start ? s.grid.slabs.imbalance : 1);
    if (!job->kept || is_reported(job))
      job->result->k_error = s.grid.active_all > 0 ? stokes_solver_mean_error(&s) : 0.0;
    /* Must come last: it overwrites all of the solver but the solution. */
    const bool last = c->fixed == 0 || c->tried == c->fixed;
    if (status == STATUS_OK && s.grid.active_all > 0 && job->lattice.micro_porosity != NULL && last)
      status = measure_soil(job, &s);
    cascade_keep(c, &s);
  }
  stokes_solver_free(&s);
  return status;
}

/* The reported k is the estimate extrapolated from all lattices where there is one, not the value
 * of the finest lattice. */
static void set_result(struct stokes_job *job) {
  struct run_result *result = job->result;
  const struct uncertainty *u = &job->cascade.uncertainty;
  result_from_darcy(job->scene, job->darcy, result);
  result->error = *u;
  result->error.averaging = 0.0;
  result->error.steadiness = result->k_error;
  result->k_finest = result->k;
  result->reynolds = job->reynolds;
  result->gradient = scene_hydraulic_gradient(job->scene);
  if (!(u->extrapolated > 0.0 && u->finest > 0.0)) return;
  const double current = job->kept ? result->intrinsic_permeability : u->finest;
  if (!(current > 0.0)) return;
  const double scale = u->extrapolated / current;
  result->k_finest *= u->finest / current;
  result->k *= scale;
  result->intrinsic_permeability *= scale;
  for (int a = 0; a < 3; a++) result->darcy_velocity[a] *= scale;
  result->reynolds *= scale;
}

/* After an interrupt outside a solve: writes a checkpoint with the last completed solve, from which
 * --resume continues. */
static enum status keep_solved(struct stokes_job *job) {
  struct stokes_solver *s = &job->cascade.coarse;
  struct progress_state none = {.best = INFINITY};
  error_clear();
  /* If it has not been read yet, the checkpoint with which the run began stays valid. */
  if (job->checkpoint != NULL) return FAIL(STATUS_INTERRUPTED, "interrupted; go on with --resume");
  if (s->grid.active_all == 0)
    return FAIL(STATUS_INTERRUPTED, "interrupted in the set-up: there is nothing to go on from");
  const enum status status = write_checkpoint(job, s, &none, true);
  if (status != STATUS_OK) return status;
  /* Its k is known, but not yet all other parts of its error. */
  return FAIL(STATUS_INTERRUPTED, "interrupted in lattice %d; go on with --resume",
              job->cascade.tried);
}

/* Adds the effect of the soil on k to the result. */
static enum status add_micropores(struct stokes_job *job) {
  struct run_result *result = job->result;
  struct micropores *m = &result->micropores;
  if (job->lattice.micro_porosity == NULL || !(result->k > 0.0)) return STATUS_OK;
  soil_response_describe(&job->lattice, m);
  if (m->own.connected == 0.0)
    log_warning("%s: no soil with pores below the voxel lies on a path along the force: it carries "
                "nothing, and k is that of the pores alone",
                job->scene->path);
  return soil_response_curve(&job->cascade, &job->lattice, result->k, m);
}

static enum status run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  const char *why = "converged";
  double spacing;
  struct lattice base = *lattice;
  struct stokes_job job = {
      .scene = scene, .recorder = recorder, .result = result, .lattice_is_base = true};
  TRY(recorder_add_column(recorder, "residual", "1", 1));
  TRY(recorder_add_column(recorder, "divergence", "1", 1));
  cascade_begin(scene, plan, &base, &job.cascade);
  TRY(recorder_resume(recorder, &job.checkpoint));
  if (job.checkpoint != NULL) TRY(cascade_read(&job.cascade, job.checkpoint));
  while (status == STATUS_OK && cascade_next(&job.cascade, &spacing, &why))
    status = solve_level(&job, spacing);
  if (status == STATUS_OK) status = cascade_finish(&job.cascade);
  /* With --time, the effect of the sides is computed last; including it, the error may exceed the
   * one asked for, so that further lattices are solved. */
  while (status == STATUS_OK && cascade_next(&job.cascade, &spacing, &why))
    status = solve_level(&job, spacing);
  if (status != STATUS_OK && status != STATUS_INTERRUPTED) goto cleanup;
  const bool solved = job.cascade.coarse.grid.active_all > 0;
  const bool blocked = status == STATUS_OK && !solved;
  if (blocked) log_warning("%s: %s", scene->path, percolation_none(&base));
  if (status == STATUS_OK) result->status = blocked ? "blocked" : why;
  result->ended = strcmp(why, "converged") != 0 ? job.cascade.ended : NULL;
  if (status == STATUS_OK && !job.lattice_is_base && log_level() >= LOG_VERBOSE) {
    struct throats throats;
    TRY(throats_compare(&base, &job.lattice, &throats));
    log_verbose("the last lattice closes %zu throats of the model's and opens %zu", throats.closed,
                throats.opened);
  }
  if (solved || blocked) set_result(&job);
  if (status == STATUS_OK) status = add_micropores(&job);
  if (status == STATUS_OK)
    status = stokes_write_snapshot(scene, &job.lattice, &job.cascade.coarse, recorder);
  /* After an interrupt the user waits: the checkpoint has the solution, and the resumed run writes
   * the snapshot. */
  if (status == STATUS_INTERRUPTED && !job.kept) status = keep_solved(&job);
  if (status == STATUS_INTERRUPTED) result->status = "interrupted";
  result->steps = job.iterations;
  result->iterates = true;
  result->pair_interactions = job.pairs;
  if (job.solving > 0.0) result->pair_interactions_per_second = job.pairs / job.solving;
  if (result->reynolds > 1.0 && !scene->wants_slow_k)
    log_warning("%s: Re = %.2g, but method stokes leaves inertia out; %s", scene->path,
                result->reynolds,
                lattice->micro_porosity != NULL ? "lower the hydraulic gradient"
                                                : "run method = \"wcsph\"");
  result->inertia_from_gradient = reynolds_inertia_gradient(
      result->intrinsic_permeability, (double)base.fluid_count / base.bulk_count,
      plan->context.kinematic_viscosity);
  recorder_count_traffic(recorder);
cleanup:
  h5_close(job.checkpoint);
  cascade_end(&job.cascade);
  /* The caller's record describes the lattice that was solved last. */
  if (!job.lattice_is_base && job.lattice.count > 0) {
    lattice_free(&base);
    *lattice = job.lattice;
  }
  return status;
}

static bool takes(const struct effect_context *context, char why[EFFECT_WHY]) {
  const bool soil = context->lattice != NULL && context->lattice->micro_porosity != NULL;
  if (!(context->has_wall || soil) || context->scene->steady_tolerance == 0 ||
      context->has_moving_wall)
    return false;
  const bool creeps = context->reynolds < REYNOLDS_CREEPING;
  if (creeps)
    snprintf(why, EFFECT_WHY, "the flow creeps: Re about %.2g is below %g, and nothing moves",
             context->reynolds, REYNOLDS_CREEPING);
  else if (context->scene->wants_slow_k && *context->scene->model_path)
    snprintf(why, EFFECT_WHY,
             "--error and --time ask for the k of slow flow; Re about %.2g is not below %g, and "
             "inertia is left out",
             context->reynolds, REYNOLDS_CREEPING);
  else if (soil)
    snprintf(
        why, EFFECT_WHY,
        "no other method takes the model's soil; Re about %.2g is not below %g, and inertia is "
        "left out",
        context->reynolds, REYNOLDS_CREEPING);
  return creeps || soil || (context->scene->wants_slow_k && *context->scene->model_path);
}

static enum wall_scheme wall(const struct scene *scene) {
  return scene->stokes.wall;
}

static const char *wall_name(const struct scene *scene) {
  return wall_scheme_names[scene->stokes.wall];
}

const struct method method_stokes = {.name = "stokes",
                                     .effects = stokes_effects,
                                     .constants = stokes_constants,
                                     .resolves_pores = true,
                                     .solves_creeping = true,
                                     .takes_soil = true,
                                     .wall_layers = 4,
                                     .takes = takes,
                                     .expect = error_expect,
                                     .scales = stokes_scales,
                                     .cost = stokes_cost,
                                     .wall_name = wall_name,
                                     .wall = wall,
                                     .error_flat = 5e-6, /* error left by the solver */
                                     .error_flat_why =
                                         "parallel flat walls: exact but for the solver",
                                     /* set on sands: 18 % of k at 4 sites across a
                                      * mean pore, 7 % at 7.5; smooth bodies have less */
                                     .error_narrow = 0.018,
                                     .error_narrow_order = 1.85,
                                     .bytes_least = stokes_bytes_least,
                                     .levels = cascade_levels,
                                     .run = run};
