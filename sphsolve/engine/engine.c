#include "sphsolve/engine/engine.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/kernel.h"
#include "common/log.h"
#include "common/memory.h"

/* Clusters are cut when wider than this, lists reach this much farther than the kernel; both in
 * spacings. Measured on sand models, see docs/performance.md. */
#define REACH 3.2
#define SKIN 0.8
/* Steps between removals of the mean pressure, and particles in a block of its sum. */
#define MEAN_STEPS 16
#define MEAN_BLOCK 2048
/* Row clusters a thread takes at a time. */
#define BLOCK 32
/* Floor of the distance to a wall, spacings: numbers nearer are noise. */
#define WALL_DISTANCE_LEAST 0.02

struct particle_fields engine_fields(const struct engine_settings *s) {
  bool frozen = s->wall == PASS_FROZEN, adami = s->wall == PASS_ADAMI;
  return (struct particle_fields){
      .next_state = !frozen,
      .shift = s->shift,
      .distance = s->wall == PASS_SUBVOXEL,
      .wall_state = frozen || adami,
      .wall_base = frozen,
      .wall_distance = s->wall == PASS_SUBVOXEL,
      .wall_v = adami || s->wall_moves,
      .wall_given = adami && s->wall_moves,
  };
}

/* The part of a frozen wall's density that never changes: itself and the walls around it. */
static void wall_base_sum(struct engine *engine) {
  struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const struct engine_settings *s = &engine->settings;
  double volume = 1;
  int reach[3];
  for (int a = 0; a < 3; a++) {
    bool flat = lattice->dimensions == 2 && a == 1;
    volume *= flat ? 1 : lattice->spacing[a];
    reach[a] = flat ? 0 : (int)floor(s->support / lattice->spacing[a]);
  }
  size_t slots = particles_wall_slots(p);
#pragma omp parallel for schedule(static)
  for (size_t w = 0; w < slots; w++) {
    if (p->site[0][w] == NO_SITE) continue;
    double sum = 0;
    for (int k = -reach[2]; k <= reach[2]; k++)
      for (int j = -reach[1]; j <= reach[1]; j++)
        for (int i = -reach[0]; i <= reach[0]; i++) {
          int offset[3] = {i, j, k};
          size_t at[3];
          double square = 0;
          for (int a = 0; a < 3; a++) {
            long n = (long)lattice->size[a];
            at[a] = (size_t)((((long)p->site[a][w] + offset[a]) % n + n) % n);
            square += offset[a] * lattice->spacing[a] * offset[a] * lattice->spacing[a];
          }
          size_t site = (at[2] * lattice->size[1] + at[1]) * lattice->size[0] + at[0];
          if (lattice->kind[site] == SITE_WALL)
            sum += kernel_w(KERNEL_QUINTIC, lattice->dimensions, sqrt(square), s->smoothing_length);
        }
    p->wall_base[w] = (float)(volume * sum);
  }
}

static void set_velocities(struct engine *engine) {
  struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const struct engine_settings *s = &engine->settings;
  if (lattice->region == NULL || s->region_velocity == NULL) return;
  for (size_t i = 0; i < particles_slots(p); i++) {
    size_t region = p->id[i] == NO_PARTICLE ? 0 : lattice->region[p->id[i]];
    for (int a = 0; a < 3 && region > 0; a++) p->v[a][i] = (float)s->region_velocity[region - 1][a];
  }
  float **to = p->wall_given[0] != NULL ? p->wall_given : p->wall_v;
  for (size_t w = 0; w < particles_wall_slots(p) && s->wall_moves; w++) {
    if (p->site[0][w] == NO_SITE) continue;
    size_t site = ((size_t)p->site[2][w] * lattice->size[1] + p->site[1][w]) * lattice->size[0] +
                  p->site[0][w];
    size_t region = lattice->region[site];
    for (int a = 0; a < 3 && region > 0; a++) to[a][w] = (float)s->region_velocity[region - 1][a];
  }
}

static enum status make_locals(struct engine *engine) {
  enum status status = STATUS_OK;
  const struct lattice *lattice = engine->lattice;
  double sites = 1;
  for (int a = 0; a < 3; a++)
    if (lattice->dimensions == 3 || a != 1)
      sites *= 2 * (engine->settings.support + engine->skin) / lattice->spacing[a] + 2 * REACH;
  engine->threads = omp_get_max_threads();
  TRY(memory_allocate(&engine->locals, (size_t)engine->threads, sizeof *engine->locals, "threads"));
  for (int t = 0; t < engine->threads; t++) {
    struct local *local = &engine->locals[t];
    local->capacity = ((size_t)(1.5 * sites) + 1024) / 16 * 16;
    TRY(memory_allocate(&local->field[0], local->capacity * LOCAL_FIELDS, sizeof(float),
                        "columns of a cluster"));
    for (int f = 1; f < LOCAL_FIELDS; f++)
      local->field[f] = local->field[0] + (size_t)f * local->capacity;
  }
cleanup:
  return status;
}

enum status engine_make(const struct lattice *lattice, const struct engine_settings *settings,
                        struct engine *engine) {
  enum status status = STATUS_OK;
  memset(engine, 0, sizeof *engine);
  engine->settings = *settings;
  engine->lattice = lattice;
  engine->fields = engine_fields(settings);
  const struct engine_settings *s = &engine->settings;
  double widest = 0, volume = 1, geometric = 1;
  for (int a = 0; a < 3; a++) {
    if (lattice->dimensions == 2 && a == 1) continue;
    widest = fmax(widest, lattice->spacing[a]);
    volume *= lattice->spacing[a];
    geometric = volume;
  }
  geometric = pow(geometric, 1.0 / lattice->dimensions);
  engine->skin = SKIN * geometric;
  TRY(pair_table_choose(&engine->table));
  double reach = REACH * widest;
  TRY(particles_make(lattice, s->support + engine->skin, reach,
                     2 * (s->support + 2 * engine->skin + 2 * reach), &engine->fields,
                     &engine->particles));
  if (engine->fields.wall_base) wall_base_sum(engine);
  set_velocities(engine);
  TRY(cluster_boxes_wall(&engine->particles, &engine->wall_boxes));
  TRY(make_locals(engine));

  struct pass *pass = &engine->pass;
  const struct frame *frame = &engine->particles.frame;
  pass->particles = &engine->particles;
  pass->fluid_fluid = &engine->fluid_fluid;
  pass->fluid_wall = &engine->fluid_wall;
  pass->wall_fluid = &engine->wall_fluid;
  double h = s->smoothing_length, alpha = kernel_w(KERNEL_QUINTIC, lattice->dimensions, 0, h) / 66;
  for (int a = 0; a < 3; a++) pass->scale[a] = (float)(frame->unit[a] / h);
  pass->radius = (float)(s->support / h);
  pass->dt = s->dt;
  pass->w_scale = volume * alpha;
  pass->g_scale = 5 * volume * alpha / h;
  pass->smoothing_length = h;
  pass->sound_speed = s->sound_speed;
  pass->rest_ratio = s->rest_ratio;
  pass->viscosity = s->kinematic_viscosity;
  memcpy(pass->force, s->force, sizeof pass->force);
  pass->diffusion = s->pressure_diffusion;
  pass->spacing = geometric;
  if (s->wall == PASS_FROZEN) /* until the first density pass */
    for (size_t i = 0; i < particles_slots(&engine->particles); i++) engine->particles.state[i] = 1;
  for (size_t i = 0; i < particles_slots(&engine->particles); i++) {
    double square = 0;
    for (int a = 0; a < 3; a++)
      square += (double)engine->particles.v[a][i] * (double)engine->particles.v[a][i];
    engine->speed_max = fmax(engine->speed_max, sqrt(square));
  }
cleanup:
  if (status != STATUS_OK) engine_free(engine);
  return status;
}

void engine_free(struct engine *engine) {
  for (int t = 0; t < engine->threads && engine->locals != NULL; t++)
    memory_free(&engine->locals[t].field[0]);
  memory_free(&engine->locals);
  neighbours_free(&engine->fluid_fluid);
  neighbours_free(&engine->fluid_wall);
  neighbours_free(&engine->wall_fluid);
  cluster_set_free(&engine->wall_boxes);
  particles_free(&engine->particles);
}

static void run_pass(struct engine *engine, pass_function *function, size_t clusters,
                     enum engine_phase phase) {
  double start = clock_seconds();
#pragma omp parallel num_threads(engine->threads)
  {
    struct local *local = &engine->locals[omp_get_thread_num()];
#pragma omp for schedule(dynamic, 1)
    for (size_t block = 0; block < (clusters + BLOCK - 1) / BLOCK; block++) {
      size_t end = (block + 1) * BLOCK;
      function(&engine->pass, local, block * BLOCK, end < clusters ? end : clusters);
    }
  }
  engine->seconds[phase] += clock_seconds() - start;
}

static void count_pairs(struct engine *engine) {
  uint64_t fluid = 0, wall = 0;
  const struct particles *p = &engine->particles;
#pragma omp parallel num_threads(engine->threads) reduction(+ : fluid, wall)
  {
    struct local *local = &engine->locals[omp_get_thread_num()];
#pragma omp for schedule(dynamic, BLOCK)
    for (size_t c = 0; c < p->clusters; c++)
      engine->table->count(&engine->pass, local, c, c + 1, &fluid);
    if (engine->wall_fluid.rows > 0) {
#pragma omp for schedule(dynamic, BLOCK)
      for (size_t c = 0; c < p->wall_clusters; c++)
        engine->table->count_wall(&engine->pass, local, c, c + 1, &wall);
    }
  }
  engine->pairs_fluid = fluid;
  engine->pairs_wall = wall;
}

/* Orders the particles anew and makes the lists; `sort` false keeps the order (after a restart). */
static enum status make_lists(struct engine *engine, bool sort) {
  enum status status = STATUS_OK;
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  struct cluster_set fluid = {0};
  double range = engine->settings.support + engine->skin, widest = 2 * p->reach;
  if (sort) {
    TRY(particles_sort(p));
    engine->moved = 0;
  }
  TRY(cluster_boxes_fluid(p, &fluid));
  TRY(neighbours_build(&p->frame, &fluid, &fluid, range, widest, &engine->fluid_fluid));
  range = engine->settings.support + 0.5 * engine->skin; /* walls do not come to meet */
  TRY(neighbours_build(&p->frame, &fluid, &engine->wall_boxes, range, widest, &engine->fluid_wall));
  if (engine->fields.wall_state)
    TRY(neighbours_build(&p->frame, &engine->wall_boxes, &fluid, range, widest,
                         &engine->wall_fluid));
  /* Counting costs half a density pass; the number changes by parts per thousand in a run. */
  if (engine->pairs_fluid == 0) count_pairs(engine);
  engine->listed = true;
  engine->rebuilds++;
cleanup:
  cluster_set_free(&fluid);
  engine->seconds[PHASE_LISTS] += clock_seconds() - start;
  return status;
}

/* Difference of the distance along one axis, away from the wall: one-sided, for in the middle of a
 * pore two sites wide, between two walls, a central difference would be none. */
static double slope_from_wall(double low, double here, double high) {
  double back = here - low, fore = high - here;
  if (here < 0) return fore > -back ? fmax(fore, 0) : fmin(back, 0);
  return back > -fore ? fmax(back, 0) : fmin(fore, 0);
}

/* Distance to the wall: that of the nearest site, continued as the plane it is the distance to.
 * (Interpolation between the sites would cut off the ridge in the middle of a narrow pore, which
 * brakes what flows there: by 10 % in a sand whose pores are two sites wide.) Negated where the
 * field at the nearest site changes faster than a distance can (noise): the curvature of the
 * velocity is then left out. */
static void update_distance(struct engine *engine) {
  struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const float *field = lattice->wall_distance;
  const size_t slots = particles_slots(p);
  const size_t stride[3] = {1, lattice->size[0], lattice->size[0] * lattice->size[1]};
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = 0; i < slots; i++) {
    size_t near[3], site = 0;
    double offset[3]; /* spacings from the nearest site */
    for (int a = 0; a < 3; a++) {
      double t = ldexp((double)frame_fold(&p->frame, a, p->x[a][i]), p->frame.image_bits[a] - 32) *
                 (double)lattice->size[a];
      if (p->frame.step[a] == 0) t = 0.5;
      near[a] = (size_t)t;
      if (near[a] >= lattice->size[a]) near[a] = 0;
      offset[a] = t - (double)(size_t)t - 0.5;
      site += near[a] * stride[a];
    }
    double here = (double)field[site], along = 0, square = 0;
    bool smooth = true;
    for (int a = 0; a < 3; a++) {
      if (p->frame.step[a] == 0) continue;
      size_t last = lattice->size[a] - 1, back = last * stride[a];
      double high = (double)field[near[a] < last ? site + stride[a] : site - back];
      double low = (double)field[near[a] > 0 ? site - stride[a] : site + back];
      double most = 1.15 * lattice->spacing[a], slope = slope_from_wall(low, here, high);
      smooth = smooth && fabs(high - here) < most && fabs(low - here) < most;
      along += slope * offset[a];
      square += slope * slope / (lattice->spacing[a] * lattice->spacing[a]);
    }
    double d =
        fmax(here + along / fmax(sqrt(square), 1), WALL_DISTANCE_LEAST * engine->pass.spacing);
    p->distance[i] = (float)(smooth ? d : -d);
  }
}

/* x += (v + u) dt; finds the largest speed and displacement. */
static void drift(struct engine *engine) {
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  double dt = engine->settings.dt, speed = 0, step = 0;
  double per_unit[3];
  for (int a = 0; a < 3; a++) per_unit[a] = p->frame.step[a] == 0 ? 0 : dt / p->frame.unit[a];
  size_t slots = particles_slots(p);
#pragma omp parallel for schedule(static) num_threads(engine->threads) reduction(max : speed, step)
  for (size_t i = 0; i < slots; i++) {
    double own = 0, moving = 0;
    for (int a = 0; a < 3; a++) {
      double v = (double)p->v[a][i];
      own += v * v;
      if (p->shift[0] != NULL) v += (double)p->shift[a][i];
      moving += v * v;
      double units = v * per_unit[a];
      if (fabs(units) < 0x1p30) p->x[a][i] += (uint32_t)(int32_t)lrint(units);
    }
    speed = fmax(speed, own);
    step = fmax(step, moving);
  }
  engine->speed_max = sqrt(speed);
  engine->moved += sqrt(step) * dt;
  engine->seconds[PHASE_DRIFT] += clock_seconds() - start;
}

/* Differences leave the mean pressure free, and rounding and disorder let it walk: it is taken out
 * now and then. Sums over fixed blocks, so that threads change no bit. */
static enum status remove_mean_pressure(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  size_t slots = particles_slots(p), blocks = (slots + MEAN_BLOCK - 1) / MEAN_BLOCK;
  double *sums = NULL, sum = 0;
  TRY(memory_allocate(&sums, blocks, sizeof *sums, "block sums"));
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t b = 0; b < blocks; b++)
    for (size_t i = b * MEAN_BLOCK; i < (b + 1) * MEAN_BLOCK && i < slots; i++)
      if (p->id[i] != NO_PARTICLE) sums[b] += (double)p->state[i];
  for (size_t b = 0; b < blocks; b++) sum += sums[b];
  float mean = (float)(sum / (double)p->count);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = 0; i < slots; i++) p->state[i] -= mean;
cleanup:
  memory_free(&sums);
  return status;
}

static void swap(float **a, float **b) {
  float *t = *a;
  *a = *b;
  *b = t;
}

void engine_set_dt(struct engine *engine, double dt) {
  engine->settings.dt = engine->pass.dt = dt;
}

enum status engine_step(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const struct engine_settings *s = &engine->settings;
  const struct pair_table *table = engine->table;
  /* After a restart the order of the particles stands, unless the run that was interrupted would
   * have ordered them anew at this very step. */
  bool due = 2 * engine->moved > engine->skin;
  if (!engine->listed || due) TRY(make_lists(engine, due || !engine->resumed));
  engine->pass.shift_speed = engine->speed_max;
  bool has_walls = p->wall_clusters > 0;
  if (s->wall == PASS_FROZEN) {
    run_pass(engine, table->density, p->clusters, PHASE_DENSITY);
    run_pass(engine, table->density_wall, p->wall_clusters, PHASE_DENSITY);
    engine->pair_interactions += (double)(engine->pairs_fluid + engine->pairs_wall);
  } else if (s->wall == PASS_ADAMI) {
    run_pass(engine, table->image_velocity, p->wall_clusters, PHASE_WALL);
    engine->pair_interactions += (double)engine->pairs_wall;
  } else if (s->wall == PASS_SUBVOXEL) {
    double start = clock_seconds();
    update_distance(engine);
    engine->seconds[PHASE_WALL] += clock_seconds() - start;
  }
  run_pass(engine, table->force[s->wall][s->viscosity][s->shift], p->clusters, PHASE_FORCE);
  engine->pair_interactions += (double)engine->pairs_fluid;
  if (s->wall != PASS_FROZEN) {
    run_pass(engine, table->continuity[has_walls][s->diffusion][s->shift], p->clusters,
             PHASE_CONTINUITY);
    engine->pair_interactions += (double)engine->pairs_fluid;
    swap(&p->state, &p->state_next);
    if (engine->steps % MEAN_STEPS == 0) TRY(remove_mean_pressure(engine));
  }
  for (int a = 0; a < 3; a++) swap(&p->v[a], &p->v_next[a]);
  drift(engine);
  engine->steps++;
  for (int t = 0; t < engine->threads; t++)
    if (engine->locals[t].overflow)
      TRY_FAIL(STATUS_NUMERIC,
               "more than %zu particles within reach of one cluster: particles have clumped",
               engine->locals[t].capacity);
cleanup:
  return status;
}

double engine_density(const struct engine *engine, size_t slot) {
  double state = (double)engine->particles.state[slot];
  return engine->settings.wall == PASS_FROZEN ? 1 / state : 1 + state;
}

double engine_pressure(const struct engine *engine, size_t slot) {
  double state = (double)engine->particles.state[slot];
  return engine->settings.wall == PASS_FROZEN ? 1 / state - engine->settings.rest_ratio : state;
}
