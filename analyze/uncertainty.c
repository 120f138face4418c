#include "analyze/uncertainty.h"

#include <math.h>

#include "analyze/product.h"
#include "common/constants.h"
#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/model_file.h"

void uncertainty_read(const struct run *run, struct uncertainty *u) {
  struct h5_file *file = NULL;
  *u = (struct uncertainty){.parts = run->error,
                            .resolution_needs = run->resolution_needs,
                            .slope_solved = isfinite(run->error.slope_void_ratio),
                            .scanned = run->model_path[0] != '\0'};
  if (isnan(u->resolution)) u->resolution = run->predicted_error;
  u->resolution_expected = isnan(run->error.resolution) || run->levels.count < 2;
  if (u->slope_solved || run->model_file[0] == '\0') return;
  if (h5_open(run->model_file, &file) != STATUS_OK) {
    error_clear();
    return;
  }
  double e = h5_attribute_or_nan(file, "/model", "void_ratio");
  double threshold_slope = h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio");
  double uncertainty = h5_attribute_or_nan(file, "/calibration", "threshold_uncertainty");
  if (e > 0.0) {
    u->slope_void_ratio = 3.0 / e - 1.0 / (1.0 + e);
    u->void_ratio = u->slope_void_ratio * fabs(model_void_ratio_error(file));
    u->slope_threshold = u->slope_void_ratio / threshold_slope;
    if (uncertainty > 0.0) u->threshold = fabs(u->slope_threshold) * uncertainty;
  }
  h5_close(file);
}

double uncertainty_total(const struct uncertainty *u) {
  const double total = uncertainty_parts_total(&u->parts, u->resolution);
  return isfinite(total) ? total : 0.0;
}

/* Whether a part is seen in the total; the others are left out where people read. */
static bool is_shown(const struct uncertainty *u, double part) {
  return fabs(part) >= PART_LEAST * uncertainty_total(u) && part != 0;
}

void uncertainty_json(const struct uncertainty *u, json_t *object) {
  json_t *parts = json_object();
  for (int i = 0; i < UNCERTAINTY_SHARES; i++)
    json_put_number(parts, uncertainty_part_names[i], u->parts.value[i]);
  json_put_number(parts, "total", uncertainty_total(u));
  json_t *shown = json_array();
  for (int i = 0; i < UNCERTAINTY_SHARES; i++)
    if (is_shown(u, u->parts.value[i]))
      json_array_append_new(shown, json_string(uncertainty_part_names[i]));
  json_object_set_new(parts, "shown", shown);
  json_object_set_new(parts, "scan_unknown", json_boolean(u->scanned && isnan(u->scan)));
  json_object_set_new(parts, "sides_unknown", json_boolean(u->sides_unknown > 0));
  json_put_number(parts, "blur_assumed_m", u->blur_assumed);
  json_put_number(parts, "dlnk_sides_closed", u->sides_closed);
  json_object_set_new(parts, "resolution_from",
                      json_string(u->resolution_index      ? "grid convergence index"
                                  : u->resolution_expected ? "expectation"
                                                           : "lattices"));
  json_object_set_new(parts, "resolution_needs",
                      json_string(u->resolution_needs != NULL ? u->resolution_needs : ""));
  json_object_set_new(object, "error_budget", parts);
  json_put_number(object, "dlnk_dvoid_ratio", u->slope_void_ratio);
  json_object_set_new(object, "dlnk_dvoid_ratio_solved", json_boolean(u->slope_solved));
  json_put_number(object, "dlnk_dthreshold", u->slope_threshold);
  json_put_number(object, "dlnk_dlnk_micro", u->slope_micro);
}

static void write_part(FILE *stream, const char *what, double share) {
  if (!isfinite(share) || share == 0) return;
  fputs(what, stream);
  write_percent(stream, share);
}

static void write_shown(const struct uncertainty *u, FILE *stream, const char *what, double part) {
  if (is_shown(u, part)) write_part(stream, what, part);
}

void uncertainty_write(const struct uncertainty *u, FILE *stream) {
  fputs("  error of k: ", stream);
  if (isfinite(u->resolution))
    write_part(stream, u->resolution_expected ? "resolution (expected) " : "resolution ",
               u->resolution);
  else
    fputs("resolution unknown, not counted", stream);
  write_shown(u, stream, isfinite(u->blur_assumed) ? ", scan (blur assumed) " : ", scan ", u->scan);
  if (u->scanned && isnan(u->scan)) fputs(", scan unknown, not counted", stream);
  write_shown(u, stream, ", sides ", u->sides);
  if (u->sides_unknown > 0) fputs(", sides unknown, not counted", stream);
  write_shown(u, stream, ", averaging ", u->averaging);
  write_shown(u, stream, ", steadiness ", u->steadiness);
  write_shown(u, stream, ", void ratio ", u->void_ratio);
  write_shown(u, stream, ", threshold ", u->threshold);
  write_shown(u, stream, ", soil below the voxel ", u->micro);
  write_part(stream, "; together ", uncertainty_total(u));
  if (isfinite(u->void_ratio) && isnan(u->threshold))
    write_part(
        stream,
        "\n  the void ratio was given without its +-, which is not counted: each 0.01 moves k by ",
        fabs(0.01 * u->slope_void_ratio));
  if (isfinite(u->slope_void_ratio) && log_level() >= LOG_VERBOSE) {
    write_part(stream, "\n  0.01 of void ratio moves k by ", 0.01 * u->slope_void_ratio);
    write_part(stream,
               u->slope_solved ? " (solved), one grey level of the threshold by "
                               : " (Kozeny-Carman), one grey level of the threshold by ",
               u->slope_threshold);
  }
  fputc('\n', stream);
}
