/* k from a run: where the force drives water round a periodic box full of it, or two heads drive it
 * along a column of soil; in a tank v / i along gravity means nothing. */
#ifndef TOSUI_SPHSOLVE_ISPH_PERMEAMETER_H
#define TOSUI_SPHSOLVE_ISPH_PERMEAMETER_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* The history's column of isph_column_velocity. */
#define COLUMN_VELOCITY "velocity_through_soil"

/* Darcy velocity through the planes of a column's longest layer of soil, their mean, m/s along its
 * axis: of the soil, clear of its ends, and never of the water before it, which moves by more than
 * what fine soil lets through. False where the scene is no column between two heads. Collective. */
bool isph_column_velocity(const struct isph *s, double *velocity);
/* k with its steadiness and averaging into `result`, NAN where there is none: after the run.
 * Between heads v is the mean over its second half. Collective. */
enum status isph_find_k(const struct isph *s, const struct plan *plan,
                        const struct recorder *recorder, struct run_result *result);

#endif
