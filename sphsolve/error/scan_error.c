#include "sphsolve/error/scan_error.h"
#include "sphsolve/plan/constants.h"

#include <math.h>

double scan_deviation(const struct scan_quality *scan) {
  return scan->resolution / RESOLUTION_DEVIATIONS;
}

double scan_shape_error(const struct scan_quality *scan, double width) {
  return width < SCAN_SHAPE_RESOLVED * scan->blur ? scan->shape : 0.0;
}

/* Error due to blur. For labels, the voxel steps and their smoothing widen pores by about twice the
 * change, plus a position error of the wall. If the blur was not removed, the error is about the
 * change itself. If it was removed, the noise, narrow pores and the uncertainty of the blur (its
 * variance twice, for 95 %) leave a fraction of the change, and walls are rough by a length that
 * follows from the noise power. */
static double error_of_blur(const struct scan_quality *scan, double change, double width) {
  if (scan->labels)
    return hypot(SCAN_LABELS_ERROR * (1.0 + SCAN_ERROR_GROWTH * fabs(change)) * fabs(change),
                 SCAN_LABELS_POSITION * scan_deviation(scan) / width);
  const double blur = 4.0 * scan->blur_error / scan->blur;
  const double rough =
      SCAN_ROUGHNESS + (SCAN_ROUGHNESS_SMOOTH - SCAN_ROUGHNESS) * scan->smooth_walls;
  const double noise = SCAN_BLUR_NOISE * sqrt(scan->noise_power / pow(scan->blur, 3.0));
  const double unresolved = SCAN_BLUR_UNRESOLVED * pow(scan->blur / width, 2.0);
  const double left =
      hypot(hypot(noise, blur), hypot(unresolved, SCAN_BLUR_REMOVED * scan->smooth_walls));
  const double share =
      scan->removed ? left * (1.0 + SCAN_ERROR_GROWTH * fabs(change)) : SCAN_BLUR_KEPT;
  return hypot(hypot(SCAN_VOXEL_ERROR, scan_shape_error(scan, width)),
               hypot(share * change, rough * cbrt(scan->noise_power) / width));
}

/* Interpolation between slices acts like a blur that was not removed. */
double scan_error(const struct scan_quality *scan, double change, double width) {
  const double between = scan->between / pow(scan_deviation(scan), 2.0);
  return hypot(error_of_blur(scan, change, width),
               fmin(SCAN_INTERPOLATION_MOST, SCAN_BLUR_KEPT * between * fabs(change)));
}

double scan_change_expected(const struct scan_quality *scan, double width) {
  return SCAN_CHANGE_EXPECTED * pow(scan_deviation(scan) / width, 2.0);
}
