/* The surface at which walkers turn back: the wall as the place where a distance is 0 that is given
 * at the corners of the cells and linear between them. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_SURFACE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_SURFACE_H

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

/* Signed distances at the low corner of each cell of the flow, m, [count]. Interpolated from those
 * at the centres, and then moved, by half a spacing at most, until the cells around each corner
 * hold together as much of the pore as the flow has in them: between two walls the distance has a
 * ridge that interpolation cuts off, which would close throats and, where the cells are as large as
 * them, take a sixth of the pores. */
enum status walk_surface_find(const struct solute_flow *flow, float *corners);

#endif
