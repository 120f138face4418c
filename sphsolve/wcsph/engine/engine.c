#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/engine_ranks.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/kernel.h"
#include "common/memory.h"
#include "common/threads.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/engine_walls.h"
#include "sphsolve/wcsph/engine/simd.h"

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

/* Capacity of the buffer of a row cluster in columns: half of the sites within its reach, as the
 * others are walls too deep or out of reach of its rows, plus 2048. */
static size_t local_capacity(const struct lattice *lattice, double support) {
  double sites = 1;
  for (int a = 0; a < 3; a++)
    if (lattice->dimensions == 3 || a != 1)
      sites *= 2 * support / lattice->spacing[a] + 2 * (ENGINE_REACH + 2 * ENGINE_PATH);
  return ((size_t)(0.5 * sites) + 2048) / SIMD_LANES * SIMD_LANES;
}

int engine_threads(const struct lattice *lattice, double support, int most) {
  double neighbours = lattice->dimensions == 3 ? 4.0 / 3 * M_PI : M_PI;
  for (int a = 0; a < 3; a++)
    if (lattice->dimensions == 3 || a != 1) neighbours *= support / lattice->spacing[a];
  return threads_for(neighbours * (double)lattice->fluid_count, PAIRS_PER_THREAD, most);
}

static enum status make_locals(struct engine *engine) {
  enum status status = STATUS_OK;
  size_t capacity = local_capacity(engine->lattice, engine->settings.support);
  engine->threads =
      engine_threads(engine->lattice, engine->settings.support, omp_get_max_threads());
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

/* Places the fluid on its sites; with several ranks, each a contiguous range. */
static enum status place(struct engine *engine) {
  enum status status = STATUS_OK;
  struct particles *p = &engine->particles;
  size_t first = 0, end = p->count;
  if (RANKS) TRY(engine_partition(engine, (p->count + CLUSTER - 1) / CLUSTER));
  if (engine_is_distributed(engine)) {
    const size_t *partition = engine->ranks.fluid.partition + ranks_own();
    first = partition[0] * CLUSTER < end ? partition[0] * CLUSTER : end;
    end = partition[1] * CLUSTER < end ? partition[1] * CLUSTER : end;
  }
  struct particle_fields now = engine->fields;
  now.eulerian = false; /* made later by particles_make_site_terms */
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
  double widest = 0, volume = 1;
  for (int a = 0; a < 3; a++) {
    if (lattice->dimensions == 2 && a == 1) continue;
    widest = fmax(widest, lattice->spacing[a]);
    volume *= lattice->spacing[a];
  }
  const double spacing = pow(volume, 1.0 / lattice->dimensions);
  TRY(pair_table_choose(s->kernel, &engine->table));
  /* Extent of a new cluster, plus the past and future displacement of its members on both sides. */
  double reach = ENGINE_REACH * widest, room = 2 * (1 + ENGINE_SWERVE) * ENGINE_PATH * spacing;
  TRY(particles_make(lattice, s->support + WALL_MARGIN * spacing, reach,
                     2 * (s->support + 2 * (reach + room)), &engine->fields, &engine->particles));
  if (ranks_count() > 1) TRY(engine_order_walls(engine, s->support + WALL_MARGIN * spacing));
  TRY(place(engine));
  if (engine->fields.wall_base) TRY(engine_sum_wall_base(engine));
  TRY(set_velocities(engine));
  if (!engine_is_distributed(engine)) {
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
  if (s->wall != PASS_FROZEN) { /* gradients exact on the lattice */
    pass->g_scale /= s->moment;
    pass->l_scale /= s->moment;
  }
  pass->smoothing_length = h;
  pass->sound_speed = s->sound_speed;
  pass->rest_ratio = s->rest_ratio;
  pass->kinematic_viscosity = s->kinematic_viscosity;
  memcpy(pass->force, s->force, sizeof pass->force);
  pass->diffusion = s->pressure_diffusion;
  pass->weights = s->weights;
  pass->stabilisation = s->pressure_diffusion / (s->sound_speed * s->sound_speed);
  pass->spacing = spacing;
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
  if (RANKS) engine_await_ghosts(engine);
  neighbours_free(&engine->fluid_fluid);
  neighbours_free(&engine->fluid_wall);
  neighbours_free(&engine->wall_fluid);
  cluster_set_free(&engine->boxes);
  engine->listed = false;
}

void engine_free(struct engine *engine) {
  memory_free(&engine->acceleration);
  for (int t = 0; t < engine->threads && engine->locals != NULL; t++) {
    MEMORY_FREE(&engine->locals[t].field[0], &engine->locals[t].collected);
  }
  memory_free(&engine->locals);
  engine_drop_lists(engine);
  cluster_bins_free(&engine->wall_bins);
  ghosts_free(&engine->ranks.fluid);
  ghosts_free(&engine->ranks.walls);
  MEMORY_FREE(&engine->ranks.blocks, &engine->ranks.work);
  particles_free(&engine->particles);
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

struct particle_fields engine_fields(const struct engine_settings *s) {
  bool frozen = s->wall == PASS_FROZEN, adami = s->wall == PASS_ADAMI;
  return (struct particle_fields){
      .shift = s->shift,
      .rate = s->wall == PASS_SUBVOXEL,
      .eulerian = s->wall == PASS_EULERIAN,
      .wall_state = frozen || adami,
      .wall_base = frozen,
      .wall_depth = s->wall == PASS_SUBVOXEL || s->wall == PASS_EULERIAN,
      .wall_v = adami,
      .wall_region = s->wall_moves && s->region_count > 0,
  };
}

/* Memory is largest while lists are made: particles, lists, boxes of rows and bins of columns. For
 * the ordering (16 bytes of keys per particle) and for snapshots (24 of points) the lists are
 * freed. */
double engine_bytes_fluid(const struct engine_settings *settings) {
  struct particle_fields fields = engine_fields(settings);
  return SLOTS_FLUID * ((double)particles_bytes_fluid(&fields) + BOXES + BINS) +
         (fields.eulerian ? LISTS_EULERIAN : LISTS_FLUID) +
         (settings->own_count > 0 ? SLOTS_FLUID * 3 * sizeof(double) : 0);
}

double engine_bytes_wall(const struct engine_settings *settings) {
  struct particle_fields fields = engine_fields(settings);
  return SLOTS_WALL * ((double)particles_bytes_wall(&fields) + BINS) +
         (fields.wall_region ? (double)sizeof(uint16_t) / CLUSTER : 0) +
         (settings->wall == PASS_ADAMI ? BOXES + LISTS_WALL : 0);
}
