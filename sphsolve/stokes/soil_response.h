/* Response of k to the permeability k_micro of soil with pores below the site spacing, from a given
 * solution:
 *   d ln k / d ln k_micro, without another solve. The system is its own adjoint (state.c), so that
 *     the flux of the solution, corrected by its residual in the system with slightly more
 *     permeable soil, is accurate to second order (Pierce, Giles 2000, SIAM Review 42). It equals
 *     the fraction of the power of the force that is dissipated by drag;
 *   the fraction of the flux through soil: the sum of the superficial velocity over its sites;
 *   k as a function of k_micro: one solve per value, started from the solution of the one before.
 */
#ifndef TOSUI_SPHSOLVE_STOKES_SOIL_RESPONSE_H
#define TOSUI_SPHSOLVE_STOKES_SOIL_RESPONSE_H

#include "sphsolve/output/micropores.h"
#include "sphsolve/error/cascade.h"

/* Fills flux, connected and slope of `point` for a solved lattice. Afterwards solution, mean and
 * stencil of the solver are unchanged, but the rest belongs to other soil: nothing more can be
 * solved with it. */
enum status soil_response_measure(struct stokes_solver *solver, const struct lattice *lattice,
                                  struct micropores_point *point);

/* Largest relative amount by which the slope is too small (tests/verify/verify_micro.c, packings);
 * the uncertainty computed from the slope includes it. */
#define SOIL_SLOPE_SMALL 0.15

/* Half width (95 %) of ln k_micro: the scene's and the model's (from the peaks of its scan)
 * combined; 0: none is given. */
double soil_response_uncertainty(const struct scene *scene, const struct model_facts *model);

/* Fills sites, porosity and permeability (geometric mean, m^2) of the soil of a lattice. */
void soil_response_describe(const struct lattice *lattice, struct micropores *micropores);

/* Computes the curve of k over scene->micro.factors by solves on the last lattice of the cascade,
 * whose solution is kept. k of each point is its ratio to that of the last lattice, times `k`. A
 * solve that fails omits its point, with a warning. */
enum status soil_response_curve(const struct cascade *cascade, const struct lattice *lattice,
                                double k, struct micropores *micropores);

#endif
