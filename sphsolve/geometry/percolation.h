/* Percolation: whether connected fluid sites lead through a periodic lattice along a direction, and
 * which sites these are. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_PERCOLATION_H
#define TOSUI_SPHSOLVE_GEOMETRY_PERCOLATION_H

#include <stdbool.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* *flows: whether a path over the faces of fluid sites (with `corners` also over their edges)
 * returns to its start one or more periods farther, with a component along `driving`.
 * flowing[lattice->count], initially 0, becomes PERCOLATION_FLOWS in the pores of such paths; it
 * may be NULL. */
#define PERCOLATION_FLOWS 2
enum status percolation_find(const struct lattice *lattice, const double driving[3], bool corners,
                             uint8_t *flowing, bool *flows);

/* The message, with advice, if no path exists. */
const char *percolation_none(const struct lattice *lattice);

/* Collective. Turns pores without flow (over faces) into walls, so that their fluid is at rest;
 * their wall distances do not change. Does nothing if there is no flow at all. *closed: number of
 * these sites; *flows as above. */
enum status percolation_close(struct lattice *lattice, const double driving[3], size_t *closed,
                              bool *flows);

#endif
