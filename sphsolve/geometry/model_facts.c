#include "sphsolve/geometry/model_facts.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/model_file.h"
#include "common/provenance.h"

/* Pores narrower than a few standard deviations of the blur do not reach the grey value of their
 * material: the threshold that encloses their volume lies off the middle between the peaks of the
 * grey values, and blur has rounded their corners. A pore of circular section has 1.38 times the
 * conductance of a triangular one of the same area (shape factors of Patzek, Silin 2001, J. Colloid
 * Interface Sci. 236: .5 G against .6 G, G = area / perimeter^2); the scan cannot tell which it
 * is. */
static const double SHAPE = 0.32; /* ln 1.38 */
/* Distances of the threshold from the middle, relative to that of the peaks: usual in sands, and
 * the additional distance at which the shape is entirely unknown. */
static const double OFF_MIDDLE_USUAL = 0.05;
static const double OFF_MIDDLE_RANGE = 0.12;

static double shape_uncertainty(struct h5_file *file) {
  const double pore = h5_attribute_or_nan(file, "/calibration", "pore_peak");
  const double grain = h5_attribute_or_nan(file, "/calibration", "grain_peak");
  const double threshold = h5_attribute_or_nan(file, "/calibration", "threshold_original");
  const double off = fabs((threshold - pore) / (grain - pore) - 0.5);
  return isfinite(off) ? SHAPE * fmin(1.0, fmax(0.0, (off - OFF_MIDDLE_USUAL) / OFF_MIDDLE_RANGE))
                       : 0.0;
}

/* Elongated voxels become cubes by linear interpolation: triangular weights, whose variance is a
 * sixth of the square of half the base. The contribution of the short edges is already in the blur;
 * the rest along one of three axes counts a third. */
static double interpolation_variance(struct h5_file *file) {
  const double longest = h5_attribute_or_nan(file, "/model", "voxel_scanned_longest");
  const double short_squared =
      pow(h5_attribute_or_nan(file, "/model", "voxel_scanned"), 3.0) / longest;
  const double more = longest * longest - short_squared;
  return more > 1e-6 * short_squared ? more / 18.0 : 0.0;
}

/* Assumes a blur for a grey-value scan whose blur could not be estimated. It counts as not removed,
 * even if it was. */
static void assume_blur(struct h5_file *file, struct scan_quality *scan) {
  const double voxel = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  const double ratio = h5_attribute_or_nan(file, "/calibration", "contrast_to_noise");
  if (!(voxel > 0.0 && ratio > 0.0)) return;
  *scan = (struct scan_quality){.known = true,
                                .blur = MODEL_BLUR_ASSUMED * voxel,
                                .resolution = RESOLUTION_DEVIATIONS * MODEL_BLUR_ASSUMED * voxel,
                                .noise_power = pow(voxel, 3.0) / (ratio * ratio),
                                .assumed = true};
}

/* Standard error of the blur: half of its uncertainty, the whole of it in files of versions that
 * did not tell a void ratio of the scan. */
static double blur_error(struct h5_file *file) {
  const bool half_width = h5_attribute_exists(file, "/model", "void_ratio_scan");
  return h5_attribute_or_nan(file, "/scanner", "blur_uncertainty") / (half_width ? 2.0 : 1.0);
}

static struct scan_quality read_scan(struct h5_file *file) {
  /* Labels have no measurable blur; the smoothing of their steps is their blur. */
  const double smoothing = h5_attribute_or_nan(file, "/calibration", "smoothing");
  if (smoothing > 0.0) {
    const double counted = h5_attribute_or_nan(file, "/calibration", "void_ratio_uncertainty");
    return (struct scan_quality){.known = true,
                                 .void_ratio_error = fmax(0.0, counted),
                                 .resolution = RESOLUTION_DEVIATIONS * smoothing,
                                 .between = interpolation_variance(file),
                                 .labels = true};
  }
  const double ratio = h5_attribute_or_nan(file, "/scanner", "contrast_to_noise");
  /* Even uncorrelated noise is constant within a voxel. */
  const double correlation_length =
      fmax(h5_attribute_or_nan(file, "/model", "voxel_scanned"),
           2.0 * sqrt(M_PI) * h5_attribute_or_nan(file, "/scanner", "noise_correlation"));
  const double blur = h5_attribute_or_nan(file, "/scanner", "blur");
  struct scan_quality scan = {.blur = blur,
                              .blur_error = blur_error(file),
                              .resolution = h5_attribute_or_nan(file, "/scanner", "resolution"),
                              .noise_power =
                                  pow(fmax(0.0, correlation_length), 3.0) / (ratio * ratio),
                              .removed = h5_attribute_or_nan(file, "/scanner", "removed") == 1.0};
  /* Models made before November 2026 may come from means of voxels, which keep the blur's effect.
   */
  if (h5_attribute_or_nan(file, "/scanner", "averaged") > 1.0) scan.removed = false;
  scan.known = scan.blur > 0.0 && scan.blur_error > 0.0 && scan.resolution > 0.0 && ratio > 0.0;
  if (!scan.known) assume_blur(file, &scan);
  scan.shape = shape_uncertainty(file);
  scan.between = interpolation_variance(file);
  scan.smooth_walls = fmax(0.0, h5_attribute_or_nan(file, "/scanner", "smooth_walls"));
  scan.void_ratio_error = fmax(0.0, h5_attribute_or_nan(file, "/model", "void_ratio_doubt"));
  return scan;
}

/* What the numbers of a model can be: outside of these ranges the error of k would be none. NAN is
 * unknown, and 0 as good as that. */
static const struct range {
  const char *group, *attribute;
  double low, high;
  bool in_voxels; /* a length, in voxels of the scan where these are known */
} RANGES[] = {
    {"/model", "voxel_scanned", 1e-12, 1e3, false},
    {"/model", "voxel_scanned_longest", 0.0, 1e3, true},
    {"/model", "void_ratio_error", -1e3, 1e3, false},
    {"/model", "void_ratio_measured", 0.0, 1e4, false},
    {"/model", "micro_ln_permeability_uncertainty", 0.0, 1e2, false},
    {"/calibration", "pore_peak", -FLT_MAX, FLT_MAX, false},
    {"/calibration", "grain_peak", -FLT_MAX, FLT_MAX, false},
    {"/calibration", "threshold_original", -FLT_MAX, FLT_MAX, false},
    {"/calibration", "threshold_uncertainty", 0.0, FLT_MAX, false},
    {"/calibration", "dthreshold_dvoid_ratio", -FLT_MAX, FLT_MAX, false},
    {"/calibration", "contrast_to_noise", 1e-6, INFINITY, false},
    {"/calibration", "smoothing", 0.0, 1e3, true},
    {"/calibration", "void_ratio_uncertainty", 0.0, 1e3, false},
    {"/scanner", "contrast_to_noise", 1e-6, INFINITY, false},
    {"/scanner", "noise_correlation", 0.0, 1e3, true},
    {"/scanner", "blur", 0.0, 1e3, true},
    {"/scanner", "blur_uncertainty", 0.0, 1e3, true},
    {"/scanner", "resolution", 0.0, 1e4, true},
    {"/scanner", "smooth_walls", 0.0, 1.0, false},
};

static enum status check_ranges(const char *path, struct h5_file *file) {
  const double voxel = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  for (size_t i = 0; i < sizeof RANGES / sizeof *RANGES; i++) {
    const struct range *range = &RANGES[i];
    const double value = h5_attribute_or_nan(file, range->group, range->attribute);
    const double unit = range->in_voxels && voxel > 0.0 ? voxel : 1.0;
    if (value != 0.0 && (value < range->low * unit || value > range->high * unit))
      return FAIL(STATUS_INPUT, "%s: %s: %s is %g; %g to %g is possible (docs/formats.md)", path,
                  range->group, range->attribute, value, range->low * unit, range->high * unit);
  }
  const double uncertainty = h5_attribute_or_nan(file, "/calibration", "threshold_uncertainty");
  const double slope = fabs(h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio"));
  if (uncertainty > 1e3 * slope)
    return FAIL(STATUS_INPUT,
                "%s: /calibration: threshold_uncertainty is %g where the threshold changes by %g a "
                "void ratio of 1: the two do not belong together",
                path, uncertainty, slope);
  return STATUS_OK;
}

enum status model_facts_read(const char *path, struct model_facts *facts) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  char *sides = NULL, *mirror = NULL;
  *facts = (struct model_facts){0};
  TRY(hash_file(path, &facts->hash));
  TRY(h5_open(path, &file));
  TRY(check_ranges(path, file));
  facts->voxel_scanned = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  facts->void_ratio_error = model_void_ratio_error(file);
  facts->threshold_slope = h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio");
  facts->threshold_uncertainty = h5_attribute_or_nan(file, "/calibration", "threshold_uncertainty");
  facts->soil_error = h5_attribute_or_nan(file, "/model", "micro_ln_permeability_uncertainty");
  facts->scan = read_scan(file);
  if (h5_attribute_exists(file, "/model", "mirror_axis")) {
    TRY(h5_read_attribute_text(file, "/model", "mirror_axis", &mirror));
    facts->z_mirrored = !strcmp(mirror, "z");
  }
  if (!h5_attribute_exists(file, "/model", "sides")) goto cleanup;
  TRY(h5_read_attribute_text(file, "/model", "sides", &sides));
  facts->sides_wrapped = !strcmp(sides, "periodic");
  facts->sides_mirrored = !strcmp(sides, "mirrored");
  facts->sides_stated = h5_attribute_or_nan(file, "/model", "sides_stated") > 0.0;
cleanup:
  h5_close(file);
  MEMORY_FREE(&sides, &mirror);
  return status;
}
