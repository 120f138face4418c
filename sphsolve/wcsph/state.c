#include "sphsolve/wcsph/state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/effects/wall_subvoxel.h"
#include "sphsolve/geometry/wall_shape.h"

#define SUM_BLOCK 2048

/* Contribution of a wall next to a particle to the volume integral of the velocity: factors of the
 * velocity, and of the force plus pressure gradient (Euler-Maclaurin formula at the end of a line
 * of sites, stokes/effects/wall_subvoxel.h). For particles that have left the lines of the lattice
 * it holds on average. */
struct end_of_line {
  double velocity, pull; /* 1, s */
};
static struct end_of_line end_of_line(const struct engine *engine, size_t slot) {
  const struct lattice *l = engine->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]};
  size_t near[3], site = 0;
  double at[3], share = 0;
  struct end_of_line sum = {0, 0};
  particles_position(&engine->particles, l, slot, at);
  for (int a = 0; a < 3; a++) {
    long n = (long)l->size[a], index = lround((at[a] - l->origin[a]) / l->spacing[a]);
    near[a] = (size_t)(((index % n) + n) % n);
    site += near[a] * stride[a];
  }
  if (l->kind[site] != SITE_FLUID) return sum;
  double d = fabs(engine_wall_distance(engine, slot));
  for (int a = 0; a < 3; a++) {
    if (l->dimensions == 2 && a == 1) continue;
    double step = l->spacing[a], most = 0;
    size_t last = l->size[a] - 1, back = last * stride[a];
    for (int up = 0; up < 2; up++) {
      size_t other = up ? (near[a] < last ? site + stride[a] : site - back)
                        : (near[a] > 0 ? site - stride[a] : site + back);
      if (l->kind[other] != SITE_WALL) continue;
      struct stokes_wall_quadrature end =
          stokes_wall_quadrature(d / step, -(double)l->wall_distance[other] / step, 1);
      sum.velocity += end.velocity;
      sum.pull += end.force * step * step / engine->settings.kinematic_viscosity;
      most = fmax(most, end.share);
    }
    share += most;
  }
  /* Effect of the wall's curvature on the profile. */
  if (share > 0 && engine->settings.wall == PASS_EULERIAN) {
    struct wall_shape wall;
    wall_shape_find(l, site, engine->pass.spacing, &wall);
    share = fmax(share, 1) * (1 - 0.5 * d * wall.curvature);
  } else {
    share = fmax(share, 1);
  }
  sum.velocity /= share;
  sum.pull /= share;
  return sum;
}

enum status wcsph_sum(struct engine *engine, bool flux, struct wcsph_totals *totals) {
  enum status status = STATUS_OK;
  const struct particles *p = &engine->particles;
  struct wcsph_totals *part = NULL;
  const enum pass_wall wall = engine->settings.wall;
  const bool ends =
      flux && (wall == PASS_EULERIAN || wall == PASS_SUBVOXEL) && !engine->settings.wall_moves;
  /* First, since it may rebuild the lists, which changes the number of slots. */
  if (ends) TRY(engine_find_acceleration(engine));
  const size_t blocks = (engine_all_slots(engine) + SUM_BLOCK - 1) / SUM_BLOCK;
  TRY(memory_allocate(&part, blocks, sizeof *part, "block sums"));
  const size_t begin = engine_first_slot(engine), last = engine_end_slot(engine);
  const size_t number = engine_number(engine, begin), first = number / SUM_BLOCK;
#pragma omp parallel for schedule(static)
  for (size_t b = begin; b < last; b += SUM_BLOCK) {
    struct wcsph_totals *t = &part[first + (b - begin) / SUM_BLOCK];
    t->density_min = INFINITY;
    const size_t end = b + SUM_BLOCK < last ? b + SUM_BLOCK : last;
    for (size_t i = b; i < end; i++) {
      if (p->id[i] == NO_PARTICLE) continue;
      double density = engine_density(engine, i), square = 0;
      struct end_of_line line = {0, 0};
      if (ends) line = end_of_line(engine, i);
      for (int a = 0; a < 3; a++) {
        double v = (double)p->v[a][i];
        t->velocity[a] += v;
        /* Between two walls the curvature of the profile due to the force is at most its slope. */
        double slope = v * line.velocity, bend = 0;
        if (ends) bend = line.pull * ((double)p->v_next[a][i] - v);
        t->flux[a] += v + slope + fmax(-fabs(slope), fmin(bend, fabs(slope)));
        t->square += v * v;
        square += v * v;
      }
      t->density += density;
      t->compression += (density - 1) * (density - 1);
      if (!(density <= t->density_max)) {
        t->density_max = density;
        t->densest = number + (i - begin);
      }
      if (!(density >= t->density_min)) {
        t->density_min = density;
        t->thinnest = number + (i - begin);
      }
      if (!(square <= t->speed_max)) {
        t->speed_max = square;
        t->fastest = number + (i - begin);
      }
    }
  }
  TRY(engine_gather_blocks(engine, SUM_BLOCK, part, sizeof *part));
  memset(totals, 0, sizeof *totals);
  totals->density_min = INFINITY;
  for (size_t b = 0; b < blocks; b++) {
    for (int a = 0; a < 3; a++) {
      totals->velocity[a] += part[b].velocity[a];
      totals->flux[a] += part[b].flux[a];
    }
    totals->square += part[b].square;
    totals->density += part[b].density;
    if (!(part[b].density_max <= totals->density_max)) {
      totals->density_max = part[b].density_max;
      totals->densest = part[b].densest;
    }
    totals->compression += part[b].compression;
    if (!(part[b].density_min >= totals->density_min)) {
      totals->density_min = part[b].density_min;
      totals->thinnest = part[b].thinnest;
    }
    if (!(part[b].speed_max <= totals->speed_max)) {
      totals->speed_max = part[b].speed_max;
      totals->fastest = part[b].fastest;
    }
  }
  totals->speed_max = sqrt(totals->speed_max);
  totals->finite = isfinite(totals->square) && isfinite(totals->density);
cleanup:
  memory_free(&part);
  return status;
}

double wcsph_time(const struct wcsph_state *state) {
  return state->time_from + (double)(state->step - state->step_from) * state->engine.settings.dt;
}

bool wcsph_sample_due(const struct wcsph_state *state) {
  return (state->step - state->sample_from) % (state->sample_steps << state->halvings) == 0;
}

/* Changes the step to the present one / 2^more. */
static void rescale(struct wcsph_state *state, int64_t since_sample, int more) {
  state->time_from = wcsph_time(state);
  state->step_from = state->step;
  state->sample_from = state->step - since_sample;
  state->halvings += more;
  engine_set_dt(&state->engine, ldexp(state->engine.settings.dt, -more));
}

void wcsph_halve(struct wcsph_state *state) {
  int64_t since = (state->step - state->sample_from) % (state->sample_steps << state->halvings);
  rescale(state, 2 * since, 1);
}

bool wcsph_double(struct wcsph_state *state) {
  int64_t since = (state->step - state->sample_from) % (state->sample_steps << state->halvings);
  if (state->halvings == 0 || since % 2 != 0) return false;
  rescale(state, since / 2, -1);
  return true;
}

/* The dataset of an array in a checkpoint. */
static const char *path_of(const struct slot_array *a, char path[32]) {
  snprintf(path, 32, a->component < 0 ? "/state/%s" : "/state/%s%d", a->name, a->component);
  return path;
}

enum status wcsph_keep(struct wcsph_state *state, struct wcsph_copy *copy) {
  enum status status = STATUS_OK;
  struct particles p = state->engine.particles; /* pointers only */
  const struct engine *engine = &state->engine;
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = particles_kept(&p, list), first = engine_first_slot(engine);
  const size_t size = (engine_end_slot(engine) - first) * sizeof(float); /* bytes of each array */
  if (copy->file.file == NULL) TRY(scratch_open(copy->beside, &copy->file));
  for (size_t i = 0; i < n; i++)
    TRY(scratch_write(&copy->file, i * size, *(float **)list[i].array + first, size));
  copy->clusters = size / (CLUSTER * sizeof(float));
  copy->samples = state->monitor.count;
  copy->step = state->step;
  copy->sample_from = state->sample_from;
  copy->halvings = state->halvings;
  copy->time = wcsph_time(state);
  copy->moved = state->engine.moved;
  copy->speed_max = state->engine.speed_max;
  copy->next_row = state->next_row;
  copy->budget = state->budget;
cleanup:
  return status;
}

enum status wcsph_go_back(const struct wcsph_copy *copy, struct wcsph_state *state) {
  enum status status = STATUS_OK;
  struct engine *engine = &state->engine;
  struct particles *p = &engine->particles;
  engine_await_ghosts(engine);
  TRY(particles_resize(p, copy->clusters));
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = particles_kept(p, list), size = particles_slots(p) * sizeof(float);
  for (size_t i = 0; i < n; i++) TRY(scratch_read(&copy->file, i * size, *list[i].array, size));
  TRY(engine_adopt_partition(engine));
  engine->moved = copy->moved;
  engine->speed_max = copy->speed_max;
  engine->listed = false;
  for (int t = 0; t < engine->threads; t++) engine->locals[t].overflow = false;
  state->monitor.count = copy->samples;
  state->next_row = copy->next_row;
  state->budget = copy->budget;
  int64_t since = (copy->step - copy->sample_from) % (state->sample_steps << copy->halvings);
  if (state->halvings < copy->halvings) {
    engine_set_dt(engine, ldexp(engine->settings.dt, state->halvings - copy->halvings));
    state->halvings = copy->halvings;
  }
  since <<= state->halvings - copy->halvings;
  /* The step number is not reset: it counts all steps computed. */
  state->time_from = copy->time;
  state->step_from = state->step;
  state->sample_from = state->step - since;
cleanup:
  return status;
}

void wcsph_copy_free(struct wcsph_copy *copy) {
  scratch_close(&copy->file);
}

/* The numbers of a checkpoint. */
#define NUMBERS 14
static void numbers_of(struct wcsph_state *s, struct h5_number numbers[NUMBERS]) {
  struct engine *e = &s->engine;
  const struct h5_number all[NUMBERS] = {{"step", H5_I64, 1, &s->step},
                                         {"halvings", H5_I32, 1, &s->halvings},
                                         {"time_from", H5_F64, 1, &s->time_from},
                                         {"step_from", H5_I64, 1, &s->step_from},
                                         {"sample_from", H5_I64, 1, &s->sample_from},
                                         {"next_row", H5_F64, 1, &s->next_row},
                                         {"watchdog_halvings", H5_I32, 1, &s->dog.halvings},
                                         {"watchdog_trip", H5_F64, 1, &s->dog.trip_time},
                                         {"moved", H5_F64, 1, &e->moved},
                                         {"speed_max", H5_F64, 1, &e->speed_max},
                                         {"steps", H5_U64, 1, &e->steps},
                                         {"interactions", H5_F64, 1, &e->pair_interactions},
                                         {"pairs_fluid", H5_U64, 1, &e->pairs_fluid},
                                         {"pairs_wall", H5_U64, 1, &e->pairs_wall}};
  memcpy(numbers, all, sizeof all);
}

enum status wcsph_write_state(struct wcsph_state *state, struct h5_file *file) {
  enum status status = STATUS_OK;
  struct particles p = state->engine.particles; /* pointers only */
  const struct engine *engine = &state->engine;
  struct h5_number numbers[NUMBERS];
  char path[32];
  const double dt = ldexp(engine->settings.dt, state->halvings), wall = engine->settings.wall;
  struct slot_array list[SLOT_ARRAYS];
  size_t n = particles_kept(&p, list), first = engine_first_slot(engine);
  size_t slots = engine_end_slot(engine) - first;
  for (size_t i = 0; i < n; i++) /* all elements have 4 bytes */
    TRY(h5_write_rows(file, path_of(&list[i], path), list[i].whole ? H5_U32 : H5_F32, 1, &slots,
                      *(float **)list[i].array + first, false));
  numbers_of(state, numbers);
  TRY(h5_write_numbers(file, "/state", NUMBERS, numbers));
  TRY(h5_write_attribute(file, "/state", "dt", H5_F64, 1, &dt));
  TRY(h5_write_attribute(file, "/state", "wall", H5_F64, 1, &wall));
  TRY(budget_write(&state->budget.total, sizeof state->budget, file, "/state/account"));
  size_t dims[2] = {state->monitor.count, MONITOR_COMPONENTS};
  if (dims[0] > 0)
    TRY(h5_write(file, "/state/monitor", H5_F64, 2, dims, state->monitor.rows, false));
cleanup:
  return status;
}

enum status wcsph_read_state(struct h5_file *file, struct wcsph_state *state) {
  enum status status = STATUS_OK;
  struct engine *engine = &state->engine;
  struct particles *p = &engine->particles;
  size_t slots[2], dims[2], own;
  int rank;
  double dt, wall, (*rows)[MONITOR_COMPONENTS] = NULL;
  struct h5_number numbers[NUMBERS];
  char path[32];
  void *array = NULL;
  TRY(h5_shape(file, "/state/id", 1, &rank, slots));
  if (slots[0] % CLUSTER != 0 || slots[0] < p->count)
    TRY_FAIL(STATUS_INPUT, "%s: /state/id has %zu slots for %zu particles: not of this scene",
             h5_path(file), slots[0], p->count);
  TRY(engine_partition(engine, slots[0] / CLUSTER));
  own = RANKS && ranks_count() > 1 ? engine_end_slot(engine) : slots[0];
  TRY(particles_resize(p, own / CLUSTER));
  struct slot_array list[SLOT_ARRAYS];
  size_t n = particles_kept(p, list);
  for (size_t i = 0; i < n; i++) {
    dims[0] = own;
    TRY(h5_read_rows(file, path_of(&list[i], path), list[i].whole ? H5_U32 : H5_F32, 1, slots[0],
                     engine_number(engine, 0), dims, &array));
    if (own > 0) memcpy(*list[i].array, array, own * sizeof(float));
    memory_free(&array);
  }
  TRY(budget_read(&state->budget.total, sizeof state->budget, file, "/state/account"));
  TRY(h5_read_attribute(file, "/state", "dt", H5_F64, 1, &dt));
  TRY(h5_read_attribute(file, "/state", "wall", H5_F64, 1, &wall));
  if (wall != (double)engine->settings.wall)
    TRY_FAIL(STATUS_INPUT, "%s: is of another treatment of walls; remove it to start anew",
             h5_path(file));
  if (dt != engine->settings.dt)
    TRY_FAIL(STATUS_INPUT, "%s: the checkpoint was made with dt = %.17g s, the scene gives %.17g s",
             h5_path(file), dt, engine->settings.dt);
  numbers_of(state, numbers);
  TRY(h5_read_numbers(file, "/state", NUMBERS, numbers));
  engine_set_dt(engine, ldexp(engine->settings.dt, -state->halvings));
  if (h5_exists(file, "/state/monitor")) {
    TRY(h5_read(file, "/state/monitor", H5_F64, 2, dims, &rows));
    if (dims[1] != MONITOR_COMPONENTS)
      TRY_FAIL(STATUS_INPUT, "%s: /state/monitor is not of this version", h5_path(file));
    for (size_t i = 0; i < dims[0]; i++) TRY(monitor_add(&state->monitor, rows[i]));
  }
cleanup:
  MEMORY_FREE(&array, &rows);
  return status;
}
