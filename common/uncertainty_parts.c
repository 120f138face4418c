#include "common/uncertainty_parts.h"

#include <math.h>
#include <stdbool.h>

const char *const uncertainty_part_names[UNCERTAINTY_PARTS] = {"resolution",
                                                               "scan",
                                                               "sides",
                                                               "void_ratio",
                                                               "threshold",
                                                               "micro",
                                                               "averaging",
                                                               "steadiness",
                                                               "dlnk_dvoid_ratio",
                                                               "dlnk_dthreshold",
                                                               "dlnk_dlnk_micro",
                                                               "dlnk_sides_closed",
                                                               "blur_assumed",
                                                               "sides_unknown"};

struct uncertainty_parts uncertainty_parts_none(void) {
  struct uncertainty_parts parts;
  for (int i = 0; i < UNCERTAINTY_PARTS; i++) parts.value[i] = NAN;
  return parts;
}

double uncertainty_parts_total(const struct uncertainty_parts *parts, double resolution) {
  struct uncertainty_parts p = *parts;
  double sum = 0.0;
  bool known = false;
  p.resolution = resolution;
  for (int i = 0; i < UNCERTAINTY_SHARES; i++) {
    if (!isfinite(p.value[i])) continue;
    sum += p.value[i] * p.value[i];
    known = true;
  }
  return known ? sqrt(sum) : NAN;
}

double uncertainty_share_of_sides(const double *k, int count) {
  if (!(k[0] > 0.0) || isnan(k[count - 1])) return NAN;
  double steps = 0.0;
  for (int i = 1; i < count; i++)
    if (k[i - 1] > 0.0 && k[i] > 0.0) steps = hypot(steps, k[i] / k[i - 1] - 1.0);
  return fmax(fabs(k[count - 1] / k[0] - 1.0), steps);
}

enum status uncertainty_parts_read(struct h5_file *file, const char *group,
                                   struct uncertainty_parts *parts) {
  enum status status = STATUS_OK;
  *parts = uncertainty_parts_none();
  for (int i = 0; i < UNCERTAINTY_PARTS; i++)
    if (h5_attribute_exists(file, group, uncertainty_part_names[i]))
      TRY(h5_read_attribute(file, group, uncertainty_part_names[i], H5_F64, 1, &parts->value[i]));
cleanup:
  return status;
}

enum status uncertainty_parts_write(const struct uncertainty_parts *parts, struct h5_file *file,
                                    const char *group) {
  enum status status = STATUS_OK;
  for (int i = 0; i < UNCERTAINTY_PARTS; i++)
    TRY(h5_write_attribute(file, group, uncertainty_part_names[i], H5_F64, 1, &parts->value[i]));
cleanup:
  return status;
}
