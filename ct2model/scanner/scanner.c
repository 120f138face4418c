#include "ct2model/scanner/scanner.h"

#include <math.h>
#include <string.h>

#include "common/model_file.h"
#include "ct2model/scan/survey.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/few_surfaces.h"
#include "ct2model/scanner/fringe.h"
#include "ct2model/scanner/narrow_scanner.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/windows.h"

/* Adds up the edge response of all windows and fits it. False where it cannot be fitted. */
static bool fit_windows(const struct windows *all, double reach, struct scanner *scanner,
                        struct edge_fit *fit) {
  scanner->response = (struct edge_response){0};
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    edge_response_add(w->grey, w->smooth, w->distance, w->size, all->stretch, reach, NULL,
                      &scanner->response);
  }
  if (!edge_fit_find(&scanner->response, reach, NAN, fit)) return false;
  scanner->blur = edge_fit_blur(fit) * all->unit;
  scanner->fringe = fmax(fit->fringe, 0.0);
  return true;
}

/* Distance from the grey of a phase, in contrasts, beyond which a voxel is a mineral of its own. */
static double mineral_distance(double noise_ratio) {
  return fmax(MINERAL_DISTANCE, MINERAL_NOISE / noise_ratio);
}

/* Noise sums over voxels deep inside one phase. The required depth, in standard deviations of the
 * fit, is lowered until there are enough pairs. `end`: the grey at which the scan is clipped on
 * that side. */
static struct noise_sums sum_noise(const struct windows *all, double noise_ratio,
                                   const struct edge_fit *fit, bool grain, double end) {
  struct noise_sums sums = {0};
  for (double depth = NOISE_DEPTH; depth >= 2.0 && sums.apart_pairs < NOISE_PAIRS;
       depth -= NOISE_DEPTH_STEP) {
    sums = (struct noise_sums){.end = end};
    for (size_t i = 0; i < all->count; i++)
      noise_add(all->window[i].grey, all->window[i].distance, all->window[i].size,
                fmax(depth * fit->deviation, 1.5), grain ? -1.0 : 1.0,
                grain ? fit->grain : fit->pore, mineral_distance(noise_ratio), &sums);
  }
  return sums;
}

/* Whether the grains have significantly less noise than the pores. `ratio`: standard deviation in
 * the grains over that in the pores; lengths: correlation lengths in voxels. */
static bool has_less_noise(const struct noise_sums *grain, double grain_length,
                           const struct noise_sums *pore, double pore_length, double ratio) {
  const double chance =
      hypot(noise_deviation_error(grain, grain_length), noise_deviation_error(pore, pore_length));
  return grain->apart_pairs >= NOISE_PAIRS && ratio < NOISE_RATIO_LESS &&
         (chance < NOISE_ERROR_SMALL || 1.0 - ratio > NOISE_STANDARD_ERRORS * chance);
}

/* Measures the noise as the scan shows it, after clipping, since simulated scans must resemble the
 * scan. Returns the ratio of this noise to that before clipping. Noise is measured in the pores.
 * But fines that the blur hides there look like noise; where the grains, texture included, have
 * significantly less, their noise is taken. */
static double measure_noise(struct windows *all, double noise_ratio, const struct edge_fit *fit,
                            struct scanner *scanner) {
  const double contrast = all->grain - all->pore, *voxel = all->region->voxel;
  double ends[2];
  windows_find_clipping(all, ends);
  windows_bound_depth(all);
  struct noise_sums pore = sum_noise(all, noise_ratio, fit, false, ends[0]);
  const struct noise_sums grain = sum_noise(all, noise_ratio, fit, true, ends[1]);
  if (pore.count < NOISE_VOXELS) pore = grain; /* too few voxels in pores */
  const double pore_length = noise_mean_length(&pore, voxel),
               grain_length = noise_mean_length(&grain, voxel);
  const double kept = noise_clipping_ratio(&pore);
  const double pore_noise = noise_deviation(&pore), grain_noise = noise_deviation(&grain);
  const bool less = has_less_noise(&grain, grain_length / all->unit, &pore, pore_length / all->unit,
                                   grain_noise / noise_clipping_ratio(&grain) * kept / pore_noise);
  scanner->noise =
      contrast * (less ? grain_noise / noise_clipping_ratio(&grain) * kept : pore_noise);
  scanner->noise_correlation = less ? fmin(pore_length, grain_length) : pore_length;
  scanner->contrast_to_noise = (fit->grain - fit->pore) * contrast / scanner->noise;
  return kept;
}

/* Corrects `fit` for the bias of the edge response by neighbouring surfaces, curvature and surfaces
 * displaced by noise. The bias is measured on a scan simulated from `grains`, whose scanner is
 * known: the estimate sought is the one with which the simulated scan gives the fit `seen` on the
 * real one (indirect inference, Gourieroux, Monfort and Renault 1993). Each of `times` rounds
 * brings `fit` closer. */
static enum status correct_fit(const struct windows *grains, const struct edge_fit *seen,
                               const struct fringe_request *scan, int times, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  struct windows simulated = {0};
  for (int round = 0; round < times && scan->length >= 0.0; round++) {
    struct scanner simulated_scanner = {0};
    struct edge_fit simulated_fit;
    const double blur = edge_fit_blur(fit), fringe = fmax(fit->fringe, 0.0);
    TRY(windows_simulate(grains, blur, fringe, scan->noise, scan->length, &simulated));
    TRY(windows_find_surfaces(&simulated, scan->contrast_to_noise,
                              edge_response_limit(scan->reach, grains->stretch)));
    if (!fit_windows(&simulated, scan->reach, &simulated_scanner, &simulated_fit) ||
        !(simulated_fit.grain - simulated_fit.pore > CONTRAST_LEAST))
      break;
    windows_end(&simulated);
    fit->deviation = edge_fit_deviation(blur * edge_fit_blur(seen) / edge_fit_blur(&simulated_fit));
    fit->fringe = fmax(fringe + seen->fringe - simulated_fit.fringe, 0.0);
    const double contrast = (seen->grain - seen->pore) / (simulated_fit.grain - simulated_fit.pore);
    fit->pore = seen->pore - contrast * simulated_fit.pore;
    fit->grain = fit->pore + contrast;
  }
cleanup:
  windows_end(&simulated);
  return status;
}

static void apply_fit(const struct windows *all, const struct edge_fit *fit,
                      struct scanner *scanner) {
  scanner->blur = edge_fit_blur(fit) * all->unit;
  scanner->fringe = fmax(fit->fringe, 0.0);
  scanner->pore = all->pore + fit->pore * (all->grain - all->pore);
  scanner->grain = all->pore + fit->grain * (all->grain - all->pore);
}

/* Corrects `scanner` and `fit`, which hold the uncorrected edge fit, by indirect inference
 * (correct_fit). Under a blur of a voxel or more, grains taken from the scan as it is would be
 * blurred twice in the simulation; where a phase is `deep` they are therefore restored first, with
 * a first estimate of the blur. */
static enum status correct_scanner(const struct windows *all, bool deep, double contrast_to_noise,
                                   double reach, struct scanner *scanner, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  const struct edge_fit seen = *fit;
  const struct fringe_request scan = {.contrast_to_noise = contrast_to_noise,
                                      .reach = reach,
                                      .noise = 1.0 / scanner->contrast_to_noise,
                                      .length = scanner->noise_correlation / all->unit};
  struct windows grains = {0};
  TRY(correct_fit(all, &seen, &scan, CORRECTIONS_FIRST, fit));
  apply_fit(all, fit, scanner);
  const bool as_seen = !deep || scanner->blur < all->unit;
  const struct windows *used = as_seen ? all : &grains;
  if (!as_seen) TRY(grain_windows(all, scanner, &grains));
  TRY(correct_fit(used, &seen, &scan, CORRECTIONS_RESTORED, fit));
  if (fit->fringe < FRINGE_DETECTABLE && scan.length >= 0.0)
    TRY(fringe_find(used, &scanner->response, &scan, edge_fit_blur(fit) / edge_fit_blur(&seen),
                    fit));
  apply_fit(all, fit, scanner);
  scanner->contrast_to_noise *= (fit->grain - fit->pore) / (seen.grain - seen.pore);
  scanner->blur_error =
      hypot(scanner->blur_error, 0.5 * (edge_fit_blur(fit) - edge_fit_blur(&seen)) * all->unit);
cleanup:
  windows_end(&grains);
  return status;
}

static double resolution_of(const struct edge_fit *fit) {
  double low = 0.0, high = 4.0 / fit->deviation; /* cycles a voxel */
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    if (edge_fit_transfer(fit, middle) > 0.1)
      low = middle;
    else
      high = middle;
  }
  return 1.0 / high;
}

/* Statistics of the greys of one phase, told by the sign of the distances: `count` voxels, `deep`
 * of them deeper than `depth`, and `common` of those that are no minerals of their own (one grain
 * of such a mineral would move the mean by a tenth of the contrast), with the mean and standard
 * deviation of their greys in the units of the region. */
struct phase_greys {
  double count, deep, common, mean, deviation;
};
static struct phase_greys greys_within(const struct windows *all, const struct survey *survey,
                                       double sign, double depth) {
  const double contrast = all->grain - all->pore, level = sign > 0.0 ? 0.0 : 1.0;
  const double most = mineral_distance(survey->phases.contrast_to_noise);
  double count = 0.0, deep = 0.0, n = 0.0, sum = 0.0, square = 0.0;
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    for (size_t v = 0; v < w->size[0] * w->size[1] * w->size[2]; v++) {
      if (!(sign * (double)w->distance[v] > 0.0)) continue;
      count += 1.0;
      if (!(sign * (double)w->distance[v] > depth)) continue;
      deep += 1.0;
      if (fabs((double)w->grey[v] - level) > most) continue;
      n += 1.0;
      sum += (double)w->grey[v];
      square += (double)w->grey[v] * (double)w->grey[v];
    }
  }
  const double mean = sum / fmax(n, 1.0);
  return (struct phase_greys){count, deep, n, all->pore + contrast * mean,
                              contrast * sqrt(fmax(square / fmax(n, 1.0) - mean * mean, 0.0))};
}

/* Sign of the distances in the phase with the smaller volume: 1 for pores, -1 for grains. */
static double sign_of_lesser(const struct survey *survey) {
  return survey->porosity < 0.5 ? 1.0 : -1.0;
}

/* Whether the phase of smaller volume is deep enough in places to show its own grey. */
static bool shows_own_grey(const struct windows *all, const struct survey *survey) {
  const struct phase_greys lesser =
      greys_within(all, survey, sign_of_lesser(survey), DEPTH_OWN_GREY);
  return lesser.deep > DEEP_FRACTION * lesser.count;
}

/* Mean grey of the region, over the windows or over the slices of the survey, whichever hold more
 * voxels: in a small scan, few slices may all lie where grains are few. */
static double mean_grey(const struct windows *all, const struct survey *survey) {
  double sum = 0.0, n = 0.0;
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    const size_t voxels = w->size[0] * w->size[1] * w->size[2];
    for (size_t v = 0; v < voxels; v++) sum += (double)w->grey[v];
    n += (double)voxels;
  }
  if (n < (double)survey->pixels) return survey->mean;
  return all->pore + (all->grain - all->pore) * sum / n;
}

/* Sets the greys of both phases where each surface has another one near: the phase of larger
 * volume, if deep enough, by its own mean, the other one by the mean grey and the known void ratio.
 * Used where the edges show a clear fringe all the same. */
static void set_levels_by_mean(const struct windows *all, const struct survey *survey,
                               const struct edge_fit *fit, struct scanner *scanner) {
  const double sign = sign_of_lesser(survey);
  const double depth = fmin(fmax(3.0 * fit->deviation, DEPTH_OWN_GREY), EDGE_REACH);
  const struct phase_greys greater = greys_within(all, survey, -sign, depth);
  const double contrast =
      survey_contrast_by_mean(survey, mean_grey(all, survey), greater.mean, greater.mean);
  scanner->levels = greater.common > VOXELS_FOR_MEAN && contrast > 0.0;
  if (!scanner->levels) return;
  scanner->by_void_ratio = true;
  scanner->pore = sign > 0.0 ? greater.mean - contrast : greater.mean;
  scanner->grain = scanner->pore + contrast;
  scanner->contrast_to_noise = contrast / scanner->noise;
}

/* Sets the greys of both phases. A phase too narrow to show its own grey gets that which follows
 * from the mean grey, and the blur is then less certain. False where the edge response showed less
 * than half of the resulting contrast: it is then not that of a surface. */
static bool find_levels(const struct windows *all, const struct survey *survey,
                        const struct edge_fit *fit, struct scanner *scanner) {
  const double sign = sign_of_lesser(survey), depth = fmax(3.0 * fit->deviation, DEPTH_OWN_GREY);
  const struct phase_greys lesser = greys_within(all, survey, sign, DEPTH_OWN_GREY);
  const struct phase_greys greater = greys_within(all, survey, -sign, fmin(depth, EDGE_REACH));
  double pore = scanner->pore, grain = scanner->grain;
  const double peak = sign > 0.0 ? survey->phases.grain_peak : survey->phases.pore_peak;
  *(sign > 0.0 ? &grain : &pore) = greater.common > VOXELS_FOR_MEAN ? greater.mean : peak;
  const bool by_mean = survey_levels_by_mean(survey, &pore, &grain);
  const double contrast = grain - pore;
  if (by_mean && scanner->grain - scanner->pore < 0.5 * contrast) return false;
  /* A wide and uncertain blur was fitted to surfaces with near neighbours, too. */
  const bool wide_and_uncertain = scanner->blur_error >= BLUR_ERROR_UNKNOWN * scanner->blur &&
                                  scanner->blur > narrow_scanner_widest() * all->unit;
  scanner->narrow = wide_and_uncertain || lesser.deep < DEEP_FRACTION_NARROW * lesser.count;
  if (scanner->narrow)
    scanner->blur_error = fmax(scanner->blur_error, BLUR_ERROR_UNKNOWN * scanner->blur);
  if (!by_mean || lesser.deep > DEEP_FRACTION * lesser.count) return true;
  scanner->by_void_ratio = true;
  scanner->pore = pore;
  scanner->grain = grain;
  scanner->contrast_to_noise = contrast / scanner->noise;
  return true;
}

/* Assumes a blur of MODEL_BLUR_ASSUMED voxels where no surface is free of neighbours, because pores
 * (or grains) are narrow. The grey of the wider phase is its mean where it is deep; that of the
 * other one follows from the mean grey. Where the mean gives no levels, the peaks of the histogram
 * serve as starting values only. Does nothing where hardly any grey lies between the two: such an
 * image is not blurred. */
static void assume_scanner(const struct windows *all, const struct survey *survey,
                           struct scanner *scanner) {
  const double sign = sign_of_lesser(survey);
  if (all->region->size[2] < SLICES_MINIMUM) return;
  const struct phase_greys greater = greys_within(all, survey, -sign, DEPTH_OWN_GREY);
  const bool deep = greater.common > VOXELS_FOR_MEAN && greater.deviation > 0.0;
  const double noise = deep ? greater.deviation : survey->phases.noise;
  double pore = survey->phases.pore_peak, grain = survey->phases.grain_peak;
  if (deep) *(sign > 0.0 ? &grain : &pore) = greater.mean;
  const bool by_mean = survey_levels_by_mean(survey, &pore, &grain);
  const double lesser_fraction = fmin(survey->porosity, 1.0 - survey->porosity);
  if (survey_between(survey, pore, grain) < BLURRED_FRACTION * lesser_fraction) return;
  const struct edge_fit fit = {.deviation = edge_fit_deviation(MODEL_BLUR_ASSUMED)};
  *scanner = (struct scanner){.assumed = by_mean,
                              .by_void_ratio = by_mean,
                              .narrow = true,
                              .blur = MODEL_BLUR_ASSUMED * all->unit,
                              .pore = pore,
                              .grain = grain,
                              .noise = noise,
                              .contrast_to_noise = (grain - pore) / noise,
                              .resolution = resolution_of(&fit) * all->unit,
                              .unit = all->unit};
}

enum status scanner_measure(const struct region *region, const struct survey *survey,
                            struct scanner *scanner) {
  enum status status = STATUS_OK;
  const struct grey_phases *phases = &survey->phases;
  struct windows all = {0};
  struct edge_fit fit;
  *scanner = (struct scanner){.blur = NAN,
                              .blur_error = NAN,
                              .fringe = NAN,
                              .pore = NAN,
                              .grain = NAN,
                              .noise = NAN,
                              .contrast_to_noise = NAN,
                              .noise_correlation = NAN,
                              .resolution = NAN,
                              .smooth_walls = NAN,
                              .fine_relief = NAN,
                              .two_phases = NAN};
  if (!(phases->contrast_to_noise > 0.0)) return STATUS_OK;
  TRY(windows_read(region, phases, &all));
  TRY(windows_find_surfaces(&all, phases->contrast_to_noise, EDGE_REACH + 2.0));
  /* First with a medium range, then with the range that suits the blur found. */
  double reach = REACH_FIRST;
  bool found = fit_windows(&all, reach, scanner, &fit);
  if (!found) found = fit_windows(&all, reach = REACH_NARROW, scanner, &fit);
  for (int round = 0; found && round < 2; round++) {
    const double wanted = fmin(fmax(REACH_DEVIATIONS * fit.deviation, REACH_LEAST), EDGE_REACH);
    struct scanner other_scanner = *scanner;
    struct edge_fit other_fit;
    if (fabs(wanted / reach - 1.0) < 0.1 || !fit_windows(&all, wanted, &other_scanner, &other_fit))
      break;
    *scanner = other_scanner;
    fit = other_fit;
    reach = wanted;
  }
  if (!found || !(fit.grain - fit.pore > CONTRAST_LEAST)) goto cleanup;
  /* The peaks of noisy phases lie between their true greys. The fit gives better levels, and with
   * them the surfaces are found anew. */
  const bool deep = shows_own_grey(&all, survey);
  if (deep) {
    windows_rescale(&all, fit.pore, fit.grain);
    TRY(windows_find_surfaces(&all, phases->contrast_to_noise, EDGE_REACH + 2.0));
    if (!fit_windows(&all, reach, scanner, &fit) || !(fit.grain - fit.pore > CONTRAST_LEAST))
      goto cleanup;
  }
  scanner->blur_error = fmax(BLUR_SCATTER, few_surfaces_error(&all, reach)) * scanner->blur;
  const double noise_kept = measure_noise(&all, phases->contrast_to_noise, &fit, scanner);
  if (!(scanner->noise > 0.0)) goto cleanup;
  const double seen_fringe = fit.fringe;
  TRY(correct_scanner(&all, deep, phases->contrast_to_noise, reach, scanner, &fit));
  scanner->noise /= noise_kept;
  scanner->contrast_to_noise *= noise_kept;
  if (!find_levels(&all, survey, &fit, scanner)) goto cleanup;
  if (scanner->narrow && seen_fringe > FRINGE_BY_NEIGHBOURS)
    set_levels_by_mean(&all, survey, &fit, scanner);
  scanner->known = true;
  scanner->unit = all.unit;
  scanner->resolution = resolution_of(&fit) * all.unit;
cleanup:
  if (!scanner->known) {
    scanner->blur = scanner->blur_error = scanner->fringe = NAN;
    scanner->pore = scanner->grain = NAN;
    if (status == STATUS_OK) assume_scanner(&all, survey, scanner);
  }
  windows_end(&all);
  return status;
}
