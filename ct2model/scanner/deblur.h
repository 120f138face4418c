/* One slab of a scan without the scanner's blur and noise. */
#ifndef TOSUI_CT2MODEL_SCANNER_DEBLUR_H
#define TOSUI_CT2MODEL_SCANNER_DEBLUR_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Noise is taken as correlated over a length of so many voxels at least: finer noise makes relief
 * between the voxels. */
#define DEBLUR_CORRELATION_LEAST 0.6

/* What the scanner does, lengths in voxels of the slab by axis. */
struct deblur_scanner {
  double blur[3]; /* standard deviation, without the voxel's own width */
  double fringe;  /* the blurred image less this times blur^2 times its Laplacian */
  double power;   /* of the noise: variance over contrast^2, times the volume that it is alike in,
                     voxels */
  double correlation; /* length that the noise is correlated over, of its Gaussian filter, in the
                         shortest voxel edges */
  double stretch[3];  /* voxel edges over their shortest */
  double surface;     /* times the usual cost of surface; 1 where walls have relief */
};

struct deblur {
  size_t size[3]; /* of the slab at work, at most as large as at deblur_start */
  struct deblur_scanner scanner;
  float *grey;  /* [z][y][x], 0 pore and 1 grain; is lost */
  float *share; /* the result: the share of grain, 0 to 1 */
  float *grain, *u, *y, *a, *b;
  uint8_t *contacts;
};

/* Room for so many voxels, to be freed with deblur_end. */
enum status deblur_start(size_t voxels, const struct deblur_scanner *scanner,
                         struct deblur *deblur);
void deblur_end(struct deblur *deblur);
enum status deblur_run(struct deblur *deblur);
/* What the result leaves unexplained of `grey`, the scan: the sum of squares over voxels. */
double deblur_misfit(struct deblur *deblur, const float *grey);

#endif
