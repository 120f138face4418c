/* The critical width of a pore space: the diameter of the largest ball that passes through it along
 * the force (Katz, Thompson 1986, Phys. Rev. B 34: 8179). A lattice on which it is less than a
 * spacing may close the way that carries the flow, and one on which it is few spacings resolves
 * that way poorly, however wide the pores are on average. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_THROAT_WIDTH_H
#define TOSUI_SPHSOLVE_GEOMETRY_THROAT_WIDTH_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* *width (m): by wall distances at the sites, thus up to a spacing too small; INFINITY without
 * walls, 0 if no path along `driving` leads through the lattice. */
enum status throat_width_find(const struct lattice *lattice, const double driving[3],
                              double *width);

#endif
