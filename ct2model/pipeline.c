#include "ct2model/pipeline.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/side_distance.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/model_file.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/units.h"
#include "ct2model/scan/autocrop.h"
#include "ct2model/binarise.h"
#include "ct2model/constants.h"
#include "ct2model/misfit.h"
#include "ct2model/model_size.h"
#include "ct2model/model/sides.h"
#include "ct2model/readers/byte_order.h"
#include "ct2model/scan.h"
#include "ct2model/scanner/narrow_scanner.h"
#include "ct2model/scanner/porod.h"
#include "ct2model/scanner/smooth_walls.h"
#include "ct2model/segment.h"
#include "ct2model/surface/wall_distance.h"
#include "ct2model/wall_level.h"

/* ---- region: crop, voxel size ---- */

static enum status choose_voxel(struct pipeline *pipeline) {
  const struct stack *stack = &pipeline->stack;
  const double *given = pipeline->request->voxel;
  double *voxel = pipeline->region.voxel;
  const bool unknown = isnan(given[0]);
  for (int d = 0; d < 3; d++) voxel[d] = unknown ? stack->voxel[d] : given[d];
  if (isnan(voxel[0]) && !pipeline->distances) {
    log_info("no voxel size given: the threshold needs none; lengths are left out");
    voxel[0] = 1;
    pipeline->unsized = true;
  }
  if (isnan(voxel[0]))
    return FAIL(
        STATUS_INPUT,
        "%s: does not say how large a voxel is; give --voxel-size, e.g. --voxel-size 5.83um",
        stack->files[0].path);
  if (isnan(voxel[1])) voxel[1] = voxel[0];
  if (isnan(voxel[2])) {
    if (unknown && !pipeline->unsized)
      log_warning("%s give no slice distance; that of the pixels is taken", stack->voxel_source);
    voxel[2] = voxel[0];
  }
  if (unknown && !pipeline->unsized) {
    char text[40];
    quantity_format(voxel[0], "m", text, sizeof text);
    log_info("voxel size %s from the %s", text, stack->voxel_source);
  }
  stack_compare_voxel(stack, given, pipeline->request->has_slice_distance);
  return STATUS_OK;
}

/* Surveys the greys and their artefacts, sets their correction, and measures the scanner. */
static enum status survey_region(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct request *request = pipeline->request;
  struct survey *survey = &pipeline->survey;
  bool wanted = request->correct_beam || request->correct_rings || request->denoise != DENOISE_NONE;
  memcpy(pipeline->survey_size, pipeline->region.size, sizeof pipeline->survey_size);
  TRY(survey_take(&pipeline->region, request->void_ratio / (1.0 + request->void_ratio),
                  request->correct_beam || request->correct_rings, survey));
  pipeline->correction =
      (struct correction){survey_correct, survey, request->correct_beam, request->correct_rings};
  if (wanted && !(survey->phases.contrast_to_noise > 0.0)) {
    log_warning("--denoise and --correct do nothing: the image is segmented or of one grey");
  } else if (wanted && isnan(survey->rings) && (request->correct_beam || request->correct_rings)) {
    log_warning("--correct does nothing: the region is too small to tell how greys change with the "
                "radius");
    pipeline->correction.beam = pipeline->correction.rings = false;
    pipeline->region.correction = &pipeline->correction;
  } else if (wanted) {
    pipeline->region.correction = &pipeline->correction;
  }
  if (pipeline->region.correction != NULL) pipeline->region.denoise = request->denoise;
  if (request->roi.kind != ROI_NONE) survey->porosity = NAN; /* the void ratio is that of a part */
  if (pipeline->finer != NULL) {
    pipeline->scanner = pipeline->finer->scanner;
    goto cleanup;
  }
  TRY(scanner_measure(&pipeline->region, survey, &pipeline->scanner));
  if (pipeline->scanner.narrow) TRY(narrow_scanner_find(&pipeline->region, &pipeline->scanner));
cleanup:
  return status;
}

static enum status choose_region(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct request *request = pipeline->request;
  struct stack *stack = &pipeline->stack;
  struct region *region = &pipeline->region;
  *region = (struct region){.stack = stack, .scale = request->dark_grains ? -1.0 : 1.0};
  memcpy(region->size, stack->size, sizeof region->size);
  for (int d = 0; d < 2; d++) {
    region->axis[d] = isnan(request->axis[d]) ? 0.5 * (double)stack->size[d] : request->axis[d];
    if (!(region->axis[d] > -1e5 && region->axis[d] < 1e6))
      TRY_FAIL(STATUS_USAGE, "--axis: %g is far outside the slices", region->axis[d]);
  }
  for (int d = 0; request->crop_given && d < 3; d++) {
    region->origin[d] = request->crop[d];
    region->size[d] = request->crop[d + 3];
    if (region->origin[d] + region->size[d] > stack->size[d])
      TRY_FAIL(STATUS_USAGE, "--crop: %c from %zu to %zu, but the stack is %zux%zux%zu", "xyz"[d],
               region -> origin[d], region -> origin[d] + region -> size[d], stack -> size[0],
               stack -> size[1], stack -> size[2]);
  }
  TRY(stack_keep_labels(stack, region->origin[2]));
  if (request->crop_auto) TRY(autocrop(region));
  TRY(choose_voxel(pipeline));
  TRY(segment_take(pipeline));
  if (!pipeline->labels.on) TRY(survey_region(pipeline));
  int axis = (request->flow_axis + 1 + request->mirror_axis) % 3; /* axis of the scan that is z
                                                                     inside the pipeline */
  for (int a = 0; a < 3; a++) pipeline->place[a] = (a + 2 - request->mirror_axis) % 3;
  pipeline->as_read = *region;
  /* Turning also stores the denoised slices, so that each is denoised once. */
  if (axis != 2 || region->denoise != DENOISE_NONE)
    TRY(region_turn(region, axis, &pipeline->turned));
  TRY(model_size_choose(pipeline));
cleanup:
  return status;
}

static enum status count_calibration(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct grey_histogram *region = &pipeline->histogram;
  struct grey_histogram *calibration = &pipeline->calibration;
  TRY(grey_histogram_start(region->low, region->width, region->bins, calibration));
  if (pipeline->request->roi.kind != ROI_NONE) {
    TRY(roi_count(&pipeline->request->roi, &pipeline->region, calibration));
  } else {
    memcpy(calibration->counts, region->counts, region->bins * sizeof *region->counts);
    calibration->total = region->total;
  }
cleanup:
  return status;
}

/* ---- model ---- */

static void add_layers(struct pipeline *pipeline) {
  struct voxel_model *model = &pipeline->model;
  const enum sides sides = pipeline->request->sides;
  const struct mirroring mirroring = pipeline_mirroring(pipeline);
  model->mirror_plane = pipeline->request->mirror ? (int)pipeline->size[2] - 1 : -1;
  for (int d = 0; d < 3; d++) {
    model->size[d] = mirroring.mirrored[d] ? 2 * pipeline->size[d] - 1 : pipeline->size[d];
    model->periodic[d] = sides != SIDES_CLOSED || d == 2;
    model->spacing[d] =
        pipeline->region.voxel[d] * (double)pipeline->region.size[d] / (double)pipeline->size[d];
  }
}

/* Mirrors along z: layers n .. 2n - 2 repeat n - 2 .. 0; `layer` voxels each. */
static void mirror_layers(const struct pipeline *pipeline, size_t layer, void *data, size_t bytes) {
  const size_t n = pipeline->size[2];
  layer *= bytes;
  for (size_t z = n; z < pipeline->model.size[2]; z++)
    memcpy((char *)data + z * layer, (char *)data + (2 * n - 2 - z) * layer, layer);
}

static size_t plain_layer(const struct pipeline *pipeline) {
  return pipeline->size[0] * pipeline->size[1];
}

static enum status extend(const struct pipeline *pipeline, float **data, const char *what) {
  enum status status = memory_resize(data, model_site_count(&pipeline->model), sizeof **data, what);
  if (status != STATUS_OK) return status;
  mirror_layers(pipeline, plain_layer(pipeline), *data, sizeof **data);
  return sides_mirror(pipeline->size, &pipeline->model, *data, sizeof **data);
}

/* Turns one field of the model from the pipeline's axes to its own. */
static enum status turn_field(const struct pipeline *pipeline, void *field, size_t bytes) {
  enum status status = STATUS_OK;
  const size_t *from = pipeline->model.size;
  const int *place = pipeline->place;
  const size_t step[3] = {1, from[0], from[0] * from[1]};
  const size_t nx = from[place[0]], ny = from[place[1]], nz = from[place[2]];
  char *copy = NULL, *out = field;
  if (field == NULL) return STATUS_OK;
  TRY(memory_allocate(&copy, nx * ny * nz, bytes, "the turned model"));
  memcpy(copy, field, nx * ny * nz * bytes);
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < ny * nz; row++) {
    size_t start = row % ny * step[place[1]] + row / ny * step[place[2]];
    for (size_t x = 0; x < nx; x++)
      memcpy(out + (row * nx + x) * bytes, copy + (start + x * step[place[0]]) * bytes, bytes);
  }
cleanup:
  memory_free(&copy);
  return status;
}

static enum status turn_model(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct voxel_model *model = &pipeline->model;
  const struct voxel_model inside = *model;
  if (pipeline->place[0] == 0) return STATUS_OK;
  TRY(turn_field(pipeline, model->solid, sizeof *model->solid));
  TRY(turn_field(pipeline, model->wall_distance, sizeof *model->wall_distance));
  TRY(turn_field(pipeline, model->grain_fraction, sizeof *model->grain_fraction));
  TRY(turn_field(pipeline, model->micro_porosity, sizeof *model->micro_porosity));
  TRY(turn_field(pipeline, model->micro_permeability, sizeof *model->micro_permeability));
  for (int a = 0; a < 3; a++) {
    model->size[a] = inside.size[pipeline->place[a]];
    model->spacing[a] = inside.spacing[pipeline->place[a]];
  }
cleanup:
  return status;
}

/* Porosity and permeability of soil, in the voxels that are not solid. */
static enum status find_micro(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct voxel_model *model = &pipeline->model;
  const struct request *request = pipeline->request;
  const int turn = (request->flow_axis + request->mirror_axis + 2) % 3;
  const size_t sites = pipeline->size[0] * pipeline->size[1] * pipeline->size[2];
  float **porosity = &model->micro_porosity, **permeability = &model->micro_permeability;
  if (pipeline->labels.micro.kind == NULL) return STATUS_OK;
  TRY(micro_check(&pipeline->labels.micro, model->spacing));
  TRY(memory_allocate(porosity, sites, sizeof **porosity, "micro-porosities"));
  TRY(memory_allocate(permeability, sites, sizeof **permeability, "micro-permeabilities"));
  micro_resample(&pipeline->labels.micro, turn, pipeline->size, model->solid, *porosity,
                 *permeability);
  TRY(extend(pipeline, porosity, "micro-porosities"));
  TRY(extend(pipeline, permeability, "micro-permeabilities"));
cleanup:
  return status;
}

static enum status make_solid(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct voxel_model *model = &pipeline->model;
  add_layers(pipeline);
  TRY(memory_allocate(&model->solid, model_site_count(model), 1, "the model"));
  size_t sites = pipeline->size[0] * pipeline->size[1] * pipeline->size[2];
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < sites; i++)
    model->solid[i] = (double)pipeline->volume[i] > pipeline->solid_threshold;
  memory_free(&pipeline->volume);
  TRY(find_micro(pipeline));
  mirror_layers(pipeline, plain_layer(pipeline), model->solid, 1);
  TRY(sides_mirror(pipeline->size, model, model->solid, 1));
  TRY(binarise_connect(pipeline));
  model->void_ratio_measured = pipeline->request->void_ratio;
  misfit_warn(pipeline);
  model->threshold = pipeline->labels.on ? NAN : pipeline_grey(pipeline, pipeline->threshold);
cleanup:
  return status;
}

static struct wall_request wall_request_of(const struct pipeline *pipeline, double threshold,
                                           double contrast) {
  struct wall_request request = {
      .threshold = threshold, .contrast = contrast, .mirror = pipeline->request->mirror};
  memcpy(request.size, pipeline->size, sizeof request.size);
  return request;
}

/* Measures the surface of the sample, which is then freed. */
static enum status measure_surface(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct wall_request request =
      wall_request_of(pipeline, pipeline->threshold_original, pipeline_contrast(pipeline));
  if (pipeline->sample.count > 0) {
    TRY(surface_sample_measure(&pipeline->sample, &request, &pipeline->quality.surface_original,
                               &pipeline->quality.surface_error));
    pipeline->quality.surface_error *= 2.0; /* twice the standard error: 95 % */
  }
cleanup:
  surface_sample_end(&pipeline->sample);
  return status;
}

/* 95 % half width of the specific surface S of labels, 1/m: the direction of a wall is that of
 * voxels' steps; in narrow pores, of mean width w = 4 phi / S, walls are close to the next ones. */
static double labels_surface_error(const struct pipeline *pipeline, double surface) {
  const double void_ratio = pipeline->void_ratio_original, *voxel = pipeline->region.voxel;
  const double width = 4.0 * void_ratio / (1.0 + void_ratio) / surface;
  return surface * hypot(LABELS_SURFACE,
                         LABELS_SURFACE_NARROW * cbrt(voxel[0] * voxel[1] * voxel[2]) / width);
}

/* Measures distances, grain fractions and surface of the walls. */
static enum status measure_walls(struct pipeline *pipeline, struct wall_result *result) {
  enum status status = STATUS_OK;
  const struct wall_level *walls = &pipeline->walls;
  struct quality *quality = &pipeline->quality;
  struct wall_request request = wall_request_of(pipeline, walls->threshold, walls->contrast);
  double volume = 1.0;
  for (int d = 0; d < 3; d++)
    volume *= (double)pipeline->region.size[d] * pipeline->region.voxel[d];
  request.distances = true;
  TRY(wall_measure(&walls->region, &request, result));
  pipeline->specks = result->specks * walls->step * walls->step * walls->step;
  if (!walls->averaged) {
    quality->surface_original = result->surface_area / volume;
    quality->surface_error =
        pipeline->labels.on ? labels_surface_error(pipeline, quality->surface_original) : NAN;
    if (pipeline->restored.scan.levels != NULL)
      TRY(porod_surface(&pipeline->restored, &pipeline->scanner, walls->region.voxel,
                        &quality->surface_original, &quality->surface_error));
  }
cleanup:
  coarse_end(&pipeline->coarse);
  restored_end(&pipeline->restored);
  return status;
}

static enum status find_walls(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct wall_result walls = {0};
  TRY(measure_walls(pipeline, &walls));
  struct voxel_model *model = &pipeline->model;
  model->wall_distance = walls.distance;
  model->grain_fraction = walls.grain_fraction;
  walls = (struct wall_result){0};
  if (pipeline->request->sides != SIDES_PERIODIC)
    side_distance_unwrap(pipeline->size, model->spacing, (const bool[3]){true, true, false},
                         model->wall_distance);
  TRY(extend(pipeline, &model->wall_distance, "wall distances"));
  TRY(extend(pipeline, &model->grain_fraction, "grain fractions"));
  TRY(wall_complete(model->wall_distance, model->solid, model->size, model->spacing,
                    &pipeline->disagreeing));
  /* Mirrored again, so that both halves agree to the last bit. */
  mirror_layers(pipeline, model->size[0] * model->size[1], model->wall_distance,
                sizeof *model->wall_distance);
  sides_repeat(pipeline->size, model, model->wall_distance, sizeof *model->wall_distance);
cleanup:
  wall_result_end(&walls);
  return status;
}

/* Checks the output before the work, not after it. */
static enum status check_output(const struct pipeline *pipeline) {
  const struct stack *stack = &pipeline->stack;
  for (size_t i = 0; i < stack->file_count; i++) {
    const struct image *image = &stack->files[i];
    output_protect(image->path);
    for (size_t k = 0; k < image->data_file_count; k++) output_protect(image->data_files[k]);
  }
  return output_allow_kind(pipeline->request->output, "/run", "a run of sphsolve");
}

/* Whether the blur can be removed: a grey scan with a known or assumed scanner, and no option
 * against it. */
static bool can_restore(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  return (pipeline->scanner.known || pipeline->scanner.assumed) && !request->keep_blur &&
         pipeline->region.denoise == DENOISE_NONE &&
         (request->filter == FILTER_BICUBIC || request->filter == FILTER_AREA);
}

/* Removes the blur, and replaces the resampled volume by that of the result. */
static enum status restore(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const double e = pipeline->void_ratio_original;
  const size_t *size = pipeline->size;
  const struct mirroring mirroring = pipeline_mirroring(pipeline);
  const struct enclosed_sides sides = wall_level_sides(pipeline);
  if (pipeline->finer == NULL) TRY(smooth_walls_find(&pipeline->as_read, &pipeline->scanner));
  TRY(restored_make(&pipeline->region, &pipeline->scanner, e, &sides, &pipeline->restored));
  pipeline->blur_removed = pipeline->restored.scan.levels != NULL;
  pipeline->scanner.two_phases = pipeline->restored.two_phases;
  if (!pipeline->blur_removed) return STATUS_OK;
  misfit_warn_of_doubt(pipeline);
  if (pipeline->scanner.assumed)
    log_warning("no surface of the scan stands alone for its blur to be measured: pores or grains "
                "are narrow; one of %.2g voxels is assumed and taken out",
                MODEL_BLUR_ASSUMED);
  TRY(restored_resample(&pipeline->restored, pipeline->request->filter, size, pipeline->volume));
  TRY(volume_threshold(pipeline->volume, &mirroring, e / (1.0 + e), &pipeline->solid_threshold));
cleanup:
  return status;
}

enum status pipeline_run(const struct request *request, const char *const *paths, size_t count,
                         bool distances, const struct pipeline *finer, struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  *pipeline = (struct pipeline){
      .request = request,
      .finer = finer,
      .distances = distances,
      .grey_scale = 1.0,
      .walls = {.void_ratio = NAN}, /* until they are measured */
      .coarse = {.step = 1},
      .restored = {.scan = {.step = 1}, .scan_void_ratio = NAN, .scan_void_ratio_error = NAN}};
  TRY(stack_open(paths, count, &request->raw, &pipeline->stack));
  if (!request->raw.given)
    TRY(byte_order_check(&pipeline->stack.files[pipeline->stack.file_count / 2]));
  TRY(check_output(pipeline));
  TRY(choose_region(pipeline));
  /* A sweep alone need not hold a huge scan in memory. */
  const size_t *out = pipeline->size;
  const bool labels = pipeline->labels.on;
  pipeline->resampled =
      distances || (!request->survey && (double)out[0] * (double)out[1] * (double)out[2] < 1.5e8);
  pipeline->restoring = distances && !labels && can_restore(pipeline);
  if (distances && !labels && !pipeline->restoring)
    TRY(coarse_start(&pipeline->region, out, &pipeline->survey, &pipeline->coarse));
  if (!distances || pipeline->coarse.step > 1)
    TRY(surface_sample_start(&pipeline->region, &pipeline->sample));
  TRY(scan_take(pipeline));
  TRY(count_calibration(pipeline));
  TRY(binarise_calibrate(pipeline));
  memory_free(&pipeline->survey.sample); /* room for the model */
  TRY(measure_surface(pipeline));
  pipeline->solid_threshold = pipeline->threshold;
  const struct sweep_source swept = {.histogram = &pipeline->histogram,
                                     .volume = pipeline->volume,
                                     .mirroring = pipeline_mirroring(pipeline),
                                     .unit = pipeline_grey(pipeline, 1.0),
                                     .dark_grains = request->dark_grains};
  if (!labels) TRY(sweep_table_make(&swept, &pipeline->table));
  if (pipeline->restoring) TRY(restore(pipeline));
  if (distances) TRY(wall_level_find(pipeline));
  if (pipeline->resampled) TRY(make_solid(pipeline));
  if (distances) {
    TRY(find_walls(pipeline));
    TRY(morphology_measure(&pipeline->model, pipeline->size[2], &pipeline->morphology));
  }
  TRY(turn_model(pipeline));
cleanup:
  return status;
}
