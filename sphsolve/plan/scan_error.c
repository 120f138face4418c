#include "sphsolve/plan/scan_error.h"

#include <math.h>

/* Fitted to generated sands (docs/notes/2026-11-22-scanner.md). */
static const double KEPT = 1.5; /* the error over the change of ln k, where the blur was left in, */
static const double REMOVED = 0.3;  /* and where it was taken out from walls that are smooth, */
static const double GROWTH = 3.0;   /* which grows by this times the change */
/* In sands the noise limits what is recovered: the error over the noise averaged over the volume
 * of the blur, relative to the contrast (docs/notes/2026-11-28-sharper-scan-bars.md). */
static const double NOISE = 0.6;
static const double ROUGH = 0.4;    /* the error over (roughness by noise / width of a pore), */
static const double SMOOTH = 1.0;   /* where walls are smooth and no wedges make up for it */
static const double VOXELS = 0.035; /* what the sharpest scan's voxels leave */
static const double CHANGE = 9.5;   /* expected change of ln k, times (deviation / mean pore)^2 */
/* Of the steps of a segmented image: fitted to spheres, packs, fibres and level sets of noise
 * (docs/notes/2026-11-22-labels.md). */
static const double LABELS = 2.0; /* the error over the change */
/* Walls from labels are a fortieth of a voxel off, as turned slits show (3 times twice that over a
 * slit's width, which is w / 2); in deviations of what smooths labels, .7 voxels. */
static const double PLACED = 0.43; /* .301 voxels */

/* Pores narrower than so many standard deviations of the blur do not show their shape. */
static const double NARROW = 8.0;
/* What is drawn between slices far apart; of sands it grows no more from four times as far as wide
 * on. */
static const double DRAWN = 0.3; /* of k at most */

double scan_deviation(const struct scan_quality *scan) {
  return scan->resolution / RESOLUTION_DEVIATIONS;
}

double scan_shape_error(const struct scan_quality *scan, double width) {
  return width < NARROW * scan->blur ? scan->shape : 0.0;
}

/* Where labels are all that is left, the steps between voxels and what smooths them widen pores by
 * about twice the change, beside a part of a voxel that any wall may be off. A scan whose blur was
 * left in is off by about the change itself, and so is one too large for its blur to be taken out
 * of every voxel. Where it was taken out, the noise and the uncertainty of the measured blur (its
 * variance twice, for 95 %) leave a share of it, and walls are rough by a length that the noise
 * power has. */
static double error_of_blur(const struct scan_quality *scan, double change, double width) {
  if (scan->labels)
    return hypot(LABELS * (1.0 + GROWTH * fabs(change)) * fabs(change),
                 PLACED * scan_deviation(scan) / width);
  const double blur = 4.0 * scan->blur_error / scan->blur;
  const bool sharp = scan->removed && !scan->averaged;
  const double rough = ROUGH + (SMOOTH - ROUGH) * scan->smooth_walls;
  const double noise = NOISE * sqrt(scan->noise_power / pow(scan->blur, 3.0));
  const double left = hypot(hypot(noise, blur), REMOVED * scan->smooth_walls);
  const double share = sharp ? left * (1.0 + GROWTH * fabs(change)) : KEPT;
  return hypot(hypot(VOXELS, scan_shape_error(scan, width)),
               hypot(share * change, rough * cbrt(scan->noise_power) / width));
}

/* What is drawn between slices is left in, like a blur. */
double scan_error(const struct scan_quality *scan, double change, double width) {
  const double between = scan->between / pow(scan_deviation(scan), 2.0);
  return hypot(error_of_blur(scan, change, width), fmin(DRAWN, KEPT * between * fabs(change)));
}

double scan_change_expected(const struct scan_quality *scan, double width) {
  return CHANGE * pow(scan_deviation(scan) / width, 2.0);
}
