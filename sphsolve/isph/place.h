/* Initial placement of the water. */
#ifndef TOSUI_SPHSOLVE_ISPH_PLACE_H
#define TOSUI_SPHSOLVE_ISPH_PLACE_H

#include "sphsolve/isph/state.h"

/* Initial water, start_count particles on all ranks. Collective. */
enum status isph_place_water(struct isph *s, const struct lattice *lattice);
/* Before that and isph_open_create: chooses the mass of a particle. */
enum status isph_choose_mass(struct isph *s, const struct lattice *lattice);

#endif
