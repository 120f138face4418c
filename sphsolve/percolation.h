/* Whether fluid sites lead through a periodic lattice along a direction. */
#ifndef TOSUI_SPHSOLVE_PERCOLATION_H
#define TOSUI_SPHSOLVE_PERCOLATION_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/lattice.h"

/* *flows: some path over fluid sites, edges and corners included, returns to its start one or more
 * boxes farther with a component along `direction`. */
enum status percolation_find(const struct lattice *lattice, const double direction[3], bool *flows);

#endif
