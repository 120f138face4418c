/* Noise inside the pores or the grains of a window of the scan, where no surface is near. */
#ifndef TOSUI_CT2MODEL_SCANNER_NOISE_H
#define TOSUI_CT2MODEL_SCANNER_NOISE_H

#include <stddef.h>

/* Sums over voxels and over pairs of neighbours along x, y, z, less the mean of their slice; and
 * over pairs some slices apart, whose differences know nothing of rings and of walls along z. */
struct noise_sums {
  double square, count;
  double apart, apart_pairs;
  double product[3], pairs[3];
  double end, at_end; /* the grey at which the scan is cut off on this phase's side; its voxels */
};

/* Voxels at least `depth` from the surface, in the pore where `sign` is 1, in the grain where it is
 * -1; greys beyond `most` from `level` are minerals and left out. */
void noise_add(const float *grey, const float *distance, const size_t size[3], double depth,
               double sign, double level, double most, struct noise_sums *sums);
double noise_deviation(const struct noise_sums *sums);
/* That deviation over the one of the noise before it was cut off. */
double noise_left(const struct noise_sums *sums);
/* Standard deviation (voxels) of the Gaussian filter that makes of white noise what is correlated
 * as much from one voxel to the next along `axis`; 0: not correlated. */
double noise_length(const struct noise_sums *sums, int axis);

/* How far chance moves that deviation, over itself (1 sigma): of noise alike over `length` voxels,
 * few voxels are independent. */
double noise_deviation_error(const struct noise_sums *sums, double length);

#endif
