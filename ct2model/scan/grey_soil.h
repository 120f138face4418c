/* Greys between pore and grain taken as soil whose pores are smaller than a voxel: the darker, the
 * more porous, linear between the peaks of pore and grain, or by a table. The scan becomes an image
 * of labels. */
#ifndef TOSUI_CT2MODEL_SCAN_GREY_SOIL_H
#define TOSUI_CT2MODEL_SCAN_GREY_SOIL_H

#include <stdbool.h>

#include "common/error.h"
#include "ct2model/scan/labels.h"
#include "ct2model/scan/micro_rules.h"

/* The bounds as they were moved, and the peaks between which porosity is linear; as stored. NAN:
 * unknown, and not asked for. Uncertainties are 95 % half widths. */
struct grey_soil {
  double low, high, shift, pore_peak, soil_peak, grain_peak;
  /* Of `auto`: of the bounds; of the peaks; of the mean porosity of soil, and of the logarithm of
   * its permeability where that follows from a grain size. */
  double low_error, high_error, pore_error, soil_error, grain_error;
  double porosity_error, permeability_error;
  /* By which the threshold between grain and all else may be off, and how it moves with the void
   * ratio of all that is not grain: as of a scan of two phases. */
  double threshold_error, threshold_slope;
  double void_ratio_error; /* of pores and micro-pores, where none was measured */
};

/* Pore below the bounds, grain above; both are moved by the same grey until the void ratio is
 * `void_ratio`, micro-pores counted (NAN: they stay); its error may be NAN. Edges between pore and
 * grain are no soil (settle.h). Makes `region` read the smoothed walls, as labels_take does. */
enum status micro_take(struct region *region, const struct micro_rules *rules, double void_ratio,
                       double void_ratio_error, const bool reflect[3], struct labels *labels,
                       struct grey_soil *greys);

#endif
