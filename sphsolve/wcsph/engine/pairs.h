/* The passes over pairs of particles, one table for each kernel and instruction set.
 *
 * A pass walks row clusters [begin, end); rows are independent, so that threads change no bit.
 * Lengths inside are in units of 2 h; `scale` turns fixed-point differences into them. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/kernel.h"
#include "sphsolve/wcsph/engine/neighbours.h"
#include "sphsolve/wcsph/engine/particles.h"

/* What stands at the wall; decides which form of the equations the rows take. */
enum pass_wall {
  PASS_FROZEN,
  PASS_OPEN,
  PASS_ADAMI,
  PASS_SUBVOXEL,
  PASS_EULERIAN, /* sub-voxel walls, and Eulerian fluid (stays on its lattice points):
                    pairs_eulerian.h */
  PASS_WALLS
};

/* Sums of wall densities are counted in this part of rho_0: up to 8 fit. */
#define WALL_SUM_UNIT 0x1p-29

/* Where other threads add to the same sums, a thread collects its own first, of so many clusters at
 * a time. */
#define COLLECTED 1024
struct collected {
  uint32_t cluster[COLLECTED];
  uint64_t sum[COLLECTED][CLUSTER / 2]; /* two sums of 32 bits in each */
};
/* Gives the sums of one place, or of all, to `sums` of all threads, and starts anew from 0. */
void collected_give(struct collected *from, size_t at, uint32_t *sums);
void collected_give_all(struct collected *from, uint32_t *sums);

/* Columns of a row cluster, gathered and cut to what is in reach. */
#define LOCAL_FIELDS 8
struct local {
  float *field[LOCAL_FIELDS];
  size_t capacity;
  size_t entries;              /* of walls whose place was gathered */
  struct collected *collected; /* NULL: there is no other thread */
  bool overflow;               /* more columns than `capacity`: particles have clumped */
};

/* Row clusters a thread takes at a time. */
#define PASS_BLOCK 32

/* Sums over the particles of a block of rows, per mass of one particle: of velocities, what a
 * second adds to them by each effect, and powers; see pairs_budget.h. */
struct pass_budget {
  double momentum[3], kinetic, elastic;            /* m/s, m^2/s^2 */
  double pressure[3], viscous[3];                  /* m/s^2 */
  double wall_pressure[3], friction[3], shift[3];  /* m/s^2; Eulerian: of advection */
  double force_work, pressure_work, friction_work; /* m^2/s^3 */
  double viscous_work, shift_work;
};

struct pass {
  struct particles *particles;
  const struct neighbour_list *fluid_fluid, *fluid_wall, *wall_fluid;
  float scale[3]; /* 2 h per fixed-point unit */
  float radius;   /* support in 2 h */
  double dt;      /* s */
  /* With the kernel's vector forms (kernels/): W = w_scale * kernel_vector_w; grad_i W = g_scale *
   * (4 slope/s) * (x_j - x_i)/(2 h); both times the particle volume. g_scale is per metre. -(1/r)
   * dW/dr = l_scale * (4 slope/s). */
  double w_scale, g_scale, l_scale;
  double smoothing_length;    /* m */
  double sound_speed;         /* m/s */
  double rest_ratio;          /* gauge: lattice sum / rho_0; absolute: 0 */
  double kinematic_viscosity; /* m^2/s */
  double force[3];            /* m/s^2 */
  double diffusion;           /* m^2/s, of pressure */
  double stabilisation;       /* s, diffusion / c^2; Eulerian */
  double weights;             /* 1/m^2, of diffusion where no site around is missing; Eulerian */
  double shift_speed;         /* m/s */
  double shift_length;        /* m, A h */
  double spacing;             /* m */
  /* For the budget alone. */
  enum pass_wall wall;
  bool shifts;
  struct pass_budget *budget;
};

typedef void pass_function(const struct pass *pass, struct local *local, size_t begin, size_t end);

struct pair_table {
  const char *name;   /* of the instruction set */
  double kernel_at_0; /* kernel_vector_w(0), exactly */
  /* state = rho_0/rho of fluid by summation over all columns; what walls have of it is added to
   * wall_sum. */
  pass_function *density;
  /* v_next from v; [wall][viscous][shift]. */
  pass_function *force[PASS_WALLS][2][2];
  /* state_next from state and v; [walls][diffusion][shift]. Beside sub-voxel walls without walls
   * and shift: their parts follow from sums of the force pass, which leaves them in `rate`. */
  pass_function *continuity[2][2][2];
  /* Eulerian: once, the sums over walls and over fluid; then, of the flux in v_next. */
  pass_function *eulerian_walls, *eulerian_moments, *eulerian_continuity;
  pass_function *continuity_exact[2][2]; /* without walls, see pairs_exact.h */
  pass_function *image_velocity;         /* wall_v and wall_state of adami's walls */
  pass_function *budget;                 /* changes nothing */
  /* Directed pairs within the support, self excluded: of fluid with all and with fluid alone, and
   * of wall with fluid. */
  void (*count)(const struct pass *pass, struct local *local, size_t begin, size_t end,
                uint64_t *pairs, uint64_t *alone);
  void (*count_wall)(const struct pass *pass, struct local *local, size_t begin, size_t end,
                     uint64_t *pairs);
};

/* Whether there are pair loops with this kernel. */
bool pair_table_exists(enum kernel kernel);
/* The widest this machine runs; TOSUI_ISA=baseline|avx2|avx512 asks for a narrower one. */
enum status pair_table_choose(enum kernel kernel, const struct pair_table **table);

#endif
