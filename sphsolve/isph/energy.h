/* The bound on the energy, J or J/m: kinetic energy of the pore velocity, and
 * potential energy -f.x. */
#ifndef TOSUI_SPHSOLVE_ISPH_ENERGY_H
#define TOSUI_SPHSOLVE_ISPH_ENERGY_H

#include "sphsolve/isph/state.h"

double isph_kinetic_energy(const struct isph *s);
double isph_potential_energy(const struct isph *s);
/* Between predictor and projection: the kinetic energy that v* has lost, s->friction. */
void isph_energy_find_friction(struct isph *s);
/* Between predictor and projection: limits the expansion of compressed water. */
void isph_energy_limit_relaxation(struct isph *s, double relaxation_time, double dt);
/* After the projection: the energy that relaxation added in a step, J or J/m, beyond what friction
 * dissipated, if the water is compressed as a whole. */
double isph_energy_from_relaxation(const struct isph *s, double relaxation_time, double dt);
/* Changes the displacements so that their work against the force is at most `available`: the
 * kinetic energy before the step plus that from relaxation, less the present kinetic energy. */
void isph_energy_limit_displacement(struct isph *s, double (*displacement)[3], double available);
/* Slows the water to an energy of `most`; `moved`: kinetic energy after the move, old porosities.
 */
void isph_energy_limit_velocity(struct isph *s, double most, double moved);

#endif
