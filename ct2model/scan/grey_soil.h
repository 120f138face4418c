/* Greys between pore and grain taken as soil whose pores are smaller than a voxel: the darker, the
 * more porous, linear between the peaks of pore and grain. The scan becomes an image of labels. */
#ifndef TOSUI_CT2MODEL_SCAN_GREY_SOIL_H
#define TOSUI_CT2MODEL_SCAN_GREY_SOIL_H

#include <stdbool.h>

#include "common/error.h"
#include "ct2model/scan/labels.h"

/* What --micro and --micro-permeability say, in greys as stored. */
struct micro_rules {
  bool given;
  double low, high;                /* soil lies between them */
  double permeability, grain_size; /* m^2 or m, the other 0 */
};

/* "80..170"; usage errors. */
enum status micro_rules_parse(const char *text, struct micro_rules *rules);

/* The bounds as they were moved, and the peaks between which porosity is linear; as stored. */
struct grey_soil {
  double low, high, shift, pore_peak, grain_peak;
};

/* Pore below rules->low, grain above rules->high; both are moved by the same grey until the void
 * ratio is `void_ratio`, micro-pores counted (NAN: they stay). A voxel between them with pore and
 * grain both within MICRO_RIM voxels is an edge between the two, no soil: it goes to the nearer.
 * The peaks are the most frequent greys below and above. Makes `region` read the smoothed walls, as
 * labels_take does. */
#define MICRO_RIM 2
enum status micro_take(struct region *region, const struct micro_rules *rules, double void_ratio,
                       const bool reflect[3], struct labels *labels, struct grey_soil *greys);

#endif
