/* The greys of pore, soil and grain where a scan has all three, from its voxels at full resolution,
 * and how sure each is.
 *
 * Noise and the blur of edges fill the valleys of a scan's histogram. Counted are therefore means
 * of 4x4x4 voxels, and of these only the flat ones, whose halves differ by less than a tenth of the
 * contrast along each axis (histogram of low gradients: Weszka, Rosenfeld 1979, IEEE Trans. Syst.
 * Man Cybern. 9, 38). A peak of that histogram is clear where it stands high above the valley
 * between it and a higher one (its persistence: Edelsbrunner, Letscher, Zomorodian 2002, Discrete
 * Comput. Geom. 28, 511), in standard deviations of the counts. */
#ifndef TOSUI_CT2MODEL_SCAN_GREY_PEAKS_H
#define TOSUI_CT2MODEL_SCAN_GREY_PEAKS_H

#include "common/error.h"
#include "ct2model/scan/region.h"

enum { PEAK_PORE, PEAK_SOIL, PEAK_GRAIN, PEAKS };

/* Greys of the region, where grain is bright, rising; 95 % half widths: what differs between the
 * eight octants of the scan, and what edges that count as flat leave. */
struct grey_peaks {
  double grey[PEAKS], error[PEAKS];
};

/* An input error where the histogram shows fewer clear peaks than three, or more. */
enum status grey_peaks_find(const struct region *region, struct grey_peaks *peaks);

#endif
