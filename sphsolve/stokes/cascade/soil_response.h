/* How k answers to soil with pores below the sites, from a solution that is there:
 *   d ln k / d ln k_micro  without another solve: the system is its own adjoint (state.c), so that
 *     the flux of the solution at hand, corrected by the residual that it leaves where the
 *     permeability of all soil is a little more, is right to the second order
 *     (Pierce, Giles 2000, SIAM Review 42). In words: of the power of the force, what drag takes;
 *   the fraction of the flux through soil: the sum of the superficial velocity over its sites;
 *   k over k_micro: a solve each, that starts where the one beside it has ended. */
#ifndef TOSUI_SPHSOLVE_STOKES_CASCADE_SOIL_RESPONSE_H
#define TOSUI_SPHSOLVE_STOKES_CASCADE_SOIL_RESPONSE_H

#include "sphsolve/output/micropores.h"
#include "sphsolve/stokes/cascade/cascade.h"

/* Fills flux, connected and slope of a solved lattice. Solution, mean and stencil of the solver
 * stand afterwards, all else is of other soil: it is only to be kept. */
enum status soil_response_measure(struct stokes_solver *solver, const struct lattice *lattice,
                                  struct micropores_point *point);

/* By so much at most the slope is too small (tests/verify/verify_micro.c, packings); a share of the
 * error that is found from it takes this in. */
#define SOIL_SLOPE_SMALL 0.15

/* Half width (95 %) of the logarithm of the soil's permeability: what the scene says of it, and
 * what the model says that the peaks of its scan leave; 0: nothing is said. */
double soil_response_uncertainty(const struct scene *scene, const struct model_facts *model);

/* Sites, porosity and permeability of the soil of a lattice. */
void soil_response_describe(const struct lattice *lattice, struct micropores *micropores);

/* The curve over scene->micro.factors, by solves on the last lattice of the cascade, with its
 * solution kept. k is that of each over the last lattice's own, times `k`. A solve that fails
 * leaves its point out, with a warning. */
enum status soil_response_curve(const struct cascade *cascade, const struct lattice *lattice,
                                double k, struct micropores *micropores);

#endif
