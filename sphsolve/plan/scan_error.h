/* The error of k by the scanner's blur and noise: from what the scan tells of its scanner and from
 * the change of k when its surface is blurred once more. */
#ifndef TOSUI_SPHSOLVE_PLAN_SCAN_ERROR_H
#define TOSUI_SPHSOLVE_PLAN_SCAN_ERROR_H

#include "sphsolve/geometry/model_facts.h"

/* The standard deviation (m) of a Gaussian that resolves as much as the scanner. */
double scan_deviation(const struct scan_quality *scan);

/* Relative 95 % half width of k in pores of a mean width (4 V / S, m), where the blur of
 * scan_deviation once more changes ln k by `change`. */
double scan_error(const struct scan_quality *scan, double change, double width);

/* What of it is for pores too narrow to show their shape; 0: they show it. */
double scan_shape_error(const struct scan_quality *scan, double width);

/* The change to expect in pores of that width, before anything is solved. */
double scan_change_expected(const struct scan_quality *scan, double width);

#endif
