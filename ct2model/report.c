#include "ct2model/report.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/provenance.h"
#include "common/units.h"

/* The numbers of both outputs. JSON has no NaN: what is not known is null. */
static json_t *number(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

static json_t *numbers(const double *values, size_t n) {
  json_t *array = json_array();
  for (size_t i = 0; i < n; i++) json_array_append_new(array, number(values[i]));
  return array;
}

static json_t *sizes(const size_t size[3]) {
  json_t *array = json_array();
  for (int d = 0; d < 3; d++) json_array_append_new(array, json_integer((json_int_t)size[d]));
  return array;
}

static void put(json_t *object, const char *key, double value) {
  json_object_set_new(object, key, number(value));
}

static void put_count(json_t *object, const char *key, size_t value) {
  json_object_set_new(object, key, json_integer((json_int_t)value));
}

static double threshold_slope(const struct pipeline *pipeline) {
  return pipeline_grey(pipeline, pipeline->threshold_slope);
}

static json_t *json_of_table(const struct sweep_table *table) {
  json_t *object = json_object();
  json_object_set_new(object, "threshold", numbers(table->threshold, table->count));
  json_object_set_new(object, "void_ratio", numbers(table->void_ratio, table->count));
  json_object_set_new(object, "histogram", numbers(table->histogram, table->count));
  if (table->void_ratio_resampled != NULL) {
    json_object_set_new(object, "void_ratio_resampled",
                        numbers(table->void_ratio_resampled, table->count));
    json_object_set_new(object, "histogram_resampled",
                        numbers(table->histogram_resampled, table->count));
  }
  return object;
}

static void json_of_model(const struct pipeline *pipeline, json_t *root) {
  const struct voxel_model *model = &pipeline->model;
  const struct quality *quality = &pipeline->quality;
  json_object_set_new(root, "size", sizes(model->size));
  json_object_set_new(root, "spacing_m", numbers(model->spacing, 3));
  json_object_set_new(root, "mirror_plane", json_integer(model->mirror_plane));
  put(root, "void_ratio", model->void_ratio);
  put(root, "void_ratio_error", model->void_ratio - pipeline->request->void_ratio);
  put(root, "porosity", quality->porosity);
  put(root, "connected_porosity", quality->connected_porosity);
  put_count(root, "isolated_pores", quality->isolated_pores);
  put_count(root, "isolated_pore_voxels", quality->isolated_voxels);
  put_count(root, "floating_grains", quality->floating_grains);
  put_count(root, "floating_grain_voxels", quality->floating_voxels);
  json_object_set_new(root, "percolates",
                      json_pack("{s:b,s:b,s:b}", "x", (int)quality->percolates[0], "y",
                                (int)quality->percolates[1], "z", (int)quality->percolates[2]));
  put(root, "specific_surface_model_per_m", quality->surface_model);
}

static enum status print_json(const struct pipeline *pipeline, const struct options *options,
                              const struct sweep_table *table) {
  json_t *root = json_object();
  bool build = strcmp(options_command(options), "build") == 0;
  put(root, "void_ratio_measured", pipeline->request->void_ratio);
  put(root, "threshold", pipeline_grey(pipeline, pipeline->threshold));
  put(root, "threshold_original", pipeline_grey(pipeline, pipeline->threshold_original));
  put(root, "threshold_otsu", pipeline_grey(pipeline, pipeline->otsu));
  put(root, "threshold_valley", pipeline_grey(pipeline, pipeline->phases.valley));
  put(root, "dthreshold_dvoid_ratio", threshold_slope(pipeline));
  put(root, "dthreshold_dvoid_ratio_original",
      pipeline_grey(pipeline, pipeline->threshold_slope_original));
  put(root, "void_ratio_original", pipeline->void_ratio_original);
  put(root, "pore_peak", pipeline_grey(pipeline, pipeline->phases.pore_peak));
  put(root, "grain_peak", pipeline_grey(pipeline, pipeline->phases.grain_peak));
  put(root, "contrast_to_noise", pipeline->phases.contrast_to_noise);
  put(root, "specific_surface_per_m", pipeline->quality.surface_original);
  json_object_set_new(root, "size_original", sizes(pipeline->region.size));
  json_object_set_new(root, "voxel_size_m", numbers(pipeline->region.voxel, 3));
  if (pipeline->volume != NULL) json_of_model(pipeline, root);
  if (build) put_count(root, "sign_adjusted", pipeline->disagreeing);
  if (table != NULL) json_object_set_new(root, "sweep", json_of_table(table));
  if (pipeline->request->output != NULL)
    json_object_set_new(root, "output", json_string(pipeline->request->output));
  char *text = json_dumps(root, JSON_INDENT(2));
  json_decref(root);
  if (text == NULL) return FAIL(STATUS_RUN, "out of memory");
  puts(text);
  free(text);
  return STATUS_OK;
}

static void print_model(const struct pipeline *pipeline) {
  const struct voxel_model *model = &pipeline->model;
  const struct quality *quality = &pipeline->quality;
  char spacing[40];
  quantity_format(model->spacing[0], "m", spacing, sizeof spacing);
  printf("model             %zux%zux%zu voxels of %s", model->size[0], model->size[1],
         model->size[2], spacing);
  if (model->mirror_plane >= 0) printf(", mirrored about layer %d", model->mirror_plane + 1);
  printf("\nvoid ratio        %.4f", model->void_ratio);
  if (!isnan(pipeline->request->void_ratio))
    printf(" (measured %.4g, error %+.4f)", pipeline->request->void_ratio,
           model->void_ratio - pipeline->request->void_ratio);
  printf("\nporosity          %.4f, on a path along z %.4f\n", quality->porosity,
         quality->connected_porosity);
  printf("percolates        x %s, y %s, z %s\n", quality->percolates[0] ? "yes" : "no",
         quality->percolates[1] ? "yes" : "no", quality->percolates[2] ? "yes" : "no");
  printf("isolated pores    %zu (%zu voxels)\n", quality->isolated_pores, quality->isolated_voxels);
  printf("floating grains   %zu (%zu voxels)\n", quality->floating_grains,
         quality->floating_voxels);
}

static void print_text(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const struct quality *quality = &pipeline->quality;
  printf("threshold         %.4f", pipeline_grey(pipeline, pipeline->threshold));
  printf(" (full resolution %.4f, Otsu %.4g)\n",
         pipeline_grey(pipeline, pipeline->threshold_original),
         pipeline_grey(pipeline, pipeline->otsu));
  if (pipeline->phases.levels > 2)
    printf("dT/de             %.4g grey levels per unit of void ratio (full resolution %.4g)\n",
           threshold_slope(pipeline), pipeline_grey(pipeline, pipeline->threshold_slope_original));
  printf("grey peaks        pore %.4g, grain %.4g",
         pipeline_grey(pipeline, pipeline->phases.pore_peak),
         pipeline_grey(pipeline, pipeline->phases.grain_peak));
  if (isfinite(pipeline->phases.contrast_to_noise))
    printf(", contrast %.3g times the noise", pipeline->phases.contrast_to_noise);
  putchar('\n');
  if (request->rule != THRESHOLD_AUTO || pipeline->phases.levels == 2)
    printf("full resolution   void ratio %.4f\n", pipeline->void_ratio_original);
  if (pipeline->volume != NULL) print_model(pipeline);
  printf("specific surface  %.4g 1/mm of bulk volume", quality->surface_original * 1e-3);
  if (pipeline->volume != NULL) printf(" (model %.4g)", quality->surface_model * 1e-3);
  putchar('\n');
  if (request->output != NULL) printf("written           %s\n", request->output);
}

enum status report_print(const struct pipeline *pipeline, const struct options *options,
                         const struct sweep_table *table) {
  if (options_json(options)) return print_json(pipeline, options, table);
  print_text(pipeline);
  return STATUS_OK;
}

/* ---- the model file ---- */

static enum status write_number(struct h5_file *file, const char *group, const char *name,
                                double value) {
  return h5_write_attribute(file, group, name, H5_F64, 1, &value);
}

static enum status write_calibration(struct h5_file *file, const struct pipeline *pipeline,
                                     const struct sweep_table *table) {
  enum status status = STATUS_OK;
  const char *group = "/calibration";
  TRY(h5_write(file, "/calibration/threshold", H5_F64, 1, &table->count, table->threshold, false));
  TRY(h5_write(file, "/calibration/void_ratio", H5_F64, 1, &table->count,
               table->void_ratio_resampled, false));
  TRY(h5_write(file, "/calibration/histogram", H5_F64, 1, &table->count, table->histogram_resampled,
               false));
  TRY(h5_write(file, "/calibration/void_ratio_original", H5_F64, 1, &table->count,
               table->void_ratio, false));
  TRY(h5_write(file, "/calibration/histogram_original", H5_F64, 1, &table->count, table->histogram,
               false));
  TRY(write_number(file, group, "threshold", pipeline_grey(pipeline, pipeline->threshold)));
  TRY(write_number(file, group, "threshold_original",
                   pipeline_grey(pipeline, pipeline->threshold_original)));
  TRY(write_number(file, group, "threshold_otsu", pipeline_grey(pipeline, pipeline->otsu)));
  TRY(write_number(file, group, "dthreshold_dvoid_ratio", threshold_slope(pipeline)));
  TRY(write_number(file, group, "pore_peak", pipeline_grey(pipeline, pipeline->phases.pore_peak)));
  TRY(write_number(file, group, "grain_peak",
                   pipeline_grey(pipeline, pipeline->phases.grain_peak)));
cleanup:
  return status;
}

static enum status write_quality(struct h5_file *file, const struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct quality *quality = &pipeline->quality;
  int32_t percolates[3] = {quality->percolates[2], quality->percolates[1], quality->percolates[0]};
  TRY(write_number(file, "/model", "void_ratio_error",
                   pipeline->model.void_ratio - pipeline->request->void_ratio));
  TRY(write_number(file, "/model", "porosity", quality->porosity));
  TRY(write_number(file, "/model", "connected_porosity", quality->connected_porosity));
  TRY(write_number(file, "/model", "isolated_pores", (double)quality->isolated_pores));
  TRY(write_number(file, "/model", "isolated_pore_voxels", (double)quality->isolated_voxels));
  TRY(write_number(file, "/model", "specific_surface", quality->surface_original));
  TRY(write_number(file, "/model", "specific_surface_model", quality->surface_model));
  TRY(h5_write_attribute(file, "/model", "percolates", H5_I32, 3, percolates));
cleanup:
  return status;
}

static enum status write_provenance(struct h5_file *file, const struct pipeline *pipeline,
                                    const struct options *options) {
  enum status status = STATUS_OK;
  size_t n = pipeline->stack.file_count;
  uint64_t *hashes = NULL;
  const char **paths = NULL;
  TRY(memory_allocate(&hashes, n, sizeof *hashes, "hashes"));
  TRY(memory_allocate(&paths, n, sizeof *paths, "file names"));
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < n; i++) {
    const struct image *image = &pipeline->stack.files[i];
    paths[i] = image->path;
    enum status one =
        hash_file(image->data_path != NULL ? image->data_path : image->path, &hashes[i]);
    if (one != STATUS_OK) {
#pragma omp critical
      status = one;
    }
  }
  if (status != STATUS_OK) goto cleanup;
  TRY(provenance_write(file, "ct2model", options_command_line(options), n, paths, hashes));
cleanup:
  memory_free(&hashes);
  memory_free(&paths);
  return status;
}

enum status report_write_model(const struct pipeline *pipeline, const struct options *options,
                               const struct sweep_table *table) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  TRY(h5_create(pipeline->request->output, &file));
  TRY(model_write(file, &pipeline->model));
  TRY(write_calibration(file, pipeline, table));
  TRY(write_quality(file, pipeline));
  TRY(write_provenance(file, pipeline, options));
  struct h5_file *whole = file;
  file = NULL; /* commit frees it */
  TRY(h5_commit(whole));
cleanup:
  h5_close(file);
  return status;
}
