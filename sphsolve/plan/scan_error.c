#include "sphsolve/plan/scan_error.h"

#include <math.h>

#include "common/hdf5_file.h"
#include "common/model_file.h"

/* A Gaussian's transfer is a tenth at this period, in standard deviations: 2 pi / sqrt(2 ln 10). */
#define RESOLUTION_DEVIATIONS 2.9278
/* Fitted to generated sands (docs/notes/2026-11-22-scanner.md). */
static const double KEPT = 1.5; /* the error over the change of ln k, where the blur was left in, */
static const double REMOVED = 0.3;  /* and where it was taken out, */
static const double GROWTH = 3.0;   /* which grows by this times the change */
static const double ROUGH = 0.4;    /* the error over (roughness by noise / width of a pore) */
static const double VOXELS = 0.035; /* what the sharpest scan's voxels leave */
static const double CHANGE = 9.5;   /* expected change of ln k, times (deviation / mean pore)^2 */
/* Of the steps of a segmented image: fitted to spheres, packs, fibres and level sets of noise
 * (docs/notes/2026-11-22-labels.md). */
static const double LABELS = 2.0; /* the error over the change */
/* Walls from labels are a fortieth of a voxel off, as turned slits show (3 times twice that over a
 * slit's width, which is w / 2); in deviations of what smooths labels, .7 voxels. */
static const double PLACED = 0.43; /* .301 voxels */

/* Pores narrower than so many standard deviations of the blur show no grey of their own: the
 * threshold that encloses their volume then lies off the middle between the peaks of the greys, and
 * blur has rounded their corners. A pore of circular section lets 1.38 times as much through as a
 * triangular one of the same area (shape factors of Patzek, Silin 2001, J. Colloid Interface Sci.
 * 236: .5 G against .6 G, G = area / perimeter^2); which it is the scan cannot tell. */
static const double NARROW = 8.0;  /* deviations */
static const double SHAPE = 0.32;  /* ln 1.38 */
static const double MIDDLE = 0.05; /* off the middle, of the peaks' distance, as in sands */
static const double OFF = 0.12;    /* over so much more the shape is lost */

/* Voxels longer than wide become cubes by lines between neighbours: a triangle's weights, whose
 * variance is a sixth of the square of its half base. What the short edges have of it anyway is in
 * the blur; along one of three axes it counts a third. */
static const double DRAWN = 0.3; /* of k at most: of sands it grows no more from four times on */
static double drawn_between(struct h5_file *file) {
  const double longest = h5_attribute_or_nan(file, "/model", "voxel_scanned_longest");
  const double short_squared =
      pow(h5_attribute_or_nan(file, "/model", "voxel_scanned"), 3.0) / longest;
  const double more = longest * longest - short_squared;
  return more > 1e-6 * short_squared ? more / 18.0 : 0.0;
}

static double shape_lost(struct h5_file *file) {
  const double pore = h5_attribute_or_nan(file, "/calibration", "pore_peak");
  const double grain = h5_attribute_or_nan(file, "/calibration", "grain_peak");
  const double threshold = h5_attribute_or_nan(file, "/calibration", "threshold_original");
  const double off = fabs((threshold - pore) / (grain - pore) - 0.5);
  return isfinite(off) ? SHAPE * fmin(1.0, fmax(0.0, (off - MIDDLE) / OFF)) : 0.0;
}

/* A scan in greys that told no blur: one is assumed, and counts as left in, taken out or not. */
static bool assume(struct h5_file *file, struct scan_quality *scan) {
  const double voxel = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  const double ratio = h5_attribute_or_nan(file, "/calibration", "contrast_to_noise");
  if (!(voxel > 0.0 && ratio > 0.0)) return false;
  *scan = (struct scan_quality){.blur = MODEL_BLUR_ASSUMED * voxel,
                                .resolution = RESOLUTION_DEVIATIONS * MODEL_BLUR_ASSUMED * voxel,
                                .noise_power = pow(voxel, 3.0) / (ratio * ratio),
                                .assumed = true};
  return true;
}

bool scan_quality_read(const char *model_path, struct scan_quality *scan) {
  struct h5_file *file = NULL;
  if (!*model_path) return false;
  if (h5_open(model_path, &file) != STATUS_OK) {
    error_clear();
    return false;
  }
  /* Labels have no blur to be measured; what smooths their steps blurs them. */
  const double smoothing = h5_attribute_or_nan(file, "/calibration", "smoothing");
  if (smoothing > 0.0) {
    *scan = (struct scan_quality){.resolution = RESOLUTION_DEVIATIONS * smoothing,
                                  .between = drawn_between(file),
                                  .labels = true};
    h5_close(file);
    return true;
  }
  const double ratio = h5_attribute_or_nan(file, "/scanner", "contrast_to_noise");
  const double alike =
      2.0 * sqrt(M_PI) * h5_attribute_or_nan(file, "/scanner", "noise_correlation");
  const double blur = h5_attribute_or_nan(file, "/scanner", "blur");
  *scan =
      (struct scan_quality){.blur = blur,
                            .blur_error = h5_attribute_or_nan(file, "/scanner", "blur_uncertainty"),
                            .resolution = h5_attribute_or_nan(file, "/scanner", "resolution"),
                            .noise_power = pow(fmax(0.0, alike), 3.0) / (ratio * ratio),
                            .removed = h5_attribute_or_nan(file, "/scanner", "removed") == 1.0,
                            .averaged = h5_attribute_or_nan(file, "/scanner", "averaged") > 1.0};
  bool known = scan->blur > 0.0 && scan->blur_error > 0.0 && scan->resolution > 0.0 && ratio > 0.0;
  if (!known) known = assume(file, scan);
  scan->shape = shape_lost(file);
  scan->between = drawn_between(file);
  h5_close(file);
  return known;
}

double scan_deviation(const struct scan_quality *scan) {
  return scan->resolution / RESOLUTION_DEVIATIONS;
}

double scan_shape_error(const struct scan_quality *scan, double width) {
  return width < NARROW * scan->blur ? scan->shape : 0.0;
}

/* Where labels are all that is left, the steps between voxels and what smooths them widen pores by
 * about twice the change, beside a part of a voxel that any wall may be off. A scan whose blur was
 * left in is off by about the change itself, and so is one too large for its blur to be taken out
 * of every voxel. Where it was taken out, a share of it is left, beside what the uncertainty of the
 * blur makes (its variance twice, for 95 %), and walls are rough by a length that the noise power
 * has. */
static double error_of_blur(const struct scan_quality *scan, double change, double width) {
  if (scan->labels)
    return hypot(LABELS * (1.0 + GROWTH * fabs(change)) * fabs(change),
                 PLACED * scan_deviation(scan) / width);
  const double blur = 4.0 * scan->blur_error / scan->blur;
  const bool sharp = scan->removed && !scan->averaged;
  const double share = sharp ? hypot(REMOVED, blur) * (1.0 + GROWTH * fabs(change)) : KEPT;
  return hypot(hypot(VOXELS, scan_shape_error(scan, width)),
               hypot(share * change, ROUGH * cbrt(scan->noise_power) / width));
}

/* What is drawn between slices is left in, like a blur. */
double scan_error(const struct scan_quality *scan, double change, double width) {
  const double between = scan->between / pow(scan_deviation(scan), 2.0);
  return hypot(error_of_blur(scan, change, width), fmin(DRAWN, KEPT * between * fabs(change)));
}

double scan_change_expected(const struct scan_quality *scan, double width) {
  return CHANGE * pow(scan_deviation(scan) / width, 2.0);
}
