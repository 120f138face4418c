/* The pair loops, for the kernel and instruction set of pair_loops.c. Each loop is specialised at
 * compile time for its set of effects: the flags of an `always_inline` function are constants where
 * it is instantiated, so that inactive effects generate no code.
 *
 * A row cluster first gathers its columns into a small local buffer (pairs_gather.h); then each row
 * loops over the buffer with full vectors. */
#include "sphsolve/wcsph/engine/pairs_budget.h"
#include "sphsolve/wcsph/engine/pairs_continuity.h"
#include "sphsolve/wcsph/engine/pairs_count.h"
#include "sphsolve/wcsph/engine/pairs_density.h"
#include "sphsolve/wcsph/engine/pairs_eulerian.h"
#include "sphsolve/wcsph/engine/pairs_force.h"

#define FORCE(wall, viscous, shift)                                                                \
  static void force_##wall##_##viscous##_##shift(const struct pass *pass, struct local *local,     \
                                                 size_t begin, size_t end) {                       \
    force_rows(pass, local, begin, end, PASS_##wall, viscous, shift);                              \
  }
#define FORCES(wall) FORCE(wall, 0, 0) FORCE(wall, 0, 1) FORCE(wall, 1, 0) FORCE(wall, 1, 1)
FORCES(FROZEN)
FORCES(OPEN)
FORCES(ADAMI)
FORCES(SUBVOXEL)
#define CONTINUITY(walls, diffusion, shift)                                                        \
  static void continuity_##walls##_##diffusion##_##shift(                                          \
      const struct pass *pass, struct local *local, size_t begin, size_t end) {                    \
    continuity_rows(pass, local, begin, end, walls, diffusion, shift, false);                      \
  }
#define CONTINUITIES(walls)                                                                        \
  CONTINUITY(walls, 0, 0) CONTINUITY(walls, 0, 1) CONTINUITY(walls, 1, 0) CONTINUITY(walls, 1, 1)
CONTINUITIES(0)
CONTINUITIES(1)
static void eulerian_continuity(const struct pass *pass, struct local *local, size_t begin,
                                size_t end) {
  continuity_rows(pass, local, begin, end, false, true, false, true);
}
#define CONTINUITY_EXACT(diffusion, shift)                                                         \
  static void continuity_exact_##diffusion##_##shift(const struct pass *pass, struct local *local, \
                                                     size_t begin, size_t end) {                   \
    continuity_exact_rows(pass, local, begin, end, diffusion, shift);                              \
  }
CONTINUITY_EXACT(0, 0)
CONTINUITY_EXACT(0, 1)
CONTINUITY_EXACT(1, 0)
CONTINUITY_EXACT(1, 1)

#define TABLE_FORCE(wall)                                                                          \
  {                                                                                                \
    {force_##wall##_0_0, force_##wall##_0_1}, {                                                    \
      force_##wall##_1_0, force_##wall##_1_1                                                       \
    }                                                                                              \
  }
#define TABLE_CONTINUITY(walls)                                                                    \
  {                                                                                                \
    {continuity_##walls##_0_0, continuity_##walls##_0_1}, {                                        \
      continuity_##walls##_1_0, continuity_##walls##_1_1                                           \
    }                                                                                              \
  }
#define TABLE_NAME_(kernel, isa) pair_table_##kernel##_##isa
#define TABLE_NAME(kernel, isa) TABLE_NAME_(kernel, isa)
#define TEXT_(isa) #isa
#define TEXT(isa) TEXT_(isa)
const struct pair_table TABLE_NAME(KERNEL_NAME, SIMD_ISA) = {
    .name = TEXT(SIMD_ISA),
    .kernel_at_0 = KERNEL_AT_0,
    .density = density,
    .force = {TABLE_FORCE(FROZEN),
              TABLE_FORCE(OPEN),
              TABLE_FORCE(ADAMI),
              TABLE_FORCE(SUBVOXEL),
              {{eulerian_acceleration, eulerian_acceleration}, {eulerian_force, eulerian_force}}},
    .continuity = {TABLE_CONTINUITY(0), TABLE_CONTINUITY(1)},
    .continuity_exact = TABLE_CONTINUITY(exact),
    .eulerian_walls = eulerian_walls,
    .eulerian_moments = eulerian_moments,
    .eulerian_continuity = eulerian_continuity,
    .image_velocity = image_velocity,
    .budget = budget,
    .count = count,
    .count_wall = count_wall,
};
