#include "sphsolve/wcsph/engine/engine_ranks.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/kernel.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/engine/engine_sites.h"
#include "sphsolve/wcsph/engine/engine_walls.h"
#include "sphsolve/wcsph/engine/simd.h"

/* Clusters are cut when wider than this; lists are made for paths of PATH, with so much around them
 * (see cluster_boxes_fluid). All in spacings; measured on sand models, docs/performance.md. */
#define REACH 4.0
#define PATH 1.5
#define SWERVE 0.4
#define MARGIN 0.1
/* Lists reach so much beyond the support that rounding cannot lose a pair. */
#define ROUNDING 1e-3
/* Walls so much beyond the support of the fluid's first sites are kept. */
#define WALL_ROOM 0.8
/* Steps between removals of the mean pressure, and particles in a block of its sum. */
#define MEAN_STEPS 16
#define MEAN_BLOCK 2048

static enum status set_velocities(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const struct lattice *lattice = engine->lattice;
  const struct engine_settings *s = &engine->settings;
  if (lattice->region == NULL || s->region_velocity == NULL) return STATUS_OK;
  for (size_t i = 0; i < particles_slots(p); i++) {
    size_t region = p->id[i] == NO_PARTICLE ? 0 : lattice->region[p->id[i]];
    for (int a = 0; a < 3 && region > 0; a++) p->v[a][i] = (float)s->region_velocity[region - 1][a];
  }
  if (p->wall_region == NULL) return STATUS_OK;
  TRY(memory_allocate(&p->wall_velocity, s->region_count + 1, sizeof *p->wall_velocity,
                      "region velocities"));
  for (size_t r = 0; r < s->region_count; r++)
    for (int a = 0; a < 3; a++) p->wall_velocity[r + 1][a] = (float)s->region_velocity[r][a];
cleanup:
  return status;
}

/* Columns that the buffer of a row cluster takes: half of what fits where a cluster can see, and
 * more where it sees little. */
static size_t local_capacity(const struct lattice *lattice, double support) {
  double sites = 1;
  for (int a = 0; a < 3; a++)
    if (lattice->dimensions == 3 || a != 1)
      sites *= 2 * support / lattice->spacing[a] + 2 * (REACH + 2 * PATH);
  return ((size_t)(0.5 * sites) + 2048) / SIMD_LANES * SIMD_LANES;
}

static enum status make_locals(struct engine *engine) {
  enum status status = STATUS_OK;
  size_t capacity = local_capacity(engine->lattice, engine->settings.support);
  engine->threads = omp_get_max_threads();
  TRY(memory_allocate(&engine->locals, (size_t)engine->threads, sizeof *engine->locals, "threads"));
  for (int t = 0; t < engine->threads; t++) {
    struct local *local = &engine->locals[t];
    local->capacity = capacity;
    TRY(memory_allocate(&local->field[0], capacity * LOCAL_FIELDS, sizeof(float),
                        "columns of a cluster"));
    for (int f = 1; f < LOCAL_FIELDS; f++) local->field[f] = local->field[0] + (size_t)f * capacity;
    if (engine->threads > 1 && engine->settings.wall == PASS_FROZEN)
      TRY(memory_allocate(&local->collected, 1, sizeof *local->collected, "shares of walls"));
  }
cleanup:
  return status;
}

/* The fluid on its sites: on ranks, each a run of it. */
static enum status place(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  size_t first = 0, end = p->count;
  if (RANKS) TRY(engine_cut(engine, (p->count + CLUSTER - 1) / CLUSTER));
  if (engine_is_shared(engine)) {
    const size_t *cut = engine->ranks.fluid.cut + ranks_own();
    first = cut[0] * CLUSTER < end ? cut[0] * CLUSTER : end;
    end = cut[1] * CLUSTER < end ? cut[1] * CLUSTER : end;
  }
  struct particle_fields now = engine->fields;
  now.sites = false; /* not yet: particles_make_sites */
  TRY(particles_place(engine->lattice, &now, first, end - first, p));
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
  struct cluster_set wall_boxes = {0};
  const struct engine_settings *s = &engine->settings;
  double widest = 0, volume = 1, geometric = 1;
  for (int a = 0; a < 3; a++) {
    if (lattice->dimensions == 2 && a == 1) continue;
    widest = fmax(widest, lattice->spacing[a]);
    volume *= lattice->spacing[a];
    geometric = volume;
  }
  geometric = pow(geometric, 1.0 / lattice->dimensions);
  TRY(pair_table_choose(s->kernel, &engine->table));
  /* A cluster as it was cut, and what its members may have gone and may go on both sides. */
  double reach = REACH * widest, room = 2 * (1 + SWERVE) * PATH * geometric;
  TRY(particles_make(lattice, s->support + WALL_ROOM * geometric, reach,
                     2 * (s->support + 2 * (reach + room)), &engine->fields, &engine->particles));
  if (ranks_count() > 1) TRY(engine_order_walls(engine, s->support + WALL_ROOM * geometric));
  TRY(place(engine));
  if (engine->fields.wall_base) TRY(engine_sum_wall_base(engine));
  TRY(set_velocities(engine));
  if (!engine_is_shared(engine)) {
    TRY(cluster_boxes_wall(&engine->particles, &wall_boxes));
    TRY(cluster_bins_make(&engine->particles.frame, &wall_boxes, s->support, &engine->wall_bins));
  }
  TRY(make_locals(engine));

  struct pass *pass = &engine->pass;
  const struct frame *frame = &engine->particles.frame;
  engine->moved = INFINITY;
  pass->particles = &engine->particles;
  pass->fluid_fluid = &engine->fluid_fluid;
  pass->fluid_wall = &engine->fluid_wall;
  pass->wall_fluid = &engine->wall_fluid;
  const double h = s->smoothing_length;
  const double alpha = kernel_w(s->kernel, lattice->dimensions, 0, h) / engine->table->kernel_at_0;
  for (int a = 0; a < 3; a++) pass->scale[a] = (float)(frame->unit[a] / (2 * h));
  pass->radius = (float)(s->support / (2 * h));
  pass->dt = s->dt;
  pass->w_scale = volume * alpha;
  pass->g_scale = 5 * volume * alpha / (2 * h);
  pass->l_scale = 5 * volume * alpha / (4 * h * h);
  if (s->wall != PASS_FROZEN) { /* exact on the lattice */
    pass->g_scale /= s->moment;
    pass->l_scale /= s->moment;
  }
  pass->smoothing_length = h;
  pass->sound_speed = s->sound_speed;
  pass->rest_ratio = s->rest_ratio;
  pass->viscosity = s->kinematic_viscosity;
  memcpy(pass->force, s->force, sizeof pass->force);
  pass->diffusion = s->pressure_diffusion;
  pass->weights = s->weights;
  pass->stabilisation = s->pressure_diffusion / (s->sound_speed * s->sound_speed);
  pass->spacing = geometric;
  if (s->wall == PASS_FROZEN) /* until the first density pass */
    for (size_t i = 0; i < particles_slots(&engine->particles); i++) engine->particles.state[i] = 1;
  for (size_t i = 0; i < particles_slots(&engine->particles); i++) {
    double square = 0;
    for (int a = 0; a < 3; a++)
      square += (double)engine->particles.v[a][i] * (double)engine->particles.v[a][i];
    engine->speed_max = fmax(engine->speed_max, sqrt(square));
  }
  engine->speed_max = ranks_max(engine->speed_max);
cleanup:
  cluster_set_free(&wall_boxes);
  if (status != STATUS_OK) engine_free(engine);
  return status;
}

void engine_drop_lists(struct engine *engine) {
  if (RANKS) engine_settle(engine);
  neighbours_free(&engine->fluid_fluid);
  neighbours_free(&engine->fluid_wall);
  neighbours_free(&engine->wall_fluid);
  cluster_set_free(&engine->boxes);
  engine->listed = false;
}

void engine_free(struct engine *engine) {
  for (int t = 0; t < engine->threads && engine->locals != NULL; t++) {
    memory_free(&engine->locals[t].field[0]);
    memory_free(&engine->locals[t].collected);
  }
  memory_free(&engine->locals);
  engine_drop_lists(engine);
  cluster_bins_free(&engine->wall_bins);
  ghosts_free(&engine->ranks.fluid);
  ghosts_free(&engine->ranks.walls);
  memory_free(&engine->ranks.blocks);
  memory_free(&engine->ranks.work);
  particles_free(&engine->particles);
}

static void run_pass(struct engine *engine, pass_function *function, bool wall,
                     enum engine_phase phase) {
  double start = clock_seconds();
  size_t clusters = wall ? engine->particles.wall_clusters : engine->particles.clusters;
  if (engine_is_shared(engine)) {
    engine_run_shared(engine, function, wall);
    clusters = 0;
  }
  const size_t blocks = (clusters + BLOCK - 1) / BLOCK;
  /* Rows that add to sums of others: few long runs, for they meet where runs do. */
  const bool adds = engine->locals[0].collected != NULL && phase == PHASE_DENSITY;
  // NOLINTNEXTLINE: it is read, by the schedule
  const int run = adds ? 1 + (int)(blocks / (16 * (size_t)engine->threads)) : 1;
#pragma omp parallel num_threads(engine->threads)
  {
    struct local *local = &engine->locals[omp_get_thread_num()];
#pragma omp for schedule(dynamic, run)
    for (size_t block = 0; block < blocks; block++) {
      size_t end = (block + 1) * BLOCK;
      function(&engine->pass, local, block * BLOCK, end < clusters ? end : clusters);
    }
  }
  engine->seconds[phase] += clock_seconds() - start;
}

static void count_pairs(struct engine *engine) {
  uint64_t fluid = 0, alone = 0, wall = 0;
  const struct particles *p = &engine->particles;
  const struct ghosts *walls = &engine->ranks.walls;
  size_t first = engine_first_slot(engine) / CLUSTER, end = engine_end_slot(engine) / CLUSTER;
  size_t first_wall = walls->cut != NULL ? walls->begin : 0;
  size_t end_wall = walls->cut != NULL ? walls->end : p->wall_clusters;
#pragma omp parallel num_threads(engine->threads) reduction(+ : fluid, alone, wall)
  {
    struct local *local = &engine->locals[omp_get_thread_num()];
#pragma omp for schedule(dynamic, BLOCK)
    for (size_t c = first; c < end; c++)
      engine->table->count(&engine->pass, local, c, c + 1, &fluid, &alone);
    if (engine->wall_fluid.rows > 0) {
#pragma omp for schedule(dynamic, BLOCK)
      for (size_t c = first_wall; c < end_wall; c++)
        engine->table->count_wall(&engine->pass, local, c, c + 1, &wall);
    }
  }
  double sums[3] = {(double)fluid, (double)alone, (double)wall};
  ranks_sum_all(sums, 3);
  engine->pairs_fluid = (uint64_t)sums[0];
  engine->pairs_alone = (uint64_t)sums[1];
  engine->pairs_wall = (uint64_t)sums[2];
  if (engine->settings.wall == PASS_FROZEN) /* the same pairs seen from their other end */
    engine->pairs_wall = engine->pairs_fluid - engine->pairs_alone;
}

/* Walls and their list are for the sums over them, before there is another list. */
static enum status sum_walls_of_sites(struct engine *engine, double range, double widest) {
  enum status status = STATUS_OK;
  const struct pair_table *table = engine->table;
  struct particles *p = &engine->particles;
  if (!engine_is_shared(engine))
    TRY(neighbours_build(&p->frame, &engine->boxes, &engine->wall_bins, range, widest,
                         &engine->fluid_wall));
  TRY(particles_make_sites(p));
  engine_sites_begin(engine);
  run_pass(engine, table->sites_walls, false, PHASE_WALL);
  neighbours_free(&engine->fluid_wall);
  if (engine_is_shared(engine)) return STATUS_OK; /* walls are part of the next lists */
  cluster_bins_free(&engine->wall_bins);
  particles_drop_walls(p);
cleanup:
  return status;
}

/* Makes the lists; at the start of a step (`order`) it orders the particles anew where they have
 * gone far since they were last ordered. The order decides the order of sums and so must not depend
 * on when lists are made: a resumed run makes its own. */
static enum status make_lists(struct engine *engine, bool order) {
  enum status status = STATUS_OK;
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  const struct engine_settings *s = &engine->settings;
  struct cluster_set wall_boxes = {0};
  struct cluster_bins bins = {0};
  double spacing = engine->pass.spacing, path = PATH * spacing;
  double range = engine->settings.support + ROUNDING * spacing, widest = 2 * p->reach;
  if (order && engine->moved >= path) {
    engine_drop_lists(engine); /* their memory is the keys' */
    TRY(engine_is_shared(engine) ? engine_order(engine) : particles_sort(p));
    engine->moved = 0;
  }
  /* Until the next ordering, if particles keep their speed. */
  double speed = engine->speed_max * (engine->settings.shift ? 1 + SHIFTING_LIMIT : 1);
  const bool sites = s->wall == PASS_SITES;
  double horizon = speed > 0 ? fmax(path - engine->moved, 0.1 * path) / speed : 0;
  if (sites) horizon = 0;
  if (RANKS) engine_settle(engine);
  engine->boxes.begin = engine_first_slot(engine) / CLUSTER;
  engine->boxes.end = engine_end_slot(engine) / CLUSTER;
  TRY(cluster_boxes_fluid(p, horizon, SWERVE, sites ? 0 : MARGIN * spacing, &engine->boxes));
  if (engine_is_shared(engine)) {
    TRY(engine_list_shared(engine, range, widest));
    if (sites && !engine->sites_known) TRY(sum_walls_of_sites(engine, range, widest));
    goto listed;
  }
  if (sites && !engine->sites_known) TRY(sum_walls_of_sites(engine, range, widest));
  TRY(cluster_bins_make(&p->frame, &engine->boxes, range, &bins));
  TRY(neighbours_build(&p->frame, &engine->boxes, &bins, range, widest, &engine->fluid_fluid));
  if (s->wall == PASS_ADAMI) {
    TRY(cluster_boxes_wall(p, &wall_boxes));
    TRY(neighbours_build(&p->frame, &wall_boxes, &bins, range, widest, &engine->wall_fluid));
  }
  cluster_bins_free(&bins);
  if (!sites)
    TRY(neighbours_build(&p->frame, &engine->boxes, &engine->wall_bins, range, widest,
                         &engine->fluid_wall));
listed:
  if (sites && !engine->sites_known) {
    run_pass(engine, engine->table->sites_moments, false, PHASE_WALL);
    engine_sites_finish(engine);
    engine->sites_known = true;
  }
  /* Counting costs half a density pass; the number changes by parts per thousand in a run. */
  if (engine->pairs_fluid == 0) count_pairs(engine);
  engine->listed = true;
  engine->rebuilds++;
cleanup:
  cluster_set_free(&wall_boxes);
  cluster_bins_free(&bins);
  engine->seconds[PHASE_LISTS] += clock_seconds() - start;
  return status;
}

/* x += (v + u) share dt; finds the largest speed and displacement, and whether a particle has left
 * the box that the lists were made for. */
static void drift(struct engine *engine, double share) {
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  double dt = share * engine->settings.dt, speed = 0, step = 0;
  double per_unit[3];
  bool left = false;
  const size_t first = engine_first_slot(engine), end = engine_end_slot(engine);
  for (int a = 0; a < 3; a++) per_unit[a] = p->frame.step[a] == 0 ? 0 : dt / p->frame.unit[a];
#pragma omp parallel for schedule(static) num_threads(engine->threads) reduction(max               \
                                                                                 : speed, step)    \
    reduction(||                                                                                   \
              : left)
  for (size_t i = first; i < end; i++) {
    const struct cluster_box *box = &engine->boxes.boxes[i / CLUSTER];
    double own = 0, moving = 0;
    bool out = false;
    for (int a = 0; a < 3; a++) {
      double v = (double)p->v[a][i];
      own += v * v;
      if (p->shift[0] != NULL) v += (double)p->shift[a][i];
      moving += v * v;
      double units = v * per_unit[a];
      if (fabs(units) < 0x1p30) p->x[a][i] += (uint32_t)(int32_t)lrint(units);
      /* Within the box: centre - half <= x <= centre + half, modulo 2^32. */
      out = out || p->x[a][i] - box->centre[a] + box->half[a] > 2 * box->half[a];
    }
    /* What stands in an empty slot is no particle's, and not the same after a resume. */
    if (p->id[i] == NO_PARTICLE) continue;
    left = left || out;
    speed = fmax(speed, own);
    step = fmax(step, moving);
  }
  if (engine_is_shared(engine)) {
    double most[] = {speed, step, left, engine->locals[0].overflow};
    for (int t = 1; t < engine->threads; t++) most[3] = fmax(most[3], engine->locals[t].overflow);
    ranks_max_all(most, 4);
    speed = most[0], step = most[1], left = most[2] > 0;
    engine->locals[0].overflow = most[3] > 0;
  }
  engine->speed_max = sqrt(speed);
  engine->moved += sqrt(step) * dt;
  if (left) engine->listed = false;
  engine->seconds[PHASE_DRIFT] += clock_seconds() - start;
}

/* Differences leave the mean pressure free, and rounding and disorder let it walk: it is taken out
 * now and then. Sums over fixed blocks, so that neither threads nor ranks change a bit. */
static enum status remove_mean_pressure(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const size_t blocks = (engine_all_slots(engine) + MEAN_BLOCK - 1) / MEAN_BLOCK;
  const size_t first = engine_first_slot(engine), last = engine_end_slot(engine);
  const size_t own = engine_number(engine, first) / MEAN_BLOCK;
  double *sums = NULL, sum = 0;
  TRY(memory_allocate(&sums, blocks, sizeof *sums, "block sums"));
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t b = 0; b < (last - first + MEAN_BLOCK - 1) / MEAN_BLOCK; b++)
    for (size_t i = first + b * MEAN_BLOCK; i < first + (b + 1) * MEAN_BLOCK && i < last; i++)
      if (p->id[i] != NO_PARTICLE) sums[own + b] += (double)p->state[i];
  TRY(engine_gather_blocks(engine, MEAN_BLOCK, sums, sizeof *sums));
  for (size_t b = 0; b < blocks; b++) sum += sums[b];
  float mean = (float)(sum / (double)p->count);
#pragma omp parallel for schedule(static) num_threads(engine->threads)
  for (size_t i = first; i < last; i++) p->state[i] -= mean;
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

/* The rest of a step on sites. */
static enum status continue_on_sites(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  engine_sites_flux(engine);
  if (RANKS) engine_send(engine, SENT_FLUX);
  p->state_next = p->flux[0]; /* what it held is in the flux now */
  run_pass(engine, engine->table->sites_continuity, false, PHASE_CONTINUITY);
  engine->pair_interactions += (double)engine->pairs_fluid;
  swap(&p->state, &p->flux[0]);
  drift(engine, 0); /* finds the largest speed */
  if (engine->steps % MEAN_STEPS == 0) TRY(remove_mean_pressure(engine));
  if (RANKS) engine_send(engine, SENT_STATE);
cleanup:
  return status;
}

static void take_velocities(struct particles *p) {
  for (int a = 0; a < 3; a++) swap(&p->v[a], &p->v_next[a]);
}

/* What the forces need to know: densities, or what is at the walls. */
static void prepare(struct engine *engine) {
  const struct pair_table *table = engine->table;
  if (engine->settings.wall == PASS_FROZEN) {
    engine_clear_wall_sums(engine);
    run_pass(engine, table->density, false, PHASE_DENSITY);
    engine_settle_wall_sums(engine);
    if (RANKS) engine_send(engine, SENT_DENSITY);
    if (RANKS) engine_send(engine, SENT_WALL);
  } else if (engine->settings.wall == PASS_ADAMI) {
    run_pass(engine, table->image_velocity, true, PHASE_WALL);
    if (RANKS) engine_send(engine, SENT_WALL);
  } else if (engine->settings.wall == PASS_SUBVOXEL) {
    engine_update_distance(engine);
  }
}

/* Velocities belong to the middle of a step, positions and pressures to its ends (leapfrog). The
 * pressure is therefore carried on by the divergence half-way: on the places of the step's start it
 * would lag, and take (dt/2) |grad p|^2 a second from the flow. */
enum status engine_step(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const struct engine_settings *s = &engine->settings;
  const struct pair_table *table = engine->table;
  if (!engine->listed || engine->moved >= PATH * engine->pass.spacing)
    TRY(make_lists(engine, true));
  engine->pass.shift_speed = engine->speed_max;
  double moved = engine->speed_max * s->dt * s->smoothing_length * s->crowding;
  engine->pass.shift_length =
      s->smoothing_length * fmin(SHIFTING_STRENGTH, moved > 0 ? SHIFTING_STABLE / moved : INFINITY);
  bool has_walls = engine_has_walls(engine);
  prepare(engine);
  if (s->wall == PASS_FROZEN)
    engine->pair_interactions += (double)(engine->pairs_fluid + engine->pairs_wall);
  if (s->wall == PASS_ADAMI) engine->pair_interactions += (double)engine->pairs_wall;
  run_pass(engine, table->force[s->wall][s->viscosity][s->shift], false, PHASE_FORCE);
  engine->pair_interactions += (double)engine->pairs_fluid;
  take_velocities(p);
  if (s->wall == PASS_SITES) {
    TRY(continue_on_sites(engine));
  } else if (s->wall == PASS_FROZEN) {
    drift(engine, 1);
    if (RANKS) engine_send(engine, SENT_MOTION);
  } else {
    drift(engine, 0.5);
    if (!engine->listed)
      TRY(make_lists(engine, false));
    else if (RANKS)
      engine_send(engine, SENT_MOTION);
    p->state_next = p->v_next[0]; /* the old velocity is not needed any more */
    /* Beside sub-voxel walls the force pass has done all but the pairs of fluid. */
    bool done = s->wall == PASS_SUBVOXEL;
    pass_function *continuity =
        s->wall == PASS_OPEN
            ? table->continuity_exact[s->diffusion][s->shift]
            : table->continuity[has_walls && !done][s->diffusion][s->shift && !done];
    run_pass(engine, continuity, false, PHASE_CONTINUITY);
    engine->pair_interactions += (double)engine->pairs_fluid;
    swap(&p->state, &p->v_next[0]);
    drift(engine, 0.5);
    if (engine->steps % MEAN_STEPS == 0) TRY(remove_mean_pressure(engine));
    if (RANKS) engine_send(engine, SENT_PLACE);
  }
  engine->steps++;
  for (int t = 0; t < engine->threads; t++)
    if (engine->locals[t].overflow)
      TRY_FAIL(STATUS_NUMERIC,
               "more than %zu particles within reach of one cluster: particles have clumped",
               engine->locals[t].capacity);
cleanup:
  return status;
}

enum status engine_pull(struct engine *engine) {
  enum status status = STATUS_OK;
  const struct engine_settings *s = &engine->settings;
  /* As the next step would. */
  if (!engine->listed || engine->moved >= PATH * engine->pass.spacing)
    TRY(make_lists(engine, true));
  if (s->wall == PASS_SUBVOXEL) engine_update_distance(engine);
  engine->pass.dt = 1;
  run_pass(engine, engine->table->force[s->wall][0][0], false, PHASE_FORCE);
  engine->pass.dt = s->dt;
cleanup:
  return status;
}

enum status engine_account(struct engine *engine, struct pass_account *total) {
  enum status status = STATUS_OK;
  const struct engine_settings *s = &engine->settings;
  struct pass *pass = &engine->pass;
  struct pass_account *sums = NULL;
  if (!engine->listed || engine->moved >= PATH * pass->spacing) TRY(make_lists(engine, true));
  const size_t blocks = (engine_all_slots(engine) / CLUSTER + BLOCK - 1) / BLOCK;
  const size_t first = engine_first_slot(engine), own = engine_number(engine, first);
  const size_t count = sizeof *sums / sizeof(double);
  TRY(memory_allocate(&sums, blocks, sizeof *sums, "block sums"));
  prepare(engine);
  pass->wall = s->wall, pass->shifts = s->shift;
  /* Rows count from the first cluster here; there are no more of others before it than among all.
   */
  pass->account = sums + own / (BLOCK * CLUSTER) - first / (BLOCK * CLUSTER);
  run_pass(engine, engine->table->account, false, PHASE_ACCOUNT);
  TRY(engine_gather_blocks(engine, BLOCK * CLUSTER, sums, sizeof *sums));
  memset(total, 0, sizeof *total);
  for (size_t b = 0; b < blocks; b++)
    for (size_t k = 0; k < count; k++) ((double *)total)[k] += ((const double *)&sums[b])[k];
cleanup:
  memory_free(&sums);
  pass->account = NULL;
  return status;
}

double engine_bytes_thread(const struct lattice *lattice, double support) {
  return LOCAL_FIELDS * sizeof(float) * (double)local_capacity(lattice, support) +
         sizeof(struct collected);
}

double engine_density(const struct engine *engine, size_t slot) {
  double state = (double)engine->particles.state[slot];
  return engine->settings.wall == PASS_FROZEN ? 1 / state : 1 + state;
}

double engine_pressure(const struct engine *engine, size_t slot) {
  double state = (double)engine->particles.state[slot];
  return engine->settings.wall == PASS_FROZEN ? 1 / state - engine->settings.rest_ratio : state;
}
