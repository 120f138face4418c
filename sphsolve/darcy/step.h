/* One step in time by the two-stage method SDIRK2 (Alexander 1977), which is of order 2 and
 * L-stable. */
#ifndef TOSUI_SPHSOLVE_DARCY_STEP_H
#define TOSUI_SPHSOLVE_DARCY_STEP_H

#include "sphsolve/darcy/state.h"

/* Takes one step, not beyond `until`, and sets `dt` to its length. STATUS_NUMERIC if no step can be
 * solved. */
enum status richards_advance(struct richards *s, double until, double *dt);

#endif
