#include "ct2model/state.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

struct mirroring pipeline_mirroring(const struct pipeline *pipeline) {
  const bool sides = pipeline->request->sides == SIDES_MIRRORED;
  const size_t *n = pipeline->size;
  return (struct mirroring){{n[0], n[1], n[2]}, {sides, sides, pipeline->request->mirror}};
}

double pipeline_grey(const struct pipeline *pipeline, double internal) {
  const bool negated = pipeline->request->dark_grains && !pipeline->labels.on;
  return internal * pipeline->grey_scale * (negated ? -1.0 : 1.0);
}

bool pipeline_walls_enclose(const struct pipeline *pipeline) {
  return (pipeline->labels.on || isfinite(pipeline->walls.void_ratio)) &&
         pipeline->labels.micro.kind == NULL && !pipeline->request->fill_islands &&
         memcmp(pipeline->size, pipeline->region.size, sizeof pipeline->size) == 0;
}

double pipeline_void_ratio(const struct pipeline *pipeline) {
  const double n = pipeline->labels.model_porosity;
  if (!pipeline_walls_enclose(pipeline)) return pipeline->model.void_ratio;
  return pipeline->labels.on ? n / (1.0 - n) : pipeline->walls.void_ratio;
}

double pipeline_contrast(const struct pipeline *pipeline) {
  const struct grey_histogram *histogram = &pipeline->histogram;
  const double contrast = pipeline->phases.grain_peak - pipeline->phases.pore_peak;
  return contrast > 0.0 ? contrast : histogram->width * (double)histogram->bins;
}

/* Uncertainty of a void ratio that was not measured, in units of the difference between that of the
 * threshold and that of the scan's own edges after deblurring, in the middle between pore and
 * grain. For fibres and balls under a blur the edges themselves are off by half of this
 * (docs/physics/restoration.md). */
static const double EDGE_DIFFERENCES = 2.0;
static double void_ratio_error(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  if (isfinite(request->void_ratio)) return request->void_ratio_error;
  if (!pipeline->blur_removed) return NAN;
  return EDGE_DIFFERENCES * fabs(pipeline->restored.middle - pipeline->void_ratio_original);
}

double pipeline_threshold_error(const struct pipeline *pipeline) {
  return fabs(pipeline_grey(pipeline, pipeline->threshold_slope)) * void_ratio_error(pipeline);
}

bool pipeline_finer_size(const struct pipeline *pipeline, double aim, size_t size[3],
                         bool *enough) {
  const double error = pipeline->morphology.expected_error; /* second order in the voxel size */
  *enough = true;
  if (!(error > aim)) return false;
  for (int a = 0; a < 3; a++) {
    const size_t most = pipeline->region.size[pipeline->place[a]];
    size[a] = (size_t)ceil(sqrt(error / aim) * (double)pipeline->size[pipeline->place[a]]);
    *enough &= size[a] <= most;
    if (size[a] > most) size[a] = most;
  }
  return true;
}

void pipeline_end(struct pipeline *pipeline) {
  model_free(&pipeline->model);
  grey_histogram_end(&pipeline->histogram);
  grey_histogram_end(&pipeline->calibration);
  sweep_table_end(&pipeline->table);
  MEMORY_FREE(&pipeline->volume, &pipeline->middle, &pipeline->turned);
  surface_sample_end(&pipeline->sample);
  coarse_end(&pipeline->coarse);
  restored_end(&pipeline->restored);
  survey_end(&pipeline->survey);
  labels_end(&pipeline->labels);
  stack_close(&pipeline->stack);
}
