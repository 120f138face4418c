#include "ct2model/scanner/least_risk.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Stein's unbiased estimate (1981, Ann. Statist. 9: 1135) of the risk |H A u - f|^2,
 * f the scan without its noise, u the restored grains (deblur.c):
 *
 *   |H A u - g|^2 + 2 tr(J C),   J = d(H A u) / dg,
 *
 * g the scan, C the covariance of its noise, but for tr C, which is the same for each cost. The
 * trace is n . J n on average over noise n that is made up, and J n the difference that a little of
 * n makes (Ramani, Blu and Unser 2008, IEEE Trans. Image Process. 17: 1540). */
enum { COSTS = 6 };
static const double COST[COSTS] = {0.25, 0.5, 1.0, 2.0, 4.0, 8.0}; /* each twice the last */
static const double LITTLE = 0.1;

/* H A u of the piece with so much of the noise added, and its misfit to the piece. */
static enum status explain(const struct window *piece, const float *noise, double much,
                           struct deblur *deblur, float *explained, double *misfit) {
  enum status status = STATUS_OK;
  const size_t n = piece->size[0] * piece->size[1] * piece->size[2];
  memcpy(deblur->size, piece->size, sizeof deblur->size);
  for (size_t i = 0; i < n; i++) deblur->grey[i] = piece->grey[i] + (float)much * noise[i];
  TRY(deblur_run(deblur));
  *misfit = deblur_misfit(deblur, piece->grey);
  memcpy(explained, deblur->b, n * sizeof *explained);
cleanup:
  return status;
}

/* Where the parabola through the least and those beside it is least, the middle of three; in steps
 * of the index. */
static double least_of(const double risk[COSTS]) {
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
  struct windows made = {0};
  double risk[COSTS], misfit;
  float *explained = NULL, *more = NULL;
  TRY(memory_allocate(&explained, n, sizeof *explained, "a piece of the scan"));
  TRY(memory_allocate(&more, n, sizeof *more, "a piece of the scan"));
  for (size_t i = 0; i < n; i++) piece->distance[i] = 1.0F; /* all pore: noise alone */
  TRY(windows_make_up(scan, 0.0, 0.0, noise, length, &made));
  const float *made_up = made.window[0].grey;
  for (int i = 0; i < COSTS; i++) {
    double trace = 0.0;
    deblur->scanner.surface = COST[i];
    TRY(explain(piece, made_up, LITTLE, deblur, more, &misfit));
    TRY(explain(piece, made_up, 0.0, deblur, explained, &misfit));
    for (size_t v = 0; v < n; v++)
      trace += (double)made_up[v] * ((double)more[v] - (double)explained[v]) / LITTLE;
    risk[i] = misfit + 2.0 * trace;
  }
  *cost = COST[0] * exp2(least_of(risk));
cleanup:
  memory_free(&explained);
  memory_free(&more);
  windows_end(&made);
  return status;
}
