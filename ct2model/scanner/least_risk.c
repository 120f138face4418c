#include "ct2model/scanner/least_risk.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/scanner/constants.h"

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
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
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
  const double up = risk[least + 1] - risk[least], down = risk[least - 1] - risk[least];
  return least + 0.5 * (down - up) / (down + up);
}

enum status least_risk_find(struct windows *scan, double noise, double length,
                            struct deblur *deblur, double *cost) {
  enum status status = STATUS_OK;
  struct window *piece = &scan->window[0];
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  struct windows simulated = {0};
  double risk[COSTS], misfit;
  float *explained = NULL, *perturbed = NULL;
  TRY(memory_allocate(&explained, n, sizeof *explained, "a piece of the scan"));
  TRY(memory_allocate(&perturbed, n, sizeof *perturbed, "a piece of the scan"));
  for (size_t i = 0; i < n; i++)
    piece->distance[i] = 1.0F; /* all pore: the simulated scan is noise
                                  alone */
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
