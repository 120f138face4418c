#include "ct2model/scanner/smooth_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/porod.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/restored.h"
#include "ct2model/scanner/windows.h"

/* A Monte Carlo test (Barnard 1963, J. R. Stat. Soc. B 25: 294). A piece of the scan is restored
 * twice, with a lower and a higher cost of surface. The same is done with a scan simulated from the
 * smoother result, with the scanner's blur and noise. What the higher cost removes there is noise
 * and nothing else. If it removes as much from the scan, the scan has no relief that the higher
 * cost would remove either. The third moment of the removed share is compared: edges, corners and
 * contacts of grains are few, but lose more than noise does anywhere.
 *
 * Smooth walls: the usual cost is compared with that of smooth walls. Fine relief: COST_FINE times
 * the usual cost is compared with the usual one. The noise may have been measured 10 to 20 % too
 * low, or 10 % too high where fines add to it, and the removed moment grows faster than the noise.
 * So the simulated noise is adjusted until it leaves the same residual as the scan does.
 *
 * The cost changes by octaves: with the cost of least risk and with fine relief, so
 * that the error of k of generated sands is least. Under a wide blur corners look like relief, and
 * a reduction counts less. Noise with a correlation length like the blur, or a voxel, looks like
 * fine relief, too; under much noise what smooth walls would remove tells the relief then. */

/* What a higher cost of surface removes, summed over voxels: the cubes of the removed shares of
 * grain, and the squares of the residual of the scan. */
struct removal {
  double cube, residual;
};

/* Restores the piece with the two costs surface[] and adds up what the higher one removes. If
 * `lower` is NULL only the residual is computed, with half the work. */
static enum status add_removal(const struct window *piece, const double surface[2],
                               struct deblur *deblur, float *lower, struct removal *removal) {
  enum status status = STATUS_OK;
  const size_t n = window_voxels(piece);
  for (int higher = lower != NULL ? 0 : 1; higher < 2; higher++) {
    memcpy(deblur->size, piece->size, sizeof deblur->size);
    memcpy(deblur->grey, piece->grey, n * sizeof *piece->grey);
    deblur->scanner.surface = surface[higher];
    TRY(deblur_run(deblur));
    if (lower != NULL && !higher) memcpy(lower, deblur->share, n * sizeof *lower);
  }
  for (size_t i = 0; lower != NULL && i < n; i++)
    removal->cube += pow(fabs((double)lower[i] - (double)deblur->share[i]), 3.0);
  removal->residual += deblur_misfit(deblur, piece->grey);
cleanup:
  return status;
}

/* Measures what the higher of two costs removes from the piece, and the contrast of its grains over
 * that of the whole scan. The distances of the piece become those to the restored walls. */
static enum status measure_scan(struct windows *scan, const double surface[2],
                                struct deblur *deblur, float *lower, struct removal *seen,
                                double *contrast) {
  enum status status = STATUS_OK;
  struct window *piece = &scan->window[0];
  const size_t n = window_voxels(piece);
  double grain = 0.0, shares = 0.0;
  *seen = (struct removal){0};
  TRY(add_removal(piece, surface, deblur, lower, seen));
  TRY(edge_distances(deblur->share, piece->size, scan->stretch, WALL_RANGE, piece->distance));
  for (size_t i = 0; i < n; i++) {
    grain += (double)deblur->share[i] * (double)deblur->grain[i];
    shares += (double)deblur->share[i];
  }
  *contrast = grain / shares;
cleanup:
  return status;
}

/* Ratio of what was removed from the scan (`seen`) to what is removed from a scan simulated from
 * the grains that measure_scan left, with the given noise (over the contrast). */
static enum status compare(const struct windows *scan, const struct scanner *scanner, double noise,
                           const double surface[2], const struct removal *seen,
                           struct deblur *deblur, float *lower, struct removal *ratio) {
  enum status status = STATUS_OK;
  struct windows simulated = {0};
  struct removal expected = {0};
  const double length = fmin(scanner->noise_correlation / scan->unit, deblur->scanner.correlation);
  /* With the noise and its negative, effects to second order remain. */
  for (int sign = -1; sign <= 1; sign += 2) {
    TRY(windows_simulate(scan, scanner->blur / scan->unit, scanner->fringe, sign * noise, length,
                         &simulated));
    TRY(add_removal(&simulated.window[0], surface, deblur, lower, &expected));
    windows_end(&simulated);
  }
  *ratio =
      (struct removal){2.0 * seen->cube / expected.cube, 2.0 * seen->residual / expected.residual};
cleanup:
  windows_end(&simulated);
  return status;
}

/* Stein's unbiased estimate (1981, Ann. Statist. 9: 1135) of the risk |H A u - f|^2, where f is the
 * scan without its noise and u the restored grains (deblur.c):
 *
 *   |H A u - g|^2 + 2 tr(J C),   J = d(H A u) / dg,
 *
 * with the scan g and the covariance C of its noise, up to the constant tr C. The trace is the mean
 * of n . J n over simulated noise n, and J n is the change of H A u by a small multiple of n
 * (Ramani, Blu and Unser 2008, IEEE Trans. Image Process. 17: 1540). */
enum { COSTS = 6 };
static const double COST[COSTS] = {0.25, 0.5, 1.0, 2.0, 4.0, 8.0}; /* each twice the previous one */
/* Computes H A u of the piece after adding a multiple of the noise, and its misfit to the piece
 * itself. */
static enum status restore_and_blur(const struct window *piece, const float *noise, double multiple,
                                    struct deblur *deblur, float *explained, double *misfit) {
  enum status status = STATUS_OK;
  const size_t n = window_voxels(piece);
  memcpy(deblur->size, piece->size, sizeof deblur->size);
  for (size_t i = 0; i < n; i++) deblur->grey[i] = piece->grey[i] + (float)multiple * noise[i];
  TRY(deblur_run(deblur));
  *misfit = deblur_misfit(deblur, piece->grey);
  memcpy(explained, deblur->b, n * sizeof *explained);
cleanup:
  return status;
}

/* Position, in fractions of the index, of the minimum of the parabola through the smallest risk and
 * its neighbours. */
static double index_of_minimum(const double risk[COSTS]) {
  int least = 0;
  for (int i = 1; i < COSTS; i++)
    if (risk[i] < risk[least]) least = i;
  if (least == 0 || least + 1 == COSTS) return least;
  return least + parabola_minimum(risk[least - 1], risk[least], risk[least + 1]);
}

/* Finds the cost of least risk, relative to the usual one, for the first window of `scan`, whose
 * distances are overwritten. `noise`: standard deviation, `length`: correlation length (voxels). */
static enum status find_least_risk(struct windows *scan, double noise, double length,
                                   struct deblur *deblur, double *cost) {
  enum status status = STATUS_OK;
  struct window *piece = &scan->window[0];
  const size_t n = window_voxels(piece);
  struct windows simulated = {0};
  double risk[COSTS], misfit;
  float *explained = NULL, *perturbed = NULL;
  TRY(memory_allocate(&explained, n, sizeof *explained, "a piece of the scan"));
  TRY(memory_allocate(&perturbed, n, sizeof *perturbed, "a piece of the scan"));
  for (size_t i = 0; i < n; i++)
    piece->distance[i] = 1.0F; /* all pore: the simulated scan is noise alone */
  TRY(windows_simulate(scan, 0.0, 0.0, noise, length, &simulated));
  const float *added_noise = simulated.window[0].grey;
  for (int i = 0; i < COSTS; i++) {
    double trace = 0.0;
    deblur->scanner.surface = COST[i];
    TRY(restore_and_blur(piece, added_noise, PERTURBATION, deblur, perturbed, &misfit));
    TRY(restore_and_blur(piece, added_noise, 0.0, deblur, explained, &misfit));
    for (size_t v = 0; v < n; v++)
      trace +=
          (double)added_noise[v] * ((double)perturbed[v] - (double)explained[v]) / PERTURBATION;
    risk[i] = misfit + 2.0 * trace;
  }
  *cost = COST[0] * exp2(index_of_minimum(risk));
cleanup:
  MEMORY_FREE(&explained, &perturbed);
  windows_end(&simulated);
  return status;
}

/* Change of the cost of surface, in octaves of the usual cost, for walls with relief. */
static enum status find_octaves(const struct region *region, const struct scanner *scanner,
                                double smooth_ratio, struct windows *scan, struct deblur *deblur,
                                float *lower, double *octaves) {
  enum status status = STATUS_OK;
  const double fine[2] = {COST_FINE, 1.0};
  struct removal seen, ratio;
  double contrast, least_risk;
  restore_scanner(region, scanner, scanner->blur, &deblur->scanner);
  TRY(measure_scan(scan, fine, deblur, lower, &seen, &contrast));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(scan, scanner, noise, fine, &seen, deblur, NULL, &ratio));
  TRY(compare(scan, scanner, noise * sqrt(ratio.residual), fine, &seen, deblur, lower, &ratio));
  TRY(find_least_risk(scan, 1.0 / scanner->contrast_to_noise,
                      scanner->noise_correlation / scan->unit, deblur, &least_risk));
  const double relief = ratio.cube < RATIO_IMPLAUSIBLE ? ratio.cube - 1.0 : 0.0;
  const double clear = ramp(scanner->contrast_to_noise, CONTRAST_NOISY, CONTRAST_CLEAR);
  const double length = scanner->noise_correlation / fmax(scanner->blur, scanner->unit);
  const double distinguishable = ramp(-length, -LENGTH_LONG, -LENGTH_SHORT);
  const double by_fine = OCTAVES_BY_RISK * log2(least_risk) - OCTAVES_BY_RELIEF * relief;
  const double by_smooth = log2(least_risk) - (smooth_ratio - RATIO_SAND);
  const double wanted =
      distinguishable * by_fine + (1.0 - distinguishable) * (1.0 - clear) * by_smooth;
  const double wide = ramp(scanner->blur / scan->unit, BLUR_SHARP, BLUR_WIDE);
  const double counts = wanted < 0.0 ? 1.0 - REDUCTION_WIDE * wide : 1.0;
  const double least = OCTAVES_NOISY + (log2(COST_FINE) - OCTAVES_NOISY) * clear;
  *octaves = fmax(counts * wanted * ramp(fabs(wanted), OCTAVES_CHANCE, OCTAVES_SIGNIFICANT), least);
cleanup:
  return status;
}

/* Weight from 0 to 1 that the walls restored by `deblur` are those of grains in contact (porod.h),
 * and not of tubes, fibres or beads. */
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
  /* By stereology the surface per volume is twice the intersections per length of random lines
   * (Saltykov 1958). */
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
  struct scanner smooth_scanner = *scanner;
  struct deblur_scanner work;
  struct windows scan = {0};
  struct removal seen, ratio;
  float *lower = NULL;
  double contrast, touching, octaves = 0.0;
  scanner->smooth_walls = scanner->fine_relief = 0.0;
  if (!scanner->known || !isfinite(scanner->noise_correlation)) return STATUS_OK;
  smooth_scanner.smooth_walls = 1.0;
  restore_scanner(region, &smooth_scanner, scanner->blur, &work);
  if (!(work.surface > 1.0)) return STATUS_OK; /* noise too fine to be told from the voxels */
  TRY(windows_read_middle(region, &phases, PIECE_SIDE, &scan));
  const size_t *size = scan.window[0].size, n = size[0] * size[1] * size[2];
  TRY(memory_allocate(&lower, n, sizeof *lower, "a piece of the scan"));
  TRY(deblur_start(n, &work, &deblur));
  deblur.iterations = ITERATIONS_COMPARED;
  deblur.compared = true;
  const double smooth[2] = {1.0, work.surface};
  TRY(measure_scan(&scan, smooth, &deblur, lower, &seen, &contrast));
  TRY(find_touching(region, &deblur, scanner->blur, &touching));
  const double noise = 1.0 / (contrast * scanner->contrast_to_noise);
  TRY(compare(&scan, scanner, noise, smooth, &seen, &deblur, lower, &ratio));
  const double smooth_share = (1.0 - touching) * ramp(-ratio.cube, -RATIO_ROUGH, -RATIO_SMOOTH);
  if (smooth_share < 1.0)
    TRY(find_octaves(region, scanner, ratio.cube, &scan, &deblur, lower, &octaves));
  octaves += smooth_share * (log2(COST_SMOOTH) - octaves);
  scanner->smooth_walls = fmax(octaves / log2(COST_SMOOTH), 0.0);
  scanner->fine_relief = fmax(octaves / log2(COST_FINE), 0.0);
cleanup:
  memory_free(&lower);
  deblur_end(&deblur);
  windows_end(&scan);
  return status;
}
