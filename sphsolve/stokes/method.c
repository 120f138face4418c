/* Method stokes: steady creeping flow, the SPH-Stokes system solved on the lattice itself. */
#include "sphsolve/stokes/solver.h"

#include <math.h>
#include <stdlib.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/stokes/method.h"

/* Where neither the residual nor the velocity is said to be good enough. */
#define RESIDUAL_DEFAULT 1e-6

struct fields {
  double *points;
  float *velocity, *pressure, *density;
  uint64_t *id;
};

static void fields_free(struct fields *f) {
  memory_free(&f->points);
  memory_free(&f->velocity);
  memory_free(&f->pressure);
  memory_free(&f->density);
  memory_free(&f->id);
}

/* All fluid sites, those of blocked pores at rest. */
static enum status write_snapshot(const struct scene *scene, const struct lattice *lattice,
                                  const struct stokes_solver *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct fields f = {0};
  const size_t nx = lattice->size[0], n = s->grid.active;
  const size_t first = s->grid.row_begin * nx;
  const size_t end = (s->grid.mirrored ? s->grid.rows : s->grid.row_end) * nx;
  size_t count = 0;
  for (size_t site = first; site < end; site++) count += lattice->kind[site] == SITE_FLUID;
  const size_t axes = (size_t)s->stencil.axis_count;
  const double density = scene->fluid.density;
  const double pressure_unit = density * s->acceleration * s->stencil.unit;
  TRY(memory_allocate(&f.points, 3 * count, sizeof *f.points, "points of the snapshot"));
  TRY(memory_allocate(&f.velocity, 3 * count, sizeof *f.velocity, "velocity of the snapshot"));
  TRY(memory_allocate(&f.pressure, count, sizeof *f.pressure, "pressure of the snapshot"));
  TRY(memory_allocate(&f.density, count, sizeof *f.density, "density of the snapshot"));
  TRY(memory_allocate(&f.id, count, sizeof *f.id, "ids of the snapshot"));
  for (size_t site = first, at = 0, packed = 0; site < end; site++) {
    const size_t i = site % nx, row = site / nx;
    const bool image = row >= s->grid.row_end;
    if (i == 0 && n > 0) packed = s->grid.row_start[image ? stokes_grid_image(&s->grid, row) : row];
    if (lattice->kind[site] != SITE_FLUID) continue;
    const size_t xyz[3] = {i, row % lattice->size[1], row / lattice->size[1]};
    for (int a = 0; a < 3; a++)
      f.points[3 * at + (size_t)a] = lattice->origin[a] + (double)xyz[a] * lattice->spacing[a];
    f.density[at] = (float)density;
    f.id[at] = site;
    if (n > 0 && stokes_grid_is_active(&s->grid, row, i)) {
      for (size_t a = 0; a < axes; a++) {
        const int axis = s->stencil.axes[a];
        f.velocity[3 * at + (size_t)axis] = (image ? s->grid.parity[axis] : 1.0f) *
                                            (float)(s->x[a * n + packed] * s->velocity_unit);
      }
      f.pressure[at] =
          (image ? s->grid.parity[3] : 1.0f) * (float)(s->x[axes * n + packed] * pressure_unit);
      packed++;
    }
    at++;
  }
  const struct snapshot_field list[] = {
      {"velocity", "m/s", "velocity", H5_F32, 3, f.velocity, NULL, NULL},
      {"pressure", "Pa", "pressure without the part that drives the flow", H5_F32, 1, f.pressure,
       NULL, NULL},
      {"density", "kg/m^3", "density", H5_F32, 1, f.density, NULL, NULL},
      {"id", "1", "number of the lattice site, x fastest", H5_U64, 1, f.id, NULL, NULL}};
  const struct snapshot_field points = {.type = H5_F64, .components = 3, .data = f.points};
  TRY(recorder_snapshot(recorder, 0.0, s->iterations, count, &points, sizeof list / sizeof *list,
                        list));
cleanup:
  fields_free(&f);
  return status;
}

/* Pore velocity times hydraulic diameter 4 V / S over nu; S counts voxel faces, which overstate a
 * smooth surface by 3/2. */
static double reynolds_number(const struct lattice *l, double darcy, double nu) {
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  double surface = 0.0;
  for (size_t site = 0; site < l->count; site++)
    for (int a = 0; a < 3; a++) {
      const bool last = site / step[a] % l->size[a] + 1 == l->size[a];
      const size_t next = last ? site - (l->size[a] - 1) * step[a] : site + step[a];
      if (l->kind[site] != l->kind[next]) surface += 1.0 / l->spacing[a];
    }
  if (!(surface > 0.0)) return 0.0;
  const double diameter = 4.0 * (double)l->fluid_count / (surface * 2.0 / 3.0);
  return darcy * l->bulk_count / (double)l->fluid_count * diameter / nu;
}

/* Darcy velocity in m/s, and the Reynolds number with it. */
static void scale_darcy(const struct lattice *lattice, const struct scene *scene,
                        const struct stokes_solver *s, double darcy[3], double *reynolds) {
  double length = 0.0;
  for (int a = 0; a < 3; a++) {
    darcy[a] = s->mean[a] * s->velocity_unit;
    length = hypot(length, darcy[a]);
  }
  *reynolds = reynolds_number(lattice, length, scene->fluid.viscosity / scene->fluid.density);
}

static enum status write_row(const struct scene *scene, const struct lattice *lattice,
                             const struct stokes_solver *s, double darcy[3],
                             struct recorder *recorder, double *reynolds) {
  const double volume = lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2];
  const size_t n = s->grid.active;
  struct history_row row = {.step = s->iterations,
                            .density_max = scene->fluid.density,
                            .density_mean = scene->fluid.density};
  double square = 0.0;
  for (size_t r = s->grid.row_begin; n > 0 && r < s->grid.row_end; r++)
    for (size_t a = 0; a < (size_t)s->stencil.axis_count; a++)
      for (size_t i = s->grid.row_start[r]; i < s->grid.row_start[r + 1]; i++)
        square += stokes_grid_weight(&s->grid, r) * s->x[a * n + i] * s->x[a * n + i];
  square = ranks_sum(square);
  row.mass = scene->fluid.density * volume * (double)lattice->fluid_count;
  scale_darcy(lattice, scene, s, darcy, reynolds);
  for (int a = 0; a < 3; a++) {
    row.darcy_velocity[a] = darcy[a];
    row.momentum[a] = darcy[a] * scene->fluid.density * volume * lattice->bulk_count;
  }
  row.kinetic_energy =
      0.5 * scene->fluid.density * volume * square * s->velocity_unit * s->velocity_unit;
  row.reynolds = *reynolds;
  const double extra[] = {s->residual_now, s->divergence};
  return recorder_row(recorder, &row, extra);
}

/* What the rounds hand on beside the solution itself. */
struct progress_state {
  double best;
  int stalled;
};

#define CHECKPOINT_NUMBERS 11

static enum status write_checkpoint(const struct stokes_solver *s,
                                    const struct progress_state *state, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  size_t count = CHECKPOINT_NUMBERS, n = s->grid.active;
  char name[32];
  const double numbers[CHECKPOINT_NUMBERS] = {
      s->mean[0],         s->mean[1],        s->mean[2],           s->change,
      s->residual_before, s->residual_start, s->residual_now,      s->divergence,
      state->best,        state->stalled,    (double)s->iterations};
  TRY(recorder_checkpoint_begin(recorder, &file));
  for (size_t c = 0; c <= (size_t)s->stencil.axis_count; c++) {
    snprintf(name, sizeof name, "/state/x%zu", c);
    TRY(h5_write_share(file, name, H5_F64, 1, &n, s->x + c * n, false));
    snprintf(name, sizeof name, "/state/residual%zu", c);
    TRY(h5_write_share(file, name, H5_F32, 1, &n, s->residual + c * n, false));
  }
  TRY(h5_write(file, "/state/numbers", H5_F64, 1, &count, numbers, false));
  status = recorder_checkpoint_commit(recorder, file); /* takes the file over */
  file = NULL;
cleanup:
  h5_close(file);
  return status;
}

static enum status read_checkpoint(struct stokes_solver *s, struct progress_state *state,
                                   struct recorder *recorder, bool *resumed) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  double *x = NULL, *numbers = NULL;
  float *residual = NULL;
  size_t length = s->grid.active, count;
  char name[32];
  TRY(recorder_resume(recorder, &file));
  *resumed = file != NULL;
  if (file == NULL) goto cleanup;
  TRY(h5_read(file, "/state/numbers", H5_F64, 1, &count, &numbers));
  if (count != CHECKPOINT_NUMBERS)
    TRY_FAIL(STATUS_INPUT, "%s: is of another scene; remove it to start anew", h5_path(file));
  for (size_t c = 0; c <= (size_t)s->stencil.axis_count; c++) {
    snprintf(name, sizeof name, "/state/x%zu", c);
    TRY(h5_read_share(file, name, H5_F64, 1, s->grid.active_all, s->grid.offset, &length, &x));
    if (length > 0) memcpy(s->x + c * length, x, length * sizeof *x);
    memory_free(&x);
    snprintf(name, sizeof name, "/state/residual%zu", c);
    TRY(h5_read_share(file, name, H5_F32, 1, s->grid.active_all, s->grid.offset, &length,
                      &residual));
    if (length > 0) memcpy(s->residual + c * length, residual, length * sizeof *residual);
    memory_free(&residual);
  }
  memcpy(s->mean, numbers, sizeof s->mean);
  s->change = numbers[3], s->residual_before = numbers[4];
  s->residual_start = numbers[5], s->residual_now = numbers[6], s->divergence = numbers[7];
  *state = (struct progress_state){numbers[8], (int)numbers[9]};
  s->iterations = (long)numbers[10];
cleanup:
  memory_free(&x);
  memory_free(&residual);
  memory_free(&numbers);
  h5_close(file);
  return status;
}

/* What the solution itself says, apart from the solver's own measures: whether the flux through
 * each plane across the force is the same (plain sums over its sites, without the shares of walls
 * within a site), the sum of all that acts on the water, and that of its work. Moving walls may
 * drive it round and round: then across the largest velocities, over their sum without signs. */
static enum status balance(const struct stokes_solver *s, struct ledger *ledger) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = &s->grid;
  const size_t n = grid->active, first[3] = {0, grid->size[0], grid->size[0] + grid->size[1]};
  const size_t planes = first[2] + grid->size[2];
  struct {
    double left[3], driving[3], flow[3], power_left, power;
  } sum = {{0}, {0}, {0}, 0, 0};
  double *flux = NULL, open = 0, driving = 0, square = 0;
  int main_axis = 0;
  TRY(memory_allocate(&flux, planes, sizeof *flux, "the ledger"));
  for (int c = 0; c < s->stencil.axis_count; c++) {
    const int a = s->stencil.axes[c];
    const double *u = s->x + (size_t)c * n;
    if (grid->mirrored && grid->parity[a] < 0.0f) continue; /* both halves cancel */
    for (size_t row = stokes_grid_begin(grid), p = 0; row < stokes_grid_end(grid); row++)
      for (size_t i = 0; i < grid->size[0]; i++) {
        if (!stokes_grid_is_active(grid, row, i)) continue;
        const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
        flux[first[a] + at[a]] += u[p++];
      }
    for (size_t i = 0; i < n; i++) {
      const double left = (double)s->residual[(size_t)c * n + i];
      const double given =
          s->force[a] + (s->walls_move ? (double)s->operator.drag[(size_t)c * n + i] : 0);
      sum.left[a] += left;
      sum.driving[a] += fabs(given);
      sum.flow[a] += s->walls_move ? fabs(u[i]) : u[i];
      sum.power_left += left * u[i];
      sum.power += given * u[i];
    }
  }
  ranks_sum_all(flux, planes);
  ranks_sum_all((double *)&sum, sizeof sum / sizeof(double));
  const double *size = s->walls_move ? sum.flow : s->force;
  for (int a = 1; a < 3; a++)
    if (fabs(size[a]) > fabs(size[main_axis])) main_axis = a;
  const size_t main_planes = main_axis == 2 ? stokes_grid_planes(grid) : grid->size[main_axis];
  const double count = (double)main_planes, scale = sum.flow[main_axis] / count;
  double mean = 0;
  for (size_t i = 0; i < main_planes; i++) mean += flux[first[main_axis] + i] / count;
  for (size_t i = 0; i < main_planes; i++) {
    const double off = (flux[first[main_axis] + i] - mean) / scale;
    square += off * off / count;
  }
  for (int a = 0; a < 3; a++) {
    open = hypot(open, sum.left[a]);
    driving = hypot(driving, sum.driving[a]);
  }
  ledger->steady = true;
  ledger->flux_open = sqrt(square);
  ledger->force_open = open / driving;
  ledger->power_open = fabs(sum.power_left / sum.power);
cleanup:
  memory_free(&flux);
  return status;
}

struct stokes_goal stokes_goal_of(const struct scene *scene) {
  struct stokes_goal goal = {.residual = scene->stokes.tolerance, .mean = scene->steady_tolerance};
  if (isnan(goal.residual)) goal.residual = goal.mean > 0.0 ? 0.0 : RESIDUAL_DEFAULT;
  return goal;
}

static enum status run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  struct stokes_solver s = {0};
  double darcy[3] = {0.0}, reynolds = 0.0, solving = 0.0;
  struct progress_state state = {.best = INFINITY};
  bool resumed = false;
  const struct stokes_goal goal = stokes_goal_of(scene);
  TRY(recorder_add_column(recorder, "residual", "1", 1));
  TRY(recorder_add_column(recorder, "divergence", "1", 1));
  TRY(stokes_solver_build(lattice, scene, plan->context.support, scene->stokes.wall,
                          plan->context.kinematic_viscosity, scene->driving, &s));
  result->status = s.grid.active_all > 0 ? "converged" : "blocked";
  if (s.grid.active_all == 0)
    log_warning("%s: no pore leads through the model along the force: k is 0; resolve the "
                "throats with smaller voxels, or look at the threshold",
                scene->path);
  if (s.grid.flowing < lattice->fluid_count)
    log_verbose("%zu of %zu pore sites lie in pores that do not lead through",
                lattice->fluid_count - s.grid.flowing, lattice->fluid_count);
  if (s.grid.active_all > 0) TRY(read_checkpoint(&s, &state, recorder, &resumed));
  if (resumed)
    scale_darcy(lattice, scene, &s, darcy, &reynolds);
  else
    TRY(write_row(scene, lattice, &s, darcy, recorder, &reynolds));
  while (s.grid.active_all > 0 && !stokes_solver_converged(&s, &goal)) {
    if (recorder_checkpoint_due(recorder)) TRY(write_checkpoint(&s, &state, recorder));
    if (recorder_interrupted(recorder)) {
      result->status = "interrupted";
      status = FAIL(STATUS_INTERRUPTED, "interrupted at a residual of %.1e; go on with --resume",
                    s.residual_now);
      break;
    }
    char note[80];
    const double started = clock_seconds();
    if (!stokes_solver_round(&s)) continue; /* interrupted */
    solving += clock_seconds() - started;
    recorder_add_time(recorder, "stokes_solve", clock_seconds() - started);
    TRY(write_row(scene, lattice, &s, darcy, recorder, &reynolds));
    const double error = fmin(1.0, stokes_solver_mean_error(&s));
    snprintf(note, sizeof note, "k to %.1e, residual %.1e, Darcy velocity %.4g m/s", error,
             s.residual_now, hypot(hypot(darcy[0], darcy[1]), darcy[2]));
    if (getenv("TRACE"))
      fprintf(stderr, "it %ld J %.9g res %.2e div %.2e est %.2e\n", s.iterations, s.mean[2],
              s.residual_now, s.divergence, stokes_solver_mean_error(&s));
    recorder_progress(recorder,
                      fmin(1.0, goal.residual > 0.0 ? log(s.residual_now) / log(goal.residual)
                                                    : log(error) / log(goal.mean)),
                      note);
    state.stalled = s.residual_now < 0.9 * state.best ? 0 : state.stalled + 1;
    state.best = fmin(state.best, s.residual_now);
    if (state.stalled == 10)
      TRY_FAIL(STATUS_NUMERIC,
               "%s: no progress after %ld iterations at a residual of %.1e; stokes.tolerance = "
               "%.1g accepts it",
               scene->path, s.iterations, s.residual_now, 2.0 * s.residual_now);
  }
  if (s.grid.active_all > 0) {
    enum status told = balance(&s, &result->ledger);
    if (status == STATUS_OK) TRY(told);
  }
  result_from_darcy(scene, darcy, result);
  result->k_error = s.grid.active_all > 0 ? stokes_solver_mean_error(&s) : 0.0;
  result->error.averaging = 0.0;
  result->error.steadiness = result->k_error;
  result->reynolds = reynolds;
  result->steps = s.iterations;
  result->pair_interactions =
      (double)s.iterations * (double)s.grid.active_all * (double)s.stencil.offset_count;
  if (solving > 0.0) result->pair_interactions_per_second = result->pair_interactions / solving;
  if (reynolds > 1.0)
    log_warning("%s: Re = %.2g, but method stokes leaves inertia out; run method = \"wcsph\"",
                scene->path, reynolds);
  recorder_set_fact(recorder, "residual", s.residual_now);
  recorder_set_fact(recorder, "divergence", s.divergence);
  recorder_set_fact(recorder, "iterations", (double)s.iterations);
  recorder_set_fact(recorder, "sites_solved", (double)s.grid.active_all);
  recorder_count_traffic(recorder);
  if (RANKS)
    recorder_set_fact(recorder, "imbalance", s.grid.slabs.start ? s.grid.slabs.imbalance : 1);
  stokes_krylov_free(&s.krylov); /* room for the snapshot */
  stokes_operator_free(&s.operator);
  enum status left = write_snapshot(scene, lattice, &s, recorder);
  if (status == STATUS_OK) status = left;
cleanup:
  stokes_solver_free(&s);
  return status;
}

/* Below it inertia changes k by less than a thousandth (its share goes with the square). */
#define REYNOLDS_CREEPING 0.1

static bool takes(const struct effect_context *context, char why[EFFECT_WHY]) {
  if (!context->has_wall || context->scene->steady_tolerance == 0 || context->has_moving_wall ||
      !(context->reynolds < REYNOLDS_CREEPING))
    return false;
  snprintf(why, EFFECT_WHY,
           "the flow creeps: Re = v / (nu S) about %.2g is below %g, and nothing moves",
           context->reynolds, REYNOLDS_CREEPING);
  return true;
}

static enum wall_scheme wall(const struct scene *scene) {
  return scene->stokes.wall;
}

static const char *wall_name(const struct scene *scene) {
  return wall_scheme_names[scene->stokes.wall];
}

const struct method method_stokes = {.name = "stokes",
                                     .effects = stokes_effects,
                                     .resolves_pores = true,
                                     .solves_creeping = true,
                                     .wall_layers = 4,
                                     .takes = takes,
                                     .scales = stokes_scales,
                                     .cost = stokes_cost,
                                     .ranks_cost = stokes_ranks_cost,
                                     .wall_name = wall_name,
                                     .wall = wall,
                                     .error_flat = 5e-6, /* what the solver leaves */
                                     .error_flat_why =
                                         "parallel flat walls: exact but for the solver",
                                     .run = run};
