/* Reynolds number, for all methods and for explain:
 *
 * Re = u D / nu, where u = v_D / porosity is the pore velocity and D = 4 V / S the hydraulic
 * diameter,
 *
 * with V the volume of the pores and S their surface; this is four times Carman's v_D / (nu S per
 * bulk volume). A bed of spheres of diameter d has D = (2/3) d porosity / (1 - porosity) (Bird,
 * Stewart, Lightfoot 2002, eq. 6.4-6). */
#ifndef TOSUI_SPHSOLVE_PLAN_REYNOLDS_H
#define TOSUI_SPHSOLVE_PLAN_REYNOLDS_H

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/plan/constants.h"

/* Hydraulic diameter, m; 0 without walls. S is the area of voxel faces divided by 3/2, by which
 * they overestimate a smooth surface. */
double hydraulic_diameter(const struct lattice *lattice);
/* Hydraulic diameter of a bed of spheres of diameter `grain_size`, m. */
double hydraulic_diameter_of_grains(double grain_size, double porosity);
/* `darcy`: Darcy velocity, m/s. */
double reynolds_number(const double darcy[3], double porosity, double diameter,
                       double kinematic_viscosity);

/* Hydraulic gradient at which inertia balances INERTIA_SHARE of the force, for a permeability k
 * (m^2), porosity n and kinematic viscosity nu (m^2/s), under standard gravity: g i = nu v / k +
 * beta v^2,   beta = ERGUN_INERTIAL / sqrt(150 k n^3)     (Ergun 1952) NAN without flow. An
 * estimate: beta differs by a factor of two between materials. */
double reynolds_inertia_gradient(double permeability, double porosity, double kinematic_viscosity);
/* Of the coarsest soil of a scene, in a fluid of kinematic viscosity nu; NAN without soil. */
double reynolds_of_soil(const struct scene *scene, double nu, const double darcy[3]);

#endif
