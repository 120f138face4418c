/* The state of a scene at its start. */
#ifndef TOSUI_SPHSOLVE_ISPH_CREATE_H
#define TOSUI_SPHSOLVE_ISPH_CREATE_H

#include "sphsolve/isph/state.h"

/* Particles and walls of the scene's initial state; it is fresh then (refresh.h). Free with
 * isph_free, also after a failure. Collective. */
enum status isph_create(const struct scene *scene, const struct lattice *lattice,
                        const struct isph_switches *switches, struct isph *s);
void isph_free(struct isph *s);

#endif
