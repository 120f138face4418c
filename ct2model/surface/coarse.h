/* The scan averaged over cubes of 2 or 4 voxels a side, held in memory as 8-bit levels: what walls
 * are measured on where a model voxel spans eight voxels of the scan or more. The surface is found
 * there within a twentieth of the model's voxel, nearer than in the scan itself where that is noisy
 * (docs/ct2model.md), and the scan need not be read again once the threshold is known. */
#ifndef TOSUI_CT2MODEL_SURFACE_COARSE_H
#define TOSUI_CT2MODEL_SURFACE_COARSE_H

#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/region.h"

struct survey;

struct coarse {
  size_t step, size[3];            /* step 1: not in use, all else is empty */
  double low, unit;                /* grey = low + unit * level */
  uint8_t *levels;                 /* [z][y][x] */
  struct grey_histogram histogram; /* of the levels */
};

/* Chooses the step for a model of `size` voxels, such that one spans four steps at least: 1 where
 * there is none, a side of the scan does not divide, or 160 MB would not hold it. Greys half the
 * contrast beyond both phases are cut off. Free with coarse_end. */
enum status coarse_start(const struct region *region, const size_t size[3],
                         const struct survey *survey, struct coarse *coarse);
void coarse_end(struct coarse *coarse);

/* Floats that hold the sums of one coarse slice on its way. */
size_t coarse_sums(const struct coarse *coarse);
/* Adds row y of slice z to `sums`. Slices of one coarse slice come in order from one thread, which
 * stores it after the last row. */
void coarse_add(const struct coarse *coarse, size_t y, size_t z, const float *row, float *sums);
void coarse_store(struct coarse *coarse, size_t z, const float *sums);

/* The same as a region of larger voxels. */
struct region coarse_region(const struct coarse *coarse, const struct region *region);

#endif
