/* Seepage through soil that is full of water and stays so. Soil and water are rigid, and inertia is
 * left out, so that the flow is steady at each time:
 *   div v = 0,   A v + b |v| v = p - grad h        p: gravity over 9.80665 m/s^2, as a vector
 * A is the inverse of the permeability, a tensor (Darcy), b the coefficient of Forchheimer (1901).
 *
 * Fluxes are multi-point (MPFA-O: Aavatsmark, Barkve, Boe, Mannseth 1996, J. Comput. Phys. 127, 2).
 * Around each edge of the lattice along y meet four sites, a quarter of each; h is linear in each
 * quarter, and takes one value on both sides in the middle of each face; these values are those at
 * which the flux out of one quarter enters the next. It is exact where h is linear in each soil and
 * faces of soils lie between sites. Without a component xz of the permeability it is the sum of
 * resistances on the path between two sites (Patankar 1980, 4.2-3), as it is along y. Free water
 * beside the soil has a very large permeability.
 *
 * |v| is that of each site, found by iteration: with i = (A + b |v|) v of the last solution, |v| is
 * the speed at which A |v| + b |v|^2 = i. That is exact if the gradient stays, and where the flux
 * stays it halves the error at least. */
#ifndef TOSUI_SPHSOLVE_DARCY_SATURATED_H
#define TOSUI_SPHSOLVE_DARCY_SATURATED_H

#include "sphsolve/darcy/state.h"

/* Finds the sites that meet at corners alone, which the matrix of turned beds couples. */
enum status richards_saturated_corners(struct richards *s);
/* Finds which sites are connected. */
enum status richards_saturated_bodies(struct richards *s);
/* Finds heads and fluxes at a time. Fails where there is no steady flow. */
enum status richards_saturated_solve(struct richards *s, double time);

#endif
