/* How grey rises across a grain's surface: the edge response of the scanner, from voxels of the
 * scan binned by their distance to the surface (ASTM E1695 does so across a phantom's rim), and the
 * blur and the fringe that explain it. Greys are 0 in the pore and 1 in the grain. */
#ifndef TOSUI_CT2MODEL_SCANNER_EDGE_RESPONSE_H
#define TOSUI_CT2MODEL_SCANNER_EDGE_RESPONSE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

enum { EDGE_REACH = 10, EDGE_FINE = 4, EDGE_BINS = 2 * EDGE_REACH * EDGE_FINE };

/* Bin i holds distances from -EDGE_REACH + i / EDGE_FINE on, in voxels, positive in the pore. */
struct edge_response {
  double sum[EDGE_BINS], count[EDGE_BINS];
};

/* The edge response of a Gaussian blur of standard deviation S with a fringe f (the blurred image
 * less f S^2 times its Laplacian, as propagation adds it: Bronnikov 2002, eq. 2), across a flat
 * surface: pore + (grain - pore) (Phi(-d / S) - f d / S phi(d / S)). */
struct edge_fit {
  double deviation; /* S, voxels; NAN: no fit */
  double fringe, pore, grain, shift, residual;
};

/* The middle of a bin, voxels, positive in the pore. */
double edge_bin_distance(size_t bin);
/* Over the bins within `reach` voxels, with that fringe (NAN: the one that fits best); false where
 * too few hold anything. */
bool edge_fit_find(const struct edge_response *response, double reach, double fringe,
                   struct edge_fit *fit);
/* Standard deviation (voxels) of the blur itself, without the widths of voxel and bin; and S of a
 * blur. */
double edge_fit_blur(const struct edge_fit *fit);
double edge_fit_deviation(double blur);
/* Modulation transfer at `frequency` (cycles a voxel): the Fourier transform of the fit's line
 * spread. */
double edge_fit_transfer(const struct edge_fit *fit, double frequency);

/* Signed distances to the surface where `smooth` is 1/2, of all voxels, at most `limit`, positive
 * in the pore; in voxels times `stretch`. */
enum status edge_distances(const float *smooth, const size_t size[3], const double stretch[3],
                           double limit, float *distance);
/* The least limit of distances that edge_response_add with that reach sees nothing of. */
double edge_response_limit(double reach, const double stretch[3]);
/* Adds the voxels of `grey` within `reach` of a surface that is alone over `reach` on both sides
 * and borders on a grain of common grey. To one response, or with a `middle` (voxels of the window)
 * to that of their octant about it, x first. */
void edge_response_add(const float *grey, const float *smooth, const float *distance,
                       const size_t size[3], const double stretch[3], double reach,
                       const size_t middle[3], struct edge_response response[]);

#endif
