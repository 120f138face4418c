/* The weakly compressible engine: particles, lists and passes put together into a time step. It
 * knows numbers and lattices, no scene and no file. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_ENGINE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sphsolve/wcsph/engine/pairs.h"
#include "sphsolve/parallel/ghosts.h"

/* Clusters are cut when wider than this; lists are made for paths of ENGINE_PATH, with so much
 * around them (see cluster_boxes_fluid). All in spacings; measured on sand models,
 * docs/performance.md. */
#define ENGINE_REACH 4.0
#define ENGINE_PATH 1.5
#define ENGINE_SWERVE 0.4

/* A force that an effect brings in its own file (struct effect): the accelerations, m/s^2, of slots
 * engine_first_slot to engine_end_slot, from the engine at the start of a step. */
typedef void engine_force(const void *engine, double (*acceleration)[3]);
#define ENGINE_OWN 4 /* at most */
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
  const double (*region_velocity)[3];         /* of lattice->region - 1; NULL: nothing moves */
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

/* What a rank has to know of the others; empty where there are none. */
struct engine_ranks {
  struct ghosts fluid, walls;
  uint32_t *blocks; /* of own rows: first those that read no ghost */
  size_t inner, count;
  double *work; /* of own rows, by units of the partition; NULL: not known */
  double work_sum;
};

struct engine {
  struct engine_settings settings;
  const struct lattice *lattice;
  struct particles particles;
  struct particle_fields fields;
  struct neighbour_list fluid_fluid, fluid_wall, wall_fluid;
  struct cluster_set boxes; /* of the fluid, with room for paths: the lists hold in them */
  struct cluster_bins wall_bins;
  const struct pair_table *table;
  struct pass pass;
  int threads;
  struct local *locals;
  double moved;     /* m: longest path of any particle since they were ordered; INFINITY: never */
  double speed_max; /* m/s */
  bool listed;      /* the lists hold: no particle has left its box */
  bool terms_known; /* the site terms of all own particles */
  /* Directed, when last counted: of fluid with all, with fluid alone, of walls with fluid. */
  uint64_t pairs_fluid, pairs_alone, pairs_wall;
  double pair_interactions; /* evaluated so far: pairs, once for each equation they enter */
  double seconds[PHASE_COUNT];
  uint64_t rebuilds, steps;
  struct engine_ranks ranks;
  double (*acceleration)[3]; /* m/s^2, of an own force; NULL where there is none */
  /* What each own force gives in a second, over the mass of a particle; by the last engine_budget.
   */
  struct engine_force_sum {
    double impulse[3], work; /* m/s^2, m^2/s^3 */
  } own_sum[ENGINE_OWN];
};

/* The arrays that particles need with these settings. */
struct particle_fields engine_fields(const struct engine_settings *settings);
/* The lattice must outlive the engine. */
enum status engine_make(const struct lattice *lattice, const struct engine_settings *settings,
                        struct engine *engine);
void engine_free(struct engine *engine);
enum status engine_step(struct engine *engine);
/* Collective (common/ranks.h): waits for ghosts under way. */
void engine_await_ghosts(struct engine *engine);
/* Collective: which of so many clusters of fluid are this rank's to hold, from slot 0 on. */
enum status engine_partition(struct engine *engine, size_t clusters);
/* Collective, where own clusters were put in place by hand: they are partitioned as they are. */
enum status engine_adopt_partition(struct engine *engine);
/* Collective: sums over blocks of so many slots, `size` bytes each, of which this rank has its own;
 * then it has all. */
enum status engine_gather_blocks(const struct engine *engine, size_t slots, void *sums,
                                 size_t size);
/* Slots that this rank computes. */
static inline size_t engine_first_slot(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL ? engine->ranks.fluid.begin * CLUSTER : 0;
}
static inline size_t engine_end_slot(const struct engine *engine) {
  return RANKS && engine->ranks.fluid.partition != NULL ? engine->ranks.fluid.end * CLUSTER
                                                        : particles_slots(&engine->particles);
}
/* The place of an own slot in the order of all, and how many that has. */
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
void engine_set_dt(struct engine *engine, double dt);
/* Gives back what the next step makes anew: lists and their boxes. No bit depends on it. */
void engine_drop_lists(struct engine *engine);
/* rho/rho_0 and the gauge pressure over rho_0 c^2 of a slot. */
double engine_density(const struct engine *engine, size_t slot);
double engine_pressure(const struct engine *engine, size_t slot);
/* Distance of a slot to the wall, m: that of the nearest site, continued as the plane it is the
 * distance to. (Interpolation between the sites would cut off the ridge in the middle of a narrow
 * pore, which brakes what flows there: by 10 % in a sand whose pores are two sites wide.) Negated
 * where the field at the nearest site changes faster than a distance can (noise): the curvature of
 * the velocity is then left out. */
double engine_wall_distance(const struct engine *engine, size_t slot);
/* Force and pressure gradient on every fluid particle, m/s^2, as particles.v_next - particles.v
 * until the next step. Changes no bit of what comes. */
enum status engine_find_acceleration(struct engine *engine);
/* What the next step's effects give the fluid, and what there is before it; changes no bit of what
 * comes. */
enum status engine_budget(struct engine *engine, struct pass_budget *total);
/* Collective: v += dt a of each own force in turn, in the order of the registry; with `sums` what
 * each gives goes to engine.own_sum. */
enum status engine_kick(struct engine *engine, bool sums);
/* Most bytes held at any time, everything of the engine included, per fluid site and per wall site:
 * what plans are made with; tests/cli/memory.bats holds it against the count of a run. */
double engine_bytes_fluid(const struct engine_settings *settings);
double engine_bytes_wall(const struct engine_settings *settings);
/* Per thread; `support` in m. */
/* Threads that the pairs of a lattice keep busy. */
int engine_threads(const struct lattice *lattice, double support, int most);
double engine_bytes_thread(const struct lattice *lattice, double support);

#endif
