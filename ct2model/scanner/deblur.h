/* Removes the scanner's blur and noise from one slab of a scan. */
#ifndef TOSUI_CT2MODEL_SCANNER_DEBLUR_H
#define TOSUI_CT2MODEL_SCANNER_DEBLUR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Properties of the scanner in the units of the slab. Arrays of 3 are along x, y, z, in voxels of
 * the slab. */
struct deblur_scanner {
  double blur[3];     /* standard deviation without the voxel's own width */
  double fringe;      /* strength f: the blurred image minus f blur^2 times its Laplacian */
  double power;       /* noise: variance over contrast^2, times correlation volume, voxels */
  double correlation; /* correlation length of the noise: standard deviation of its Gaussian filter,
                         in shortest voxel edges */
  double stretch[3];  /* voxel edges over the shortest one */
  double surface;     /* cost of surface relative to the usual one; 1 where walls have relief */
  double two_phases;  /* weight from 0 to 1 with which each voxel is to be grain or pore */
};

struct progress;

struct deblur {
  size_t size[3]; /* of the slab being restored, at most the voxels given to deblur_start */
  /* Number of these voxels at either end of each axis that lie outside the scan; their greys are
   * not used. */
  size_t beyond[3][2];
  struct deblur_scanner scanner;
  /* Told after each iteration if not NULL: `done`, and the share of this slab that is done. */
  struct progress *progress;
  double done;
  int iteration;
  bool compared;  /* with a simulated scan restored in the same way, without a margin */
  int iterations; /* ITERATIONS, or as set after deblur_start */
  float *grey;    /* input [z][y][x], 0 in pores and 1 in grains; overwritten */
  float *share;   /* result [z][y][x]: share of grain, 0 to 1 */
  float *grain, *u, *y, *a, *b;
  uint8_t *contacts;
};

/* Allocates slabs of up to `voxels` voxels; free with deblur_end, on failure too. */
enum status deblur_start(size_t voxels, const struct deblur_scanner *scanner,
                         struct deblur *deblur);
void deblur_end(struct deblur *deblur);
/* Restores deblur->share from deblur->grey, whose `size` and `beyond` are set. */
enum status deblur_run(struct deblur *deblur);
/* Misfit of the result to the scan `grey`: the sum of squared residuals over voxels. */
double deblur_misfit(struct deblur *deblur, const float *grey);

#endif
