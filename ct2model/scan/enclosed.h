/* Volume enclosed by the walls, that is by surfaces of equal grey between voxel centres, to
 * fractions of a voxel. Counting voxels does not give it: where walls lie along planes of voxels,
 * all voxels of a plane have about one grey, and every threshold between two such greys counts the
 * same. */
#ifndef TOSUI_CT2MODEL_SCAN_ENCLOSED_H
#define TOSUI_CT2MODEL_SCAN_ENCLOSED_H

#include <stdbool.h>

#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

/* Treatment of the sides of a region. Axes with `reflect` are mirrored about the first face and the
 * last centre, or with `faces` end at their faces: all voxels count once, the outermost ones
 * including the half voxel beyond their centres. The other axes are periodic. */
struct enclosed_sides {
  bool reflect[3], faces;
};

/* Histogram of the volume of the trilinear field between voxel centres, by grey from `low` to
 * `high`; greys beyond are counted in the end bins. Identical for any number of threads. Free with
 * grey_histogram_end. */
enum status enclosed_measure(const struct region *region, const struct enclosed_sides *sides,
                             double low, double high, struct grey_histogram *histogram);

/* Moves *threshold to the grey, between `low` and `high`, at which the walls enclose the pore
 * fraction *porosity; if there is none it is left unchanged. *porosity becomes the fraction that
 * the walls enclose. */
enum status enclosed_match(const struct region *region, const struct enclosed_sides *sides,
                           double low, double high, double *threshold, double *porosity);

#endif
