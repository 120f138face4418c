/* What depends on the places of the particles, after they have moved. */
#ifndef TOSUI_SPHSOLVE_ISPH_REFRESH_H
#define TOSUI_SPHSOLVE_ISPH_REFRESH_H

#include "sphsolve/isph/state.h"

/* Sorts the particles and updates what depends on their places: the state is then fresh, as
 * isph_create and isph_advance leave it. To be called after any other change of positions.
 * Collective. */
enum status isph_refresh(struct isph *s);

#endif
