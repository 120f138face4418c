/* Error of k due to blur and noise of the CT scanner, from the scan quality and from the change of
 * k when the surface is blurred once more. */
#ifndef TOSUI_SPHSOLVE_ERROR_SCAN_ERROR_H
#define TOSUI_SPHSOLVE_ERROR_SCAN_ERROR_H

#include "sphsolve/geometry/model_facts.h"

/* Standard deviation (m) of the Gaussian with the resolution of the scanner. */
double scan_deviation(const struct scan_quality *scan);

/* Relative half width of the 95 % interval of k for pores of mean width `width` (4 V / S, m), where
 * additional blur of scan_deviation changes ln k by `change`. */
double scan_error(const struct scan_quality *scan, double change, double width);

/* Its part due to pores too narrow to show their shape; 0 if the shape is resolved. */
double scan_shape_error(const struct scan_quality *scan, double width);

/* Expected change of ln k for pores of that width, before anything is solved. */
double scan_change_expected(const struct scan_quality *scan, double width);

#endif
