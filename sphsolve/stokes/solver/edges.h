/* Where lines of sites end at walls or soil: what the integral of the velocity needs there. */
#ifndef TOSUI_SPHSOLVE_STOKES_EDGES_H
#define TOSUI_SPHSOLVE_STOKES_EDGES_H

#include "sphsolve/stokes/solver/operator.h"

/* Fills edge_start, edges and edge_moving of an operator that has all else; without walls between
 * sites (WALL_SUBVOXEL) there are none. */
enum status stokes_edges_build(struct stokes_operator *op);

#endif
