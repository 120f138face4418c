#include "sphsolve/plan/scan_error.h"

#include <math.h>

/* Fitted to generated sands (docs/physics/error-of-k.md). */
static const double BLUR_KEPT = 1.5;    /* error / change of ln k if the blur was not removed */
static const double BLUR_REMOVED = 0.3; /* the same if it was removed from smooth walls */
static const double ERROR_GROWTH = 3.0; /* relative growth of the latter / change of ln k */
/* Error / change of ln k / (noise averaged over the volume of the blur / contrast), if the blur was
 * removed: the noise limits what is recovered (docs/physics/error-of-k.md). */
static const double BLUR_NOISE = 0.6;
/* The same per (blur / pore width)^2: in pores a few blurs wide the blur closes throats, not all of
 * which the restoration opens again (ibid.). */
static const double BLUR_UNRESOLVED = 5.0;
/* Error / (roughness due to noise / pore width), and for smooth walls, where no wedges compensate
 * for it. */
static const double ROUGHNESS = 0.4, ROUGHNESS_SMOOTH = 1.0;
static const double VOXEL_ERROR = 0.035; /* error due to the voxels of even the sharpest scan */
/* Expected change of ln k / (blur deviation / mean pore width)^2. */
static const double CHANGE_EXPECTED = 9.5;
/* For the steps of a segmented image: fitted to spheres, packings, fibres and level sets of noise
 * (docs/physics/error-of-k.md). */
static const double LABELS_ERROR = 2.0; /* error / change of ln k */
/* Position error of walls from labels: 1/40 of a voxel, from rotated slits (3 times twice that
 * divided by the width of a slit, which is w / 2); in standard deviations of the smoothing of
 * labels, .7 voxels. */
static const double LABELS_POSITION = 0.43; /* .301 voxels */

/* Pores narrower than this many standard deviations of the blur do not show their shape. */
static const double SHAPE_RESOLVED = 8.0;
/* Largest relative error of k due to interpolation between distant slices; for sands it does not
 * increase beyond a ratio of slice distance to pixel width of four. */
static const double INTERPOLATION_ERROR_MAX = 0.3;

double scan_deviation(const struct scan_quality *scan) {
  return scan->resolution / RESOLUTION_DEVIATIONS;
}

double scan_shape_error(const struct scan_quality *scan, double width) {
  return width < SHAPE_RESOLVED * scan->blur ? scan->shape : 0.0;
}

/* Error due to blur. For labels, the voxel steps and their smoothing widen pores by about twice the
 * change, plus a position error of the wall. If the blur was not removed, the error is about the
 * change itself. If it was removed, the noise, narrow pores and the uncertainty of the blur (its
 * variance twice, for 95 %) leave a fraction of the change, and walls are rough by a length that
 * follows from the noise power. */
static double error_of_blur(const struct scan_quality *scan, double change, double width) {
  if (scan->labels)
    return hypot(LABELS_ERROR * (1.0 + ERROR_GROWTH * fabs(change)) * fabs(change),
                 LABELS_POSITION * scan_deviation(scan) / width);
  const double blur = 4.0 * scan->blur_error / scan->blur;
  const double rough = ROUGHNESS + (ROUGHNESS_SMOOTH - ROUGHNESS) * scan->smooth_walls;
  const double noise = BLUR_NOISE * sqrt(scan->noise_power / pow(scan->blur, 3.0));
  const double unresolved = BLUR_UNRESOLVED * pow(scan->blur / width, 2.0);
  const double left =
      hypot(hypot(noise, blur), hypot(unresolved, BLUR_REMOVED * scan->smooth_walls));
  const double share = scan->removed ? left * (1.0 + ERROR_GROWTH * fabs(change)) : BLUR_KEPT;
  return hypot(hypot(VOXEL_ERROR, scan_shape_error(scan, width)),
               hypot(share * change, rough * cbrt(scan->noise_power) / width));
}

/* Interpolation between slices acts like a blur that was not removed. */
double scan_error(const struct scan_quality *scan, double change, double width) {
  const double between = scan->between / pow(scan_deviation(scan), 2.0);
  return hypot(error_of_blur(scan, change, width),
               fmin(INTERPOLATION_ERROR_MAX, BLUR_KEPT * between * fabs(change)));
}

double scan_change_expected(const struct scan_quality *scan, double width) {
  return CHANGE_EXPECTED * pow(scan_deviation(scan) / width, 2.0);
}
