#include "ct2model/scanner/narrow_scanner.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/windows.h"

/* A cube in the middle of the scan is restored with the surface cost of smooth walls. Its grains
 * are then blurred by a series of trial widths. For each width, least squares of pore + contrast *
 * (blurred grains) to the scan give the levels; the width with the smallest residual is the
 * estimate. It is some 10 to 30 % low, since noise and the deblurring have displaced the walls.
 * This bias is measured on a scan simulated from the same grains with a known scanner: the one
 * sought gives there the same estimate as on the real scan (indirect inference, Gourieroux, Monfort
 * and Renault 1993). */
struct estimate {
  bool levels;                 /* pore and contrast are fixed at 0 and 1: the levels are known */
  double fringe;               /* strength, as in struct scanner; not fitted */
  double blur, pore, contrast; /* blur in voxels; greys in units of the window */
  double noise, length;        /* standard deviation, and correlation length in voxels */
};

/* Fits pore + contrast * model[] to grey[] by least squares, unless the levels are known. Returns
 * the mean square residual. */
static double fit_levels(const float *model, const float *grey, size_t n,
                         struct estimate *estimate) {
  if (estimate->levels) {
    double square = 0.0;
    for (size_t i = 0; i < n; i++) square += pow((double)grey[i] - (double)model[i], 2.0);
    estimate->contrast = 1.0;
    estimate->pore = 0.0;
    return square / (double)n;
  }
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (size_t i = 0; i < n; i++) {
    const double a = (double)model[i], b = (double)grey[i];
    x += a, y += b, xx += a * a, xy += a * b, yy += b * b;
  }
  x /= (double)n, y /= (double)n;
  xx = xx / (double)n - x * x, xy = xy / (double)n - x * y, yy = yy / (double)n - y * y;
  estimate->contrast = xy / xx;
  estimate->pore = y - estimate->contrast * x;
  return yy - xy * xy / xx;
}

/* Estimates the noise from the residual of the fit: the scan minus the blurred grains `model`. */
static void estimate_noise(const float *model, struct window *piece, const double stretch[3],
                           struct estimate *estimate) {
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  struct noise_sums sums = {.end = NAN};
  for (size_t i = 0; i < n; i++)
    piece->smooth[i] =
        piece->grey[i] - (float)(estimate->pore + estimate->contrast * (double)model[i]);
  noise_add(piece->smooth, piece->distance, piece->size, -WALL_RANGE - 1.0, 1.0, 0.0, INFINITY,
            &sums);
  estimate->noise = noise_deviation(&sums);
  estimate->length = fmax(noise_mean_length(&sums, stretch), 0.0);
}

/* Estimates blur, levels and noise on the first window, whose distances become those to the
 * restored walls. `found` is false where the smallest residual lies at an end of the trials. */
static enum status estimate_scanner(struct windows *scan, const struct deblur_scanner *work,
                                    struct deblur *deblur, struct estimate *estimate, bool *found) {
  enum status status = STATUS_OK;
  struct window *piece = &scan->window[0];
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  struct windows blurred = {0};
  double residual[BLUR_TRIALS];
  int least = 0;
  TRY(grain_window(piece, scan->stretch, work, deblur, piece->distance));
  for (int t = 0; t < BLUR_TRIALS; t++) {
    TRY(windows_simulate(scan, BLUR_MIN * pow(BLUR_RATIO, t), estimate->fringe, 0.0, 1.0,
                         &blurred));
    residual[t] = fit_levels(blurred.window[0].grey, piece->grey, n, estimate);
    if (residual[t] < residual[least]) least = t;
    windows_end(&blurred);
  }
  *found = least > 0 && least + 1 < BLUR_TRIALS && estimate->contrast > 0.0;
  if (!*found) goto cleanup;
  const double off = parabola_minimum(residual[least - 1], residual[least], residual[least + 1]);
  estimate->blur = BLUR_MIN * pow(BLUR_RATIO, least + off);
  TRY(windows_simulate(scan, estimate->blur, estimate->fringe, 0.0, 1.0, &blurred));
  fit_levels(blurred.window[0].grey, piece->grey, n, estimate);
  estimate_noise(blurred.window[0].grey, piece, scan->stretch, estimate);
cleanup:
  windows_end(&blurred);
  return status;
}

/* Corrects the bias of the estimate `seen`: finds the scanner under which a scan simulated from the
 * grains of `scan` gives the same estimate. */
static enum status correct_bias(const struct windows *scan, const struct deblur_scanner *work,
                                struct deblur *deblur, const struct estimate *seen,
                                struct estimate *estimate, bool *found) {
  enum status status = STATUS_OK;
  const size_t *size = scan->window[0].size, n = size[0] * size[1] * size[2];
  struct windows simulated = {0};
  struct estimate simulated_estimate = {.levels = seen->levels, .fringe = seen->fringe};
  *estimate = *seen;
  for (int round = 0; *found && round < NARROW_CORRECTIONS; round++) {
    TRY(windows_simulate(scan, estimate->blur, estimate->fringe,
                         estimate->noise / estimate->contrast, estimate->length, &simulated));
    float *grey = simulated.window[0].grey;
    for (size_t i = 0; i < n; i++)
      grey[i] = (float)(estimate->pore + estimate->contrast * (double)grey[i]);
    TRY(estimate_scanner(&simulated, work, deblur, &simulated_estimate, found));
    windows_end(&simulated);
    if (!*found) break;
    estimate->blur *= seen->blur / simulated_estimate.blur;
    estimate->contrast *= seen->contrast / simulated_estimate.contrast;
    estimate->pore += seen->pore - simulated_estimate.pore;
    estimate->noise *= seen->noise / simulated_estimate.noise;
  }
cleanup:
  windows_end(&simulated);
  return status;
}

/* Copies the estimate into `scanner`. Noise measured far from walls, which exists where the levels
 * are known or a blur too wide was measured, is kept. */
static void apply_estimate(const struct estimate *estimate, const struct windows *scan, bool wide,
                           struct scanner *scanner) {
  const double contrast = scanner->grain - scanner->pore;
  scanner->pore += contrast * estimate->pore;
  scanner->grain = scanner->pore + contrast * estimate->contrast;
  scanner->blur = estimate->blur * scan->unit;
  if (estimate->levels) return;
  if (!wide) {
    scanner->noise = contrast * estimate->noise;
    scanner->noise_correlation = estimate->length * scan->unit;
  }
  scanner->contrast_to_noise = contrast * estimate->contrast / scanner->noise;
}

double narrow_scanner_widest(void) {
  return BLUR_MIN * pow(BLUR_RATIO, BLUR_TRIALS - 1);
}

enum status narrow_scanner_find(const struct region *region, struct scanner *scanner) {
  enum status status = STATUS_OK;
  struct scanner current = *scanner;
  struct deblur deblur = {0};
  struct deblur_scanner work;
  struct windows scan = {0};
  const double fringe = scanner->levels ? scanner->fringe : 0.0;
  struct estimate seen = {.levels = scanner->levels, .fringe = fringe}, estimate;
  bool found = true;
  const bool wide = current.blur > narrow_scanner_widest() * scanner->unit;
  if (wide) current.blur = BLUR_FIRST * scanner->unit;
  for (int round = 0; found && round < NARROW_ROUNDS; round++) {
    const struct grey_phases phases = {.pore_peak = current.pore, .grain_peak = current.grain};
    restore_scanner(region, &current, current.blur, &work);
    work.surface = COST_SMOOTH;
    TRY(windows_read_middle(region, &phases, PIECE_SIDE, &scan));
    const size_t *size = scan.window[0].size;
    TRY(deblur_start(size[0] * size[1] * size[2], &work, &deblur));
    TRY(estimate_scanner(&scan, &work, &deblur, &seen, &found));
    TRY(correct_bias(&scan, &work, &deblur, &seen, &estimate, &found));
    found = found && estimate.blur > BLUR_MIN && estimate.blur < narrow_scanner_widest() &&
            estimate.contrast > 0.0;
    if (found) apply_estimate(&estimate, &scan, wide, &current);
    deblur_end(&deblur);
    windows_end(&scan);
  }
  if (!found || current.contrast_to_noise > CONTRAST_SYNTHETIC) goto cleanup;
  current.known = true;
  current.assumed = false;
  current.blur_error = BLUR_ERROR_UNKNOWN * current.blur;
  current.resolution *= current.blur / scanner->blur;
  *scanner = current;
cleanup:
  deblur_end(&deblur);
  windows_end(&scan);
  return status;
}
