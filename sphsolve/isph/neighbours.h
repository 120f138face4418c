/* Lists of neighbours, and what they make of each neighbourhood. */
#ifndef TOSUI_SPHSOLVE_ISPH_NEIGHBOURS_H
#define TOSUI_SPHSOLVE_ISPH_NEIGHBOURS_H

#include "sphsolve/isph/state.h"

/* Finds neighbours, kernel_sum, gradient_sum and correction of the sorted particles, their surface
 * weights, and the corrections of free water and of soil. Collective. */
enum status isph_find_neighbours(struct isph *s);

#endif
