/* Whether fluid sites lead through a periodic lattice along a direction, and which. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_PERCOLATION_H
#define TOSUI_SPHSOLVE_GEOMETRY_PERCOLATION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* *flows: some path over the faces of fluid sites, or their edges and `corners` too, returns to its
 * start one or more boxes farther with a component along `driving`. flowing[lattice->count], zero
 * at first, becomes PERCOLATION_FLOWS in the pores of such paths; NULL: which they are is not
 * asked. */
#define PERCOLATION_FLOWS 2
enum status percolation_find(const struct lattice *lattice, const double driving[3], bool corners,
                             uint8_t *flowing, bool *flows);

/* What is said where nothing does, and what to do. */
const char *percolation_none(const struct lattice *lattice);

/* Collective, where something flows: pores through which nothing flows, over faces, become walls
 * without a distance to them: their fluid is at rest. *closed: how many sites that were; *flows as
 * above. */
enum status percolation_close(struct lattice *lattice, const double driving[3], size_t *closed,
                              bool *flows);

#endif
