/* Sums of the kernel over the lattice. */
#ifndef TOSUI_SPHSOLVE_ISPH_LATTICE_SUMS_H
#define TOSUI_SPHSOLVE_ISPH_LATTICE_SUMS_H

#include "sphsolve/isph/state.h"

/* Normalises the kernel by them. */
void isph_normalise_kernel(struct isph *s);

#endif
