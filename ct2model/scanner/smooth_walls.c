#include "ct2model/scanner/smooth_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/windows.h"

/* A Monte Carlo test (Barnard 1963, J. R. Stat. Soc. B 25: 294). A piece of the scan is restored
 * twice, with the surface at its usual cost and at the cost for smooth walls; so is a scan made up
 * of the smoother of the two, with the scanner's blur and noise. What the higher cost takes away
 * is noise there, and nothing else. If it is as much in the scan, the scan has no relief either.
 * Its third moment is compared: edges, corners and contacts of grains are few, but lose more than
 * noise does anywhere. Of 47 sands of contrast 4 to 30 times the noise the ratio is 1.18
 * to 1.9, 1.24 and more in all but two; of 40 bodies with smooth walls it is .76 to 1.18
 * (docs/notes/2026-11-25-smooth-walls.md). */
static const double SMOOTH = 1.16, ROUGH = 1.22;
/* Voxels a side: walls enough, restored six times in a second. */
enum { PIECE = 64 };
static const double FAR = 4.0; /* voxels: shares of grain further from walls are 0 and 1 */

/* The sum over voxels of the third power of what the second cost of surface takes; the shares of
 * grain that it leaves stay in `deblur`. */
static enum status sum_taken(const struct window *piece, const double surface[2],
                             struct deblur *deblur, float *usual, double *sum) {
  enum status status = STATUS_OK;
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  for (int smooth = 0; smooth < 2; smooth++) {
    memcpy(deblur->size, piece->size, sizeof deblur->size);
    memcpy(deblur->grey, piece->grey, n * sizeof *piece->grey);
    deblur->scanner.surface = surface[smooth];
    TRY(deblur_run(deblur));
    if (!smooth) memcpy(usual, deblur->share, n * sizeof *usual);
  }
  for (size_t i = 0; i < n; i++) {
    const double taken = fabs((double)usual[i] - (double)deblur->share[i]);
    *sum += taken * taken * taken;
  }
cleanup:
  return status;
}

enum status smooth_walls_find(const struct region *region, const struct scanner *scanner,
                              double *smooth) {
  enum status status = STATUS_OK;
  const struct grey_phases phases = {.pore_peak = scanner->pore, .grain_peak = scanner->grain};
  struct deblur deblur = {0};
  struct scanner its = *scanner;
  struct deblur_scanner work;
  struct windows scan = {0}, made = {0};
  float *usual = NULL;
  double seen = 0.0, expected = 0.0;
  *smooth = 0.0;
  if (!scanner->known || !isfinite(scanner->noise_correlation)) return STATUS_OK;
  its.smooth_walls = 1.0;
  restore_scanner(region, &its, scanner->blur, 1, &work);
  const double surface[2] = {1.0, work.surface};
  if (!(surface[1] > 1.0)) return STATUS_OK;
  TRY(windows_read_middle(region, &phases, PIECE, &scan));
  struct window *piece = &scan.window[0];
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  TRY(memory_allocate(&usual, n, sizeof *usual, "a piece of the scan"));
  TRY(deblur_start(n, &work, &deblur));
  TRY(sum_taken(piece, surface, &deblur, usual, &seen));
  TRY(edge_distances(deblur.share, piece->size, scan.stretch, FAR, piece->distance));
  /* Noise is over the contrast that these grains have, not over that of all. */
  double grain = 0.0, shares = 0.0;
  for (size_t i = 0; i < n; i++) {
    grain += (double)deblur.share[i] * (double)deblur.grain[i];
    shares += (double)deblur.share[i];
  }
  /* The noise and its negative: what it does to second order stays. */
  const double noise = shares / grain / scanner->contrast_to_noise;
  for (int sign = -1; sign <= 1; sign += 2) {
    TRY(windows_make_up(&scan, scanner->blur / scan.unit, scanner->fringe, sign * noise,
                        fmin(scanner->noise_correlation / scan.unit, work.correlation), &made));
    TRY(sum_taken(&made.window[0], surface, &deblur, usual, &expected));
    windows_end(&made);
  }
  const double ratio = 2.0 * seen / expected;
  if (isfinite(ratio)) *smooth = fmin(fmax((ROUGH - ratio) / (ROUGH - SMOOTH), 0.0), 1.0);
cleanup:
  memory_free(&usual);
  deblur_end(&deblur);
  windows_end(&made);
  windows_end(&scan);
  return status;
}
