/* The Reynolds number, the same for all methods and for explain:
 *
 *   Re = u D / nu,   u = v_D / porosity the pore velocity, D = 4 V / S the hydraulic diameter,
 *
 * V the volume of the pores and S their surface; four times Carman's v_D / (nu S per bulk volume).
 * A bed of spheres of diameter d has D = (2/3) d porosity / (1 - porosity) (Bird, Stewart,
 * Lightfoot 2002, eq. 6.4-6). */
#ifndef TOSUI_SPHSOLVE_PLAN_REYNOLDS_H
#define TOSUI_SPHSOLVE_PLAN_REYNOLDS_H

#include "sphsolve/geometry/lattice.h"

/* Below it inertia changes k by less than a thousandth (its share goes with the square). */
#define REYNOLDS_CREEPING 0.4

/* m; 0 without walls. S counts the faces of voxels, which overstate a smooth surface by 3/2. */
double hydraulic_diameter(const struct lattice *lattice);
double hydraulic_diameter_of_grains(double grain_size, double porosity);
/* `darcy` [3], m/s. */
double reynolds_number(const double darcy[3], double porosity, double diameter,
                       double kinematic_viscosity);

#endif
