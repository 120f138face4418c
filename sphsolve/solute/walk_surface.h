/* The surface at which walkers are reflected: the zero level of a distance that is given at the
 * corners of the cells and trilinear between them. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_SURFACE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_SURFACE_H

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

/* Computes signed distances at the low corner of each cell of the flow, m, [count]. They are
 * interpolated from those at the centres and then shifted, by at most half a spacing, until the
 * cells around each corner together have the pore volume that they have in the flow: between two
 * walls the distance has a ridge, which interpolation cuts off. This would close throats and, where
 * cells are as large as the throats, remove a sixth of the pores. */
enum status walk_surface_find(const struct solute_flow *flow, float *corners);

#endif
