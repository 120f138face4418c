/* The share of grain in each voxel as the scan would show it without the scanner: of all images
 * between 0 (pore) and 1 (grain) the one that, blurred as the scanner blurs, explains the scan to
 * within its noise with the least surface. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORE_H
#define TOSUI_CT2MODEL_SCANNER_RESTORE_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/blur_and_noise.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/surface/coarse.h"

/* 1 up to 150 million voxels: wedges between grains are lost with a mean. Of the sample sand,
 * blur 1.9 voxels, means of 2 x 2 x 2 lose a tenth of the surface more and k comes out 9 % too high
 * (docs/notes/2026-11-23-averaged.md). Beyond, voxels a side of the means, so many that `blur` (m)
 * still spans nine tenths of one. */
size_t restore_step(const size_t size[3], const double voxel[3], double blur);

/* What is told to deblur_start, of a region averaged over `step` voxels a side. */
void restore_scanner(const struct region *region, const struct scanner *scanner, double blur,
                     size_t step, struct deblur_scanner *work);

/* Into `restored`, whose levels 0 .. 255 are shares 0 .. 1 (free with coarse_end). A region
 * too large is averaged first (restore_step). `blur` (m) is taken for that of
 * the scanner. Step 1 with no levels: memory would not hold it. */
enum status restore_run(const struct region *region, const struct scanner *scanner, double blur,
                        struct coarse *restored);

#endif
