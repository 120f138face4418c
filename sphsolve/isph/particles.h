/* The arrays of the particles, and particles added to them. */
#ifndef TOSUI_SPHSOLVE_ISPH_PARTICLES_H
#define TOSUI_SPHSOLVE_ISPH_PARTICLES_H

#include "sphsolve/isph/state.h"

enum status isph_reserve(struct isph *s, size_t capacity);
enum status isph_add_particle(struct isph *s, const double position[3], const double velocity[3],
                              double mass);
/* Collective: adds a particle that enters the domain, with its mass (kg, kg/m in 2-D), velocity and
 * pressure (Pa), as the last in the order of all, and books it in the balances. */
enum status isph_let_in(struct isph *s, const double position[3], const double velocity[3],
                        double mass, double pressure);

#endif
