/* Predicted cost of a solve: the iterations until the relative error of k is below e are
 *   ITERATIONS_FIRST - ITERATIONS_DECADE log10(e),
 * and the error of k is proportional to the square of the residual. */
#include "sphsolve/stokes/solver/cost.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <string.h>

#include "sphsolve/stokes/solver/rows.h"

#define STRAIGHT_WALL_FACTOR 0.5 /* iterations in pores with straight walls over others */
#define SECONDS_BUILD 1e-6       /* processor seconds of the assembly per fluid site */

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
                                        : !strcmp(rows, "avx2") ? AVX2_FACTOR
                                                                : BASELINE_FACTOR;
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
