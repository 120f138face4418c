/* Predicted cost of a solve. The constants were measured on sand models of 60 to 240 sites a side
 * and on the exact cases of verify_stokes. */
#include "sphsolve/stokes/solver/cost.h"

#include <math.h>
#include <string.h>

#include "sphsolve/stokes/solver/rows.h"

/* Number of iterations until the relative error of k is below e; it does not depend on the size of
 * the lattice:
 *   ITERATIONS_FIRST - ITERATIONS_DECADE log10(e),
 * i.e. 21 for e = 1e-3 and 31 for e = 1e-4. Multiplied by STRAIGHT_WALL_FACTOR for pores with
 * straight walls and by ADAMI_WALL_FACTOR for Adami walls. The error of k is proportional to the
 * square of the residual. */
#define ITERATIONS_DECADE 9.5
#define ITERATIONS_FIRST (-7.0)
#define STRAIGHT_WALL_FACTOR 0.5
#define ADAMI_WALL_FACTOR 1.8
/* CPU seconds: per site and iteration, per fluid site and iteration, and per fluid site for the
 * assembly. */
#define SECONDS_SITE 30e-9
#define SECONDS_FLUID 165e-9
#define SECONDS_BUILD 1e-6
/* Ratio of the CPU time, of an iteration and of the assembly, with soil (pores below the voxel
 * size) to that without. The number of iterations hardly changes: in packings of 60 and 120 sites a
 * side, one third of it soil, it is 0.7 to 1.4 times that with impermeable soil, for k_micro/dx^2
 * from 1e-8 to 1. */
#define SOIL_TIME_RATIO 1.3

double stokes_soil_seconds(const struct lattice *l) {
  return l->micro_porosity != NULL ? SOIL_TIME_RATIO : 1.0;
}

double stokes_iterations(const struct pore_shape *pores, const struct stokes_goal *goal,
                         enum wall_scheme wall) {
  const double k_error = goal->residual > 0.0 ? goal->residual * goal->residual : goal->mean;
  const double count = fmax(ITERATIONS_FIRST - ITERATIONS_DECADE * log10(k_error), 3.0);
  return count * (pores->straight ? STRAIGHT_WALL_FACTOR : 1.0) *
         (wall == WALL_ADAMI ? ADAMI_WALL_FACTOR : 1.0);
}

double stokes_seconds(double iterations, double sites, double fluid) {
  const char *rows = stokes_rows_best()->name;
  const double instruction_set_factor = !strcmp(rows, "avx512") ? 1.0
                                        : !strcmp(rows, "avx2") ? 1.3
                                                                : 2.5;
  return iterations * (SECONDS_SITE * sites + SECONDS_FLUID * instruction_set_factor * fluid) +
         SECONDS_BUILD * fluid;
}

double stokes_solver_seconds(const struct pore_shape *pores, const struct lattice *l,
                             double refined, const struct stokes_goal *goal,
                             enum wall_scheme wall) {
  const double site_ratio = pow(refined, l->dimensions);
  return stokes_soil_seconds(l) * stokes_seconds(stokes_iterations(pores, goal, wall),
                                                 site_ratio * (double)l->count,
                                                 site_ratio * (double)l->fluid_count);
}
