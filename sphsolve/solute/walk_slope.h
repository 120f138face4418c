/* Variation of the flux along a face: subgrid information for walkers in addition to the means in
 * the finite volumes. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_WALK_SLOPE_H
#define TOSUI_SPHSOLVE_SOLUTE_WALK_SLOPE_H

#include "sphsolve/solute/flow.h"

/* Change of the flux (m/s) over one cell along `across`, for the face at the low side of cell x
 * along `axis`; 0 if the face is closed. */
float walk_slope(const struct solute_flow *flow, const int x[3], int axis, int across);

#endif
