#include "ct2model/scanner/fringe.h"

#include <math.h>
#include <stdbool.h>

/* A blur of variance V with a fringe f has the transfer exp(-x / 2) (1 + f x), x = q^2 V, of
 * logarithm -(1 - 2 f) x / 2 - f^2 x^2 / 2 ...: a narrower one of variance (1 - 2 f) V without a
 * fringe, but for f^2. At f = 0 the fit of the two is singular, and what neighbours, curvature and
 * noise do to the response, which is more than f^2, decides on 0. They do the same to a scan made
 * up of the same grains: so each fringe is tried with the blur that it needs, from 0 on, until
 * responses are less alike again. */
enum { TRIALS = 8 };
static const double STEP = 0.1;
/* A fringe that lessens the misfit by no more than that much of it is chance. */
static const double CHANCE = 0.05;
/* Voxels: surfaces of both scans may lie apart by up to SHIFTS times that. */
enum { SHIFTS = 30 };
static const double SHIFT = 0.02;

/* A fringe with the blur that it needs; how alike the responses are. */
struct trial {
  double fringe, blur, misfit, pore, grain;
};

/* Least squares between the response seen and pore + (grain - pore) times that made up, shifted. */
static void compare(const struct edge_response *seen, const struct edge_response *made,
                    double reach, struct trial *trial) {
  trial->misfit = INFINITY;
  for (int i = -SHIFTS; i <= SHIFTS; i++) {
    double n = 0.0, x = 0.0, y = 0.0, xx = 0.0, xy = 0.0, yy = 0.0;
    for (size_t b = 0; b < EDGE_BINS; b++) {
      const double at = (double)b - i * SHIFT * EDGE_FINE, low = floor(at), part = at - low;
      if (fabs(edge_bin_distance(b)) > reach || low < 0.0 || low + 1.0 >= EDGE_BINS) continue;
      const size_t l = (size_t)low, h = l + 1;
      const double count = seen->count[b];
      if (count < 1.0 || made->count[l] < 1.0 || made->count[h] < 1.0) continue;
      const double here = seen->sum[b] / count, its = (1.0 - part) * made->sum[l] / made->count[l] +
                                                      part * made->sum[h] / made->count[h];
      n += count, x += count * its, y += count * here;
      xx += count * its * its, xy += count * its * here, yy += count * here * here;
    }
    const double slope = (xy - x * y / n) / (xx - x * x / n);
    const double left = yy - y * y / n - slope * (xy - x * y / n);
    if (!(left < trial->misfit)) continue;
    trial->misfit = left;
    trial->pore = (y - slope * x) / n;
    trial->grain = trial->pore + slope;
  }
}

/* The scan made up twice, with noise and with its negative: what noise does to second order stays.
 * False where there is too little to fit. */
static enum status try_fringe(const struct windows *scan, const struct edge_response *seen,
                              const struct fringe_request *request, double *ratio,
                              struct trial *trial, bool *found) {
  enum status status = STATUS_OK;
  struct edge_response response = {0};
  struct windows made = {0};
  struct edge_fit fit, its;
  *found = edge_fit_find(seen, request->reach, trial->fringe, &fit);
  if (!*found) return STATUS_OK;
  for (int sign = -1; sign <= 1; sign += 2) {
    TRY(windows_make_up(scan, *ratio * edge_fit_blur(&fit), trial->fringe, sign * request->noise,
                        request->length, &made));
    TRY(windows_find_surfaces(&made, request->contrast_to_noise,
                              edge_response_limit(request->reach, scan->stretch)));
    for (size_t i = 0; i < made.count; i++) {
      const struct window *w = &made.window[i];
      edge_response_add(w->grey, w->smooth, w->distance, w->size, made.stretch, request->reach,
                        NULL, &response);
    }
    windows_end(&made);
  }
  *found = edge_fit_find(&response, request->reach, trial->fringe, &its);
  if (!*found) goto cleanup;
  *ratio *= edge_fit_blur(&fit) / edge_fit_blur(&its);
  trial->blur = *ratio * edge_fit_blur(&fit);
  compare(seen, &response, request->reach, trial);
cleanup:
  windows_end(&made);
  return status;
}

/* The middle of the parabola through three trials a STEP apart. */
static double least_between(const struct trial three[3]) {
  const double up = three[2].misfit - three[1].misfit, down = three[0].misfit - three[1].misfit;
  return three[1].fringe + 0.5 * STEP * (down - up) / (down + up);
}

enum status fringe_find(const struct windows *scan, const struct edge_response *seen,
                        const struct fringe_request *request, double ratio, struct edge_fit *fit) {
  enum status status = STATUS_OK;
  struct trial none = {0}, last = {0}, best, next = {0};
  bool found;
  /* Twice, as the ratio may be far off. */
  TRY(try_fringe(scan, seen, request, &ratio, &none, &found));
  if (found) TRY(try_fringe(scan, seen, request, &ratio, &none, &found));
  if (!found) return STATUS_OK;
  best = none;
  for (int i = 1; i < TRIALS; i++) {
    next = (struct trial){.fringe = i * STEP};
    TRY(try_fringe(scan, seen, request, &ratio, &next, &found));
    if (!found) return STATUS_OK;
    if (!(next.misfit < best.misfit)) break;
    last = best;
    best = next;
  }
  if (!(best.misfit < (1.0 - CHANCE) * none.misfit)) {
    best = none;
  } else if (next.misfit > best.misfit) {
    best = (struct trial){.fringe = least_between((struct trial[]){last, best, next})};
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
