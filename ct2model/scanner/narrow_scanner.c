#include "ct2model/scanner/narrow_scanner.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/grain_windows.h"
#include "ct2model/scanner/noise.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/windows.h"

/* A piece in the middle is restored as smooth walls would be, and its grains are blurred by one
 * trial after the other: least squares of pore + contrast times that to the scan give the levels
 * for each, and the blur that leaves least. Walls have moved with the noise and with the blur that
 * was taken out, so that what is found is some 10 to 30 % low. How much is seen on a scan made up
 * of the same grains, whose scanner is known: the one sought gives there what the scan gave
 * (indirect inference, Gourieroux, Monfort and Renault 1993). */
enum { PIECE = 64, TRIALS = 10, TURNS = 2, CORRECTIONS = 2 };
static const double LEAST = 0.4, STEP = 1.26; /* voxels, and the ratio of two trials */
static const double FIRST = 2.0;              /* voxels, where the blur that was read is wider */
static const double SMOOTH = 8.0;             /* cost of surface, times the usual */
/* An image with less noise is drawn, not scanned, and its blur need not be a Gaussian. */
static const double CONTRAST_MOST = 50.0;
/* Of bodies of known blur two thirds are found within a tenth, the rest within .1 to .45
 * (docs/notes/2026-11-26-scans.md); 1 sigma. */
static const double UNCERTAIN = 0.25;

struct look {
  bool levels;                 /* pore and contrast are 0 and 1: the window's greys are known */
  double fringe;               /* as it is taken out */
  double blur, pore, contrast; /* blur in voxels, greys of the window */
  double noise, length;        /* standard deviation, and length in voxels */
};

/* Least squares of pore + contrast its[] to grey[], where they are not known; the mean square left.
 */
static double fit_levels(const float *its, const float *grey, size_t n, struct look *look) {
  if (look->levels) {
    double square = 0.0;
    for (size_t i = 0; i < n; i++) square += pow((double)grey[i] - (double)its[i], 2.0);
    look->contrast = 1.0;
    look->pore = 0.0;
    return square / (double)n;
  }
  double x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
  for (size_t i = 0; i < n; i++) {
    const double a = (double)its[i], b = (double)grey[i];
    x += a, y += b, xx += a * a, xy += a * b, yy += b * b;
  }
  x /= (double)n, y /= (double)n;
  xx = xx / (double)n - x * x, xy = xy / (double)n - x * y, yy = yy / (double)n - y * y;
  look->contrast = xy / xx;
  look->pore = y - look->contrast * x;
  return yy - xy * xy / xx;
}

/* Noise: what the grains leave of the scan. */
static void find_noise(const float *its, struct window *piece, const double stretch[3],
                       struct look *look) {
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  struct noise_sums sums = {.end = NAN};
  for (size_t i = 0; i < n; i++)
    piece->smooth[i] = piece->grey[i] - (float)(look->pore + look->contrast * (double)its[i]);
  noise_add(piece->smooth, piece->distance, piece->size, -GRAIN_WINDOW_FAR - 1.0, 1.0, 0.0,
            INFINITY, &sums);
  double length = 0.0, axes = 0.0;
  for (int a = 0; a < 3; a++) {
    if (sums.pairs[a] < 30.0) continue;
    length += noise_length(&sums, a) * stretch[a];
    axes += 1.0;
  }
  look->noise = noise_deviation(&sums);
  look->length = length / fmax(axes, 1.0);
}

/* At the first window, whose distances become those to its walls. False where the least is at an
 * end of the trials. */
static enum status look_at(struct windows *all, const struct deblur_scanner *work,
                           struct deblur *deblur, struct look *look, bool *found) {
  enum status status = STATUS_OK;
  struct window *piece = &all->window[0];
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  struct windows made = {0};
  double left[TRIALS];
  int least = 0;
  TRY(grain_window(piece, all->stretch, work, deblur, piece->distance));
  for (int t = 0; t < TRIALS; t++) {
    TRY(windows_make_up(all, LEAST * pow(STEP, t), look->fringe, 0.0, 1.0, &made));
    left[t] = fit_levels(made.window[0].grey, piece->grey, n, look);
    if (left[t] < left[least]) least = t;
    windows_end(&made);
  }
  *found = least > 0 && least + 1 < TRIALS && look->contrast > 0.0;
  if (!*found) goto cleanup;
  const double up = left[least + 1] - left[least], down = left[least - 1] - left[least];
  look->blur = LEAST * pow(STEP, least + 0.5 * (down - up) / (down + up));
  TRY(windows_make_up(all, look->blur, look->fringe, 0.0, 1.0, &made));
  fit_levels(made.window[0].grey, piece->grey, n, look);
  find_noise(made.window[0].grey, piece, all->stretch, look);
cleanup:
  windows_end(&made);
  return status;
}

/* The scanner that makes the grains of `scan` look as they were seen. */
static enum status correct_look(const struct windows *scan, const struct deblur_scanner *work,
                                struct deblur *deblur, const struct look *seen, struct look *look,
                                bool *found) {
  enum status status = STATUS_OK;
  const size_t *size = scan->window[0].size, n = size[0] * size[1] * size[2];
  struct windows made = {0};
  struct look its = {.levels = seen->levels, .fringe = seen->fringe};
  *look = *seen;
  for (int again = 0; *found && again < CORRECTIONS; again++) {
    TRY(windows_make_up(scan, look->blur, look->fringe, look->noise / look->contrast, look->length,
                        &made));
    float *grey = made.window[0].grey;
    for (size_t i = 0; i < n; i++) grey[i] = (float)(look->pore + look->contrast * (double)grey[i]);
    TRY(look_at(&made, work, deblur, &its, found));
    windows_end(&made);
    if (!*found) break;
    look->blur *= seen->blur / its.blur;
    look->contrast *= seen->contrast / its.contrast;
    look->pore += seen->pore - its.pore;
    look->noise *= seen->noise / its.noise;
  }
cleanup:
  windows_end(&made);
  return status;
}

/* Noise that was seen far from walls, as it is where levels or a wide blur were read, stays. */
static void take_look(const struct look *look, const struct windows *scan, bool wide,
                      struct scanner *scanner) {
  const double contrast = scanner->grain - scanner->pore;
  scanner->pore += contrast * look->pore;
  scanner->grain = scanner->pore + contrast * look->contrast;
  scanner->blur = look->blur * scan->unit;
  if (look->levels) return;
  if (!wide) {
    scanner->noise = contrast * look->noise;
    scanner->noise_correlation = look->length * scan->unit;
  }
  scanner->contrast_to_noise = contrast * look->contrast / scanner->noise;
}

double narrow_scanner_widest(void) {
  return LEAST * pow(STEP, TRIALS - 1);
}

enum status narrow_scanner_find(const struct region *region, struct scanner *scanner) {
  enum status status = STATUS_OK;
  struct scanner its = *scanner;
  struct deblur deblur = {0};
  struct deblur_scanner work;
  struct windows scan = {0};
  const double fringe = scanner->levels ? scanner->fringe : 0.0;
  struct look seen = {.levels = scanner->levels, .fringe = fringe}, look;
  bool found = true;
  const bool wide = its.blur > narrow_scanner_widest() * scanner->unit;
  if (wide) its.blur = FIRST * scanner->unit;
  for (int turn = 0; found && turn < TURNS; turn++) {
    const struct grey_phases phases = {.pore_peak = its.pore, .grain_peak = its.grain};
    restore_scanner(region, &its, its.blur, 1, &work);
    work.surface = SMOOTH;
    TRY(windows_read_middle(region, &phases, PIECE, &scan));
    const size_t *size = scan.window[0].size;
    TRY(deblur_start(size[0] * size[1] * size[2], &work, &deblur));
    TRY(look_at(&scan, &work, &deblur, &seen, &found));
    TRY(correct_look(&scan, &work, &deblur, &seen, &look, &found));
    found =
        found && look.blur > LEAST && look.blur < narrow_scanner_widest() && look.contrast > 0.0;
    if (found) take_look(&look, &scan, wide, &its);
    deblur_end(&deblur);
    windows_end(&scan);
  }
  if (!found || its.contrast_to_noise > CONTRAST_MOST) goto cleanup;
  its.known = true;
  its.assumed = false;
  its.blur_error = UNCERTAIN * its.blur;
  its.resolution *= its.blur / scanner->blur;
  *scanner = its;
cleanup:
  deblur_end(&deblur);
  windows_end(&scan);
  return status;
}
