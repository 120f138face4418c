/* Error of the flux through a plane by conservation of mass. */
#ifndef TOSUI_ANALYZE_PLANE_BALANCE_H
#define TOSUI_ANALYZE_PLANE_BALANCE_H

#include <stdbool.h>

#include "analyze/seepage/head_field.h"
#include "analyze/run_file.h"

/* Number of neighbouring sections within the support of one kernel, about. They are fitted to the
 * same particles, so that their errors are correlated. */
#define SECTIONS_CORRELATED 5.0

/* Error (95 %) of the flux `mean` (m^2/s per metre along y) through the plane with that name. In
 * steady flow the flux is the same through all parallel sections wholly in soil, up to the next
 * inlet or outlet. The error is the difference from their mean, combined with their scatter. In
 * free water particles are also shifted, so that the error of a plane there exceeds the scatter of
 * its mean over time. NAN if there are no such sections or the run file does not contain its
 * planes. `in_water` (may be NULL): part of the plane is in free water. */
double plane_balance(const struct run *run, const struct head_field *field, const char *name,
                     double mean, bool *in_water);

#endif
