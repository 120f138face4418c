#include "ct2model/scanner/few_surfaces.h"

#include <math.h>
#include <string.h>

#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/edge_response.h"
#include "ct2model/scanner/windows.h"

/* The delete-one jackknife (Tukey 1958, Ann. Math. Stat. 29: 614) over the octants of the region.
 * With b_i the blur fitted without octant i, and b the mean of these,
 *
 *    s^2 = (n - 1) / n sum (b_i - b)^2.
 *
 * Overlapping windows show a surface twice, but in the same octant. */
enum { OCTANTS = 8 };
static void add_octants(const struct windows *all, double reach,
                        struct edge_response octant[OCTANTS]) {
  memset(octant, 0, OCTANTS * sizeof *octant);
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    size_t middle[3];
    for (int d = 0; d < 3; d++) {
      const size_t half = all->region->size[d] / 2;
      middle[d] = half > w->first[d] ? half - w->first[d] : 0;
    }
    edge_response_add(w->grey, w->smooth, w->distance, w->size, all->stretch, reach, middle,
                      octant);
  }
}

static double voxels_in(const struct edge_response *response) {
  double n = 0.0;
  for (size_t b = 0; b < EDGE_BINS; b++) n += response->count[b];
  return n;
}

double few_surfaces_error(const struct windows *all, double reach) {
  struct edge_response octant[OCTANTS];
  double sum = 0.0, square = 0.0, n = 0.0;
  add_octants(all, reach, octant);
  for (int left_out = 0; left_out < OCTANTS; left_out++) {
    struct edge_response rest = {0};
    struct edge_fit fit;
    if (!(voxels_in(&octant[left_out]) > 0.0)) continue;
    for (int i = 0; i < OCTANTS; i++)
      for (size_t b = 0; i != left_out && b < EDGE_BINS; b++) {
        rest.sum[b] += octant[i].sum[b];
        rest.count[b] += octant[i].count[b];
      }
    if (!edge_fit_find(&rest, reach, NAN, &fit)) return BLUR_ERROR_UNKNOWN;
    sum += edge_fit_blur(&fit);
    square += edge_fit_blur(&fit) * edge_fit_blur(&fit);
    n += 1.0;
  }
  if (n < 2.0) return BLUR_ERROR_UNKNOWN;
  const double mean = sum / n;
  return sqrt((n - 1.0) * fmax(square / n - mean * mean, 0.0)) / mean;
}
