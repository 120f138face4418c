/* Restores the share of grain in each voxel from a blurred and noisy scan: of all images between 0
 * (pore) and 1 (grain) the one with the least surface that, blurred by the scanner, explains the
 * scan to within its noise. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORE_H
#define TOSUI_CT2MODEL_SCANNER_RESTORE_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/blur_and_noise.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/surface/coarse.h"

/* Number of voxels a side over which the scan is averaged before it is restored: 1 up to 150
 * million voxels; beyond, as many as are needed and possible if `blur` (m) shall still span nine
 * tenths of the average. Averaging loses wedges between grains. For the sample sand with a blur of
 * 1.9 voxels, averages of 2 x 2 x 2 lose a tenth of the surface more, and k comes out 9 % too high
 * (docs/physics/restoration.md). */
size_t restore_step(const size_t size[3], const double voxel[3], double blur);

/* Properties of the scanner as deblur_start expects them, for a region averaged over `step` voxels
 * a side, with no weight of two phases. */
void restore_scanner(const struct region *region, const struct scanner *scanner, double blur,
                     size_t step, struct deblur_scanner *work);

/* Restores the region into `restored`, whose levels 0 to 255 are shares 0 to 1 (free with
 * coarse_end). A region that is too large is averaged first (restore_step). `two_phases`: as in
 * deblur.h. `restored` has no levels if they would not fit in memory. */
enum status restore_run(const struct region *region, const struct scanner *scanner,
                        double two_phases, struct coarse *restored);

#endif
