#include "sphsolve/isph/side_image.h"

#include <math.h>
#include <string.h>

#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/window.h"

/* Whether the side at the low or high end of axis a is closed in front of x. */
static bool is_closed(const struct isph *s, const double x[3], int a, bool high) {
  double behind[3] = {x[0], x[1], x[2]};
  bool windows = false;
  for (size_t k = 0; k < s->side_count; k++)
    windows = windows || (s->sides[k].axis == a && (s->sides[k].inward < 0) == high);
  if (!windows) return true;
  behind[a] = high ? s->high[a] + s->spacing : s->low[a] - s->spacing;
  return isph_window_behind(s, behind) < 0;
}

bool isph_has_side_images(const struct isph *s, size_t i) {
  const double *x = s->position[i], reach = s->support_max;
  for (int a = 0; a < 3 && s->on.soil && !s->on.surface; a++)
    if (isph_uses_axis(s, a) && !s->periodic[a] &&
        (x[a] < s->low[a] + reach || x[a] > s->high[a] - reach))
      return true;
  return false;
}

/* The ways along an axis: straight on, and by each closed side. */
struct ways {
  int count;
  double r[3], plane[3];
};

static void find_ways(const struct isph *s, const double *xi, const double *xj, double straight,
                      double support, int a, struct ways *ways) {
  *ways = (struct ways){.count = 1, .r = {straight}};
  if (!isph_uses_axis(s, a) || s->periodic[a]) return;
  for (int high = 0; high < 2; high++) {
    const double plane = high ? s->high[a] : s->low[a], r = (xi[a] - plane) + (xj[a] - plane);
    if (!(fabs(r) < support) || !is_closed(s, xi, a, high) || !is_closed(s, xj, a, high)) continue;
    ways->r[ways->count] = r, ways->plane[ways->count++] = plane;
  }
}

size_t isph_side_images(const struct isph *s, size_t i, size_t j, const double r[3],
                        struct isph_side_image images[SIDE_IMAGES]) {
  const double support = 0.5 * s->support[i] + 0.5 * s->support[j];
  struct ways ways[3];
  size_t n = 0;
  for (int a = 0; a < 3; a++)
    find_ways(s, s->position[i], s->position[j], r[a], support, a, &ways[a]);
  for (int turn = 1; turn < ways[0].count * ways[1].count * ways[2].count; turn++) {
    const int of[3] = {turn % ways[0].count, turn / ways[0].count % ways[1].count,
                       turn / (ways[0].count * ways[1].count)};
    struct isph_side_image *image = &images[n];
    double square = 0, w;
    for (int a = 0; a < 3; a++) {
      image->r[a] = ways[a].r[of[a]], image->plane[a] = ways[a].plane[of[a]];
      image->turned[a] = of[a] > 0;
      square += image->r[a] * image->r[a];
    }
    if (!(square < support * support)) continue;
    isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(square), support, &w, &image->slope);
    image->slope *= s->kernel_slope, n++;
  }
  return n;
}

double isph_side_slope(const struct isph *s, size_t i, size_t j, const double r[3]) {
  struct isph_side_image images[SIDE_IMAGES];
  const size_t n = isph_side_images(s, i, j, r, images);
  double sum = 0;
  for (size_t k = 0; k < n; k++) sum += images[k].slope;
  return sum;
}
