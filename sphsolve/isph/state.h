/* The particles of method isph, and all that a step needs of them.
 *
 * Every particle carries a fixed mass of water m. Its bulk volume V = m / (eps rho_w) and its
 * support he = ratio V^(1/dimensions) follow the porosity eps at its place, so that inside soil the
 * particles stand further apart and still see the same number of neighbours. Velocities are Darcy
 * velocities v_D; particles move with v_D / eps.
 *
 * Particles are sorted by cell each step; neighbour lists are kept per chunk of CHUNK particles, so
 * that threads never share an array and no sum depends on their number.
 *
 * Functions that all ranks call together (`collective`) have the same result to the bit on any
 * number of them. */
#ifndef TOSUI_SPHSOLVE_ISPH_STATE_H
#define TOSUI_SPHSOLVE_ISPH_STATE_H

#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/isph/boundaries.h"
#include "sphsolve/parallel/ghosts.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/plan/effect.h"
#include "sphsolve/output/conservation.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/march/monitor.h"
#include "sphsolve/march/watchdog.h"

#define CHUNK 64     /* particles per chunk of the neighbour lists and of sums */
#define SUMS 36      /* most sums that isph_sum_chunks adds up at once */
#define PAIR_BITS 27 /* bits of the index in a pair entry; the image code is above them */
#define PAIR_MASK ((1u << PAIR_BITS) - 1)
#define GROUND_MIXED (-1) /* of isph.ground: an edge of soil is near */
#define IMAGE_NONE 13     /* code of "no image" */

#define ISPH_OWN (BUDGET_TERMS - BUDGET_OWN)
#define ISPH_EFFECTS 40   /* most active effects */
#define ISPH_OWN_FIELDS 8 /* most fields of effects */

/* Which parts of the physics are on; each flag belongs to an effect of the plan. */
struct isph_switches {
  bool soil, moving_soil, drag_linear, drag_forchheimer, interfaces, links;
  bool viscous, turbulence, relaxation, surface, shifting, artificial_viscosity, energy;
  bool no_slip, moving_walls, outlines, open_sides, wells;
  /* the mobility of a pair: see isph_mobility_between */
  bool mean_of_ends, own_mobilities;
  uint32_t budget; /* bit set of the terms of the active effects */
  size_t own_count;
  const struct effect *own[ISPH_OWN]; /* active effects that add a force or a surface pressure */
  size_t active_count, row_count;
  const struct effect *active[ISPH_EFFECTS]; /* all that are on */
  const struct effect *rows[ISPH_EFFECTS];   /* those that add to rows of the pressure equation */
  double dt_most; /* s; least limit of the effects that does not depend on the state */
  const char *dt_most_by;
};

/* Interface between soils at a particle: drag along it is less than across it (isph/soil.c). */
struct isph_interface {
  double normal[3];                             /* unit; 0 away from interfaces */
  double drag_a, drag_b, drag_factor, mobility; /* along it; those of isph are across it */
  double plane;                                 /* 1 at a plane, falling to 0 at corners */
};

/* The edge of mobility at a particle, which does not depend on the pressure: isph/interface.h. */
struct isph_edge_frame {
  double normal[3], share; /* unit normal, 0: no edge; weight of neighbours along the edge */
};

/* What links did to a particle near an edge of soil in a step: isph/link.h. */
struct isph_linked {
  double normal[3];               /* unit; 0 away from edges */
  double inertia, drag_a, drag_b; /* means of the links: I, a, and b |v| (1/s) */
  struct isph_edge_frame edge;
};

/* What a step did to a particle, kept for the budget, which needs the final velocity: the pressure
 * gradient (less rho f, Pa/m; across an edge the plain one), viscous forces of pairs and of walls
 * (m/s^2), and the change of v* at open sides (m/s). */
struct isph_applied {
  double pressure[3], viscous[3], friction[3], straightened[3];
};

struct isph_chunk {
  size_t begin, end;
  struct budget_sums budget; /* budget of the step */
  bool outer;                /* has pairs with particles of other ranks */
  size_t pair_count, pair_capacity;
  uint32_t *pair;       /* neighbour | image << PAIR_BITS */
  float *slope;         /* -W'(r)/r of the pair, normalised */
  float *mobility;      /* mobility of the pair; NULL without links */
  float *path_porosity; /* mean porosity on its path: isph/link.h; NULL without links */
  float *matrix;        /* a_ij of the pressure equation, m^3 * m^3 s/kg / m^2 */
  size_t wall_count, wall_capacity;
  uint32_t *wall; /* boundary particle | image << PAIR_BITS */
  float *wall_slope;
};

struct isph_cells {
  int count[3];
  int axis[3]; /* from the fastest index of a cell to the slowest, which is the longest axis */
  double origin[3], size[3];
  uint32_t *start; /* [cells + 1] */
};

struct isph_solve {
  int iterations, iterations_total, solves;
  double residual;
  double energy, pressure; /* of the first solve: x.b, and the largest pressure, Pa */
  bool fresh;              /* the matrix has no preconditioner yet */
  bool carries;            /* the first projection uses the last step's pressure */
  bool again;              /* second projection, of the remaining div v */
};

/* Energies of a step, J or J/m, for the bound on the energy: isph/energy.h. */
struct isph_energy_step {
  double kinetic, most, given, moved;
  size_t total; /* particles at its begin */
};

/* Planned end of the run: length of the last step, s, and the number of steps from it to the end; 0
 * as long as the end is far away. */
struct isph_ending {
  double last;
  int steps;
};

struct isph_multigrid;
struct isph_petsc;
struct isph_well; /* isph/well.h */
struct isph_outlet;
struct isph_ground; /* isph/link.h */
struct isph_facing; /* isph/outline.h */

struct isph {
  const struct scene *scene;
  struct isph_switches on;
  int dimensions;
  double spacing, thickness; /* m; thickness: of a 2-D scene, 1 in 3-D */
  double low[3], high[3];    /* the domain */
  bool periodic[3];
  bool reflects[3][2];   /* low and high side of each axis: isph/reflection.h */
  double behind[BEHIND]; /* table of isph_reflection_backs, in steps of 1/BEHIND_STEPS of a size */
  struct isph_image image[27];         /* by code: x + 3 y + 9 z, each 0 .. 2 */
  double kernel_w, kernel_slope;       /* normalise the lattice sums of V W and V slope r^2 to 1 */
  double slope_sum;                    /* of V slope r0^2 on the lattice, r0 = V^(1/dimensions) */
  double shift_stiffness;              /* of grad C on the lattice, in spacings; see shifting.h */
  double kernel_top;                   /* sum V W in a surface's top layer */
  double asymmetry_top;                /* |sum V grad W| he / sum V slope r^2 there */
  double density, kinematic_viscosity; /* rho_w, nu */
  double force[3];                     /* g + a - grad P / rho, m/s^2 */
  double relaxation_factor;            /* factor of the expansion by relaxation; isph/energy.c */
  double relaxation_excess, crowd_factor; /* its share beyond friction's work; factor for crowds */
  double friction;             /* kinetic energy that v* has lost in a step, J (J/m in 2-D) */
  double relaxation_time, dt;  /* s, of the present step */
  double time, viscosity_most; /* s; the largest nu + nu_T of the last step */
  /* the step whose pressure is that of the first rows is on trial; its length, s: isph/method.c */
  bool on_trial;
  double trial_dt;
  double artificial_viscosity; /* m^2/s, lower bound of the eddy viscosity */
  int64_t step;
  struct isph_ending ending;

  size_t count, capacity;  /* particles on this rank: own ones, and ghosts before and after */
  size_t total;            /* of all ranks */
  size_t start_count;      /* of all ranks, at the start */
  struct ghosts local;     /* this rank computes [local.begin, local.end) */
  size_t *chunk_partition; /* [ranks + 1]: each rank's first chunk among those of all */
  double *layer_start; /* [layers + 1]: particles of all ranks before a layer; NULL on one rank */
  double pairs_now;    /* pairs of the own particles */
  uint64_t next_id;
#define FIELD(use, type, shape, name, ...) type(*name) shape;
#include "sphsolve/isph/fields.def"
#undef FIELD
  double (*own_force[ISPH_OWN])[3];   /* m/s^2, of the effects on.own; NULL: no force */
  double *own_field[ISPH_OWN_FIELDS]; /* of the active effects: isph_own_field */
  double *work[4];                    /* r, z, p, q of CG */
  void *scratch;                      /* 3 doubles a particle */
  struct isph_ground *grounds; /* [1 + regions], by `ground`: isph/link.h; NULL without links */
  struct isph_multigrid *multigrid;
  struct isph_petsc *petsc;
  double *partial; /* [chunks of all ranks]: parts of a sum */
  size_t partial_room;
  double (*sums)[SUMS]; /* [own chunks]: parts of several sums; isph_sum_chunks */
  size_t chunk_count, chunk_capacity;
  struct isph_chunk *chunks;
  struct isph_cells cells, wall_cells;
  uint32_t *wall_order;
  size_t enclosed_count; /* bodies of water without a surface */
  double *enclosed;      /* their numbers */
  bool closed;           /* no row fixes the pressure: its mean is removed */
  struct isph_solve solve;

  /* boundary */
  size_t wall_box_count;
  struct isph_wall_box *wall_boxes;
  size_t boundary_count;
  double (*boundary_position)[3];
  double *boundary_pressure; /* open sides of given head; NULL without any */
  double *boundary_volume;   /* NULL without open sides and wall boxes: all have wall_volume */
  uint8_t *boundary_kind;
  uint16_t *boundary_box; /* wall box, or open side */
  size_t side_count, column_count;
  struct isph_open_side *sides;
  struct isph_column *columns;
  double *column_front; /* distance of the foremost particle behind the side, 0 .. 1.1 pitches */
  double wall_volume;
  double room;       /* bulk volume of the water at the start, m^3 (m^2 in 2-D) */
  double mass_ratio; /* mass of a particle over that of a cube of free water one spacing wide */
  double support_max, support_now; /* the largest possible, and the present largest */
  double soil_porosity_least;

  size_t well_count;
  struct isph_well *wells;
  double (*soil_offset)[3]; /* how far each region's soil has moved */

  /* conservation budget */
  double fastest_lost[5]; /* speed, position and id of the fastest particle lost in this step */
  size_t lost_count, left_count, entered_count;
  double losses[CONSERVATION_LOSSES][6]; /* of the first lost particles: id, time, position, mass */
  struct conservation_passed passed;
  struct budget budget;
  double budget_stored[4]; /* momentum and energy within a step, before porosity is updated */
  struct isph_energy_step energy_step;
  double *own_numbers[ISPH_EFFECTS]; /* of the active effects: isph_own_numbers */
  double pair_interactions;
  struct watchdog dog;
  bool lid_reached;       /* it has been said that water strikes the lid: isph/watch.c */
  double kernel_sum_peak; /* largest kernel sum since a warning of it; 0: none */
  int64_t stable_from;    /* step of the watchdog's last trip or return to a longer step */
  struct monitor_settling settling;
  int threads_most; /* available threads; a step uses as many as its pairs keep busy */
  double seconds_lists, seconds_predict, seconds_solve, seconds_correct;
  double seconds_setup; /* part of seconds_solve: matrix and preconditioner, on several ranks */
};

/* Whether the scene has axis a: 2-D scenes have no y. */
static inline bool isph_uses_axis(const struct isph *s, int a) {
  return s->dimensions == 3 || a != 1;
}

/* The size of a particle, m: the side of a square or cube of its bulk volume. */
static inline double isph_size_of(const struct isph *s, double volume) {
  return s->dimensions == 3 ? cbrt(volume) : sqrt(volume);
}

/* Whether anything but walls acts on the water. */
static inline bool isph_is_driven(const struct isph *s) {
  const double *f = s->force;
  return f[0] != 0 || f[1] != 0 || f[2] != 0 || s->on.soil || s->on.open_sides;
}

/* Whether nothing but walls acts on water with a surface. */
static inline bool isph_is_unforced(const struct isph *s) {
  return s->on.surface && !isph_is_driven(s);
}

#endif
