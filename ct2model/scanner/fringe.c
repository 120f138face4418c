#include "ct2model/scanner/fringe.h"

#include <math.h>
#include <stdbool.h>

#include "ct2model/scanner/constants.h"

/* A blur of variance V with a fringe f has the transfer exp(-x / 2) (1 + f x), x = q^2 V, of
 * logarithm -(1 - 2 f) x / 2 - f^2 x^2 / 2 ...: up to terms in f^2 it equals a narrower blur of
 * variance (1 - 2 f) V without a fringe. So at f = 0 the joint fit of both is singular:
 * neighbouring surfaces, curvature and noise affect the response by more than f^2 and decide the
 * result. They affect a scan simulated from the same grains in the same way. Each fringe, in steps
 * from 0, is therefore simulated with the blur that it requires, until the responses of scan and
 * simulation agree less well again. */
/* A fringe, the blur that it requires, and the misfit between the responses of scan and simulation,
 * with the greys of pore and grain that minimise it. */
struct trial {
  double fringe, blur, misfit, pore, grain;
};

/* Fits pore + (grain - pore) * (simulated response, shifted) to the measured response by least
 * squares, over all shifts. */
static void compare(const struct edge_response *seen, const struct edge_response *simulated,
                    double reach, struct trial *trial) {
  trial->misfit = INFINITY;
  for (int i = -SHIFTS; i <= SHIFTS; i++) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (size_t b = 0; b < EDGE_BINS; b++) {
      const double at = (double)b - i * SHIFT * EDGE_FINE, low = floor(at), fraction = at - low;
      if (fabs(edge_bin_distance(b)) > reach || low < 0.0 || low + 1.0 >= EDGE_BINS) continue;
      const size_t l = (size_t)low, h = l + 1;
      const double count = seen->count[b];
      if (count < 1.0 || simulated->count[l] < 1.0 || simulated->count[h] < 1.0) continue;
      const double measured = seen->sum[b] / count,
                   model = (1.0 - fraction) * simulated->sum[l] / simulated->count[l] +
                           fraction * simulated->sum[h] / simulated->count[h];
      n += count, x += count * model, y += count * measured;
      xx += count * model * model, xy += count * model * measured,
          yy += count * measured * measured;
    }
    const double slope = (xy - x * y / n) / (xx - x * x / n);
    const double residual = yy - y * y / n - slope * (xy - x * y / n);
    if (!(residual < trial->misfit)) continue;
    trial->misfit = residual;
    trial->pore = (y - slope * x) / n;
    trial->grain = trial->pore + slope;
  }
}

/* Simulates the scan with a trial fringe and the blur that it requires. This is done twice, with
 * noise and with its negative, so that effects of noise to first order cancel and those to second
 * order remain. `ratio`: true blur over apparent blur, which is updated. `found` is false where
 * there are too few data for a fit. */
static enum status try_fringe(const struct windows *scan, const struct edge_response *seen,
                              const struct fringe_request *request, double *ratio,
                              struct trial *trial, bool *found) {
  enum status status = STATUS_OK;
  struct edge_response response = {0};
  struct windows simulated = {0};
  struct edge_fit fit, simulated_fit;
  *found = edge_fit_find(seen, request->reach, trial->fringe, &fit);
  if (!*found) return STATUS_OK;
  for (int sign = -1; sign <= 1; sign += 2) {
    TRY(windows_simulate(scan, *ratio * edge_fit_blur(&fit), trial->fringe, sign * request->noise,
                         request->length, &simulated));
    TRY(windows_find_surfaces(&simulated, request->contrast_to_noise,
                              edge_response_limit(request->reach, scan->stretch)));
    for (size_t i = 0; i < simulated.count; i++) {
      const struct window *w = &simulated.window[i];
      edge_response_add(w->grey, w->smooth, w->distance, w->size, simulated.stretch, request->reach,
                        NULL, &response);
    }
    windows_end(&simulated);
  }
  *found = edge_fit_find(&response, request->reach, trial->fringe, &simulated_fit);
  if (!*found) goto cleanup;
  *ratio *= edge_fit_blur(&fit) / edge_fit_blur(&simulated_fit);
  trial->blur = *ratio * edge_fit_blur(&fit);
  compare(seen, &response, request->reach, trial);
cleanup:
  windows_end(&simulated);
  return status;
}

enum status fringe_find(const struct windows *scan, const struct edge_response *seen,
                        const struct fringe_request *request, double ratio, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  struct trial none = {0}, last = {0}, best, next = {0};
  bool found;
  /* Two rounds, as the ratio may be far off. */
  TRY(try_fringe(scan, seen, request, &ratio, &none, &found));
  if (found) TRY(try_fringe(scan, seen, request, &ratio, &none, &found));
  if (!found) return STATUS_OK;
  best = none;
  for (int i = 1; i < FRINGE_TRIALS; i++) {
    next = (struct trial){.fringe = i * FRINGE_STEP};
    TRY(try_fringe(scan, seen, request, &ratio, &next, &found));
    if (!found) return STATUS_OK;
    if (!(next.misfit < best.misfit)) break;
    last = best;
    best = next;
  }
  if (!(best.misfit < (1.0 - FRINGE_CHANCE) * none.misfit)) {
    best = none;
  } else if (next.misfit > best.misfit) {
    best = (struct trial){
        .fringe =
            best.fringe + FRINGE_STEP * parabola_minimum(last.misfit, best.misfit, next.misfit)};
    TRY(try_fringe(scan, seen, request, &ratio, &best, &found));
    if (!found) return STATUS_OK;
  }
  fit->deviation = edge_fit_deviation(best.blur);
  fit->fringe = best.fringe;
  fit->pore = best.pore;
  fit->grain = best.grain;
cleanup:
  return status;
}
