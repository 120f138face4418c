#include "ct2model/report.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/json_number.h"
#include "common/log.h"
#include "common/units.h"
#include "ct2model/misfit.h"
#include "ct2model/scanner/fields.h"
#include "ct2model/constants.h"

static json_t *sizes(const size_t size[3]) {
  json_t *array = json_array();
  for (int d = 0; d < 3; d++) json_array_append_new(array, json_integer((json_int_t)size[d]));
  return array;
}

/* Adds a length, or the inverse of one; unknown if the voxel size is. */
static void put_length(json_t *object, const char *key, double value,
                       const struct pipeline *pipeline) {
  json_put_number(object, key, pipeline->unsized ? NAN : value);
}

static void put_count(json_t *object, const char *key, size_t value) {
  json_object_set_new(object, key, json_integer((json_int_t)value));
}

static double threshold_slope(const struct pipeline *pipeline) {
  return pipeline_grey(pipeline, pipeline->threshold_slope);
}

static const char *mirror_axis(const struct pipeline *pipeline) {
  static const char *const NAMES[] = {"x", "y", "z"};
  return NAMES[pipeline->request->mirror_axis];
}

static json_t *json_of_table(const struct sweep_table *table) {
  json_t *object = json_object();
  json_object_set_new(object, "threshold", json_numbers(table->threshold, table->count));
  json_object_set_new(object, "void_ratio", json_numbers(table->void_ratio, table->count));
  json_object_set_new(object, "histogram", json_numbers(table->histogram, table->count));
  if (table->void_ratio_resampled != NULL) {
    json_object_set_new(object, "void_ratio_resampled",
                        json_numbers(table->void_ratio_resampled, table->count));
    json_object_set_new(object, "histogram_resampled",
                        json_numbers(table->histogram_resampled, table->count));
  }
  return object;
}

static void json_of_model(const struct pipeline *pipeline, json_t *root) {
  const struct voxel_model *model = &pipeline->model;
  const struct quality *quality = &pipeline->quality;
  json_object_set_new(root, "size", sizes(model->size));
  json_object_set_new(root, "spacing_m",
                      pipeline->unsized ? json_null() : json_numbers(model->spacing, 3));
  json_object_set_new(root, "mirror_plane", json_integer(model->mirror_plane));
  json_object_set_new(root, "mirror_axis",
                      pipeline->request->mirror ? json_string(mirror_axis(pipeline)) : json_null());
  static const char *const SIDES[] = {"periodic", "closed", "mirrored"};
  json_object_set_new(root, "sides", json_string(SIDES[pipeline->request->sides]));
  json_put_number(root, "void_ratio", model->void_ratio);
  json_put_number(root, "void_ratio_error",
                  pipeline_void_ratio(pipeline) - pipeline->request->void_ratio);
  json_put_number(root, "porosity", quality->porosity);
  if (model->micro_porosity != NULL) {
    const struct micro_summary micro = micro_summary(model);
    json_put_number(root, "micro_voxels", micro.voxels);
    json_put_number(root, "micro_porosity", micro.porosity);
    json_put_number(root, "micro_permeability_m2", micro.permeability);
  }
  json_put_number(root, "connected_porosity", quality->connected_porosity);
  put_count(root, "isolated_pores", quality->isolated_pores);
  put_count(root, "isolated_pore_voxels", quality->isolated_voxels);
  put_count(root, "floating_grains", quality->floating_grains);
  put_count(root, "floating_grain_voxels", quality->floating_voxels);
  json_object_set_new(root, "percolates",
                      json_pack("{s:b,s:b,s:b}", "x", (int)quality->percolates[0], "y",
                                (int)quality->percolates[1], "z", (int)quality->percolates[2]));
  put_length(root, "specific_surface_model_per_m", quality->surface_model, pipeline);
}

static void json_of_morphology(const struct pipeline *pipeline, json_t *root) {
  const struct morphology *m = &pipeline->morphology;
  json_t *windows = json_array();
  for (size_t i = 0; i < m->window_count; i++)
    json_array_append_new(windows, json_pack("{s:f,s:o,s:o,s:I}", "size_m",
                                             (double)m->window[i] * pipeline->model.spacing[0],
                                             "void_ratio", json_number(m->window_mean[i]),
                                             "deviation", json_number(m->window_deviation[i]),
                                             "windows", (json_int_t)m->window_places[i]));
  json_put_number(root, "correlation_length_m", m->correlation_length);
  json_put_number(root, "pore_voxels_touching_grain", m->touching);
  json_put_number(root, "local_thickness_median_voxels", m->thickness_median);
  json_put_number(root, "critical_width_voxels", m->critical_width);
  json_put_number(root, "expected_error_of_k", m->expected_error);
  size_t finer[3];
  bool enough;
  json_object_set_new(root, "size_for_5_percent",
                      pipeline_finer_size(pipeline, 0.05, finer, &enough) && enough ? sizes(finer)
                                                                                    : json_null());
  json_object_set_new(root, "local_thickness_histogram",
                      json_numbers(m->thickness_histogram, THICKNESS_BINS));
  json_object_set_new(root, "representative_volume", windows);
}

static json_t *json_of_micro(const struct grey_soil *greys) {
  const struct {
    const char *key;
    double value;
  } numbers[] = {{"low", greys->low},
                 {"high", greys->high},
                 {"low_uncertainty", greys->low_error},
                 {"high_uncertainty", greys->high_error},
                 {"shift", greys->shift},
                 {"pore_peak", greys->pore_peak},
                 {"soil_peak", greys->soil_peak},
                 {"grain_peak", greys->grain_peak},
                 {"pore_peak_uncertainty", greys->pore_error},
                 {"soil_peak_uncertainty", greys->soil_error},
                 {"grain_peak_uncertainty", greys->grain_error},
                 {"porosity_uncertainty", greys->porosity_error},
                 {"ln_permeability_uncertainty", greys->permeability_error},
                 {"threshold_uncertainty", greys->threshold_error},
                 {"void_ratio_uncertainty", greys->void_ratio_error}};
  json_t *object = json_object();
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
    json_put_number(object, numbers[i].key, numbers[i].value);
  return object;
}

/* Labels have no threshold, no greys and no noise. */
static void json_of_labels(const struct pipeline *pipeline, json_t *root) {
  static const char *const OF_GREYS[] = {
      "threshold",      "threshold_original", "threshold_uncertainty",
      "threshold_otsu", "threshold_valley",   "pore_peak",
      "grain_peak"};
  const struct labels *labels = &pipeline->labels;
  if (!labels->on) {
    json_object_set_new(root, "segmented", json_null());
    return;
  }
  json_t *pore = json_array(), *grain = json_array(), *soil = json_array();
  for (size_t i = 0; i < labels->count; i++)
    if (labels->is_soil[i])
      json_array_append_new(soil, json_pack("{s:f,s:f,s:f}", "label", labels->value[i], "porosity",
                                            labels->soil[i].porosity, "permeability",
                                            labels->soil[i].permeability));
    else
      json_array_append_new(labels->pore[i] ? pore : grain, json_real(labels->value[i]));
  json_object_set_new(root, "segmented",
                      json_pack("{s:o,s:o,s:o,s:f,s:f}", "pore", pore, "grain", grain, "soil", soil,
                                "smoothing_voxels", LABEL_SMOOTHING, "k_change_by_smoothing",
                                labels_effect_on_k(labels)));
  const double unsure = labels_void_ratio_error(labels);
  json_put_number(json_object_get(root, "segmented"), "void_ratio_uncertainty",
                  unsure > 0.0 ? unsure : NAN);
  for (size_t i = 0; i < sizeof OF_GREYS / sizeof *OF_GREYS; i++)
    json_object_set_new(root, OF_GREYS[i], json_null());
  if (pipeline->request->micro.given)
    json_object_set_new(root, "micro", json_of_micro(&pipeline->micro));
}

static json_t *json_of_scanner(const struct scanner *scanner, bool unsized) {
  json_t *object = json_object();
  const bool known = scanner->known && !unsized;
  for (size_t i = 0; i < scanner_field_count; i++)
    json_put_number(object, scanner_fields[i].key,
                    known ? scanner_field_value(&scanner_fields[i], scanner) : NAN);
  return object;
}

json_t *report_json(const struct pipeline *pipeline, const struct options *options) {
  json_t *root = json_object();
  bool build = strcmp(options_command(options), "build") == 0;
  json_put_number(root, "void_ratio_measured", pipeline->request->void_ratio);
  json_put_number(root, "threshold", pipeline_grey(pipeline, pipeline->threshold));
  json_put_number(root, "threshold_original",
                  pipeline_grey(pipeline, pipeline->threshold_original));
  json_put_number(root, "void_ratio_measured_uncertainty", pipeline->request->void_ratio_error);
  json_put_number(root, "void_ratio_scan", pipeline->restored.scan_void_ratio);
  json_put_number(root, "void_ratio_scan_uncertainty", pipeline->restored.scan_void_ratio_error);
  json_put_number(root, "void_ratio_doubt", misfit_void_ratio_doubt(pipeline));
  json_put_number(root, "threshold_uncertainty", pipeline_threshold_error(pipeline));
  json_put_number(root, "threshold_otsu", pipeline_grey(pipeline, pipeline->otsu));
  json_put_number(root, "threshold_valley", pipeline_grey(pipeline, pipeline->phases.valley));
  json_put_number(root, "dthreshold_dvoid_ratio", threshold_slope(pipeline));
  json_put_number(root, "dthreshold_dvoid_ratio_original",
                  pipeline_grey(pipeline, pipeline->threshold_slope_original));
  json_put_number(root, "void_ratio_original", pipeline->void_ratio_original);
  json_put_number(root, "pore_peak", pipeline_grey(pipeline, pipeline->phases.pore_peak));
  json_put_number(root, "grain_peak", pipeline_grey(pipeline, pipeline->phases.grain_peak));
  json_put_number(root, "contrast_to_noise", pipeline->phases.contrast_to_noise);
  json_object_set_new(root, "scanner", json_of_scanner(&pipeline->scanner, pipeline->unsized));
  json_put_number(root, "beam_hardening", pipeline->survey.beam);
  json_put_number(root, "rings", pipeline->survey.rings);
  json_of_labels(pipeline, root);
  if (pipeline->region.denoise != DENOISE_NONE) {
    json_put_number(root, "denoised_void_ratio", pipeline->denoised.void_ratio);
    json_put_number(root, "denoised_surface_ratio", pipeline->denoised.surface);
  }
  put_length(root, "specific_surface_per_m", pipeline->quality.surface_original, pipeline);
  put_length(root, "specific_surface_error_per_m", pipeline->quality.surface_error, pipeline);
  size_t original[3];
  double voxel[3];
  for (int a = 0; a < 3; a++) {
    original[a] = pipeline->region.size[pipeline->place[a]];
    voxel[a] = pipeline->region.voxel[pipeline->place[a]];
  }
  json_object_set_new(root, "size_original", sizes(original));
  json_object_set_new(root, "voxel_size_m",
                      pipeline->unsized ? json_null() : json_numbers(voxel, 3));
  if (pipeline->resampled) json_of_model(pipeline, root);
  if (build) {
    put_count(root, "sign_adjusted", pipeline->disagreeing);
    json_of_morphology(pipeline, root);
  }
  if (!build) json_object_set_new(root, "sweep", json_of_table(&pipeline->table));
  if (pipeline->request->output != NULL)
    json_object_set_new(root, "output", json_string(pipeline->request->output));
  return root;
}

static void print_model(const struct pipeline *pipeline) {
  const struct voxel_model *model = &pipeline->model;
  const struct quality *quality = &pipeline->quality;
  char edge[3][40];
  bool cubes = true;
  for (int d = 0; d < 3; d++) {
    quantity_format(model->spacing[d], "m", edge[d], sizeof edge[d]);
    cubes &= fabs(model->spacing[d] / model->spacing[0] - 1.0) < 1e-3;
  }
  printf("model             %zux%zux%zu voxels", model->size[0], model->size[1], model->size[2]);
  if (!pipeline->unsized) printf(" of %s", edge[0]);
  if (!pipeline->unsized && !cubes) printf(" x %s x %s", edge[1], edge[2]);
  if (model->mirror_plane >= 0)
    printf(", mirrored about layer %d of %s", model->mirror_plane + 1, mirror_axis(pipeline));
  if (pipeline->request->sides != SIDES_PERIODIC)
    printf(pipeline->request->sides == SIDES_CLOSED ? ", sides closed" : ", sides mirrored");
  printf("\nvoid ratio        %.4f", model->void_ratio);
  if (pipeline_walls_enclose(pipeline))
    printf(" by voxels%s; %.4f within the walls",
           pipeline->labels.on ? " of the smoothed labels" : "", pipeline_void_ratio(pipeline));
  const double off = pipeline_void_ratio(pipeline) - pipeline->request->void_ratio;
  if (!isnan(off)) /* rounded first: no -0.0000 */
    printf(" (measured %.4g, error %+.4f)", pipeline->request->void_ratio,
           round(1e4 * off) / 1e4 + 0.0);
  if (isfinite(pipeline->restored.scan_void_ratio))
    printf("\n                  %.3g +- %.2g by the scan's own edges",
           pipeline->restored.scan_void_ratio, pipeline->restored.scan_void_ratio_error);
  printf("\nporosity          %.4f, on a path along z %.4f: only the latter conducts\n",
         quality->porosity, quality->connected_porosity);
  if (model->micro_porosity != NULL) {
    const struct micro_summary micro = micro_summary(model);
    printf(
        "micro-pores       %.3g %% of the voxels are soil of porosity %.3g, permeability %.3g m^2 "
        "(means); its pores count in the void ratio\n",
        100.0 * micro.voxels, micro.porosity, micro.permeability);
  }
  printf("percolates        x %s, y %s, z %s: whether a pore path leads through, so that there is "
         "a k along it\n",
         quality->percolates[0] ? "yes" : "no", quality->percolates[1] ? "yes" : "no",
         quality->percolates[2] ? "yes" : "no");
  printf("isolated pores    %zu (%zu voxels): on no path along z; noise, or throats too narrow for "
         "the voxels\n",
         quality->isolated_pores, quality->isolated_voxels);
  printf("floating grains   %zu (%zu voxels): touch no other grain and no side of the scan; noise, "
         "or a contact lost\n",
         quality->floating_grains, quality->floating_voxels);
}

/* Prints the fractions of pore voxels by width, until all but 1 % are listed. */
static void print_widths(const struct morphology *m) {
  double printed = 0.0;
  printf("width histogram   ");
  for (int b = 0; b < THICKNESS_BINS && printed < 0.99; b++) {
    printed += m->thickness_histogram[b];
    if (m->thickness_histogram[b] >= 0.005)
      printf("%d-%d: %.0f %%, ", b, b + 1, 100.0 * m->thickness_histogram[b]);
  }
  printf("of the pore volume, by the largest ball that fits there, in voxels\n");
}

/* Prints the pore widths in voxels, and the resolution that would be sufficient: the error of a
 * second-order wall across N voxels is about 1 / (2 N^2), and the narrowest places control the
 * flow. */
static void print_pores(const struct pipeline *pipeline) {
  const struct morphology *m = &pipeline->morphology;
  size_t size[3];
  bool enough;
  printf("pore widths       %.0f %% of the pore voxels touch a grain\n", 100.0 * m->touching);
  if (m->critical_width > 0.0) {
    printf("critical width    %.2g voxels at the narrowest of the widest way along z",
           m->critical_width);
    if (!pipeline_finer_size(pipeline, 0.05, size, &enough))
      printf(": fine enough to resolve the flow to some 5 %%\n");
    else if (pipeline->size[0] == pipeline->region.size[0])
      printf(": too coarse for 5 %%, and the scan holds no more: a finer scan is needed\n");
    else
      printf(": too coarse for 5 %%; --size %zux%zux%zu %s\n", size[0], size[1], size[2],
             enough ? "would do" : "is the best this scan can give");
  }
  if (!isfinite(m->thickness_median)) return;
  printf("median width      %.1f voxels across a pore\n", m->thickness_median);
  print_widths(m);
}

static void print_morphology(const struct pipeline *pipeline) {
  const struct morphology *m = &pipeline->morphology;
  const double spacing = pipeline->model.spacing[0];
  char length[40], text[32];
  print_pores(pipeline);
  if (isfinite(m->correlation_length)) {
    quantity_format(m->correlation_length, "m", length, sizeof length);
    printf(
        "correlation       over %s: what is farther apart is independent; the model is %.0f times "
        "as wide\n",
        length, (double)pipeline->model.size[0] * spacing / m->correlation_length);
  }
  if (m->window_count == 0) return;
  printf("representative    ");
  for (size_t i = 0; i < m->window_count; i++) {
    quantity_format((double)m->window[i] * spacing, "m", length, sizeof length);
    if (m->window_places[i] > 1)
      printf("%s +-%s %%, ", length,
             percent_format(m->window_deviation[i] / m->window_mean[i], text));
  }
  printf("void ratio from one window of this size to the next\n");
}

/* Prints the results of the survey, and the corrections made. */
static void print_scan(const struct pipeline *pipeline) {
  const struct survey *survey = &pipeline->survey;
  const struct scanner *scanner = &pipeline->scanner;
  if (scanner->known && !pipeline->unsized)
    printf("scanner           blur %.3g +- %.2g um (%.2g voxels), fringe %.2g, contrast %.3g times "
           "the "
           "noise, noise correlated over %.2g um%s\n",
           1e6 * scanner->blur, 2e6 * scanner->blur_error, scanner->blur / scanner->unit,
           scanner->fringe, scanner->contrast_to_noise, 1e6 * scanner->noise_correlation,
           scanner->smooth_walls > 0.5 ? "; walls are smooth but for noise"
           : scanner->two_phases > 0.5 ? "; it closes throats: opened, as all is grain or pore"
                                       : "");
  if (isfinite(survey->rings))
    printf("radial            grain %+.1f +- %.1f %% of the contrast from middle to rim%s; rings "
           "%.1f %%%s\n",
           100.0 * survey->beam, 100.0 * survey->beam_error,
           pipeline->correction.beam ? " (levelled)" : "", 100.0 * survey->rings,
           pipeline->correction.rings ? " (taken out)" : "");
  if (pipeline->region.denoise != DENOISE_NONE)
    printf("denoised          surface %+.0f %%; the threshold of the noisy slices would now give a "
           "void ratio of %.4f\n",
           100.0 * (pipeline->denoised.surface - 1.0), pipeline->denoised.void_ratio);
}

static void print_grey(const char *name, double grey, double error) {
  printf("%s%.4g", name, grey);
  if (error > 0.0) printf(" +- %.2g", error);
}

static void print_micro(const struct grey_soil *greys) {
  char text[32];
  print_grey("greys             soil from ", greys->low, greys->low_error);
  print_grey(" to ", greys->high, greys->high_error);
  printf(", pore and grain beyond");
  if (greys->shift != 0.0) printf(" (moved by %+.3g to meet the void ratio)", greys->shift);
  print_grey("; peaks of pore ", greys->pore_peak, greys->pore_error);
  if (isfinite(greys->soil_peak)) print_grey(", soil ", greys->soil_peak, greys->soil_error);
  print_grey(", grain ", greys->grain_peak, greys->grain_error);
  putchar('\n');
  if (!(greys->porosity_error > 0.0)) return;
  printf("greys unsure      leave porosity of soil +- %.2g", greys->porosity_error);
  if (greys->permeability_error > 0.0)
    printf(", its permeability +- %s %%", percent_format(greys->permeability_error, text));
  if (greys->void_ratio_error > 0.0)
    printf(", void ratio, by the bounds, +- %.2g", greys->void_ratio_error);
  printf(" (95 %%)\n");
}

static void print_labels(const struct labels *labels) {
  for (int pore = 1; labels->count > 0 && pore >= 0; pore--) {
    printf(pore ? "labels            pore" : "; grain");
    for (size_t i = 0; i < labels->count; i++)
      if (labels->pore[i] == pore && !labels->is_soil[i]) printf(" %g", labels->value[i]);
  }
  for (size_t i = 0; i < labels->count; i++)
    if (labels->is_soil[i])
      printf("; soil %g (porosity %.3g, permeability %.3g m^2)", labels->value[i],
             labels->soil[i].porosity, labels->soil[i].permeability);
  if (labels->count > 0) putchar('\n');
  printf(
      "walls             labels smoothed over %.2g to %.2g voxels at the same pore volume: k %+.2g "
      "%%, by "
      "Kozeny and Carman, against walls halfway between voxels\n",
      LABEL_SMOOTHING, LABEL_SMOOTHING_WIDE, 100.0 * labels_effect_on_k(labels));
  const double unsure = labels_void_ratio_error(labels);
  if (unsure > 0.0)
    printf("                  a body of this void ratio +- %.2g has as many voxels (95 %%)\n",
           unsure);
}

/* Formats a grey with four decimals, or with four digits if it is small. */
static const char *grey_text(const struct pipeline *pipeline, double grey, char text[32]) {
  const double told = pipeline_grey(pipeline, grey);
  snprintf(text, 32, fabs(told) < 1.0 ? "%.4g" : "%.4f", told);
  return text;
}

/* Prints first the threshold of the scan, which --threshold takes, with the uncertainty of its own
 * greys; that of the downsampled greys differs. */
static void print_greys(const struct pipeline *pipeline) {
  char model[32], original[32];
  printf("threshold         %s", grey_text(pipeline, pipeline->threshold_original, original));
  const double slope = pipeline_grey(pipeline, pipeline->threshold_slope_original);
  const double error = fabs(slope) * pipeline->request->void_ratio_error;
  if (isfinite(error)) printf(" +- %.3g", error);
  printf(" (");
  if (strcmp(grey_text(pipeline, pipeline->threshold, model), original) != 0)
    printf("of the downsampled greys %s, ", model);
  printf("Otsu %.4g", pipeline_grey(pipeline, pipeline->otsu));
  if (pipeline->phases.levels > 2 && pipeline->phases.valley_depth < VALLEY_NONE)
    printf(", least between the peaks %.4g", pipeline_grey(pipeline, pipeline->phases.valley));
  printf(")\n");
  if (pipeline->phases.levels > 2)
    printf("dT/de             %.4g grey levels per unit of void ratio (full resolution %.4g)\n",
           threshold_slope(pipeline), slope);
  printf("grey peaks        pore %.4g, grain %.4g",
         pipeline_grey(pipeline, pipeline->phases.pore_peak),
         pipeline_grey(pipeline, pipeline->phases.grain_peak));
  if (isfinite(pipeline->phases.contrast_to_noise))
    printf(", contrast %.3g times the spread of a peak", pipeline->phases.contrast_to_noise);
  putchar('\n');
  print_scan(pipeline);
}

static void print_text(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const struct quality *quality = &pipeline->quality;
  if (request->micro.given) print_micro(&pipeline->micro);
  if (pipeline->labels.on)
    print_labels(&pipeline->labels);
  else
    print_greys(pipeline);
  if (request->rule != THRESHOLD_AUTO || pipeline->phases.levels == 2 ||
      request->roi.kind != ROI_NONE)
    printf("full resolution   void ratio %.4f%s\n", pipeline->void_ratio_original,
           pipeline->labels.on ? ", by the labels" : "");
  if (pipeline->resampled) print_model(pipeline);
  if (!pipeline->unsized) {
    printf("specific surface  %.4g", quality->surface_original * 1e-3);
    if (isfinite(quality->surface_error)) printf(" +- %.2g", quality->surface_error * 1e-3);
    printf(" 1/mm of bulk volume");
    if (pipeline->resampled) printf(" (model %.4g)", quality->surface_model * 1e-3);
    printf(": grain surface, the larger the slower the flow\n");
  }
  if (pipeline->model.wall_distance != NULL) print_morphology(pipeline);
  if (request->output != NULL) printf("written           %s\n", request->output);
}

enum status report_print(const struct pipeline *pipeline, const struct options *options,
                         const char *key, json_t **first) {
  if (!options_json(options)) {
    if (log_level() > LOG_QUIET) print_text(pipeline);
    return STATUS_OK;
  }
  json_t *object = report_json(pipeline, options);
  if (*first == NULL) {
    *first = object;
    return STATUS_OK;
  }
  if (json_object_get(*first, key) == NULL) json_object_set_new(*first, key, json_array());
  json_array_append_new(json_object_get(*first, key), object);
  return STATUS_OK;
}

enum status report_end(json_t **first) {
  if (*first == NULL) return STATUS_OK;
  char *text = json_dumps(*first, JSON_INDENT(2));
  json_decref(*first);
  *first = NULL;
  if (text == NULL) return FAIL(STATUS_RUN, "out of memory");
  puts(text);
  free(text);
  return STATUS_OK;
}
