/* Method wcsph: weakly compressible SPH, explicit in time. */
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/method.h"
#include "sphsolve/methods/wcsph_plan.h"
#include "sphsolve/methods/wcsph_state.h"
#include "sphsolve/percolation.h"

/* Samples of the Darcy velocity per viscous time of a mean pore, gap^2/nu; and the fewest before
 * a flow may be called steady: the slowest mode of a slit has then died to 1e-7. */
#define SAMPLES_PER_PORE_TIME 50.0
#define SAMPLES_LEAST 80

struct run {
  const struct scene *scene;
  const struct plan *plan;
  const struct lattice *lattice;
  struct recorder *recorder;
  struct wcsph_state state;
  struct wcsph_copy copy;
  int64_t last_step;
  double wall_speed;   /* m/s, the largest */
  double row_interval; /* s; NAN: each sample */
  double pore_width;   /* m */
  double direction[3]; /* of the force, or of the first moving wall */
  double started;
};

static double run_time(const struct run *run) {
  return wcsph_time(&run->state);
}

static double particle_volume(const struct lattice *lattice) {
  return lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2];
}

/* Densities between half and one and a half of that at rest: beyond, a pressure proportional to
 * the change of density means nothing. */
#define DENSITY_BAND 0.5
/* Speeds up to that of sound, energy beyond an eighth of it (2 m/s at 16): see watchdog.h. */
#define ENERGY_FLOOR 0.125
/* A state to go back to is kept while so much of a bound is used, or the step is so near its limit,
 * or the start is not rest. */
#define KEEP_FROM 0.1
#define KEEP_NEAR_LIMIT 0.85
/* A particle may pass so much of h a step (automatic step only). */
#define ADVECTION 0.25

static enum watch_bound judge(struct run *run, const struct wcsph_totals *totals, double *share) {
  struct watch_reading reading = {{0}};
  double c = run->state.engine.settings.sound_speed;
  double count = (double)run->lattice->fluid_count;
  double energy = sqrt((totals->square + c * c * totals->compression) / count);
  reading.share[WATCH_DENSITY] =
      fmax(totals->density_max - 1, 1 - totals->density_min) / DENSITY_BAND;
  reading.share[WATCH_VELOCITY] = totals->speed_max / c;
  reading.share[WATCH_ENERGY] =
      watchdog_energy(&run->state.dog, energy, run_time(run), run->plan->context.driving,
                      run->wall_speed, ENERGY_FLOOR * c);
  if (!totals->finite) reading.share[WATCH_DENSITY] = INFINITY;
  return watchdog_worst(&reading, share);
}

/* What left its bounds, which particle, where; and why, most likely. */
static void describe(const struct run *run, enum watch_bound bound,
                     const struct wcsph_totals *totals, char what[160]) {
  const struct engine *engine = &run->state.engine;
  double high = totals->density_max - 1, low = 1 - totals->density_min, at[3];
  size_t slot = bound != WATCH_DENSITY ? totals->fastest
                : low > high           ? totals->thinnest
                                       : totals->densest;
  particles_position(&engine->particles, run->lattice, slot, at);
  if (bound == WATCH_DENSITY)
    snprintf(what, 160, "density of particle %u at (%.4g, %.4g, %.4g) m is %.3g times that at rest",
             engine->particles.id[slot], at[0], at[1], at[2], low > high ? 1 - low : 1 + high);
  else
    snprintf(what, 160, "%s: particle %u at (%.4g, %.4g, %.4g) m moves at %.3g m/s",
             watchdog_name(bound), engine->particles.id[slot], at[0], at[1], at[2],
             totals->speed_max);
}

static enum status write_checkpoint(struct run *run);

/* Back to the last good state with half the step; after three times the run ends with that state in
 * its checkpoint. */
static enum status step_back(struct run *run, double time, const char *what) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct step_back back = {.time = time};
  const struct plan *plan = run->plan;
  bool go_on = watchdog_trip(&state->dog, time), kept = state->dog.kept;
  if (kept) {
    TRY(wcsph_go_back(&run->copy, state));
    recorder_go_back(run->recorder, run->copy.time);
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
  const char *cause = plan->dt > 0.9 * plan->dt_limit
                          ? "the time step is near or beyond its limit; use wcsph.dt = \"auto\""
                      : plan->context.driving * plan->dt > 0.1 * state->engine.settings.sound_speed
                          ? "the force is too strong for this sound speed; raise wcsph.sound_speed"
                          : "the sound speed is too low for this force; raise wcsph.sound_speed";
  char saved[4200] = "";
  if (kept) {
    TRY(write_checkpoint(run));
    snprintf(saved, sizeof saved, "; %s holds the last good state, t = %g s",
             recorder_checkpoint_name(run->recorder), run->copy.time);
  }
  status =
      FAIL(STATUS_NUMERIC,
           "step %lld, t = %g s: %s, after %d halvings of the time step: %s (dt %g s, limit %g "
           "s, sound speed %g m/s)%s",
           (long long)state->step, time, what, state->dog.halvings, cause,
           state->engine.settings.dt, plan->dt_limit, state->engine.settings.sound_speed, saved);
cleanup:
  return status;
}

/* The step that velocities allow: particles do not pass each other in one. */
static void adapt(struct run *run) {
  struct wcsph_state *state = &run->state;
  double h = state->engine.settings.smoothing_length, speed = state->engine.speed_max;
  if (!isnan(run->scene->wcsph.dt)) return;
  if (speed * state->engine.settings.dt > ADVECTION * h)
    wcsph_halve(state);
  else if (state->halvings > state->dog.halvings &&
           3 * speed * state->engine.settings.dt < ADVECTION * h)
    wcsph_double(state);
}

static const char *limiting_effect(const struct run *run) {
  const struct wcsph_state *state = &run->state;
  return state->halvings == 0                    ? run->plan->dt_by
         : state->halvings > state->dog.halvings ? "advection"
                                                 : "watchdog";
}

static void set_last_step(struct run *run) {
  double last =
      ceil((run->scene->end_time - run->state.time_from) / run->state.engine.settings.dt - 1e-6);
  run->last_step = run->state.step_from + (last < 9e15 ? (int64_t)last : (int64_t)9e15);
}

/* Looks at the state, keeps it if it is good, goes back if it is not (*again). */
static enum status watch(struct run *run, bool *again) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct wcsph_totals totals;
  double share;
  char what[160];
  *again = false;
  TRY(wcsph_sum(&state->engine, &totals));
  enum watch_bound worst = judge(run, &totals, &share);
  if (share >= 1) {
    describe(run, worst, &totals, what);
    *again = true;
    TRY(step_back(run, run_time(run), what));
  } else {
    bool keep = share > KEEP_FROM || run->plan->dt > KEEP_NEAR_LIMIT * run->plan->dt_limit;
    if (keep && watchdog_wants(&state->dog, state->step, share)) {
      TRY(wcsph_keep(state, &run->copy));
      watchdog_keep(&state->dog, state->step, share);
    }
    adapt(run);
  }
  set_last_step(run);
cleanup:
  return status;
}

static enum status write_row(struct run *run, const struct wcsph_totals *totals) {
  const struct lattice *lattice = run->lattice;
  double density = run->scene->fluid.density, mass = density * particle_volume(lattice);
  struct history_row row = {
      .time = run_time(run), .step = run->state.step, .dt = run->state.engine.settings.dt};
  double square = 0;
  for (int a = 0; a < 3; a++) {
    row.darcy_velocity[a] = totals->flux[a] / (double)lattice->bulk_count;
    row.momentum[a] = mass * totals->velocity[a];
    square += row.darcy_velocity[a] * row.darcy_velocity[a];
  }
  row.density_max = density * totals->density_max;
  row.density_mean = density * totals->density / (double)lattice->fluid_count;
  row.kinetic_energy = 0.5 * mass * totals->square;
  row.mass = mass * (double)lattice->fluid_count;
  row.reynolds = isfinite(run->pore_width)
                     ? sqrt(square) * run->pore_width / run->plan->context.kinematic_viscosity
                     : 0;
  return recorder_row(run->recorder, &row, NULL);
}

/* Fields of a snapshot, one at a time: a run's memory is the engine's. */
static void fill_points(const void *context, void *data) {
  const struct run *run = context;
  const struct particles *p = &run->state.engine.particles;
  double *point = data;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    particles_position(p, run->lattice, i, point);
    point += 3;
  }
}
static void fill_velocity(const void *context, void *data) {
  const struct particles *p = &((const struct run *)context)->state.engine.particles;
  float *velocity = data;
  for (size_t i = 0; i < particles_slots(p); i++)
    for (int a = 0; a < 3 && p->id[i] != NO_PARTICLE; a++) *velocity++ = p->v[a][i];
}
static void fill_pressure(const void *context, void *data) {
  const struct run *run = context;
  const struct engine *engine = &run->state.engine;
  double c = engine->settings.sound_speed, unit = run->scene->fluid.density * c * c;
  float *pressure = data;
  for (size_t i = 0; i < particles_slots(&engine->particles); i++)
    if (engine->particles.id[i] != NO_PARTICLE)
      *pressure++ = (float)(unit * engine_pressure(engine, i));
}
static void fill_density(const void *context, void *data) {
  const struct run *run = context;
  const struct engine *engine = &run->state.engine;
  float *density = data;
  for (size_t i = 0; i < particles_slots(&engine->particles); i++)
    if (engine->particles.id[i] != NO_PARTICLE)
      *density++ = (float)(run->scene->fluid.density * engine_density(engine, i));
}
static void fill_id(const void *context, void *data) {
  const struct particles *p = &((const struct run *)context)->state.engine.particles;
  uint32_t *id = data;
  for (size_t i = 0; i < particles_slots(p); i++)
    if (p->id[i] != NO_PARTICLE) *id++ = p->id[i];
}

static enum status write_snapshot(struct run *run) {
  const struct snapshot_field points = {
      .type = H5_F64, .components = 3, .fill = fill_points, .context = run};
  const struct snapshot_field fields[] = {
      {"velocity", "m/s", "fluid velocity", H5_F32, 3, NULL, fill_velocity, run},
      {"pressure", "Pa", "pressure over that of the fluid at rest", H5_F32, 1, NULL, fill_pressure,
       run},
      {"density", "kg/m^3", "density", H5_F32, 1, NULL, fill_density, run},
      {"id", "1", "site the particle started from", H5_U32, 1, NULL, fill_id, run},
  };
  engine_drop_lists(&run->state.engine);
  return recorder_snapshot(run->recorder, run_time(run), run->state.step,
                           run->state.engine.particles.count, &points,
                           sizeof fields / sizeof *fields, fields);
}

static enum status write_checkpoint(struct run *run) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(recorder_checkpoint_begin(run->recorder, &file));
  TRY(wcsph_write_state(&run->state, file));
  struct h5_file *whole = file;
  file = NULL;
  TRY(recorder_checkpoint_commit(run->recorder, whole));
cleanup:
  h5_close(file);
  return status;
}

static enum status read_checkpoint(struct run *run, bool *resumed) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(recorder_resume(run->recorder, &file));
  *resumed = file != NULL;
  if (file != NULL) TRY(wcsph_read_state(file, &run->state));
cleanup:
  h5_close(file);
  return status;
}

static void set_direction(struct run *run) {
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

/* The Darcy velocity along the force first, it decides; then its components. */
static void sample_of(const struct run *run, const struct wcsph_totals *totals,
                      double value[MONITOR_COMPONENTS]) {
  double n = (double)run->lattice->bulk_count;
  value[0] = 0;
  for (int a = 0; a < 3; a++) {
    value[1 + a] = totals->flux[a] / n;
    value[0] += value[1 + a] * run->direction[a];
  }
}

/* The live line: k so far and where it goes, density, speed. Without an end the share done is that
 * of the steps planned, or of the orders of magnitude that the error has come down. */
static void show_progress(const struct run *run, double velocity,
                          const struct monitor_verdict *verdict,
                          const struct wcsph_totals *totals) {
  char note[128], error[32] = "";
  const double mean = verdict->mean[0], tolerance = run->scene->steady_tolerance;
  const double *s = run->state.engine.seconds;
  const double seconds = s[PHASE_DENSITY] + s[PHASE_WALL] + s[PHASE_FORCE] + s[PHASE_CONTINUITY];
  if (isfinite(verdict->error)) snprintf(error, sizeof error, " +- %.2g %%", 100 * verdict->error);
  const char *trend = !(fabs(velocity - mean) > verdict->error * fabs(mean)) ? ""
                      : velocity > mean                                      ? " rising"
                                                                             : " falling";
  snprintf(note, sizeof note, "k %.4g cm/s%s%s, density %+.2f %%, %.0f M pairs/s",
           100 * mean / scene_hydraulic_gradient(run->scene), error, trend,
           100 * (totals->density_max - 1),
           seconds > 0 ? run->state.engine.pair_interactions / seconds / 1e6 : 0);
  const double steps = fmin((double)run->last_step, run->plan->steps);
  double done = fmin((double)run->state.step / steps, 0.95);
  if (tolerance > 0 && verdict->error < 1) done = fmax(done, log(verdict->error) / log(tolerance));
  recorder_progress(run->recorder, fmin(done, 0.99), note);
}

static enum status sample(struct run *run, struct monitor_verdict *verdict) {
  enum status status = STATUS_OK;
  struct wcsph_totals totals;
  double value[MONITOR_COMPONENTS];
  TRY(wcsph_sum(&run->state.engine, &totals));
  sample_of(run, &totals, value);
  TRY(monitor_add(&run->state.monitor, value));
  if (isnan(run->row_interval)) TRY(write_row(run, &totals));
  *verdict = monitor_judge(&run->state.monitor, run->scene->steady_tolerance, SAMPLES_LEAST);
  show_progress(run, value[0], verdict, &totals);
cleanup:
  return status;
}

/* Pressures c^2 rho hold the particles in a lattice that only strains (docs/physics_wcsph.md):
 * where the flow that Kozeny and Carman expect would have carried them four spacings, and they have
 * not come half a spacing far, they are locked. */
static bool locked(const struct run *run) {
  const struct wcsph_state *state = &run->state;
  const struct effect_context *context = &run->plan->context;
  if (run->scene->wcsph.equation_of_state != EOS_ABSOLUTE ||
      run->scene->wcsph.wall != WALL_FROZEN || state->monitor.count == 0)
    return false;
  double pores = (double)run->lattice->fluid_count / (double)run->lattice->bulk_count, sum = 0;
  for (size_t i = 0; i < state->monitor.count; i++) sum += state->monitor.rows[i][0];
  double time = run_time(run), way = sum / (double)state->monitor.count * time / pores;
  return context->velocity_scale * time / pores > 4 * context->spacing &&
         fabs(way) < 0.5 * context->spacing;
}

static enum status march(struct run *run, struct run_result *result) {
  enum status status = STATUS_OK;
  struct wcsph_state *state = &run->state;
  struct monitor_verdict verdict =
      monitor_judge(&state->monitor, run->scene->steady_tolerance, SAMPLES_LEAST);
  result->status = "end_time";
  while (state->step < run->last_step) {
    if (recorder_interrupted(run->recorder) || recorder_checkpoint_due(run->recorder)) {
      bool stop = recorder_interrupted(run->recorder);
      TRY(write_checkpoint(run));
      if (stop) {
        result->status = "interrupted";
        status = FAIL(STATUS_INTERRUPTED, "interrupted at step %lld, t = %g s; go on with --resume",
                      (long long)state->step, run_time(run));
        break;
      }
    }
    bool again = false;
    step_log_limit(recorder_step_log(run->recorder), limiting_effect(run));
    status = engine_step(&state->engine);
    state->step++;
    if (status == STATUS_NUMERIC) {
      char what[160];
      snprintf(what, sizeof what, "%.*s", 159, error_message());
      error_clear();
      TRY(step_back(run, run_time(run), what));
      set_last_step(run);
      continue;
    }
    if (status != STATUS_OK) goto cleanup;
    bool due = wcsph_sample_due(state);
    if (state->step % WATCH_STEPS == 0 || due || state->step == run->last_step)
      TRY(watch(run, &again));
    if (again) continue;
    double time = run_time(run), half = 0.5 * state->engine.settings.dt;
    if (!isnan(run->row_interval) && time >= state->next_row - half) {
      struct wcsph_totals totals;
      TRY(wcsph_sum(&state->engine, &totals));
      TRY(write_row(run, &totals));
      while (state->next_row <= time + half) state->next_row += run->row_interval;
    }
    if (time >= recorder_next_snapshot(run->recorder) - half && state->step < run->last_step)
      TRY(write_snapshot(run));
    if (due || state->step == run->last_step) {
      TRY(sample(run, &verdict));
      if (run->scene->steady_tolerance > 0 && verdict.steady) {
        result->status = "steady";
        break;
      }
    }
  }
  result_from_darcy(run->scene, verdict.mean + 1, result);
  result->k_error = isfinite(verdict.error) ? verdict.error : NAN;
  if (isfinite(verdict.error)) {
    result->error.steadiness = verdict.drift;
    result->error.averaging =
        sqrt(fmax(0, verdict.error * verdict.error - verdict.drift * verdict.drift));
  }
  if (status == STATUS_OK && locked(run)) {
    log_warning("the particles have locked into a crystal that does not flow, as the pressure "
                "c^2 rho makes them below its strength; there is no k: write "
                "wcsph.equation_of_state = \"gauge\"");
    result->status = "crystal";
    result->k = result->k_error = result->intrinsic_permeability = NAN;
  }
cleanup:
  return status;
}

/* The terms of the force share one loop: its time goes to them by their vector operations. That of
 * the offset, distance and slope, which each would need alone, is the pressure's. */
static void add_force_times(const struct run *run, double seconds) {
  const struct engine_settings *s = &run->state.engine.settings;
  const struct {
    const char *name;
    bool on;
    double operations;
  } terms[] = {{"pressure_symmetric", s->wall == PASS_FROZEN, 32},
               {"pressure_difference", s->wall != PASS_FROZEN, 32},
               {"viscosity_morris", s->viscosity, 6},
               {"shifting", s->shift, 10}};
  double all = 0;
  for (int i = 0; i < 4; i++) all += terms[i].on ? terms[i].operations : 0;
  for (int i = 0; i < 4; i++)
    if (terms[i].on)
      recorder_add_time(run->recorder, terms[i].name, seconds * terms[i].operations / all);
}

static void finish(struct run *run, struct run_result *result) {
  const struct engine *engine = &run->state.engine;
  const double *s = engine->seconds;
  double pair_time = s[PHASE_DENSITY] + s[PHASE_WALL] + s[PHASE_FORCE] + s[PHASE_CONTINUITY];
  result->steps = run->state.step;
  result->ledger = (struct ledger){.known = true, .start = run->lattice->fluid_count};
  for (size_t i = 0; i < particles_slots(&engine->particles); i++)
    result->ledger.end += engine->particles.id[i] != NO_PARTICLE;
  result->wall_time = clock_seconds() - run->started;
  result->pair_interactions = engine->pair_interactions;
  result->pair_interactions_per_second = pair_time > 0 ? engine->pair_interactions / pair_time : 0;
  double square = 0;
  for (int a = 0; a < 3; a++) square += result->darcy_velocity[a] * result->darcy_velocity[a];
  result->reynolds = isfinite(run->pore_width)
                         ? sqrt(square) * run->pore_width / run->plan->context.kinematic_viscosity
                         : 0;
  bool frozen = engine->settings.wall == PASS_FROZEN;
  recorder_add_time(run->recorder, frozen ? "density_summation" : "density_continuity",
                    s[PHASE_DENSITY] + s[PHASE_CONTINUITY]);
  if (s[PHASE_WALL] > 0)
    recorder_add_time(run->recorder,
                      engine->settings.wall == PASS_ADAMI ? "wall_adami" : "wall_subvoxel",
                      s[PHASE_WALL]);
  add_force_times(run, s[PHASE_FORCE]);
  recorder_add_time(run->recorder, "drift", s[PHASE_DRIFT]);
  recorder_add_time(run->recorder, "neighbour_lists", s[PHASE_LISTS]);
  recorder_set_fact(run->recorder, "list_rebuilds", (double)engine->rebuilds);
  recorder_set_fact(run->recorder, "method_peak_bytes", (double)memory_peak());
  recorder_set_fact(run->recorder, "pairs_per_pass", (double)engine->pairs_fluid);
}

enum status wcsph_run(const struct scene *scene, const struct plan *plan,
                      const struct lattice *lattice, struct recorder *recorder,
                      struct run_result *result) {
  enum status status = STATUS_OK;
  struct run run = {.scene = scene, .plan = plan, .lattice = lattice, .recorder = recorder};
  double(*region_velocity)[3] = NULL;
  struct engine_settings settings;
  struct wcsph_totals totals;
  bool flows = true, resumed, again;
  run.started = clock_seconds();
  result->k = result->k_error = NAN;
  TRY(memory_allocate(&region_velocity, scene->region_count + 1, sizeof *region_velocity,
                      "region velocities"));
  wcsph_settings(scene, plan, region_velocity, &settings);
  /* Before the engine is there: both take memory. */
  if (plan->context.driving > 0) TRY(percolation_find(lattice, scene->driving, &flows));
  TRY(engine_make(lattice, &settings, &run.state.engine));
  set_direction(&run);
  double gap = wcsph_gap(lattice) + (settings.wall == PASS_FROZEN ? 1 : 0);
  run.pore_width = gap * plan->context.spacing;
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
  TRY(read_checkpoint(&run, &resumed));
  TRY(watch(&run, &again));
  if (!resumed) {
    TRY(wcsph_sum(&run.state.engine, &totals));
    TRY(write_row(&run, &totals));
  }
  if (flows) {
    status = march(&run, result);
    if (status != STATUS_OK && status != STATUS_INTERRUPTED) goto cleanup;
  } else {
    log_warning("no path of pores leads through the model along the force: k = 0");
    const double none[3] = {0};
    result_from_darcy(scene, none, result);
    result->status = "blocked";
    result->k_error = 0;
  }
  enum status left = write_snapshot(&run);
  if (status == STATUS_OK) status = left;
  finish(&run, result);
cleanup:
  monitor_free(&run.state.monitor);
  engine_free(&run.state.engine);
  memory_free(&run.copy.arrays);
  memory_free(&region_velocity);
  return status;
}
