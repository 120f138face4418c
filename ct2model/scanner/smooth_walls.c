#include "ct2model/scanner/smooth_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/least_risk.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/windows.h"

/* A Monte Carlo test (Barnard 1963, J. R. Stat. Soc. B 25: 294). A piece of the scan is restored
 * twice, with a lower and a higher cost of surface; so is a scan made up of the smoother of the
 * two, with the scanner's blur and noise. What the higher cost takes away is noise there, and
 * nothing else. If it is as much in the scan, the scan has no relief either that the higher cost
 * would take. The third moment is compared: edges, corners and contacts of grains are few, but lose
 * more than noise does anywhere.
 *
 * Smooth walls: the usual cost against that of smooth walls. Of 47 sands of contrast 4 to 30 times
 * the noise the ratio is 1.18 to 1.9, 1.24 and more in all but two; of 40 bodies with smooth walls
 * it is .76 to 1.18 (docs/notes/2026-11-25-smooth-walls.md). */
static const double SMOOTH = 1.16, ROUGH = 1.22;
/* Fine relief: a quarter of the usual cost against that. Noise may have been measured 10 to 20 %
 * low, or 10 % high where fines add to it, and what it does grows faster than it: so the noise made
 * up is the one that leaves as much unexplained as the scan does. 1 to 1.13 in sands of which the
 * usual cost takes noise, 1.15 to 1.47 where it takes small grains, a scanner found wrong apart
 * (docs/notes/2026-11-27-fines.md). */
static const double LESS = 0.25, USUAL = 1.13, FINE = 1.39;
static const double NONE = 2.0; /* from here on the scanner is another one than was found */
/* A fringe and a wider blur are alike: blurs that differ by WIDER of themselves for each unit of
 * fringe explain a scan as well, and a fringe found too large looks like relief. Over contrasts of
 * 9 times the noise few are too large by a tenth, under 6 some by .3 (DOUBT over the contrast, up
 * to DOUBT_MOST): the mean of the relief with the fringe found and with that much less of it counts
 * (docs/notes/2026-11-26-hidden-fines.md). */
static const double DOUBT = 1.8, DOUBT_MOST = 0.3, WIDER = 0.8;
/* Where contrast is low the misfit is noise, and the cost of the least risk (least_risk.h) tells
 * relief that noise hides from the test above: SHARPER of that cost counts where it is less. Where
 * it is high the misfit is the scanner's error as much, and any relief would lessen it; of what the
 * test says LESSER is enough where it is low (docs/notes/2026-11-28-scanner-levels.md). Contrast is
 * told to some .5: from NOISY to CLEAR times the noise less and less of that counts, so that no
 * relief hinges on it (docs/notes/2026-11-27-fines.md). */
static const double NOISY = 7.0, CLEAR = 8.0, SHARPER = 0.8, LESSER = 0.66;
/* Voxels a side: walls enough, restored six times in a second. */
enum { PIECE = 64 };
static const double FAR = 0.5; /* voxels: shares of grain further from walls are 0 and 1 */

/* What a higher cost of surface did, summed over voxels: the third power of what it took, and the
 * square of what it leaves unexplained. */
struct taken {
  double cube, left;
};

/* Where `lower` is NULL only what is left, and with half the work. */
static enum status add_taken(const struct window *piece, const double surface[2],
                             struct deblur *deblur, float *lower, struct taken *taken) {
  enum status status = STATUS_OK;
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  for (int higher = lower != NULL ? 0 : 1; higher < 2; higher++) {
    memcpy(deblur->size, piece->size, sizeof deblur->size);
    memcpy(deblur->grey, piece->grey, n * sizeof *piece->grey);
    deblur->scanner.surface = surface[higher];
    TRY(deblur_run(deblur));
    if (lower != NULL && !higher) memcpy(lower, deblur->share, n * sizeof *lower);
  }
  for (size_t i = 0; lower != NULL && i < n; i++)
    taken->cube += pow(fabs((double)lower[i] - (double)deblur->share[i]), 3.0);
  taken->left += deblur_misfit(deblur, piece->grey);
cleanup:
  return status;
}

/* What the higher of two costs does to the piece, and the contrast of its grains over that of all.
 * Its distances become those to the walls that are left. */
static enum status look_at_scan(struct windows *scan, const double surface[2],
                                struct deblur *deblur, float *lower, struct taken *seen,
                                double *contrast) {
  enum status status = STATUS_OK;
  struct window *piece = &scan->window[0];
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  double grain = 0.0, shares = 0.0;
  *seen = (struct taken){0};
  TRY(add_taken(piece, surface, deblur, lower, seen));
  TRY(edge_distances(deblur->share, piece->size, scan->stretch, FAR, piece->distance));
  for (size_t i = 0; i < n; i++) {
    grain += (double)deblur->share[i] * (double)deblur->grain[i];
    shares += (double)deblur->share[i];
  }
  *contrast = grain / shares;
cleanup:
  return status;
}

/* What was seen over what is expected: what the higher cost does to a scan made up of the grains
 * that look_at_scan left, with that noise over the contrast. */
static enum status compare(const struct windows *scan, const struct scanner *scanner, double noise,
                           const double surface[2], const struct taken *seen, struct deblur *deblur,
                           float *lower, struct taken *ratio) {
  enum status status = STATUS_OK;
  struct windows made = {0};
  struct taken expected = {0};
  const double length = fmin(scanner->noise_correlation / scan->unit, deblur->scanner.correlation);
  /* The noise and its negative: what it does to second order stays. */
  for (int sign = -1; sign <= 1; sign += 2) {
    TRY(windows_make_up(scan, scanner->blur / scan->unit, scanner->fringe, sign * noise, length,
                        &made));
    TRY(add_taken(&made.window[0], surface, deblur, lower, &expected));
    windows_end(&made);
  }
  *ratio = (struct taken){2.0 * seen->cube / expected.cube, 2.0 * seen->left / expected.left};
cleanup:
  windows_end(&made);
  return status;
}

/* 0 up to `from`, 1 from `to` on. */
static double ramp(double value, double from, double to) {
  return isfinite(value) ? fmin(fmax((value - from) / (to - from), 0.0), 1.0) : 0.0;
}

/* Relief finer than of sand, 0 to 1, were the scanner that one. */
static enum status find_fine(const struct region *region, const struct scanner *scanner,
                             struct windows *scan, struct deblur *deblur, float *lower,
                             double *relief) {
  enum status status = STATUS_OK;
  const double fine[2] = {LESS, 1.0};
  struct taken seen, ratio;
  double contrast;
  *relief = 0.0;
  restore_scanner(region, scanner, scanner->blur, 1, &deblur->scanner);
  TRY(look_at_scan(scan, fine, deblur, lower, &seen, &contrast));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(scan, scanner, noise, fine, &seen, deblur, NULL, &ratio));
  TRY(compare(scan, scanner, noise * sqrt(ratio.left), fine, &seen, deblur, lower, &ratio));
  *relief = ratio.cube < NONE ? ramp(ratio.cube, USUAL, FINE) : 0.0;
cleanup:
  return status;
}

/* Relief by the cost of surface that has the least risk. */
static enum status find_hidden(const struct region *region, const struct scanner *scanner,
                               struct windows *scan, struct deblur *deblur, double *relief) {
  enum status status = STATUS_OK;
  double cost;
  restore_scanner(region, scanner, scanner->blur, 1, &deblur->scanner);
  TRY(least_risk_find(scan, 1.0 / scanner->contrast_to_noise,
                      scanner->noise_correlation / scan->unit, deblur, &cost));
  *relief = fmin(fmax(log(SHARPER * cost) / log(LESS), 0.0), 1.0);
cleanup:
  return status;
}

enum status smooth_walls_find(const struct region *region, struct scanner *scanner) {
  enum status status = STATUS_OK;
  const struct grey_phases phases = {.pore_peak = scanner->pore, .grain_peak = scanner->grain};
  struct deblur deblur = {0};
  struct scanner its = *scanner;
  struct deblur_scanner work;
  struct windows scan = {0};
  struct taken seen, ratio;
  float *lower = NULL;
  double contrast, relief;
  scanner->smooth_walls = scanner->fine_relief = 0.0;
  if (!scanner->known || !isfinite(scanner->noise_correlation)) return STATUS_OK;
  its.smooth_walls = 1.0;
  restore_scanner(region, &its, scanner->blur, 1, &work);
  if (!(work.surface > 1.0)) return STATUS_OK; /* noise too fine to be told from the voxels */
  TRY(windows_read_middle(region, &phases, PIECE, &scan));
  const size_t *size = scan.window[0].size, n = size[0] * size[1] * size[2];
  TRY(memory_allocate(&lower, n, sizeof *lower, "a piece of the scan"));
  TRY(deblur_start(n, &work, &deblur));
  deblur.rounds = DEBLUR_ROUNDS_COMPARED;
  const double smooth[2] = {1.0, work.surface};
  TRY(look_at_scan(&scan, smooth, &deblur, lower, &seen, &contrast));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(&scan, scanner, noise, smooth, &seen, &deblur, lower, &ratio));
  scanner->smooth_walls = ramp(-ratio.cube, -ROUGH, -SMOOTH);
  /* Noise longer than the blur and a voxel looks like relief: no scan is made up with it as long as
   * it is (restore_scanner). */
  const double longest = fmax(scanner->blur, scanner->unit);
  if (scanner->smooth_walls > 0.0 || scanner->noise_correlation > longest) goto cleanup;
  its = *scanner;
  TRY(find_fine(region, &its, &scan, &deblur, lower, &relief));
  const double drop = fmin(scanner->fringe, fmin(DOUBT_MOST, DOUBT / scanner->contrast_to_noise));
  if (relief > 0.0 && drop > 0.0) {
    its.fringe -= drop;
    its.blur *= 1.0 - WIDER * drop;
    double other;
    TRY(find_fine(region, &its, &scan, &deblur, lower, &other));
    relief = 0.5 * (relief + other);
  }
  const double clear = ramp(scanner->contrast_to_noise, NOISY, CLEAR);
  if (clear < 1.0) {
    double hidden;
    TRY(find_hidden(region, scanner, &scan, &deblur, &hidden));
    relief = clear * relief + (1.0 - clear) * fmax(hidden, LESSER * relief);
  }
  scanner->fine_relief = relief;
cleanup:
  memory_free(&lower);
  deblur_end(&deblur);
  windows_end(&scan);
  return status;
}
