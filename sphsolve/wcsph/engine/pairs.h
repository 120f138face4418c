/* The passes over pairs of particles, with one table for each kernel and instruction set.
 *
 * A pass processes row clusters [begin, end). Rows are independent, so results do not depend on the
 * number of threads. Lengths are in units of 2 h; `scale` converts fixed-point differences. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/kernel.h"
#include "sphsolve/wcsph/engine/neighbours.h"
#include "sphsolve/wcsph/engine/particles.h"

/* Wall treatment, which determines the form of the equations of a row. */
enum pass_wall {
  PASS_FROZEN,
  PASS_OPEN,
  PASS_ADAMI,
  PASS_SUBVOXEL,
  PASS_EULERIAN, /* sub-voxel walls, and Eulerian fluid on lattice points: pairs_eulerian.h */
  PASS_WALLS
};

/* Unit of the sums of wall densities, relative to rho_0: values up to 8 fit. */
#define WALL_SUM_UNIT 0x1p-29

/* If several threads add to the same sums, each thread first collects its contributions to this
 * many clusters. */
#define COLLECTED 1024
struct collected {
  uint32_t cluster[COLLECTED];
  uint64_t sum[COLLECTED][CLUSTER / 2]; /* each holds two 32-bit sums */
};
/* Adds the collected sums of one entry, or of all, to the common `sums`, and resets them. */
void collected_give(struct collected *from, size_t at, uint32_t *sums);
void collected_give_all(struct collected *from, uint32_t *sums);

/* Columns of a row cluster, gathered and restricted to those within reach. */
#define LOCAL_FIELDS 8
struct local {
  float *field[LOCAL_FIELDS];
  size_t capacity;
  size_t entries;              /* number of wall vectors whose source was stored */
  struct collected *collected; /* NULL with a single thread */
  bool overflow;               /* more columns than `capacity`: particles have clustered */
};

/* Row clusters that a thread processes at a time. */
#define PASS_BLOCK 32

/* Sums over the particles of a block of rows, per mass of one particle: momentum, its rate of
 * change by each effect, energy and powers; see pairs_budget.h. */
struct pass_budget {
  double momentum[3], kinetic, elastic;            /* m/s, m^2/s^2 */
  double pressure[3], viscous[3];                  /* m/s^2 */
  double wall_pressure[3], friction[3], shift[3];  /* m/s^2; shift: Eulerian, advection */
  double force_work, pressure_work, friction_work; /* m^2/s^3 */
  double viscous_work, shift_work;
};

struct pass {
  struct particles *particles;
  const struct neighbour_list *fluid_fluid, *fluid_wall, *wall_fluid;
  float scale[3]; /* 2 h per fixed-point unit */
  float radius;   /* support in 2 h */
  double dt;      /* s */
  /* With the vector forms of the kernel (kernels/): W = w_scale * kernel_vector_w; grad_i W =
   * g_scale * (4 slope/s) * (x_j - x_i)/(2 h); both times the particle volume. g_scale is in 1/m.
   * -(1/r) dW/dr = l_scale * (4 slope/s). */
  double w_scale, g_scale, l_scale;
  double smoothing_length;    /* m */
  double sound_speed;         /* m/s */
  double rest_ratio;          /* gauge: lattice sum / rho_0; absolute: 0 */
  double kinematic_viscosity; /* m^2/s */
  double force[3];            /* m/s^2 */
  double diffusion;           /* m^2/s, of pressure */
  double stabilisation;       /* s, diffusion / c^2; Eulerian */
  double weights;             /* 1/m^2, sum of the diffusion weights on a full lattice; Eulerian */
  double shift_speed;         /* m/s */
  double shift_length;        /* m, A h */
  double spacing;             /* m */
  /* For the budget only. */
  enum pass_wall wall;
  bool shifts;
  struct pass_budget *budget;
};

typedef void pass_function(const struct pass *pass, struct local *local, size_t begin, size_t end);

struct pair_table {
  const char *name;   /* instruction set */
  double kernel_at_0; /* kernel_vector_w(0), exactly */
  /* Sets state = rho_0/rho of fluid by summation over all columns; the contribution of fluid to
   * walls is added to wall_sum. */
  pass_function *density;
  /* Computes v_next from v; [wall][viscous][shift]. */
  pass_function *force[PASS_WALLS][2][2];
  /* Computes state_next from state and v; [walls][diffusion][shift]. With sub-voxel walls the loops
   * without walls and shift are used: these parts follow from sums of the force pass, which stores
   * them in `rate`. */
  pass_function *continuity[2][2][2];
  /* Eulerian: the sums over walls and over fluid, computed once; and the continuity equation with
   * the flux in v_next. */
  pass_function *eulerian_walls, *eulerian_moments, *eulerian_continuity;
  pass_function *continuity_exact[2][2]; /* without walls, [diffusion][shift], see pairs_exact.h */
  pass_function *image_velocity;         /* computes wall_v and wall_state of adami's walls */
  pass_function *budget;                 /* changes no particle */
  /* Count directed pairs within the support without self-pairs: of fluid with all and of fluid with
   * fluid; of wall with fluid. */
  void (*count)(const struct pass *pass, struct local *local, size_t begin, size_t end,
                uint64_t *pairs, uint64_t *alone);
  void (*count_wall)(const struct pass *pass, struct local *local, size_t begin, size_t end,
                     uint64_t *pairs);
};

/* Whether there are pair loops with this kernel. */
bool pair_table_exists(enum kernel kernel);
/* Whether they were compiled for it: baseline, avx2 or avx512. */
bool pair_isa_is_built(const char *name);
/* Chooses the widest instruction set of this machine; TOSUI_ISA=baseline|avx2|avx512 selects a
 * narrower one. */
enum status pair_table_choose(enum kernel kernel, const struct pair_table **table);

#endif
