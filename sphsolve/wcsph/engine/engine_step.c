/* One step: lists if they are due, the passes over pairs, and the motion of the particles. */
#include "sphsolve/wcsph/engine/engine_ranks.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/engine/engine_walls.h"

/* Steps between removals of the mean pressure, and slots per block of its sum. */
#define MEAN_STEPS 16
#define MEAN_BLOCK 2048

static void run_pass(struct engine *engine, pass_function *function, bool wall,
                     enum engine_phase phase) {
  double start = clock_seconds();
  size_t clusters = wall ? engine->particles.wall_clusters : engine->particles.clusters;
  if (engine_is_distributed(engine)) {
    engine_run_distributed(engine, function, wall);
    clusters = 0;
  }
  const size_t blocks = (clusters + BLOCK - 1) / BLOCK;
  /* Rows that add to the sums of other rows: few long runs reduce conflicts, which occur at their
   * ends. */
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
  size_t first_wall = walls->partition != NULL ? walls->begin : 0;
  size_t end_wall = walls->partition != NULL ? walls->end : p->wall_clusters;
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
  engine->pairs_wall = (uint64_t)sums[2];
  if (engine->settings.wall == PASS_FROZEN) /* the same pairs in the other direction */
    engine->pairs_wall = engine->pairs_fluid - (uint64_t)sums[1];
}

/* Computes the sums over walls; these and their list are only needed here, before other lists are
 * made. */
static enum status eulerian_sum_walls(struct engine *engine, double range, double widest) {
  enum status status = STATUS_OK;
  const struct pair_table *table = engine->table;
  struct particles *p = &engine->particles;
  if (!engine_is_distributed(engine))
    TRY(neighbours_build(&p->frame, &engine->boxes, &engine->wall_bins, range, widest,
                         &engine->fluid_wall));
  TRY(particles_make_site_terms(p));
  engine_eulerian_begin(engine);
  run_pass(engine, table->eulerian_walls, false, PHASE_WALL);
  neighbours_free(&engine->fluid_wall);
  if (engine_is_distributed(engine)) return STATUS_OK; /* walls are needed for the next lists */
  cluster_bins_free(&engine->wall_bins);
  particles_drop_walls(p);
cleanup:
  return status;
}

/* Makes the lists; at the start of a step (`order`) the particles are sorted again if they have
 * moved far since the last ordering. The order determines the order of sums and so must not depend
 * on when lists are made, as a resumed run makes its own lists. */
static enum status make_lists(struct engine *engine, bool order) {
  enum status status = STATUS_OK;
  double start = clock_seconds();
  struct particles *p = &engine->particles;
  const struct engine_settings *s = &engine->settings;
  struct cluster_set wall_boxes = {0};
  struct cluster_bins bins = {0};
  double spacing = engine->pass.spacing, path = ENGINE_PATH * spacing;
  double range = engine->settings.support + LIST_ROUNDING * spacing, widest = 2 * p->reach;
  if (order && engine->moved >= path) {
    engine_drop_lists(engine); /* frees memory for the keys */
    TRY(engine_is_distributed(engine) ? engine_order(engine) : particles_sort(p));
    engine->moved = 0;
  }
  /* Time until the next ordering at the present speed. */
  double speed = engine->speed_max * (engine->settings.shift ? 1 + SHIFTING_LIMIT : 1);
  const bool eulerian = s->wall == PASS_EULERIAN;
  double horizon = speed > 0 ? fmax(path - engine->moved, PATH_LEFT_MIN * path) / speed : 0;
  if (eulerian) horizon = 0;
  if (RANKS) engine_await_ghosts(engine);
  engine->boxes.begin = engine_first_slot(engine) / CLUSTER;
  engine->boxes.end = engine_end_slot(engine) / CLUSTER;
  TRY(cluster_boxes_fluid(p, horizon, ENGINE_SWERVE, eulerian ? 0 : BOX_MARGIN * spacing,
                          &engine->boxes));
  if (engine_is_distributed(engine)) {
    TRY(engine_list_distributed(engine, range, widest));
    if (eulerian && !engine->terms_known) TRY(eulerian_sum_walls(engine, range, widest));
    goto listed;
  }
  if (eulerian && !engine->terms_known) TRY(eulerian_sum_walls(engine, range, widest));
  TRY(cluster_bins_make(&p->frame, &engine->boxes, range, &bins));
  TRY(neighbours_build(&p->frame, &engine->boxes, &bins, range, widest, &engine->fluid_fluid));
  if (s->wall == PASS_ADAMI) {
    TRY(cluster_boxes_wall(p, &wall_boxes));
    TRY(neighbours_build(&p->frame, &wall_boxes, &bins, range, widest, &engine->wall_fluid));
  }
  cluster_bins_free(&bins);
  if (!eulerian)
    TRY(neighbours_build(&p->frame, &engine->boxes, &engine->wall_bins, range, widest,
                         &engine->fluid_wall));
listed:
  if (eulerian && !engine->terms_known) {
    run_pass(engine, engine->table->eulerian_moments, false, PHASE_WALL);
    engine_eulerian_finish(engine);
    engine->terms_known = true;
  }
  /* Counting costs half a density pass; the number varies by a few per mille during a run. */
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
 * the box for which the lists were made. */
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
      /* Inside the box if centre - half <= x <= centre + half, modulo 2^32. */
      out = out || p->x[a][i] - box->centre[a] + box->half[a] > 2 * box->half[a];
    }
    /* The content of an empty slot is arbitrary and may differ after a resume. */
    if (p->id[i] == NO_PARTICLE) continue;
    left = left || out;
    speed = fmax(speed, own);
    step = fmax(step, moving);
  }
  if (engine_is_distributed(engine)) {
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

/* Pressure differences do not determine the mean pressure, which drifts by rounding and disorder:
 * it is removed regularly. Sums over fixed blocks make the result independent of threads and
 * ranks. */
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

/* The second part of an Eulerian step. */
static enum status continue_eulerian(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  engine_eulerian_flux(engine);
  if (RANKS) engine_send(engine, SENT_FLUX);
  p->state_next = p->flux[0]; /* its content is now included in the flux */
  run_pass(engine, engine->table->eulerian_continuity, false, PHASE_CONTINUITY);
  engine->pair_interactions += (double)engine->pairs_fluid;
  swap(&p->state, &p->flux[0]);
  drift(engine, 0); /* only finds the largest speed */
  if (engine->steps % MEAN_STEPS == 0) TRY(remove_mean_pressure(engine));
  if (RANKS) engine_send(engine, SENT_STATE);
cleanup:
  return status;
}

static void swap_velocities(struct particles *p) {
  for (int a = 0; a < 3; a++) swap(&p->v[a], &p->v_next[a]);
}

/* Computes what the forces need: densities, or the values at walls. */
static void prepare(struct engine *engine) {
  const struct pair_table *table = engine->table;
  if (engine->settings.wall == PASS_FROZEN) {
    engine_clear_wall_sums(engine);
    run_pass(engine, table->density, false, PHASE_DENSITY);
    engine_finish_wall_sums(engine);
    if (RANKS) engine_send(engine, SENT_DENSITY);
    if (RANKS) engine_send(engine, SENT_WALL);
  } else if (engine->settings.wall == PASS_ADAMI) {
    run_pass(engine, table->image_velocity, true, PHASE_WALL);
    if (RANKS) engine_send(engine, SENT_WALL);
  } else if (engine->settings.wall == PASS_SUBVOXEL) {
    engine_update_distance(engine);
  }
}

/* Leapfrog scheme: velocities belong to the middle of a step, positions and pressures to its ends.
 * The pressure is therefore advanced by the divergence at the half step: with the positions of the
 * start of the step it would lag and remove the power (dt/2) |grad p|^2 from the flow. */
enum status engine_step(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  const struct engine_settings *s = &engine->settings;
  const struct pair_table *table = engine->table;
  if (!engine->listed || engine->moved >= ENGINE_PATH * engine->pass.spacing)
    TRY(make_lists(engine, true));
  engine->pass.shift_speed = engine->speed_max;
  double moved = engine->speed_max * s->dt * s->smoothing_length * s->shifting_stiffness;
  engine->pass.shift_length =
      s->smoothing_length * fmin(SHIFTING_STRENGTH, moved > 0 ? SHIFTING_STABLE / moved : INFINITY);
  bool has_walls = engine_has_walls(engine);
  TRY(engine_kick(engine, false));
  prepare(engine);
  if (s->wall == PASS_FROZEN)
    engine->pair_interactions += (double)(engine->pairs_fluid + engine->pairs_wall);
  if (s->wall == PASS_ADAMI) engine->pair_interactions += (double)engine->pairs_wall;
  run_pass(engine, table->force[s->wall][s->viscous][s->shift], false, PHASE_FORCE);
  engine->pair_interactions += (double)engine->pairs_fluid;
  swap_velocities(p);
  if (s->wall == PASS_EULERIAN) {
    TRY(continue_eulerian(engine));
  } else if (s->wall == PASS_FROZEN) {
    drift(engine, 1);
    if (RANKS) engine_send(engine, SENT_MOTION);
  } else {
    drift(engine, 0.5);
    if (!engine->listed)
      TRY(make_lists(engine, false));
    else if (RANKS)
      engine_send(engine, SENT_MOTION);
    p->state_next = p->v_next[0]; /* reuses the memory of the old velocity */
    /* With sub-voxel walls the force pass has computed all but the pairs of fluid. */
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

enum status engine_find_acceleration(struct engine *engine) {
  enum status status = STATUS_OK;
  const struct engine_settings *s = &engine->settings;
  /* As in the next step. */
  if (!engine->listed || engine->moved >= ENGINE_PATH * engine->pass.spacing)
    TRY(make_lists(engine, true));
  if (s->wall == PASS_SUBVOXEL) engine_update_distance(engine);
  engine->pass.dt = 1;
  run_pass(engine, engine->table->force[s->wall][0][0], false, PHASE_FORCE);
  engine->pass.dt = s->dt;
cleanup:
  return status;
}

/* Saves the velocities of own slots in `kept`, or restores them. */
static void keep_velocities(struct engine *engine, float *kept, bool back) {
  const size_t first = engine_first_slot(engine), n = engine_end_slot(engine) - first;
  for (int a = 0; a < 3; a++) {
    float *v = engine->particles.v[a] + first, *own = kept + (size_t)a * n;
    memcpy(back ? v : own, back ? own : v, n * sizeof *v);
  }
}

enum status engine_budget(struct engine *engine, struct pass_budget *total) {
  enum status status = STATUS_OK;
  const struct engine_settings *s = &engine->settings;
  struct pass *pass = &engine->pass;
  struct pass_budget *sums = NULL;
  float *kept = NULL;
  if (!engine->listed || engine->moved >= ENGINE_PATH * pass->spacing)
    TRY(make_lists(engine, true));
  const size_t blocks = (engine_all_slots(engine) / CLUSTER + BLOCK - 1) / BLOCK;
  const size_t first = engine_first_slot(engine), own = engine_number(engine, first);
  const size_t count = sizeof *sums / sizeof(double);
  TRY(memory_allocate(&sums, blocks, sizeof *sums, "block sums"));
  if (s->own_count > 0) { /* as in the next step */
    TRY(memory_allocate(&kept, 3 * (engine_end_slot(engine) - first), sizeof *kept, "velocities"));
    keep_velocities(engine, kept, false);
    TRY(engine_kick(engine, true));
  }
  prepare(engine);
  pass->wall = s->wall, pass->shifts = s->shift;
  /* Blocks are numbered from the first local cluster; its local index does not exceed its global
   * one. */
  pass->budget = sums + own / (BLOCK * CLUSTER) - first / (BLOCK * CLUSTER);
  run_pass(engine, engine->table->budget, false, PHASE_BUDGET);
  TRY(engine_gather_blocks(engine, BLOCK * CLUSTER, sums, sizeof *sums));
  memset(total, 0, sizeof *total);
  for (size_t b = 0; b < blocks; b++)
    for (size_t k = 0; k < count; k++) ((double *)total)[k] += ((const double *)&sums[b])[k];
  for (int k = 0; k < s->own_count; k++) { /* values before these forces act */
    for (int a = 0; a < 3; a++) total->momentum[a] -= s->dt * engine->own_sum[k].impulse[a];
    total->kinetic -= s->dt * engine->own_sum[k].work;
  }
  if (kept != NULL) keep_velocities(engine, kept, true);
  if (RANKS && kept != NULL) engine_await_ghosts(engine);
  if (RANKS && kept != NULL) engine_send(engine, SENT_MOTION);
cleanup:
  MEMORY_FREE(&kept, &sums);
  pass->budget = NULL;
  return status;
}
