#include "sphsolve/methods/wcsph_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"

#define SUM_BLOCK 2048

enum status wcsph_sum(const struct engine *engine, struct wcsph_totals *totals) {
  enum status status = STATUS_OK;
  const struct particles *p = &engine->particles;
  size_t slots = particles_slots(p), blocks = (slots + SUM_BLOCK - 1) / SUM_BLOCK;
  struct wcsph_totals *part = NULL;
  TRY(memory_allocate(&part, blocks, sizeof *part, "block sums"));
#pragma omp parallel for schedule(static)
  for (size_t b = 0; b < blocks; b++) {
    struct wcsph_totals *t = &part[b];
    size_t end = (b + 1) * SUM_BLOCK < slots ? (b + 1) * SUM_BLOCK : slots;
    for (size_t i = b * SUM_BLOCK; i < end; i++) {
      if (p->id[i] == NO_PARTICLE) continue;
      double density = engine_density(engine, i);
      for (int a = 0; a < 3; a++) {
        double v = (double)p->v[a][i];
        t->velocity[a] += v;
        t->square += v * v;
      }
      t->density += density;
      if (!(density <= t->density_max)) {
        t->density_max = density;
        t->densest = i;
      }
    }
  }
  memset(totals, 0, sizeof *totals);
  for (size_t b = 0; b < blocks; b++) {
    for (int a = 0; a < 3; a++) totals->velocity[a] += part[b].velocity[a];
    totals->square += part[b].square;
    totals->density += part[b].density;
    if (!(part[b].density_max <= totals->density_max)) {
      totals->density_max = part[b].density_max;
      totals->densest = part[b].densest;
    }
  }
  totals->finite = isfinite(totals->square) && isfinite(totals->density);
cleanup:
  memory_free(&part);
  return status;
}

struct stored {
  const char *name;
  enum h5_type type;
  void **array;
};

static size_t stored_arrays(struct particles *p, struct stored list[16]) {
  static const char *const axis[3][3] = {{"/state/x", "/state/y", "/state/z"},
                                         {"/state/vx", "/state/vy", "/state/vz"},
                                         {"/state/ux", "/state/uy", "/state/uz"}};
  size_t n = 0;
  for (int a = 0; a < 3; a++) list[n++] = (struct stored){axis[0][a], H5_U32, (void **)&p->x[a]};
  for (int a = 0; a < 3; a++) list[n++] = (struct stored){axis[1][a], H5_F32, (void **)&p->v[a]};
  if (p->shift[0] != NULL)
    for (int a = 0; a < 3; a++)
      list[n++] = (struct stored){axis[2][a], H5_F32, (void **)&p->shift[a]};
  list[n++] = (struct stored){"/state/state", H5_F32, (void **)&p->state};
  list[n++] = (struct stored){"/state/id", H5_U32, (void **)&p->id};
  return n;
}

enum status wcsph_write_state(const struct wcsph_state *state, struct h5_file *file) {
  enum status status = STATUS_OK;
  struct particles p = state->engine.particles; /* pointers only */
  const struct engine *engine = &state->engine;
  struct stored list[16];
  size_t n = stored_arrays(&p, list), slots = particles_slots(&p);
  for (size_t i = 0; i < n; i++)
    TRY(h5_write(file, list[i].name, list[i].type, 1, &slots, *list[i].array, false));
  double numbers[] = {engine->moved,
                      engine->speed_max,
                      engine->pair_interactions,
                      (double)engine->pairs_fluid,
                      (double)engine->pairs_wall,
                      state->next_row,
                      engine->settings.dt,
                      (double)engine->steps};
  size_t count = sizeof numbers / sizeof *numbers;
  TRY(h5_write(file, "/state/numbers", H5_F64, 1, &count, numbers, false));
  count = 1;
  TRY(h5_write(file, "/state/step", H5_I64, 1, &count, &state->step, false));
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
  size_t slots[2], dims[2], count;
  int rank;
  double *numbers = NULL, (*rows)[MONITOR_COMPONENTS] = NULL;
  int64_t *step = NULL;
  void *array = NULL;
  TRY(h5_shape(file, "/state/id", 1, &rank, slots));
  if (slots[0] % CLUSTER != 0 || slots[0] < p->count)
    TRY_FAIL(STATUS_INPUT, "%s: /state/id has %zu slots for %zu particles: not of this scene",
             h5_path(file), slots[0], p->count);
  TRY(particles_resize(p, slots[0] / CLUSTER));
  struct stored list[16];
  size_t n = stored_arrays(p, list);
  for (size_t i = 0; i < n; i++) {
    TRY(h5_read(file, list[i].name, list[i].type, 1, dims, &array));
    if (dims[0] != slots[0])
      TRY_FAIL(STATUS_INPUT, "%s: %s has %zu values, not %zu", h5_path(file), list[i].name, dims[0],
               slots[0]);
    memcpy(*list[i].array, array, slots[0] * sizeof(float));
    memory_free(&array);
  }
  TRY(h5_read(file, "/state/numbers", H5_F64, 1, &count, &numbers));
  TRY(h5_read(file, "/state/step", H5_I64, 1, &dims[0], &step));
  if (count != 8 || dims[0] != 1)
    TRY_FAIL(STATUS_INPUT, "%s: /state/numbers is not of this version", h5_path(file));
  if (numbers[6] != engine->settings.dt)
    TRY_FAIL(STATUS_INPUT, "%s: the checkpoint was made with dt = %.17g s, the scene gives %.17g s",
             h5_path(file), numbers[6], engine->settings.dt);
  engine->moved = numbers[0];
  engine->speed_max = numbers[1];
  engine->pair_interactions = numbers[2];
  engine->pairs_fluid = (uint64_t)numbers[3];
  engine->pairs_wall = (uint64_t)numbers[4];
  engine->resumed = *step > 0; /* before the first step no order was made yet */
  engine->steps = (uint64_t)numbers[7];
  state->next_row = numbers[5];
  state->step = *step;
  if (h5_exists(file, "/state/monitor")) {
    TRY(h5_read(file, "/state/monitor", H5_F64, 2, dims, &rows));
    if (dims[1] != MONITOR_COMPONENTS)
      TRY_FAIL(STATUS_INPUT, "%s: /state/monitor is not of this version", h5_path(file));
    for (size_t i = 0; i < dims[0]; i++) TRY(monitor_add(&state->monitor, rows[i]));
  }
cleanup:
  memory_free(&array);
  memory_free(&rows);
  memory_free(&numbers);
  memory_free(&step);
  return status;
}
