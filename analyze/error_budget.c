#include "analyze/error_budget.h"

#include <math.h>

#include "common/hdf5_file.h"

static double attribute(struct h5_file *file, const char *group, const char *name) {
  double value = NAN;
  if (h5_attribute_exists(file, group, name) &&
      h5_read_attribute(file, group, name, H5_F64, 1, &value) != STATUS_OK)
    error_clear();
  return value;
}

void error_budget_read(const struct run *run, struct error_budget *budget) {
  char path[8200];
  struct h5_file *file = NULL;
  *budget = (struct error_budget){run->predicted_error, NAN, NAN, NAN};
  if (!run_find_model(run, path, sizeof path)) return;
  if (h5_open(path, &file) != STATUS_OK) {
    error_clear();
    return;
  }
  double e = attribute(file, "/model", "void_ratio");
  double measured = attribute(file, "/model", "void_ratio_measured");
  double threshold_slope = attribute(file, "/calibration", "dthreshold_dvoid_ratio");
  if (e > 0.0) {
    budget->slope_void_ratio = 3.0 / e - 1.0 / (1.0 + e);
    budget->void_ratio = budget->slope_void_ratio * fabs(e - measured);
    budget->slope_threshold = budget->slope_void_ratio / threshold_slope;
  }
  h5_close(file);
}

double error_budget_total(const struct error_budget *budget, double statistical) {
  const double parts[3] = {statistical, budget->resolution, budget->void_ratio};
  double sum = 0.0;
  for (int i = 0; i < 3; i++)
    if (isfinite(parts[i])) sum += parts[i] * parts[i];
  return sqrt(sum);
}
