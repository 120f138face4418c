#include "ct2model/scanner/scanner.h"

#include <math.h>
#include <string.h>

#include "common/model_file.h"
#include "ct2model/scan/survey.h"
#include "ct2model/scanner/few_surfaces.h"
#include "ct2model/scanner/fringe.h"
#include "ct2model/scanner/grain_windows.h"
#include "ct2model/scanner/narrow_scanner.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/windows.h"

enum { WINDOWS_LEAST = 3 };
/* By the grains as their surfaces show them, then as they are restored with what that gave. */
enum { CORRECTIONS_FIRST = 1, CORRECTIONS = 3 };
/* In deviations: further out a fringe and a wider blur are told apart better, but fewer surfaces
 * are alone. */
static const double REACH = 2.6;
static const double FAINT = 0.1; /* a fringe that the fit cannot tell from none */
/* A phase shows its own grey where a twentieth of it is as deep (voxels). Where a hundredth is not,
 * each surface has another one near, and the blur is known to a quarter (1 sigma). */
static const double DEPTH_SEEN = 4.0, DEEP = 0.05, NOWHERE = 0.01, UNSEEN = 0.25;
static const double ENOUGH = 500.0; /* voxels, for a mean grey */
/* Neighbours that are near look like a fringe up to so much, before it is corrected. */
static const double CLEAR = 0.3;
/* For the noise, of which some tens of voxels are alike where it is correlated over one. */
static const double PAIRS = 5000.0, FEW = 2000.0;
/* Noise of grains over that of pores from which on it counts, where chance moves it by less than
 * KNOWN; elsewhere it must differ by SURE standard errors: of noise alike over a voxel few voxels
 * tell (docs/notes/2026-11-26-hidden-fines.md). */
static const double LESS = 0.97, KNOWN = 0.025, SURE = 2.3;
/* Under a blur of MODEL_BLUR_ASSUMED a flat surface has 1.6 voxels in the middle half between the
 * greys of both phases, and a phase of four voxels width as many as it is: a tenth is few. */
static const double SOFT = 0.1;
enum { SLICES = 8 }; /* fewer are no volume to tell pores from grains in */
/* The response of all windows, its fit, and how far the windows' own fits scatter about it. */
static bool fit_windows(const struct windows *all, double reach, struct scanner *scanner,
                        struct edge_fit *fit) {
  double sum = 0.0, square = 0.0, n = 0.0;
  scanner->response = (struct edge_response){0};
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    struct edge_response own = {0};
    struct edge_fit mine;
    edge_response_add(w->grey, w->smooth, w->distance, w->size, all->stretch, reach, NULL, &own);
    for (size_t b = 0; b < EDGE_BINS; b++) {
      scanner->response.sum[b] += own.sum[b];
      scanner->response.count[b] += own.count[b];
    }
    if (!edge_fit_find(&own, reach, NAN, &mine)) continue;
    sum += edge_fit_blur(&mine);
    square += edge_fit_blur(&mine) * edge_fit_blur(&mine);
    n += 1.0;
  }
  if (!edge_fit_find(&scanner->response, reach, NAN, fit)) return false;
  const double mean = sum / fmax(n, 1.0), own = edge_fit_blur(fit);
  const double scatter = n > 1.0 ? sqrt(fmax(square / n - mean * mean, 0.0) / (n - 1.0)) : 0.0;
  scanner->blur = own * all->unit;
  /* Few windows say little of their scatter: a twentieth at least. */
  scanner->blur_error = fmax(scatter, (n < WINDOWS_LEAST ? 0.1 : 0.05) * own) * all->unit;
  scanner->fringe = fmax(fit->fringe, 0.0);
  return true;
}

/* Greys further from a phase's own are minerals, in contrasts. */
static double farthest(double noise_ratio) {
  return fmax(0.5, 4.5 / noise_ratio);
}

/* Of voxels deep in one phase, as deep as leaves enough of them. */
static struct noise_sums sum_noise(const struct windows *all, double noise_ratio,
                                   const struct edge_fit *fit, bool grain, double end) {
  struct noise_sums sums = {0};
  for (double depth = 3.0; depth >= 2.0 && sums.apart_pairs < PAIRS; depth -= 0.5) {
    sums = (struct noise_sums){.end = end};
    for (size_t i = 0; i < all->count; i++)
      noise_add(all->window[i].grey, all->window[i].distance, all->window[i].size,
                fmax(depth * fit->deviation, 1.5), grain ? -1.0 : 1.0,
                grain ? fit->grain : fit->pore, farthest(noise_ratio), &sums);
  }
  return sums;
}

/* Of the axes, m; NAN where there are no pairs. */
static double mean_length(const struct noise_sums *sums, const double voxel[3]) {
  double length = 0.0, axes = 0.0;
  for (int a = 0; a < 3; a++) {
    if (sums->pairs[a] < 30.0) continue;
    length += noise_length(sums, a) * voxel[a];
    axes += 1.0;
  }
  return axes > 0.0 ? length / axes : NAN;
}

/* Whether grains show less noise than pores, beyond chance: the ratio of their deviations, and
 * their lengths in voxels. */
static bool has_less(const struct noise_sums *grain, double grain_length,
                     const struct noise_sums *pore, double pore_length, double ratio) {
  const double chance =
      hypot(noise_deviation_error(grain, grain_length), noise_deviation_error(pore, pore_length));
  return grain->apart_pairs >= PAIRS && ratio < LESS &&
         (chance < KNOWN || 1.0 - ratio > SURE * chance);
}

/* As it is seen in `scanner`, for scans made up that are to look alike; over what it was before the
 * scan was cut off is returned. Seen in pores; but fines that the blur hides there look like noise,
 * so that grains may have clearly less of it, texture and all. */
static double measure_noise(struct windows *all, double noise_ratio, const struct edge_fit *fit,
                            struct scanner *scanner) {
  const double contrast = all->grain - all->pore, *voxel = all->region->voxel;
  double ends[2];
  windows_find_ends(all, ends);
  windows_bound_depth(all);
  struct noise_sums sums = sum_noise(all, noise_ratio, fit, false, ends[0]);
  const struct noise_sums grain = sum_noise(all, noise_ratio, fit, true, ends[1]);
  if (sums.count < FEW) sums = grain;
  const double length = mean_length(&sums, voxel), grain_length = mean_length(&grain, voxel);
  const double left = noise_left(&sums);
  const double seen = noise_deviation(&sums), other = noise_deviation(&grain);
  const bool less = has_less(&grain, grain_length / all->unit, &sums, length / all->unit,
                             other / noise_left(&grain) * left / seen);
  scanner->noise = contrast * (less ? other / noise_left(&grain) * left : seen);
  scanner->noise_correlation = less ? fmin(length, grain_length) : length;
  scanner->contrast_to_noise = (fit->grain - fit->pore) * contrast / scanner->noise;
  return left;
}

/* Neighbours, curvature and surfaces that noise has moved bend the response. How much is seen on a
 * scan made up of `grains`, whose scanner is known: the one sought gives there what the scan gave
 * (indirect inference, Gourieroux, Monfort and Renault 1993). `fit` gets nearer to it. */
static enum status correct_fit(const struct windows *grains, const struct edge_fit *seen,
                               const struct fringe_request *scan, int times, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  struct windows made = {0};
  for (int again = 0; again < times && scan->length >= 0.0; again++) {
    struct scanner its_scanner = {0};
    struct edge_fit its;
    const double blur = edge_fit_blur(fit), fringe = fmax(fit->fringe, 0.0);
    TRY(windows_make_up(grains, blur, fringe, scan->noise, scan->length, &made));
    TRY(windows_find_surfaces(&made, scan->contrast_to_noise,
                              edge_response_limit(scan->reach, grains->stretch)));
    if (!fit_windows(&made, scan->reach, &its_scanner, &its) || !(its.grain - its.pore > 0.3))
      break;
    windows_end(&made);
    fit->deviation = edge_fit_deviation(blur * edge_fit_blur(seen) / edge_fit_blur(&its));
    fit->fringe = fmax(fringe + seen->fringe - its.fringe, 0.0);
    const double contrast = (seen->grain - seen->pore) / (its.grain - its.pore);
    fit->pore = seen->pore - contrast * its.pore;
    fit->grain = fit->pore + contrast;
  }
cleanup:
  windows_end(&made);
  return status;
}

static void take_fit(const struct windows *all, const struct edge_fit *fit,
                     struct scanner *scanner) {
  scanner->blur = edge_fit_blur(fit) * all->unit;
  scanner->fringe = fmax(fit->fringe, 0.0);
  scanner->pore = all->pore + fit->pore * (all->grain - all->pore);
  scanner->grain = all->pore + fit->grain * (all->grain - all->pore);
}

/* What `scanner` and `fit`, as seen, are of. A scan made up of grains as a blur of a voxel and more
 * shows them would be blurred twice: they are restored with a first guess of it where they are
 * `deep`. */
static enum status find_fit(const struct windows *all, bool deep, double contrast_to_noise,
                            double reach, struct scanner *scanner, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  const struct edge_fit seen = *fit;
  const struct fringe_request scan = {.contrast_to_noise = contrast_to_noise,
                                      .reach = reach,
                                      .noise = 1.0 / scanner->contrast_to_noise,
                                      .length = scanner->noise_correlation / all->unit};
  struct windows grains = {0};
  TRY(correct_fit(all, &seen, &scan, CORRECTIONS_FIRST, fit));
  take_fit(all, fit, scanner);
  const bool as_seen = !deep || scanner->blur < all->unit;
  const struct windows *its = as_seen ? all : &grains;
  if (!as_seen) TRY(grain_windows(all, scanner, &grains));
  TRY(correct_fit(its, &seen, &scan, CORRECTIONS, fit));
  if (fit->fringe < FAINT && scan.length >= 0.0)
    TRY(fringe_find(its, &scanner->response, &scan, edge_fit_blur(fit) / edge_fit_blur(&seen),
                    fit));
  take_fit(all, fit, scanner);
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

/* Voxels of a phase, by the sign of their distances, and those of them deeper in it than `depth`:
 * how many, and of those that are no minerals, one grain of which would move a mean by a tenth of
 * the contrast, mean and standard deviation of the greys, of the region. */
struct phase_greys {
  double count, deep, common, mean, deviation;
};
static struct phase_greys greys_within(const struct windows *all, const struct survey *survey,
                                       double sign, double depth) {
  const double contrast = all->grain - all->pore, own = sign > 0.0 ? 0.0 : 1.0;
  const double most = farthest(survey->phases.contrast_to_noise);
  double count = 0.0, deep = 0.0, n = 0.0, sum = 0.0, square = 0.0;
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    for (size_t v = 0; v < w->size[0] * w->size[1] * w->size[2]; v++) {
      if (!(sign * (double)w->distance[v] > 0.0)) continue;
      count += 1.0;
      if (!(sign * (double)w->distance[v] > depth)) continue;
      deep += 1.0;
      if (fabs((double)w->grey[v] - own) > most) continue;
      n += 1.0;
      sum += (double)w->grey[v];
      square += (double)w->grey[v] * (double)w->grey[v];
    }
  }
  const double mean = sum / fmax(n, 1.0);
  return (struct phase_greys){count, deep, n, all->pore + contrast * mean,
                              contrast * sqrt(fmax(square / fmax(n, 1.0) - mean * mean, 0.0))};
}

/* Grains' distances are below 0. */
static double sign_of_lesser(const struct survey *survey) {
  return survey->porosity < 0.5 ? 1.0 : -1.0;
}

/* Whether the lesser phase is deep enough in places to show its own grey. */
static bool shows_grey(const struct windows *all, const struct survey *survey) {
  const struct phase_greys lesser = greys_within(all, survey, sign_of_lesser(survey), DEPTH_SEEN);
  return lesser.deep > DEEP * lesser.count;
}

/* Of the region: over the windows, or over the slices that the survey has looked at where these are
 * more; few slices of a small scan may all lie where grains are few. */
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

/* Where each surface has another one near, but edges show a fringe all the same, the greater phase
 * is deep and the void ratio known: that phase's grey, and the other one's by the mean. */
static void take_levels(const struct windows *all, const struct survey *survey,
                        const struct edge_fit *fit, struct scanner *scanner) {
  const double sign = sign_of_lesser(survey);
  const double depth = fmin(fmax(3.0 * fit->deviation, DEPTH_SEEN), EDGE_REACH);
  const struct phase_greys greater = greys_within(all, survey, -sign, depth);
  const double contrast =
      survey_contrast_by_mean(survey, mean_grey(all, survey), greater.mean, greater.mean);
  scanner->levels = greater.common > ENOUGH && contrast > 0.0;
  if (!scanner->levels) return;
  scanner->pore = sign > 0.0 ? greater.mean - contrast : greater.mean;
  scanner->grain = scanner->pore + contrast;
  scanner->contrast_to_noise = contrast / scanner->noise;
}

/* Greys of the region. A phase too narrow to show its own has that which the mean says, and the
 * blur is the less certain. False where the response showed less than half of that contrast: it is
 * not that of a surface. */
static bool find_levels(const struct windows *all, const struct survey *survey,
                        const struct edge_fit *fit, struct scanner *scanner) {
  const double sign = sign_of_lesser(survey), depth = fmax(3.0 * fit->deviation, DEPTH_SEEN);
  const struct phase_greys lesser = greys_within(all, survey, sign, DEPTH_SEEN);
  const struct phase_greys greater = greys_within(all, survey, -sign, fmin(depth, EDGE_REACH));
  double pore = scanner->pore, grain = scanner->grain;
  const double seen = sign > 0.0 ? survey->phases.grain_peak : survey->phases.pore_peak;
  *(sign > 0.0 ? &grain : &pore) = greater.common > ENOUGH ? greater.mean : seen;
  const bool other = survey_levels_by_mean(survey, &pore, &grain);
  const double contrast = grain - pore;
  if (other && scanner->grain - scanner->pore < 0.5 * contrast) return false;
  /* A wide blur that few surfaces tell was read where others are near, too. */
  const bool near = scanner->blur_error >= UNSEEN * scanner->blur &&
                    scanner->blur > narrow_scanner_widest() * all->unit;
  scanner->narrow = near || lesser.deep < NOWHERE * lesser.count;
  if (scanner->narrow) scanner->blur_error = fmax(scanner->blur_error, UNSEEN * scanner->blur);
  if (!other || lesser.deep > DEEP * lesser.count) return true;
  scanner->pore = pore;
  scanner->grain = grain;
  scanner->contrast_to_noise = contrast / scanner->noise;
  return true;
}

/* No surface stands alone, as pores are narrow: the grey of the grains where they are deep, of the
 * pores by the mean, and a blur of MODEL_BLUR_ASSUMED voxels; or the other way round. Where the
 * mean says no other greys than the peaks they are to begin with only. Nothing where hardly any
 * grey is between the two: no blur has made that image. */
static void assume_scanner(const struct windows *all, const struct survey *survey,
                           struct scanner *scanner) {
  const double sign = sign_of_lesser(survey);
  if (all->region->size[2] < SLICES) return;
  const struct phase_greys greater = greys_within(all, survey, -sign, DEPTH_SEEN);
  const bool deep = greater.common > ENOUGH && greater.deviation > 0.0;
  const double noise = deep ? greater.deviation : survey->phases.noise;
  double pore = survey->phases.pore_peak, grain = survey->phases.grain_peak;
  if (deep) *(sign > 0.0 ? &grain : &pore) = greater.mean;
  const bool by_mean = survey_levels_by_mean(survey, &pore, &grain);
  const double less = fmin(survey->porosity, 1.0 - survey->porosity);
  if (survey_between(survey, pore, grain) < SOFT * less) return;
  const struct edge_fit fit = {.deviation = edge_fit_deviation(MODEL_BLUR_ASSUMED)};
  *scanner = (struct scanner){.assumed = by_mean,
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
                              .fine_relief = NAN};
  if (!(phases->contrast_to_noise > 0.0)) return STATUS_OK;
  TRY(windows_read(region, phases, &all));
  TRY(windows_find_surfaces(&all, phases->contrast_to_noise, EDGE_REACH + 2.0));
  /* First over a middling reach, then over that of the blur found. */
  double reach = 5.0;
  bool found = fit_windows(&all, reach, scanner, &fit);
  if (!found) found = fit_windows(&all, reach = 3.0, scanner, &fit);
  for (int again = 0; found && again < 2; again++) {
    const double wanted = fmin(fmax(REACH * fit.deviation, 3.5), EDGE_REACH);
    struct scanner other = *scanner;
    struct edge_fit its;
    if (fabs(wanted / reach - 1.0) < 0.1 || !fit_windows(&all, wanted, &other, &its)) break;
    *scanner = other;
    fit = its;
    reach = wanted;
  }
  if (!found || !(fit.grain - fit.pore > 0.3)) goto cleanup;
  /* Peaks of noisy phases lie between their greys, and surfaces are where these say. */
  const bool deep = shows_grey(&all, survey);
  if (deep) {
    windows_take_levels(&all, fit.pore, fit.grain);
    TRY(windows_find_surfaces(&all, phases->contrast_to_noise, EDGE_REACH + 2.0));
    if (!fit_windows(&all, reach, scanner, &fit) || !(fit.grain - fit.pore > 0.3)) goto cleanup;
  }
  scanner->blur_error = fmax(scanner->blur_error, few_surfaces_error(&all, reach) * scanner->blur);
  const double left = measure_noise(&all, phases->contrast_to_noise, &fit, scanner);
  if (!(scanner->noise > 0.0)) goto cleanup;
  const double seen_fringe = fit.fringe;
  TRY(find_fit(&all, deep, phases->contrast_to_noise, reach, scanner, &fit));
  scanner->noise /= left;
  scanner->contrast_to_noise *= left;
  if (!find_levels(&all, survey, &fit, scanner)) goto cleanup;
  if (scanner->narrow && seen_fringe > CLEAR) take_levels(&all, survey, &fit, scanner);
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
