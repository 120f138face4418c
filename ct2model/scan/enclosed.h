/* How much volume walls enclose: that of the surfaces of equal grey between voxel centres, to
 * fractions of a voxel. Counted voxels do not tell it: where walls lie along planes of voxels, all
 * of a plane have about one grey, and between two such greys any threshold counts the same. */
#ifndef TOSUI_CT2MODEL_SCAN_ENCLOSED_H
#define TOSUI_CT2MODEL_SCAN_ENCLOSED_H

#include <stdbool.h>

#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

/* Axes that are mirrored about the first face and the last centre, or, with `faces`, of which all
 * voxels count once, those at the faces with a half voxel beyond their centres; the others are
 * periodic. */
struct enclosed_sides {
  bool reflect[3], faces;
};

/* The share of the region's volume under each grey from `low` to `high`, of the trilinear field
 * between the centres of its voxels; what lies beyond is counted in the end bins. The
 * same for any number of threads. Free with grey_histogram_end. */
enum status enclosed_measure(const struct region *region, const struct enclosed_sides *sides,
                             double low, double high, struct grey_histogram *histogram);

/* Moves *threshold, which lies between the greys `low` and `high`, to where walls enclose
 * *porosity; where none between these do, it stays. Either way *porosity becomes what they enclose.
 */
enum status enclosed_match(const struct region *region, const struct enclosed_sides *sides,
                           double low, double high, double *threshold, double *porosity);

#endif
