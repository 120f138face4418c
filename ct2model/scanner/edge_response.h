/* The edge response of the scanner, that is the grey across a grain's surface, from the voxels of
 * the scan binned by their distance to the surface (as ASTM E1695 does across the rim of a
 * phantom); and the blur and fringe fitted to it. Greys are 0 in pores and 1 in grains. */
#ifndef TOSUI_CT2MODEL_SCANNER_EDGE_RESPONSE_H
#define TOSUI_CT2MODEL_SCANNER_EDGE_RESPONSE_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

enum { EDGE_REACH = 10, EDGE_FINE = 4, EDGE_BINS = 2 * EDGE_REACH * EDGE_FINE };

/* Bin i holds distances from -EDGE_REACH + i / EDGE_FINE, in voxels, positive in the pore; sum of
 * the greys and number of voxels. */
struct edge_response {
  double sum[EDGE_BINS], count[EDGE_BINS];
};

/* The edge response of a Gaussian blur of standard deviation S with a fringe f (the blurred image
 * minus f S^2 times its Laplacian, as phase propagation adds it: Bronnikov 2002, eq. 2), across a
 * flat surface at d = 0: pore + (grain - pore) (Phi(-d / S) - f d / S phi(d / S)). */
struct edge_fit {
  double deviation; /* S, voxels; NAN: no fit */
  double fringe, pore, grain;
  double shift;    /* of the surface, voxels */
  double residual; /* root mean square, per voxel */
};

/* Distance at the middle of a bin, in voxels, positive in the pore. */
double edge_bin_distance(size_t bin);
/* Fits the bins within `reach` voxels, with the given fringe or, if that is NAN, the one that fits
 * best; false if too few bins or voxels hold data. */
bool edge_fit_find(const struct edge_response *response, double reach, double fringe,
                   struct edge_fit *fit);
/* edge_fit_blur: standard deviation of the blur itself, in voxels, without the widths of the voxel
 * and the bins. edge_fit_deviation: the inverse, S for a given blur. */
double edge_fit_blur(const struct edge_fit *fit);
double edge_fit_deviation(double blur);
/* Modulation transfer at `frequency` (cycles per voxel): the Fourier transform of the line spread
 * function of the fit. */
double edge_fit_transfer(const struct edge_fit *fit, double frequency);

/* Signed distances of all voxels to the surface where `smooth` is 1/2, positive in the pore,
 * limited to `limit`; in units of the shortest voxel edge (`stretch`: voxel edges over the
 * shortest). distance[z][y][x]. */
enum status edge_distances(const float *smooth, const size_t size[3], const double stretch[3],
                           double limit, float *distance);
/* The smallest `limit` of edge_distances that leaves edge_response_add with `reach` unaffected. */
double edge_response_limit(double reach, const double stretch[3]);
/* Adds the voxels of `grey` within `reach` of a surface that has no other surface within about
 * `reach` on either side and borders on a grain of common grey. With `middle` (in voxels of the
 * window) each voxel is added to the response of its octant about that point, numbered with x
 * fastest; with NULL all are added to response[0]. */
void edge_response_add(const float *grey, const float *smooth, const float *distance,
                       const size_t size[3], const double stretch[3], double reach,
                       const size_t middle[3], struct edge_response response[]);

#endif
