/* Laminar and eddy viscosity of the particles, and friction at walls: effects/viscosity.h. */
#ifndef TOSUI_SPHSOLVE_ISPH_VISCOSITY_H
#define TOSUI_SPHSOLVE_ISPH_VISCOSITY_H

#include "sphsolve/isph/state.h"

/* Finds s->eddy and s->viscosity_most from the velocity gradient. Collective. */
void isph_viscosity_find(struct isph *s);
/* Adds the viscous force of pairs on particle i, and that of walls (friction), m/s^2. */
void isph_viscous(const struct isph *s, const struct isph_chunk *chunk, size_t i, double force[3],
                  double friction[3]);

#endif
