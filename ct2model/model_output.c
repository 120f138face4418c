#include "ct2model/model_output.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/hdf5_file.h"
#include "common/memory.h"
#include "common/provenance.h"
#include "ct2model/misfit.h"
#include "ct2model/scanner/fields.h"

static enum status write_number(struct h5_file *file, const char *group, const char *name,
                                double value) {
  return h5_write_attribute(file, group, name, H5_F64, 1, &value);
}

/* Writes the middle slice in reported greys, for display. */
static enum status write_slice(struct h5_file *file, const struct pipeline *pipeline) {
  const size_t dims[2] = {pipeline->region.size[1], pipeline->region.size[0]};
  for (size_t i = 0; i < dims[0] * dims[1]; i++)
    pipeline->middle[i] = (float)pipeline_grey(pipeline, (double)pipeline->middle[i]);
  return h5_write(file, "/calibration/slice", H5_F32, 2, dims, pipeline->middle, true);
}

/* A segmented image has no calibration, but a picture. */
static enum status write_labels(struct h5_file *file, const struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const char *group = "/calibration";
  const int32_t segmented = 1;
  const double *voxel = pipeline->region.voxel;
  TRY(write_slice(file, pipeline));
  TRY(h5_write_attribute(file, group, "segmented", H5_I32, 1, &segmented));
  TRY(write_number(file, group, "smoothing_voxels", LABEL_SMOOTHING));
  const double edge = cbrt(voxel[0] * voxel[1] * voxel[2]);
  TRY(write_number(file, group, "smoothing", LABEL_SMOOTHING * edge));
  TRY(write_number(file, group, "smoothing_even", LABEL_SMOOTHING_WIDE * edge));
  TRY(write_number(file, group, "k_change_by_smoothing", labels_effect_on_k(&pipeline->labels)));
  const double unsure = labels_void_ratio_error(&pipeline->labels);
  if (unsure > 0.0) TRY(write_number(file, group, "void_ratio_uncertainty", unsure));
  TRY(write_number(file, group, "pore_peak", 0.0));
  TRY(write_number(file, group, "grain_peak", LABEL_GREY));
  if (pipeline->micro.threshold_error > 0.0) {
    TRY(write_number(file, group, "threshold_uncertainty", pipeline->micro.threshold_error));
    TRY(write_number(file, group, "dthreshold_dvoid_ratio", pipeline->micro.threshold_slope));
  }
cleanup:
  return status;
}

static enum status write_calibration(struct h5_file *file, const struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const char *group = "/calibration";
  if (pipeline->labels.on) return write_labels(file, pipeline);
  const struct sweep_table *table = &pipeline->table;
  TRY(h5_write(file, "/calibration/threshold", H5_F64, 1, &table->count, table->threshold, false));
  TRY(h5_write(file, "/calibration/void_ratio", H5_F64, 1, &table->count,
               table->void_ratio_resampled, false));
  TRY(h5_write(file, "/calibration/histogram", H5_F64, 1, &table->count, table->histogram_resampled,
               false));
  TRY(h5_write(file, "/calibration/void_ratio_original", H5_F64, 1, &table->count,
               table->void_ratio, false));
  TRY(h5_write(file, "/calibration/histogram_original", H5_F64, 1, &table->count, table->histogram,
               false));
  TRY(write_slice(file, pipeline));
  TRY(write_number(file, group, "threshold", pipeline_grey(pipeline, pipeline->threshold)));
  TRY(write_number(file, group, "threshold_original",
                   pipeline_grey(pipeline, pipeline->threshold_original)));
  TRY(write_number(file, group, "threshold_otsu", pipeline_grey(pipeline, pipeline->otsu)));
  TRY(write_number(file, group, "dthreshold_dvoid_ratio",
                   pipeline_grey(pipeline, pipeline->threshold_slope)));
  TRY(write_number(file, group, "threshold_uncertainty", pipeline_threshold_error(pipeline)));
  TRY(write_number(file, group, "threshold_valley",
                   pipeline_grey(pipeline, pipeline->phases.valley)));
  TRY(write_number(file, group, "contrast_to_noise", pipeline->phases.contrast_to_noise));
  TRY(write_number(file, group, "beam_hardening", pipeline->survey.beam));
  TRY(write_number(file, group, "rings", pipeline->survey.rings));
  TRY(write_number(file, group, "pore_peak", pipeline_grey(pipeline, pipeline->phases.pore_peak)));
  TRY(write_number(file, group, "grain_peak",
                   pipeline_grey(pipeline, pipeline->phases.grain_peak)));
cleanup:
  return status;
}

/* Writes the properties of the scanner, and the edge response from which they are derived. */
static enum status write_scanner(struct h5_file *file, const struct scanner *scanner,
                                 bool removed) {
  enum status status = STATUS_OK;
  const size_t bins = EDGE_BINS;
  double distance[EDGE_BINS], response[EDGE_BINS];
  if (!scanner->known) return STATUS_OK;
  for (size_t i = 0; i < bins; i++) {
    distance[i] = edge_bin_distance(i) * scanner->unit;
    response[i] = scanner->response.sum[i] / scanner->response.count[i]; /* NAN: no voxel */
  }
  TRY(h5_make_group(file, "/scanner"));
  for (size_t i = 0; i < scanner_field_count; i++)
    TRY(write_number(file, "/scanner", scanner_fields[i].attribute,
                     scanner_field_value(&scanner_fields[i], scanner)));
  TRY(write_number(file, "/scanner", "removed", removed ? 1.0 : 0.0));
  TRY(h5_write(file, "/scanner/distance", H5_F64, 1, &bins, distance, false));
  TRY(h5_write(file, "/scanner/edge_response", H5_F64, 1, &bins, response, false));
cleanup:
  return status;
}

/* Writes the pore widths, and the void ratio by size of window. */
static enum status write_curves(struct h5_file *file, const struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct morphology *m = &pipeline->morphology;
  const size_t bins = THICKNESS_BINS, count = m->window_count;
  double sizes[WINDOW_SIZES], places[WINDOW_SIZES];
  for (size_t i = 0; i < count; i++) {
    sizes[i] = (double)m->window[i] * pipeline->model.spacing[0];
    places[i] = (double)m->window_places[i];
  }
  if (isfinite(m->thickness_median))
    TRY(h5_write(file, "/quality/local_thickness", H5_F64, 1, &bins, m->thickness_histogram,
                 false));
  if (count == 0) goto cleanup;
  TRY(h5_write(file, "/quality/window", H5_F64, 1, &count, sizes, false));
  TRY(h5_write(file, "/quality/windows", H5_F64, 1, &count, places, false));
  TRY(h5_write(file, "/quality/void_ratio", H5_F64, 1, &count, m->window_mean, false));
  TRY(h5_write(file, "/quality/void_ratio_deviation", H5_F64, 1, &count, m->window_deviation,
               false));
cleanup:
  return status;
}

static enum status write_quality(struct h5_file *file, const struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct quality *quality = &pipeline->quality;
  const struct morphology *morphology = &pipeline->morphology;
  int32_t percolates[3] = {quality->percolates[2], quality->percolates[1], quality->percolates[0]};
  TRY(write_number(file, "/model", "void_ratio_error",
                   pipeline_void_ratio(pipeline) - pipeline->request->void_ratio));
  TRY(write_number(file, "/model", "void_ratio_scan", pipeline->restored.scan_void_ratio));
  TRY(write_number(file, "/model", "void_ratio_scan_uncertainty",
                   pipeline->restored.scan_void_ratio_error));
  TRY(write_number(file, "/model", "void_ratio_doubt", misfit_void_ratio_doubt(pipeline)));
  TRY(write_number(file, "/model", "porosity", quality->porosity));
  if (pipeline->model.micro_porosity != NULL) {
    const struct micro_summary micro = micro_summary(&pipeline->model);
    TRY(write_number(file, "/model", "micro_voxels", micro.voxels));
    TRY(write_number(file, "/model", "micro_porosity_mean", micro.porosity));
    TRY(write_number(file, "/model", "micro_permeability_mean", micro.permeability));
    if (pipeline->micro.porosity_error > 0.0)
      TRY(write_number(file, "/model", "micro_porosity_uncertainty",
                       pipeline->micro.porosity_error));
    if (pipeline->micro.permeability_error > 0.0)
      TRY(write_number(file, "/model", "micro_ln_permeability_uncertainty",
                       pipeline->micro.permeability_error));
  }
  TRY(write_number(file, "/model", "connected_porosity", quality->connected_porosity));
  TRY(write_number(file, "/model", "isolated_pores", (double)quality->isolated_pores));
  TRY(write_number(file, "/model", "isolated_pore_voxels", (double)quality->isolated_voxels));
  TRY(write_number(file, "/model", "specific_surface", quality->surface_original));
  if (isfinite(quality->surface_error))
    TRY(write_number(file, "/model", "specific_surface_error", quality->surface_error));
  TRY(write_number(file, "/model", "specific_surface_model", quality->surface_model));
  TRY(write_number(file, "/model", "floating_grains", (double)quality->floating_grains));
  TRY(write_number(file, "/model", "floating_grain_voxels", (double)quality->floating_voxels));
  TRY(write_number(file, "/model", "correlation_length", morphology->correlation_length));
  TRY(write_number(file, "/model", "pore_voxels_touching_grain", morphology->touching));
  TRY(write_number(file, "/model", "local_thickness_median", morphology->thickness_median));
  TRY(write_number(file, "/model", "critical_width", morphology->critical_width));
  TRY(write_number(file, "/model", "expected_error_of_k", morphology->expected_error));
  TRY(write_curves(file, pipeline));
  double voxel = 1.0, longest = 0.0;
  for (int a = 0; a < 3; a++) voxel *= pipeline->region.voxel[a];
  for (int a = 0; a < 3; a++) longest = fmax(longest, pipeline->region.voxel[a]);
  TRY(write_number(file, "/model", "voxel_scanned", cbrt(voxel)));
  TRY(write_number(file, "/model", "voxel_scanned_longest", longest));
  static const char *const SCAN_AXES[] = {"yzx", "zxy", "xyz"};
  TRY(h5_write_attribute_text(file, "/model", "scan_axes",
                              SCAN_AXES[pipeline->request->flow_axis]));
  static const char *const AXES[] = {"x", "y", "z"};
  TRY(h5_write_attribute_text(file, "/model", "mirror_axis",
                              pipeline->request->mirror ? AXES[pipeline->request->mirror_axis]
                                                        : "none"));
  static const char *const SIDES[] = {"periodic", "closed", "mirrored"};
  TRY(h5_write_attribute_text(file, "/model", "sides", SIDES[pipeline->request->sides]));
  const int32_t stated = pipeline->request->sides_stated;
  TRY(h5_write_attribute(file, "/model", "sides_stated", H5_I32, 1, &stated));
  TRY(h5_write_attribute(file, "/model", "percolates", H5_I32, 3, percolates));
cleanup:
  return status;
}

/* The hash of the file with an image's pixels; of several, that of their hashes in turn. */
static enum status hash_image(const struct image *image, uint64_t *hash) {
  enum status status = STATUS_OK;
  const size_t n = image->data_file_count;
  uint64_t *hashes = NULL;
  if (n <= 1) return hash_file(n == 1 ? image->data_files[0] : image->path, hash);
  TRY(memory_allocate(&hashes, n, sizeof *hashes, "hashes"));
  for (size_t i = 0; i < n; i++) TRY(hash_file(image->data_files[i], &hashes[i]));
  *hash = hash_bytes(hashes, n * sizeof *hashes);
cleanup:
  memory_free(&hashes);
  return status;
}

/* What the slices are by the description that generate_sand puts beside them: that a scan is
 * synthetic goes with all that is made of it. */
static enum status write_origin(struct h5_file *file, const char *slice) {
  enum status status = STATUS_OK;
  const char *slash = strrchr(slice, '/');
  char path[8200];
  if (snprintf(path, sizeof path, "%.*ssand.json", slash == NULL ? 0 : (int)(slash - slice) + 1,
               slice) >= (int)sizeof path)
    return STATUS_OK;
  json_t *description = json_load_file(path, 0, NULL);
  const char *what = json_string_value(json_object_get(description, "what"));
  if (what != NULL) status = h5_write_attribute_text(file, "/provenance", "origin", what);
  json_decref(description);
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
    enum status one = hash_image(image, &hashes[i]);
    if (one != STATUS_OK) {
#pragma omp critical
      status = one;
    }
  }
  if (status != STATUS_OK) goto cleanup;
  TRY(provenance_write(file, "ct2model", options_command_line(options), n, paths, hashes));
  if (n > 0) TRY(write_origin(file, paths[0]));
cleanup:
  MEMORY_FREE(&hashes, &paths);
  return status;
}

enum status model_output_write(const struct pipeline *pipeline, const struct options *options) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  struct voxel_model model = pipeline->model;
  if (pipeline->request->mirror_axis != 2)
    model.mirror_plane = -1; /* a mirror plane is a layer of
                                z */
  TRY(h5_create(pipeline->request->output, &file));
  TRY(model_write(file, &model));
  TRY(write_calibration(file, pipeline));
  TRY(write_quality(file, pipeline));
  TRY(write_scanner(file, &pipeline->scanner, pipeline->blur_removed));
  TRY(write_provenance(file, pipeline, options));
  struct h5_file *whole = file;
  file = NULL; /* freed by h5_commit */
  TRY(h5_commit(whole));
cleanup:
  h5_close(file);
  return status;
}
