/* The water that a scene starts with, as particles of one mass. */
#ifndef TOSUI_SPHSOLVE_ISPH_FILL_H
#define TOSUI_SPHSOLVE_ISPH_FILL_H

#include "sphsolve/isph/state.h"

/* Sets s->porosity_most. */
enum status isph_fill_measure(struct isph *s, const struct lattice *lattice);
/* Collective. Sets s->started. */
enum status isph_fill(struct isph *s, const struct lattice *lattice);
/* Porosity of the soil at a place by its sharp edges, 1 outside. */
double isph_fill_porosity(const struct scene *scene, const double x[3]);

#endif
