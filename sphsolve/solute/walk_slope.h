/* How the flux of a face varies along it: what a walker in the cell sees between the means that the
 * finite volumes keep. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_SLOPE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_SLOPE_H

#include "sphsolve/solute/flow.h"

/* Change of the flux (m/s) over one cell along `across`, of the face at the low side of cell x
 * along `axis`; 0 where the face is closed. */
float walk_slope(const struct solute_flow *flow, const int x[3], int axis, int across);

#endif
