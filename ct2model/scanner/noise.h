/* Noise inside the pores or the grains of a window of the scan, away from surfaces. */
#ifndef TOSUI_CT2MODEL_SCANNER_NOISE_H
#define TOSUI_CT2MODEL_SCANNER_NOISE_H

#include <stddef.h>

/* Sums over voxels and over pairs of neighbours along x, y, z, of greys minus the mean of their
 * slice; and over pairs of voxels some slices apart, whose differences are not affected by ring
 * artefacts and by walls along z. */
struct noise_sums {
  double square, count;
  double apart, apart_pairs;
  double product[3], pairs[3];
  double end, at_end; /* grey at which the scan is clipped on this side; voxels that have it */
};

/* Adds the voxels at least `depth` (voxels) from the surface: those of the pores if `sign` is 1, of
 * the grains if it is -1. Greys further than `most` from `level` belong to other minerals and are
 * left out. */
void noise_add(const float *grey, const float *distance, const size_t size[3], double depth,
               double sign, double level, double most, struct noise_sums *sums);
/* Standard deviation of the noise; NAN without voxels. */
double noise_deviation(const struct noise_sums *sums);
/* Ratio of the standard deviation after clipping to that before it; 1 if not clipped. */
double noise_clipping_ratio(const struct noise_sums *sums);
/* Correlation length along `axis`: standard deviation (voxels) of the Gaussian filter that gives
 * white noise the same correlation between neighbours; 0 if not correlated. */
double noise_length(const struct noise_sums *sums, int axis);
/* The mean of this over the axes, of voxels with these edges; NAN if there are no pairs. */
double noise_mean_length(const struct noise_sums *sums, const double voxel[3]);
/* Relative standard error of noise_deviation, for noise of correlation length `length` (voxels),
 * which leaves few independent voxels. */
double noise_deviation_error(const struct noise_sums *sums, double length);

#endif
