/* One slab of a scan without the scanner's blur and noise. */
#ifndef TOSUI_CT2MODEL_SCANNER_DEBLUR_H
#define TOSUI_CT2MODEL_SCANNER_DEBLUR_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* Noise is taken as correlated over a length of so many voxels at least: finer noise makes relief
 * between the voxels. */
#define DEBLUR_CORRELATION_LEAST 0.6

/* Rounds of descent after grains are told apart. Under blurs of over two voxels and contrasts of
 * over 15 half as many leave throats wide, and k up to 6 % too high; twice as many move it by 2 %
 * at most (docs/notes/2026-11-27-faces.md). What is compared with a scan made up and restored alike
 * makes do with fewer. */
enum { DEBLUR_ROUNDS = 60, DEBLUR_ROUNDS_COMPARED = 30 };

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
  /* Of these, voxels at either end of each axis that the scan does not show, of any grey. */
  size_t beyond[3][2];
  struct deblur_scanner scanner;
  int rounds;   /* DEBLUR_ROUNDS, or as set after deblur_start */
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
