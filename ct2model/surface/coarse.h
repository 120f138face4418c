/* The scan averaged over cubes of 2 or 4 voxels a side, held in memory as 8-bit levels. The walls
 * are measured on it where a model voxel spans eight or more voxels of the scan. It gives the
 * surface to a twentieth of a model voxel, more accurately than a noisy scan itself
 * (docs/ct2model.md), and the scan need not be read again once the threshold is known. */
#ifndef TOSUI_CT2MODEL_SURFACE_COARSE_H
#define TOSUI_CT2MODEL_SURFACE_COARSE_H

#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

struct survey;

struct coarse {
  size_t step, size[3];            /* voxels averaged per axis; 1: not in use, all else is empty */
  double low, unit;                /* grey = low + unit * level */
  uint8_t *levels;                 /* [z][y][x] */
  struct grey_histogram histogram; /* of the levels */
};

/* Chooses the step for a model of `size` voxels, such that a model voxel spans at least four steps.
 * It is 1 if there is none, if a side of the scan is not a multiple, or if the levels would need
 * more than 160 MB. Greys more than half the contrast beyond both phases are clipped. Free with
 * coarse_end. */
enum status coarse_start(const struct region *region, const size_t size[3],
                         const struct survey *survey, struct coarse *coarse);
void coarse_end(struct coarse *coarse);

/* Number of floats for the sums of one coarse slice. */
size_t coarse_sums(const struct coarse *coarse);
/* Adds row y of slice z to `sums`. The slices of one coarse slice are added in order by one thread,
 * which calls coarse_store after the last row. */
void coarse_add(const struct coarse *coarse, size_t y, size_t z, const float *row, float *sums);
void coarse_store(struct coarse *coarse, size_t z, const float *sums);

/* The averaged scan as a region of larger voxels; it refers to the levels of `coarse`. */
struct region coarse_region(const struct coarse *coarse, const struct region *region);

#endif
