#include "analyze/error_budget.h"

#include <math.h>

#include "analyze/product.h"
#include "common/hdf5_file.h"
#include "common/log.h"

void error_budget_read(const struct run *run, struct error_budget *budget) {
  char path[8200];
  struct h5_file *file = NULL;
  *budget = (struct error_budget){.resolution = run->error.resolution,
                                  .scan = run->error.scan,
                                  .sides = run->error.sides,
                                  .averaging = run->error.averaging,
                                  .steadiness = run->error.steadiness,
                                  .void_ratio = run->error.void_ratio,
                                  .threshold = run->error.threshold,
                                  .slope_void_ratio = run->error.slope_void_ratio,
                                  .slope_threshold = run->error.slope_threshold,
                                  .slope_solved = isfinite(run->error.slope_void_ratio)};
  if (isnan(budget->resolution)) {
    budget->resolution = run->predicted_error;
    budget->resolution_expected = true;
  }
  if (budget->slope_solved || !run_find_model(run, path, sizeof path)) return;
  if (h5_open(path, &file) != STATUS_OK) {
    error_clear();
    return;
  }
  double e = h5_attribute_or_nan(file, "/model", "void_ratio");
  double measured = h5_attribute_or_nan(file, "/model", "void_ratio_measured");
  double threshold_slope = h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio");
  double uncertainty = h5_attribute_or_nan(file, "/calibration", "threshold_uncertainty");
  if (e > 0.0) {
    budget->slope_void_ratio = 3.0 / e - 1.0 / (1.0 + e);
    budget->void_ratio = budget->slope_void_ratio * fabs(e - measured);
    budget->slope_threshold = budget->slope_void_ratio / threshold_slope;
    if (uncertainty > 0.0) budget->threshold = fabs(budget->slope_threshold) * uncertainty;
  }
  h5_close(file);
}

double error_budget_total(const struct error_budget *budget) {
  const double parts[] = {budget->resolution, budget->scan,       budget->sides,
                          budget->averaging,  budget->steadiness, budget->void_ratio,
                          budget->threshold};
  double sum = 0.0;
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    if (isfinite(parts[i])) sum += parts[i] * parts[i];
  return sqrt(sum);
}

void error_budget_json(const struct error_budget *budget, json_t *object) {
  json_object_set_new(
      object, "error_budget",
      json_pack("{s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:s}", "resolution",
                json_number(budget->resolution), "scan", json_number(budget->scan), "sides",
                json_number(budget->sides), "averaging", json_number(budget->averaging),
                "steadiness", json_number(budget->steadiness), "void_ratio",
                json_number(budget->void_ratio), "threshold", json_number(budget->threshold),
                "total", json_number(error_budget_total(budget)), "resolution_from",
                budget->resolution_expected ? "expectation" : "grid convergence index"));
  json_object_set_new(object, "dlnk_dvoid_ratio", json_number(budget->slope_void_ratio));
  json_object_set_new(object, "dlnk_dvoid_ratio_solved", json_boolean(budget->slope_solved));
  json_object_set_new(object, "dlnk_dthreshold", json_number(budget->slope_threshold));
}

static void write_part(FILE *stream, const char *what, double share) {
  if (!isfinite(share) || share == 0) return;
  fputs(what, stream);
  write_percent(stream, share);
}

void error_budget_write(const struct error_budget *budget, FILE *stream) {
  fputs("  error of k: ", stream);
  if (isfinite(budget->resolution))
    write_part(stream, budget->resolution_expected ? "resolution (expected) " : "resolution ",
               budget->resolution);
  else
    fputs("resolution unknown, not counted", stream);
  write_part(stream, ", scan ", budget->scan);
  write_part(stream, ", sides ", budget->sides);
  write_part(stream, ", averaging ", budget->averaging);
  write_part(stream, ", steadiness ", budget->steadiness);
  write_part(stream, ", void ratio ", budget->void_ratio);
  write_part(stream, ", threshold ", budget->threshold);
  write_part(stream, "; together ", error_budget_total(budget));
  if (isfinite(budget->slope_void_ratio) && log_level() >= LOG_VERBOSE) {
    write_part(stream, "\n  0.01 of void ratio moves k by ", 0.01 * budget->slope_void_ratio);
    write_part(stream,
               budget->slope_solved ? " (solved), one grey level of the threshold by "
                                    : " (Kozeny-Carman), one grey level of the threshold by ",
               budget->slope_threshold);
  }
  fputc('\n', stream);
}
