/* The largest stable time step, and how the remaining time is divided into steps. */
#ifndef TOSUI_SPHSOLVE_ISPH_TIME_STEP_H
#define TOSUI_SPHSOLVE_ISPH_TIME_STEP_H

#include "sphsolve/isph/state.h"

/* The largest step the effects allow now, s; *limited_by names the effect. */
double isph_stable_dt(const struct isph *s, const char **limited_by);

/* The limit of the first step, s, if a step of dt leads to the present velocities: where water
 * would move by more than its spacing, as beside a head far above it, the way a dt^2 is to be that
 * of all other steps. */
double isph_first_dt(const struct isph *s, double dt);

/* Length of the next step, s, at most the limit. When little time is `left` (s), steps are planned
 * such that they end with the run and none is much shorter than the one before. */
double isph_dt_to_end(struct isph_ending *ending, double left, double limit);

#endif
