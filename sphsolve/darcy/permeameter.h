/* Hydraulic conductivity k of soil that is full of water: where the force drives water round a
 * periodic box, or two heads drive it along a column of soil. */
#ifndef TOSUI_SPHSOLVE_DARCY_PERMEAMETER_H
#define TOSUI_SPHSOLVE_DARCY_PERMEAMETER_H

#include "sphsolve/output/recorder.h"
#include "sphsolve/darcy/state.h"

/* Sets Darcy velocity and k in `result`; NAN if there is no k. */
void richards_find_k(const struct richards *s, struct run_result *result);

#endif
