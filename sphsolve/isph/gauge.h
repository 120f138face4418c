/* Readings of a gauge of the scene: pressure, Darcy velocity, total head, level of the water. */
#ifndef TOSUI_SPHSOLVE_ISPH_GAUGE_H
#define TOSUI_SPHSOLVE_ISPH_GAUGE_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/isph/state.h"

#define GAUGE_NUMBERS 6 /* most values that a gauge has */

/* Whether the scene has gravity, so that heads are defined. */
bool isph_has_head(const struct isph *s);
/* Reads a gauge into `number`: pressure (Pa) and Darcy velocity (m/s) at a point, exact for linear
 * fields, 0 in a void and beyond the water; with gravity also the total head z + P / (rho g), m, z
 * against gravity from the origin; with a surface also the level of the highest water over the
 * point, m, NAN if there is none. Returns the number of values. Collective. */
size_t isph_read_gauge(const struct isph *s, const double point[3], double *number);

#endif
