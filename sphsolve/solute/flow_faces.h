/* Fluxes through faces from the velocities at sites. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_FACES_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_FACES_H

#include "sphsolve/solute/flow.h"

/* Sets the face fluxes from site velocities, [nz][ny][nx][3], m/s, 0 in walls. */
void solute_flow_fluxes(struct solute_flow *flow, const float *sites);

#endif
