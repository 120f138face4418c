/* Treats greys between pore and grain as soil whose pores are smaller than a voxel: the darker, the
 * more porous, linearly between the peaks of pore and grain, or by a table. The scan becomes an
 * image of labels. */
#ifndef TOSUI_CT2MODEL_SCAN_GREY_SOIL_H
#define TOSUI_CT2MODEL_SCAN_GREY_SOIL_H

#include <stdbool.h>

#include "common/error.h"
#include "ct2model/scan/labels.h"
#include "ct2model/scan/micro.h"

/* The shifted bounds of soil, the shift, and the peaks between which porosity is linear, in greys
 * as stored. Values are NAN where unknown or not requested. Uncertainties are 95 % half widths. */
struct grey_soil {
  double low, high, shift, pore_peak, soil_peak, grain_peak;
  /* With `auto`: uncertainty of the bounds, of the peaks, of the mean porosity of soil, and of the
   * logarithm of its permeability where that follows from a grain size. */
  double low_error, high_error, pore_error, soil_error, grain_error;
  double porosity_error, permeability_error;
  /* Uncertainty of the threshold between grain and all else, and its derivative with respect to the
   * void ratio of all that is not grain, as for a scan of two phases. */
  double threshold_error, threshold_slope;
  double void_ratio_error; /* of the void ratio of pores and micro-pores, if it was not measured */
};

/* Voxels below the bounds are pore, those above are grain. Both bounds are shifted by the same grey
 * until the void ratio, with micro-pores, is `void_ratio` (NAN: no shift); its error may be NAN.
 * Edges between pore and grain are not taken as soil (grey_soil.c). `region` then reads the
 * smoothed walls, as with labels_take. */
enum status micro_take(struct region *region, const struct micro_rules *rules, double void_ratio,
                       double void_ratio_error, const bool reflect[3], struct labels *labels,
                       struct grey_soil *greys);

#endif
