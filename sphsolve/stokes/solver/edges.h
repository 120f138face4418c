/* Corrections of the volume integral of the velocity where lines of sites end at walls or soil. */
#ifndef TOSUI_SPHSOLVE_STOKES_EDGES_H
#define TOSUI_SPHSOLVE_STOKES_EDGES_H

#include "sphsolve/stokes/solver/operator.h"

/* Fills edge_start, edges and edge_moving of an operator that is otherwise complete. Without
 * subvoxel walls (WALL_SUBVOXEL) there are no edges. */
enum status stokes_edges_build(struct stokes_operator *op);

#endif
