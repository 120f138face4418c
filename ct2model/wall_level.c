#include "ct2model/wall_level.h"
#include "ct2model/constants.h"

#include <math.h>
#include <string.h>

/* The threshold in the coarse levels: that with the same void ratio, or the same grey if a
 * threshold was given or there are only two levels. False if levels were clipped around it. */
static bool coarse_threshold(const struct pipeline *pipeline, double *threshold) {
  const struct coarse *coarse = &pipeline->coarse;
  if (coarse->step == 1) return false;
  *threshold = (pipeline->threshold_original - coarse->low) / coarse->unit;
  const bool inside = *threshold > 1.0 && *threshold < (double)coarse->histogram.bins - 2.0;
  if (pipeline->request->rule == THRESHOLD_AUTO && pipeline->phases.levels > 2)
    *threshold = grey_histogram_quantile(
        &coarse->histogram,
        grey_histogram_porosity(&pipeline->histogram, pipeline->threshold_original));
  return inside;
}

static double grey_of_walls(const struct pipeline *pipeline, const struct wall_level *walls,
                            double grey) {
  const struct coarse *coarse = &pipeline->coarse;
  return walls->averaged ? (grey - coarse->low) / coarse->unit : grey;
}

static bool has_scan_voxels(const struct pipeline *pipeline) {
  return memcmp(pipeline->size, pipeline->region.size, sizeof pipeline->size) == 0;
}

struct enclosed_sides wall_level_sides(const struct pipeline *pipeline) {
  const struct mirroring mirroring = pipeline_mirroring(pipeline);
  struct enclosed_sides sides = {.faces = !has_scan_voxels(pipeline)};
  for (int d = 0; d < 3; d++) sides.reflect[d] = sides.faces || mirroring.mirrored[d];
  return sides;
}

enum status wall_level_find(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct wall_level *walls = &pipeline->walls;
  const bool restored = pipeline->restored.scan.levels != NULL;
  const bool matched = pipeline->request->rule == THRESHOLD_AUTO && pipeline->phases.levels > 2;
  double porosity = pipeline->void_ratio_original / (1.0 + pipeline->void_ratio_original);
  *walls = (struct wall_level){.region = pipeline->region,
                               .threshold = pipeline->threshold_original,
                               .contrast = pipeline_contrast(pipeline),
                               .step = 1,
                               .void_ratio = NAN};
  if (restored) {
    walls->region = restored_region(&pipeline->restored, &pipeline->region);
    walls->threshold = pipeline->restored.threshold;
    walls->contrast = 1.0 / pipeline->restored.scan.unit;
    walls->void_ratio = pipeline->restored.void_ratio;
  } else if (coarse_threshold(pipeline, &walls->threshold)) {
    walls->region = coarse_region(&pipeline->coarse, &pipeline->region);
    walls->step = pipeline->coarse.step;
    walls->contrast /= pipeline->coarse.unit;
    walls->averaged = true;
  } else {
    walls->threshold = pipeline->threshold_original;
  }
  if (pipeline->labels.on || !(restored || matched)) return STATUS_OK;
  if (!restored) {
    const double pore = grey_of_walls(pipeline, walls, pipeline->phases.pore_peak);
    const double low = pore + NEAR_PEAK * walls->contrast,
                 high = pore + (1.0 - NEAR_PEAK) * walls->contrast;
    if (!(walls->threshold > low && walls->threshold < high)) return STATUS_OK;
    const struct enclosed_sides sides = wall_level_sides(pipeline);
    TRY(enclosed_match(&walls->region, &sides, low, high, &walls->threshold, &porosity));
    walls->void_ratio = porosity / (1.0 - porosity);
  }
  if (!has_scan_voxels(pipeline)) goto cleanup;
  /* The scan's own voxels get the phase that the walls give them. */
  pipeline->solid_threshold = walls->threshold;
  if (!restored) pipeline->threshold = walls->threshold;
cleanup:
  return status;
}
