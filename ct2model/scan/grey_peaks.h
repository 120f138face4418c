/* The greys of pore, soil and grain in a scan with all three, from its voxels at full resolution,
 * and their uncertainties.
 *
 * Noise and blurred edges fill the valleys of a scan's histogram. So means over 4x4x4 voxels are
 * counted, and of these only flat ones, whose halves differ by less than a tenth of the contrast
 * along each axis (histogram of low gradients: Weszka, Rosenfeld 1979, IEEE Trans. Syst. Man
 * Cybern. 9, 38). A peak of that histogram is clear if it stands high above the valley between it
 * and a higher one (its persistence: Edelsbrunner, Letscher, Zomorodian 2002, Discrete Comput.
 * Geom. 28, 511), in standard deviations of the counts. */
#ifndef TOSUI_CT2MODEL_SCAN_GREY_PEAKS_H
#define TOSUI_CT2MODEL_SCAN_GREY_PEAKS_H

#include "common/error.h"
#include "ct2model/scan/region.h"

enum { PEAK_PORE, PEAK_SOIL, PEAK_GRAIN, PEAKS };

/* Greys of the region (bright grain) in rising order, and their 95 % half widths, from the
 * differences between the eight octants of the scan and from the effect of edges that count as
 * flat. */
struct grey_peaks {
  double grey[PEAKS], error[PEAKS];
};

/* Finds the three peaks; an input error if the histogram has fewer or more clear peaks. */
enum status grey_peaks_find(const struct region *region, struct grey_peaks *peaks);

#endif
