/* The weakly compressible engine: particles, neighbour lists and pair passes combined into a time
 * step. It depends on numbers and lattices, not on scenes or files. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sphsolve/wcsph/engine/pairs.h"
#include "sphsolve/parallel/ghosts.h"

/* Force of an effect in its own file (struct effect): writes the accelerations, m/s^2, of slots
 * engine_first_slot to engine_end_slot, from the engine at the start of a step. */
typedef void engine_force(const void *engine, double (*acceleration)[3]);
#define ENGINE_OWN 4 /* largest number */
struct engine_own {
  const char *name;
  engine_force *force;
};

struct engine_settings {
  enum kernel kernel;
  enum pass_wall wall;
  bool viscous, shift, diffusion;
  double smoothing_length, support; /* m */
  double sound_speed, kinematic_viscosity, dt;
  double force[3];                            /* m/s^2 */
  double rest_ratio;                          /* see struct pass */
  double pressure_diffusion;                  /* m^2/s */
  double moment, shifting_stiffness, weights; /* 1, 1/m^2, 1/m^2, see struct lattice_modes */
  /* Indexed by lattice->region - 1; NULL: nothing moves. */
  const double (*region_velocity)[3];
  size_t region_count;
  bool wall_moves;
  struct engine_own own[ENGINE_OWN];
  int own_count;
};

/* Seconds per phase of the step. */
enum engine_phase {
  PHASE_DENSITY,
  PHASE_WALL,
  PHASE_FORCE,
  PHASE_CONTINUITY,
  PHASE_DRIFT,
  PHASE_LISTS,
  PHASE_BUDGET,
  PHASE_COUNT
};

/* Data of a rank about the others; empty with one rank. */
struct engine_ranks {
  struct ghosts fluid, walls;
  uint32_t *blocks; /* blocks of own rows: first the `inner` ones, which read no ghost */
  size_t inner, count;
  double *work; /* per unit of the partition of own rows; NULL: unknown */
  double work_sum;
};

struct engine {
  struct engine_settings settings;
  const struct lattice *lattice;
  struct particles particles;
  struct particle_fields fields;
  struct neighbour_list fluid_fluid, fluid_wall, wall_fluid;
  struct cluster_set boxes; /* of the fluid, with room for paths: the lists are valid in them */
  struct cluster_bins wall_bins;
  const struct pair_table *table;
  struct pass pass;
  int threads;
  struct local *locals;
  /* M: longest path of any particle since the last ordering; INFINITY: never ordered. */
  double moved;
  double speed_max; /* m/s */
  bool listed;      /* the lists are valid: no particle has left its box */
  bool terms_known; /* the site terms of all own particles are known */
  /* Directed pairs at the last count: of fluid with all, of fluid with fluid, of walls with
   * fluid. */
  uint64_t pairs_fluid, pairs_wall;
  double pair_interactions; /* pairs evaluated so far, counted for each equation they enter */
  double seconds[PHASE_COUNT];
  uint64_t rebuilds, steps;
  struct engine_ranks ranks;
  double (*acceleration)[3]; /* m/s^2, of an effect's own force; NULL if there is none */
  /* Impulse and work of each own force per second and mass of a particle, from the last
   * engine_budget. */
  struct engine_force_sum {
    double impulse[3], work; /* m/s^2, m^2/s^3 */
  } own_sum[ENGINE_OWN];
};

/* Arrays that particles need with these settings. */
struct particle_fields engine_fields(const struct engine_settings *settings);
/* Makes the engine. The lattice must outlive it. */
enum status engine_make(const struct lattice *lattice, const struct engine_settings *settings,
                        struct engine *engine);
void engine_free(struct engine *engine);
/* Advances the particles by one time step; STATUS_NUMERIC if too many have clustered at one
 * place. */
enum status engine_step(struct engine *engine);
/* Collective (common/ranks.h): waits for ghosts in transfer. */
void engine_await_ghosts(struct engine *engine);
/* Collective: assigns `clusters` fluid clusters to the ranks; a rank stores its own from slot 0
 * on. */
enum status engine_partition(struct engine *engine, size_t clusters);
/* Collective, after own clusters were set by the caller: partitions them as they are. */
enum status engine_adopt_partition(struct engine *engine);
/* Collective: gathers sums over blocks of `slots` slots, `size` bytes each, from the ranks that own
 * the blocks. */
enum status engine_gather_blocks(const struct engine *engine, size_t slots, void *sums,
                                 size_t size);
/* Range of slots that this rank computes. */
static inline size_t engine_first_slot(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL ? engine->ranks.fluid.begin * CLUSTER : 0;
}
static inline size_t engine_end_slot(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL ? engine->ranks.fluid.end * CLUSTER
                                                        : particles_slots(&engine->particles);
}
/* Global index of an own slot, and the global number of slots. */
static inline size_t engine_number(const struct engine *engine, size_t slot) {
  const struct ghosts *g = &engine->ranks.fluid;
  return RANKS && g->partition != NULL ? slot + (g->partition[ranks_own()] - g->begin) * CLUSTER
                                       : slot;
}
static inline size_t engine_all_slots(const struct engine *engine) {
  const struct ghosts *g = &engine->ranks.fluid;
  return RANKS && g->partition != NULL ? g->partition[ranks_count()] * CLUSTER
                                       : particles_slots(&engine->particles);
}
static inline bool engine_has_walls(const struct engine *engine) {
  const struct ghosts *w = &engine->ranks.walls;
  return (RANKS && w->partition != NULL ? w->partition[ranks_count()]
                                        : engine->particles.wall_clusters) > 0;
}
/* Changes the time step, s. */
void engine_set_dt(struct engine *engine, double dt);
/* Frees data that the next step makes anew (lists and their boxes). Results stay bitwise
 * unchanged. */
void engine_drop_lists(struct engine *engine);
/* rho/rho_0, and the gauge pressure / (rho_0 c^2), of a slot. */
double engine_density(const struct engine *engine, size_t slot);
double engine_pressure(const struct engine *engine, size_t slot);
/* Distance of a slot to the wall, m: that of the nearest site, extrapolated as the distance to a
 * plane. (Interpolation between sites would cut off the maximum in the middle of a narrow pore,
 * which reduces the flow there: by 10 % in a sand whose pores are two sites wide.) Negative where
 * the field at the nearest site changes faster than a distance can (noise): the curvature of the
 * velocity is then omitted. */
double engine_wall_distance(const struct engine *engine, size_t slot);
/* Acceleration of every fluid particle by force and pressure gradient, m/s^2, as particles.v_next -
 * particles.v until the next step. Later results stay bitwise unchanged. */
enum status engine_find_acceleration(struct engine *engine);
/* Momentum and energy of the fluid, and the contributions of all effects in the next step. Later
 * results stay bitwise unchanged. */
enum status engine_budget(struct engine *engine, struct pass_budget *total);
/* Collective: v += dt a for each own force in turn, in the order of the registry; with `sums` the
 * contributions are stored in engine.own_sum. */
enum status engine_kick(struct engine *engine, bool sums);
/* Largest number of bytes of the whole engine per fluid site and per wall site, used by plans;
 * tests/cli/memory.bats compares them with the memory of a run. */
double engine_bytes_fluid(const struct engine_settings *settings);
double engine_bytes_wall(const struct engine_settings *settings);
/* Number of threads that the pairs of a lattice can use, at most `most`; `support` in m. */
int engine_threads(const struct lattice *lattice, double support, int most);
/* Bytes per thread; `support` in m. */
double engine_bytes_thread(const struct lattice *lattice, double support);

#endif
