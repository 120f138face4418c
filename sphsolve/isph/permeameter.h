/* Hydraulic conductivity k from a run: where the force drives water through a periodic box full of
 * it, or two heads drive it along a column of soil. In a tank v / i along gravity has no meaning.
 */
#ifndef TOSUI_SPHSOLVE_ISPH_PERMEAMETER_H
#define TOSUI_SPHSOLVE_ISPH_PERMEAMETER_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* Name of the history's column of isph_column_velocity. */
#define COLUMN_VELOCITY "velocity_through_soil"

/* Darcy velocity (m/s, along the column's axis), averaged over the planes through the column's
 * longest layer of soil, clear of its ends. The water before the soil is left out, since it moves
 * by more than what fine soil lets through. Returns false if the scene is not a column between two
 * heads. Collective. */
bool isph_column_velocity(const struct isph *s, double *velocity);
/* After the run: sets k and its errors of steadiness and averaging in `result`, NAN if there is no
 * k. Between heads v is the mean over the second half of the run. Collective. */
enum status isph_find_k(const struct isph *s, const struct plan *plan,
                        const struct recorder *recorder, struct run_result *result);

#endif
