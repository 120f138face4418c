#include "ct2model/binarise.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/side_distance.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/fragile.h"
#include "ct2model/model/connect.h"
#include "ct2model/scan/crossing.h"
#include "ct2model/constants.h"

static double void_ratio_of(double porosity) {
  return porosity / (1.0 - porosity);
}

/* ---- calibration ---- */

/* Exchanging grain and pore turns e into 1/e. If 1/e fits the measured void ratio and e, with the
 * polarity given by --grain, does not, one of the two must be wrong. */
static enum status check_polarity(const struct pipeline *pipeline, double porosity, bool sure) {
  const struct request *request = pipeline->request;
  double bright = void_ratio_of(request->dark_grains ? 1.0 - porosity : porosity);
  double e = void_ratio_of(porosity);
  const char *mine = request->dark_grains ? "dark" : "bright";
  const char *other = request->dark_grains ? "bright" : "dark";
  /* Grains attenuate more than water and air do; a resin with a heavy tracer may attenuate more. */
  if (request->dark_grains && fabs(log(e)) < log(1.5))
    log_warning("--grain dark: a void ratio of %.3g fits %.3g with bright grains as well, and in "
                "X-ray scans grains are the bright ones as a rule: look at a slice; k of the pores "
                "is not that of the grains",
                e, 1.0 / e);
  if (isnan(request->void_ratio)) {
    if (e > VOID_RATIO_MOST || e < VOID_RATIO_LEAST)
      log_warning("void ratio %.3g with bright grains, %.3g with dark ones: is --grain %s meant?",
                  bright, 1.0 / bright, other);
    return STATUS_OK;
  }
  double misfit = fabs(log(e / request->void_ratio)), swapped = fabs(log(e * request->void_ratio));
  if (!(misfit > log(1.5))) return STATUS_OK;
  /* Near 1, both e and 1/e are close to any measurement: the other polarity must agree with it as
   * well as a valley of the histogram does. */
  if (!(swapped < fmax(log(POLARITY_AGREES), POLARITY_SHARE * misfit))) {
    if (sure && request->rule == THRESHOLD_AUTO)
      log_warning("the histogram's own valley gives a void ratio of %.3g with bright grains and "
                  "%.3g with dark ones, and neither is the measured %.3g: check that it is of this "
                  "specimen, and the region (--crop auto leaves a container out)",
                  bright, 1.0 / bright, request->void_ratio);
    return STATUS_OK;
  }
  if (sure && !request->grain_given)
    return FAIL(STATUS_INPUT,
                "%s: the image has a void ratio of %.3g with bright grains and %.3g with dark "
                "ones, measured is %.3g: say --grain %s, or --grain %s if that is what you mean",
                pipeline->stack.files[0].path, bright, 1.0 / bright, request->void_ratio, other,
                mine);
  log_warning("the histogram's own valley gives a void ratio of %.3g with bright grains and %.3g "
              "with dark ones, measured is %.3g: is --grain %s meant?",
              bright, 1.0 / bright, request->void_ratio, other);
  return STATUS_OK;
}

/* Labels cannot be shifted: a segmented image has a void ratio of its own, which agrees with the
 * measured one or does not. */
static enum status check_labels(const struct pipeline *pipeline) {
  const struct request *request = pipeline->request;
  const struct labels *labels = &pipeline->labels;
  const double e = void_ratio_of(labels->voids), measured = request->void_ratio;
  const double error = isnan(request->void_ratio_error) ? 0.0 : request->void_ratio_error;
  const double off = fabs(e - measured), most = fmax(LABELS_OFF_MOST * measured, 3.0 * error);
  const char *path = pipeline->stack.files[0].path;
  const bool pair = labels->count == 2 && labels->micro.kind == NULL;
  const double pore = labels->value[labels->pore[0] ? 0 : 1];
  const double other = labels->value[labels->pore[0] ? 1 : 0];
  const char *turn = request->labels.given ? "" : "; --segmented LABEL names another";
  if (isnan(measured)) {
    if (pair && !request->labels.given)
      log_warning(
          "%s holds two labels: %g is taken as pore, %g as grain, a void ratio of %.4g; the "
          "other way round it would be %.4g (--segmented %g)",
          path, pore, other, e, 1.0 / e, other);
    return STATUS_OK;
  }
  if (pair && off > most && fabs(1.0 / e - measured) <= most)
    return FAIL(STATUS_INPUT,
                "%s: with the label %g as pore its void ratio is %.4g, with %g it is %.4g, and "
                "measured is %.4g: say --segmented %g, or leave --void-ratio out",
                path, pore, e, other, 1.0 / e, measured, other);
  if (off > most)
    return FAIL(STATUS_INPUT,
                "%s: is segmented, with a void ratio of %.4g, and no threshold makes it the "
                "measured %.4g: segment it anew from the greys, or leave --void-ratio out%s",
                path, e, measured, turn);
  if (off > fmax(VOID_RATIO_TOLERANCE * measured, error))
    log_warning("the image is segmented, with a void ratio of %.4g, not the measured %.4g: k is "
                "that of the image",
                e, measured);
  return STATUS_OK;
}

static enum status check_levels(const struct pipeline *pipeline) {
  size_t levels = 0;
  for (size_t i = 0; i < pipeline->calibration.bins; i++)
    levels += pipeline->calibration.counts[i] > 0;
  if (levels >= 2) return STATUS_OK;
  return FAIL(STATUS_INPUT, "%s: all pixels of the region have the same grey; nothing to divide",
              pipeline->stack.files[0].path);
}

/* The middle between the two greys of a segmented image. */
static double middle_of_two(const struct grey_histogram *histogram) {
  double sum = 0.0;
  for (size_t i = 0; i < histogram->bins; i++)
    if (histogram->counts[i] > 0)
      sum += 0.5 * (histogram->low + histogram->width * ((double)i + 0.5));
  return sum;
}

/* The threshold of the resampled volume at `porosity`; sets its derivative dT/de. */
static enum status resampled_threshold(struct pipeline *pipeline, double porosity,
                                       double *threshold) {
  enum status status = STATUS_OK;
  struct mirroring mirroring = pipeline_mirroring(pipeline);
  /* Walls between labels do not depend on the mirrored sides. */
  for (int d = 0; d < 2; d++) mirroring.mirrored[d] &= !pipeline->labels.on;
  double low = fmax(0.001, porosity - 0.005), high = fmin(0.999, porosity + 0.005);
  double at_low = 0.0, at_high = 0.0;
  TRY(volume_threshold(pipeline->volume, &mirroring, porosity, threshold));
  TRY(volume_threshold(pipeline->volume, &mirroring, low, &at_low));
  TRY(volume_threshold(pipeline->volume, &mirroring, high, &at_high));
  pipeline->threshold_slope = (at_high - at_low) / (void_ratio_of(high) - void_ratio_of(low));
cleanup:
  return status;
}

/* Where a histogram with a single peak does not show the phases, they are taken from the survey,
 * which uses the noise between pixels. */
static void phases_of_survey(struct pipeline *pipeline) {
  const struct grey_phases *seen = &pipeline->survey.phases;
  if (!(seen->contrast_to_noise > 0.0)) return;
  pipeline->phases.pore_peak = seen->pore_peak;
  pipeline->phases.grain_peak = seen->grain_peak;
  pipeline->phases.noise = seen->noise;
  pipeline->phases.contrast_to_noise = seen->contrast_to_noise;
}

/* Labels have no uncertain greys: the surface encloses their volume, at full resolution and after
 * resampling. */
static enum status calibrate_labels(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct labels *labels = &pipeline->labels;
  TRY(check_labels(pipeline));
  pipeline->phases = (struct grey_phases){.pore_peak = 0.0,
                                          .grain_peak = LABEL_GREY,
                                          .valley = NAN,
                                          .noise = NAN,
                                          .contrast_to_noise = NAN,
                                          .valley_depth = NAN,
                                          .levels = labels->count};
  pipeline->survey.beam = pipeline->survey.rings = NAN;
  pipeline->otsu = NAN;
  pipeline->threshold_original = pipeline->threshold = labels->threshold;
  pipeline->void_ratio_original = void_ratio_of(labels->voids);
  /* The scan's own voxels keep their surface; resampled ones get one that leaves the same pore
   * volume. */
  if (memcmp(pipeline->size, pipeline->region.size, sizeof pipeline->size) != 0)
    TRY(resampled_threshold(pipeline, labels->model_porosity, &pipeline->threshold));
  pipeline->threshold_slope = pipeline->threshold_slope_original = NAN;
cleanup:
  return status;
}

enum status binarise_calibrate(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  if (pipeline->labels.on) return calibrate_labels(pipeline);
  const struct request *request = pipeline->request;
  const struct grey_histogram *histogram = &pipeline->calibration;
  double sign = request->dark_grains ? -1.0 : 1.0;
  TRY(check_levels(pipeline));
  pipeline->otsu = grey_histogram_otsu(histogram);
  double porosity = request->void_ratio / (1.0 + request->void_ratio);
  double first = isnan(porosity) ? pipeline->otsu : grey_histogram_quantile(histogram, porosity);
  grey_histogram_phases(histogram, first, &pipeline->phases);
  /* With a wrong void ratio the threshold lies on a peak, and both sides find the same one. */
  if (pipeline->phases.valley_depth > VALLEY_NONE)
    grey_histogram_phases(histogram, pipeline->otsu, &pipeline->phases);
  if (pipeline->phases.valley_depth > VALLEY_NONE && pipeline->region.denoise == DENOISE_NONE &&
      pipeline->survey.phases.valley_depth > VALLEY_NONE)
    phases_of_survey(pipeline);
  if (!isnan(request->scale_peak)) {
    double peak = sign * pipeline->phases.grain_peak;
    if (!(peak > 0.0))
      TRY_FAIL(STATUS_INPUT, "--scale-peak: the grain peak is at %g, which no factor scales", peak);
    pipeline->grey_scale = request->scale_peak / peak;
  }
  if (pipeline->phases.levels == 2) {
    pipeline->threshold_original = middle_of_two(histogram);
    pipeline->phases.pore_peak = grey_histogram_quantile(histogram, 0.0) + 0.5 * histogram->width;
    pipeline->phases.grain_peak = grey_histogram_quantile(histogram, 1.0) - 0.5 * histogram->width;
    pipeline->phases.noise = pipeline->phases.contrast_to_noise = NAN;
    if (request->rule != THRESHOLD_AUTO)
      log_warning(
          "%s holds two greys alone, labels more likely than a scan: with --threshold their "
          "steps stand as walls, and no run can say what they do to k; leave it out, or say "
          "--segmented",
          pipeline->stack.files[0].path);
  }
  if (request->rule == THRESHOLD_AUTO) {
    bool segmented = pipeline->phases.levels == 2;
    /* On the floor of a wide valley all greys are equally good. */
    double natural =
        segmented ? pipeline->threshold_original
                  : fmin(fmax(first, pipeline->phases.valley_low), pipeline->phases.valley_high);
    TRY(check_polarity(pipeline, grey_histogram_porosity(histogram, natural),
                       segmented || pipeline->phases.valley_depth < VALLEY_SURE));
    if (!segmented) pipeline->threshold_original = first;
    pipeline->threshold = pipeline->threshold_original;
  } else {
    pipeline->threshold_original = request->rule == THRESHOLD_OTSU
                                       ? pipeline->otsu
                                       : sign * request->threshold / pipeline->grey_scale;
    pipeline->threshold = pipeline->threshold_original;
    porosity = grey_histogram_porosity(histogram, pipeline->threshold);
    if (porosity <= 0.0 || porosity >= 1.0)
      TRY_FAIL(STATUS_INPUT, "--threshold %g: all of the region is %s; its greys go from %g to %g",
               pipeline_grey(pipeline, pipeline->threshold), porosity > 0.0 ? "pore" : "grain",
               pipeline_grey(pipeline, grey_histogram_quantile(histogram, 0.0)),
               pipeline_grey(pipeline, grey_histogram_quantile(histogram, 1.0)));
    TRY(check_polarity(pipeline, porosity, true));
  }
  /* A region of interest determines the threshold at full resolution; the modelled region may be
   * denser or looser, and the resampled model matches its void ratio. */
  if (request->roi.kind != ROI_NONE)
    porosity = grey_histogram_porosity(&pipeline->histogram, pipeline->threshold_original);
  histogram = &pipeline->histogram;
  if (porosity <= 0.0 || porosity >= 1.0)
    TRY_FAIL(STATUS_INPUT, "all of the region is %s at threshold %g",
             porosity > 0.0 ? "pore" : "grain",
             pipeline_grey(pipeline, pipeline->threshold_original));
  pipeline->threshold_slope_original = grey_histogram_slope(histogram, porosity);
  pipeline->threshold_slope = pipeline->threshold_slope_original;
  if (pipeline->volume != NULL) {
    double matched;
    TRY(resampled_threshold(pipeline, porosity, &matched));
    if (request->rule == THRESHOLD_AUTO) pipeline->threshold = matched;
  }
  pipeline->void_ratio_original =
      void_ratio_of(grey_histogram_porosity(histogram, pipeline->threshold_original));
  if (pipeline->region.denoise != DENOISE_NONE)
    TRY(denoise_effect_measure(&pipeline->survey, pipeline->survey_size, pipeline->region.denoise,
                               pipeline->void_ratio_original /
                                   (1.0 + pipeline->void_ratio_original),
                               4, SIZE_MAX, &pipeline->denoised));
  fragile_warn(pipeline);
cleanup:
  return status;
}

/* ---- connection ---- */

static bool is_not_percolating(const struct part *part, const void *context) {
  return !part->percolates[*(const int *)context];
}

/* Weight (crossing.h) of the change of phase from a site to the next one along an axis. */
static uint64_t crossing_of(const struct voxel_model *model, const size_t at[3], int axis) {
  const size_t *n = model->size, step[3] = {1, n[0], n[0] * n[1]};
  double gradient[3] = {0};
  for (int side = 0; side < 2; side++) {
    size_t from[3] = {at[0], at[1], at[2]};
    if (side == 1) from[axis] = (from[axis] + 1) % n[axis];
    for (int a = 0; a < 3; a++) {
      size_t low[3] = {from[0], from[1], from[2]}, high[3] = {from[0], from[1], from[2]};
      low[a] = (from[a] + n[a] - 1) % n[a], high[a] = (from[a] + 1) % n[a];
      size_t i = 0, j = 0;
      for (int d = 0; d < 3; d++) i += low[d] * step[d], j += high[d] * step[d];
      gradient[a] += ((double)model->solid[j] - (double)model->solid[i]) / model->spacing[a];
    }
  }
  return crossing_weight(gradient, axis);
}

/* Grain surface per bulk volume of the periodic model, 1/m. */
static double model_surface(const struct voxel_model *model) {
  const size_t *n = model->size, step[3] = {1, n[0], n[0] * n[1]};
  uint64_t cx = 0, cy = 0, cz = 0;
#pragma omp parallel for schedule(static) reduction(+ : cx, cy, cz)
  for (size_t line = 0; line < n[1] * n[2]; line++) {
    const size_t y = line % n[1], z = line / n[1]; // NOLINT: there is a line
    const uint8_t *here = model->solid + line * n[0];
    const uint8_t *above = y + 1 < n[1] ? here + step[1] : here - (n[1] - 1) * step[1];
    const uint8_t *behind = z + 1 < n[2] ? here + step[2] : here - (n[2] - 1) * step[2];
    for (size_t x = 0; x < n[0]; x++) {
      const size_t at[3] = {x, y, z};
      if (here[x] != here[x + 1 < n[0] ? x + 1 : 0]) cx += crossing_of(model, at, 0);
      if (here[x] != above[x]) cy += crossing_of(model, at, 1);
      if (here[x] != behind[x]) cz += crossing_of(model, at, 2);
    }
  }
  const uint64_t crossings[3] = {cx, cy, cz};
  double sum = 0.0, sites = (double)model_site_count(model);
  for (int d = 0; d < 3; d++) sum += (double)crossings[d] / CROSSING_UNIT / model->spacing[d];
  return sum / sites;
}

/* Whether layer `at` of an axis is a face of the scan, where grains that are cut may touch others
 * outside. */
static bool is_face(const struct pipeline *pipeline, int axis, size_t at) {
  return at == 0 || at + 1 == pipeline->model.size[axis] || at + 1 == pipeline->size[axis];
}

/* Counts the grains inside the scan that touch no other grain. */
static enum status count_floating_grains(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  const struct voxel_model *model = &pipeline->model;
  struct parts grains = {0};
  struct quality *quality = &pipeline->quality;
  bool *touches = NULL;
  size_t largest = 0;
  TRY(parts_find(model->solid, model->size, model->periodic, 1, &grains));
  TRY(memory_allocate(&touches, grains.count, sizeof *touches, "parts of the grains"));
  for (size_t row = 0; row < model->size[1] * model->size[2]; row++) {
    const bool face = is_face(pipeline, 1, row % model->size[1]) || // NOLINT: it has rows
                      is_face(pipeline, 2, row / model->size[1]);
    for (size_t r = grains.row_first[row]; r < grains.row_first[row + 1]; r++) {
      const struct run *run = &grains.runs[r];
      const bool ends = run->x0 == 0 || run->x1 == model->size[0];
      if (face || ends) touches[run->part] = true;
    }
  }
  for (size_t p = 0; p < grains.count; p++)
    if (grains.parts[p].voxels > grains.parts[largest].voxels) largest = p;
  for (size_t p = 0; p < grains.count; p++) {
    if (p == largest || touches[p]) continue;
    quality->floating_grains++;
    quality->floating_voxels += grains.parts[p].voxels;
  }
cleanup:
  memory_free(&touches);
  parts_end(&grains);
  return status;
}

/* Volume of the voids on a path along the flow, in voxels; soil counts with its porosity. */
static double connected_soil(const struct voxel_model *model, const struct parts *pores, int flow) {
  const size_t rows = model->size[1] * model->size[2];
  double sum = 0.0;
  for (size_t row = 0; row < rows; row++)
    for (size_t r = pores->row_first[row]; r < pores->row_first[row + 1]; r++) {
      const struct run *run = &pores->runs[r];
      if (!pores->parts[run->part].percolates[flow]) continue;
      const float *porosity = model->micro_porosity + row * model->size[0];
      for (uint32_t x = run->x0; x < run->x1; x++)
        sum += porosity[x] > 0.0f ? (double)porosity[x] : 1.0;
    }
  return sum;
}

/* Warns if pores end at grain in the first or last layer along the flow: k is then that of pores
 * obstructed there. */
static void warn_of_cut_pores(const struct pipeline *pipeline, int flow) {
  const struct request *request = pipeline->request;
  if (flow == 2 ? request->mirror : request->sides == SIDES_MIRRORED) return;
  const double cut = model_cut_pores(&pipeline->model, flow);
  if (cut > 0.0)
    log_warning("%.0f %% of the pores in the first and last layers along the flow meet grain where "
                "the model repeats itself: k is that of pores cut there, too low, by as much as "
                "its error has to say; %s, unless the image is periodic",
                100.0 * cut, request->mirror ? "give --mirror z" : "leave out --mirror none");
}

/* Warns if a periodic image is mirrored: this gives another body, whose k may differ by 15 %. */
static void warn_of_mirrored_repeats(const struct pipeline *pipeline) {
  const struct mirroring mirroring = pipeline_mirroring(pipeline);
  char axes[12] = "";
  bool sides = false, ends = false;
  for (int a = 0; a < 3; a++) {
    const int d = pipeline->place[a];
    if (!mirroring.mirrored[d] || !model_repeats(&pipeline->model, d, pipeline->size[d])) continue;
    snprintf(axes + strlen(axes), sizeof axes - strlen(axes), "%s%c", *axes ? ", " : "", "xyz"[a]);
    *(d == 2 && pipeline->request->mirror ? &ends : &sides) = true;
  }
  if (*axes)
    log_warning("along %s the image seems to repeat itself as it stands: mirrored it is another "
                "body with another k, which its error does not hold; %s%s%s keeps it",
                axes, sides ? "--sides periodic" : "", sides && ends ? " --mirror none" : "",
                ends && !sides ? "--mirror none" : "");
}

/* Nothing flows along z; another axis may be the one that was meant. */
static void warn_of_no_path(const struct pipeline *pipeline, size_t layers) {
  const bool *leads = pipeline->quality.percolates;
  const int along = leads[0] ? 0 : 1;
  /* The model's x, y, z are these axes of the scan. */
  const char axis = (char)('x' + (pipeline->request->flow_axis + 1 + along) % 3);
  char instead[80] = "";
  if (leads[0] || leads[1])
    snprintf(instead, sizeof instead, "one leads along %c: --flow %c makes that axis z",
             'x' + along, axis);
  log_warning("no pore path leads through the model along z: nothing can flow; %s",
              instead[0] != '\0' ? instead
              : layers > 1       ? "a finer --size may open the throats"
                                 : "it has one layer");
}

enum status binarise_connect(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct voxel_model *model = &pipeline->model;
  struct quality *quality = &pipeline->quality;
  struct parts pores = {0};
  const int flow = pipeline->place[2];
  size_t sites = model_site_count(model), pore_voxels = 0, connected = 0;
  TRY(parts_find(model->solid, model->size, model->periodic, 0, &pores));
  for (size_t p = 0; p < pores.count; p++) {
    const struct part *part = &pores.parts[p];
    pore_voxels += part->voxels;
    for (int a = 0; a < 3; a++) quality->percolates[a] |= part->percolates[pipeline->place[a]];
    if (part->percolates[flow]) {
      connected += part->voxels;
    } else {
      quality->isolated_pores++;
      quality->isolated_voxels += part->voxels;
    }
  }
  warn_of_cut_pores(pipeline, flow);
  warn_of_mirrored_repeats(pipeline);
  if (!quality->percolates[2]) warn_of_no_path(pipeline, model->size[flow]);
  if (pipeline->request->fill_islands && quality->isolated_pores > 0) {
    if (connected == 0)
      TRY_FAIL(STATUS_INPUT,
               "--islands fill would fill every pore: none leads through the model along z");
    pore_voxels -= parts_paint(&pores, is_not_percolating, &flow, 1, model->solid);
    log_info("filled %zu isolated pores (%zu voxels)", quality->isolated_pores,
             quality->isolated_voxels);
  }
  if (pore_voxels == sites)
    TRY_FAIL(STATUS_INPUT, "the model would be all pore at threshold %g",
             pipeline_grey(pipeline, pipeline->threshold));
  for (size_t i = 0; i < sites && model->micro_porosity != NULL; i++)
    if (model->solid[i]) model->micro_porosity[i] = model->micro_permeability[i] = 0.0f;
  double voids = (double)pore_voxels, connected_voids = (double)connected;
  if (model->micro_porosity != NULL) {
    voids = model_porosity(model) * (double)sites;
    connected_voids = connected_soil(model, &pores, flow);
  }
  model->void_ratio = voids / ((double)sites - voids);
  quality->porosity = voids / (double)sites;
  quality->connected_porosity = connected_voids / (double)sites;
  quality->surface_model = model_surface(model);
  TRY(count_floating_grains(pipeline));
cleanup:
  parts_end(&pores);
  return status;
}
