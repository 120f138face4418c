#include "ct2model/scanner/smooth_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/least_risk.h"
#include "ct2model/scanner/porod.h"
#include "ct2model/scanner/ramp.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/restored.h"
#include "ct2model/scanner/windows.h"

/* A Monte Carlo test (Barnard 1963, J. R. Stat. Soc. B 25: 294). A piece of the scan is restored
 * twice, with a lower and a higher cost of surface; so is a scan made up of the smoother of the
 * two, with the scanner's blur and noise. What the higher cost takes away is noise there, and
 * nothing else. If it is as much in the scan, the scan has no relief either that the higher cost
 * would take. The third moment is compared: edges, corners and contacts of grains are few, but lose
 * more than noise does anywhere.
 *
 * Smooth walls: the usual cost against that of smooth walls. Of sands the ratio is 1.1 to 1.9, of
 * bodies with smooth walls .76 to 1.18 (docs/notes/2026-11-28-surface-cost.md). */
static const double SMOOTH = 1.11, ROUGH = 1.18;
/* Fine relief: a quarter of the usual cost against that. Noise may have been measured 10 to 20 %
 * low, or 10 % high where fines add to it, and what it does grows faster than it: so the noise made
 * up is the one that leaves as much unexplained as the scan does. */
static const double LESS = 0.25;
static const double NONE = 2.0; /* from here on the scanner is another one than was found */
/* Octaves by which the cost of surface changes for one of the cost of the least risk
 * (least_risk.h), and for a ratio of fine relief of 2: so k of 102 generated sands is off by the
 * least (docs/notes/2026-11-28-surface-cost.md). Up to NOTHING it may be chance, from SOMETHING on
 * all of it counts. */
static const double BY_RISK = 0.66, BY_RELIEF = 2.44, NOTHING = 0.2, SOMETHING = 0.4;
/* Under a blur of SHARP voxels relief shows, under one of WIDE corners look like it, and so much
 * less of it counts (ibid.). */
static const double SHARP = 2.2, WIDE = 2.8, FEWER = 0.67;
/* Noise that is correlated over as much as the blur, or a voxel, looks like relief: from a share of
 * ALIKE on neither is told. Nor is a scan made up with noise longer than that (restore_scanner). */
static const double SHORTER = 0.6, ALIKE = 0.9;
/* From the finest relief, a quarter of the usual cost, to smooth walls. Under contrasts of NOISY
 * times the noise and less a cost under LEAST lets noise in; from CLEAR on there is little. */
static const double FINEST = -2.0, SMOOTHEST = 3.0, LEAST = -1.5, NOISY = 7.0, CLEAR = 9.0;
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

/* Octaves of the usual cost of surface that walls with relief are given. */
static enum status find_octaves(const struct region *region, const struct scanner *scanner,
                                struct windows *scan, struct deblur *deblur, float *lower,
                                double *octaves) {
  enum status status = STATUS_OK;
  const double fine[2] = {LESS, 1.0};
  struct taken seen, ratio;
  double contrast, least_risk;
  restore_scanner(region, scanner, scanner->blur, 1, &deblur->scanner);
  TRY(look_at_scan(scan, fine, deblur, lower, &seen, &contrast));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(scan, scanner, noise, fine, &seen, deblur, NULL, &ratio));
  TRY(compare(scan, scanner, noise * sqrt(ratio.left), fine, &seen, deblur, lower, &ratio));
  TRY(least_risk_find(scan, 1.0 / scanner->contrast_to_noise,
                      scanner->noise_correlation / scan->unit, deblur, &least_risk));
  const double relief = ratio.cube < NONE ? ratio.cube - 1.0 : 0.0;
  const double wanted = BY_RISK * log2(least_risk) - BY_RELIEF * relief;
  const double wide = ramp(scanner->blur / scan->unit, SHARP, WIDE);
  const double counts = wanted < 0.0 ? 1.0 - FEWER * wide : 1.0;
  const double least = LEAST + (FINEST - LEAST) * ramp(scanner->contrast_to_noise, NOISY, CLEAR);
  *octaves = fmax(counts * wanted * ramp(fabs(wanted), NOTHING, SOMETHING), least);
cleanup:
  return status;
}

/* How far the walls that `deblur` has left are those of grains that touch (porod.h), and no tubes,
 * fibres or beads. */
static enum status find_touching(const struct region *region, const struct deblur *deblur,
                                 double blur, double *touching) {
  enum status status = STATUS_OK;
  const size_t *size = deblur->size, n = size[0] * size[1] * size[2];
  struct restored piece = {.threshold = 127.5};
  double grain = 0.0, faces = 0.0;
  TRY(memory_allocate(&piece.scan.levels, n, 1, "a piece of the scan"));
  memcpy(piece.scan.size, size, sizeof piece.scan.size);
  for (size_t i = 0; i < n; i++) {
    piece.scan.levels[i] = (uint8_t)lrint(255.0 * (double)deblur->share[i]);
    grain += piece.scan.levels[i] > 127 ? 1.0 : 0.0;
    if (i % size[0] > 0) // NOLINT: a row has voxels
      faces += (piece.scan.levels[i] > 127) != (piece.scan.levels[i - 1] > 127) ? 1.0 : 0.0;
  }
  piece.void_ratio = (double)n / grain - 1.0;
  /* A random line meets half of the surface in a unit of volume (Saltykov 1958). */
  const double surface = 2.0 * faces / ((double)n * region->voxel[0]);
  TRY(porod_grains(&piece, blur, region->voxel, surface, touching));
cleanup:
  memory_free(&piece.scan.levels);
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
  double contrast, touching, octaves = 0.0;
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
  TRY(find_touching(region, &deblur, scanner->blur, &touching));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(&scan, scanner, noise, smooth, &seen, &deblur, lower, &ratio));
  const double smooth_share = (1.0 - touching) * ramp(-ratio.cube, -ROUGH, -SMOOTH);
  const double length = scanner->noise_correlation / fmax(scanner->blur, scanner->unit);
  const double told = ramp(-length, -ALIKE, -SHORTER);
  if (smooth_share < 1.0 && told > 0.0)
    TRY(find_octaves(region, scanner, &scan, &deblur, lower, &octaves));
  octaves *= told;
  octaves += smooth_share * (SMOOTHEST - octaves);
  scanner->smooth_walls = fmax(octaves / SMOOTHEST, 0.0);
  scanner->fine_relief = fmax(octaves / FINEST, 0.0);
cleanup:
  memory_free(&lower);
  deblur_end(&deblur);
  windows_end(&scan);
  return status;
}
