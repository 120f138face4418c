#include "sphsolve/isph/gauge.h"

#include <math.h>
#include <string.h>

#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/sight.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/isph/constants.h"

/* Solves the n x n system m x = b in place by Gauss elimination with pivoting; false if singular.
 */
static bool solve_small(int n, double m[4][4], double b[4]) {
  for (int c = 0; c < n; c++) {
    int pivot = c;
    for (int r = c + 1; r < n; r++)
      if (fabs(m[r][c]) > fabs(m[pivot][c])) pivot = r;
    if (!(fabs(m[pivot][c]) > 1e-6)) return false;
    for (int k = 0; k < n; k++) {
      double swap = m[c][k];
      m[c][k] = m[pivot][k], m[pivot][k] = swap;
    }
    double swap = b[c];
    b[c] = b[pivot], b[pivot] = swap;
    for (int r = c + 1; r < n; r++) {
      double f = m[r][c] / m[c][c];
      for (int k = c; k < n; k++) m[r][k] -= f * m[c][k];
      b[r] -= f * b[c];
    }
  }
  for (int c = n - 1; c >= 0; c--) {
    for (int k = c + 1; k < n; k++) b[c] -= m[c][k] * b[k];
    b[c] /= m[c][c];
  }
  return true;
}

/* Images of a particle that a gauge uses: the particle itself and, where a closed side is nearer
 * than a support, its reflections, also where the side has wall particles (isph/wall.c). With them
 * the gradient normal to the side is that of water at rest, as it is along a wall (Dv/Dt = 0 normal
 * to it); a fit to the real particles alone would extrapolate beyond the last ones in whatever
 * arrangement they have. */
static int images_at(const struct isph *s, const double point[3], struct isph_image image[8]) {
  int n = 1;
  image[0] = (struct isph_image){.turn = {1, 1, 1}};
  for (int a = 0; a < 3; a++) {
    const double below = point[a] - s->low[a], above = s->high[a] - point[a];
    if (s->periodic[a] || !isph_uses_axis(s, a) || !(fmin(below, above) < s->support_now)) continue;
    for (int k = 0; k < n; k++) {
      image[n + k] = image[k];
      image[n + k].turn[a] = -1;
      image[n + k].shift[a] = 2 * (below < above ? s->low[a] : s->high[a]);
    }
    n *= 2;
  }
  return n;
}

/* Whether a window is in the way of an image of particle i: only a wall reflects. */
static bool is_open(const struct isph *s, size_t i, const struct isph_image *image) {
  for (int a = 0; a < 3 && s->on.open_sides; a++) {
    double behind[3];
    if (!(image->turn[a] < 0)) continue;
    memcpy(behind, s->position[i], sizeof behind);
    behind[a] = image->shift[a] - behind[a];
    if (isph_window_behind(s, behind) >= 0) return true;
  }
  return false;
}

/* r = x - point, to the nearest image along periodic axes. */
static void separation(const struct isph *s, const double x[3], const double point[3],
                       double r[3]) {
  for (int a = 0; a < 3; a++) {
    r[a] = s->dimensions == 2 && a == 1 ? 0 : x[a] - point[a];
    if (s->periodic[a]) {
      const double length = s->high[a] - s->low[a];
      r[a] -= length * round(r[a] / length);
    }
  }
}

/* Separation of the point from an image of particle i, in units of its support. Particles with r <
 * 1 count. */
static double scaled_separation(const struct isph *s, size_t i, const struct isph_image *image,
                                const double point[3], double r[3]) {
  double square = 0, x[3];
  for (int a = 0; a < 3; a++)
    x[a] = image->turn[a] < 0 ? image->shift[a] - s->position[i][a] : s->position[i][a];
  separation(s, x, point, r);
  for (int a = 0; a < 3; a++) r[a] /= s->support[i], square += r[a] * r[a];
  return sqrt(square);
}

/* Largest variance of a fitted value over that of the values fitted, above which the fit is an
 * extrapolation beyond the water: 4 to 12 at a face of the water, 11 to 35 in a corner in three
 * dimensions (lattices of all kernels and supports of 2.4 to 3 spacings), 56 to 5000 over the row
 * of particles of a tip. */
#define FIT_BEYOND 40

/* Whether a wall hides the image at r, in units of its support, of particle i from a point. */
static bool is_hidden(const struct isph *s, const struct isph_screens *screens, size_t i,
                      const double point[3], const double r[3]) {
  const double reach = s->support[i];
  double x[3];
  for (int a = 0; a < 3; a++) x[a] = point[a] + reach * r[a];
  return isph_is_hidden(s, screens, point, x, reach, 0);
}

/* Pressure and velocity by moving least squares, exact for linear fields; 0 where there is no
 * water, or only to one side and thinner than it is far away. */
static void fit(const struct isph *s, const double point[3], double value[4]) {
  enum { VALUES = 4, RIGHT = 16, WEIGHT = RIGHT + 4 * VALUES, FILLED, COUNT };
  _Static_assert(COUNT <= SUMS, "a gauge's sums");
  double total[COUNT];
  const int axis[3] = {0, s->dimensions == 3 ? 1 : 2, 2}, n = s->dimensions == 3 ? 4 : 3;
  struct isph_image image[8];
  const int images = images_at(s, point, image);
  struct isph_screens screens; /* where there are too many for it, the lists of neighbours fail */
  isph_screens_find(s, point, point, s->support_now, &screens);
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[COUNT] = {0};
    const size_t first = s->chunks[c].begin, whole = s->chunks[c].end - first;
    for (size_t k = 0; k < whole * (size_t)images; k++) {
      const size_t i = first + k / (size_t)images;
      const struct isph_image *of = &image[k % (size_t)images];
      double r[3], w, slope, length = scaled_separation(s, i, of, point, r);
      if (length >= 1 || is_open(s, i, of) || is_hidden(s, &screens, i, point, r)) continue;
      isph_kernel(s->scene->isph.kernel, s->dimensions, length, 1, &w, &slope);
      const double *v = s->velocity[i], *x = s->position[i];
      double basis[4] = {1}, values[VALUES] = {s->pressure[i], v[0], v[1], v[2]};
      /* of one length for all, also where the supports of soils differ */
      for (int a = 0; a < 3; a++) basis[a + 1] = r[axis[a]] * s->support[i] / s->support_now;
      for (int a = 0; a < 3; a++) { /* values of the reflected particle: isph/reflection.h */
        if (!(of->turn[a] < 0)) continue;
        values[0] += s->density * s->force[a] * (of->shift[a] - 2 * x[a]);
        values[a + 1] = -v[a];
      }
      for (int p = 0; p < n; p++) {
        for (int f = 0; f < VALUES; f++) sum[RIGHT + 4 * f + p] += w * basis[p] * values[f];
        for (int q = 0; q < n; q++) sum[4 * p + q] += w * basis[p] * basis[q];
      }
      sum[WEIGHT] += w;
      sum[FILLED] += w * s->volume[i] / pow(s->support[i], s->dimensions);
    }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, COUNT, total);
  double m[4][4], share[4] = {1};
  memset(value, 0, VALUES * sizeof *value);
  if (total[FILLED] < GAUGE_WATER) return;
  for (int p = 0; p < 4; p++)
    for (int q = 0; q < 4; q++) m[p][q] = total[4 * p + q] / total[WEIGHT];
  /* singular: takes the mean */
  if (!solve_small(n, m, share)) memcpy(share, (double[4]){1}, sizeof share);
  for (int f = 0; f < VALUES && share[0] < FIT_BEYOND; f++)
    for (int p = 0; p < n; p++) value[f] += share[p] * total[RIGHT + 4 * f + p] / total[WEIGHT];
}

bool isph_has_head(const struct isph *s) {
  const double *g = s->scene->gravity;
  return g[0] != 0 || g[1] != 0 || g[2] != 0;
}

#define LEVELS SUMS /* places at which the kernel sum for a level is found */

/* Whether an image is that of the water under a lid of the domain. */
static bool is_lid(const struct isph_image *image, const double at[3], const double up[3]) {
  bool lid = false;
  for (int a = 0; a < 3; a++)
    lid = lid || (image->turn[a] < 0 && up[a] * (0.5 * image->shift[a] - at[a]) > 0);
  return lid;
}

/* Whether the point at that height over the gauge lies at the underside of a wall, or in one. */
static bool is_covered(const struct isph *s, const double point[3], const double up[3],
                       double height) {
  double at = 0, x[3];
  for (int a = 0; a < 3; a++) at += point[a] * up[a];
  for (int a = 0; a < 3; a++) x[a] = point[a] + (height + s->spacing - at) * up[a];
  for (size_t b = 0; b < s->wall_box_count; b++) {
    const struct isph_wall_box *box = &s->wall_boxes[b];
    bool in = true;
    for (int a = 0; a < 3; a++)
      in = in && ((s->dimensions == 2 && a == 1) || (x[a] >= box->low[a] && x[a] <= box->high[a]));
    if (in && !box->tank) return true;
  }
  return false;
}

/* Height of the top of particle i if its distance from the vertical through the gauge is within
 * LEVEL_REACH of its size, and it is no spray; else -INFINITY. */
static double top_of(const struct isph *s, size_t i, const double point[3], const double up[3]) {
  double r[3], along = 0, square = 0, height = 0, size = pow(s->volume[i], 1.0 / s->dimensions);
  separation(s, s->position[i], point, r);
  for (int a = 0; a < 3; a++)
    along += r[a] * up[a], square += r[a] * r[a], height += s->position[i][a] * up[a];
  const bool counts =
      square - along * along <= pow(LEVEL_REACH * size, 2) && s->kernel_sum[i] >= LEVEL_KERNEL_SUM;
  return counts ? height + 0.5 * size : -INFINITY;
}

/* The largest of these, and the support of the particle that has it. */
static double highest_top(const struct isph *s, const double point[3], const double up[3],
                          double *support) {
  double most = -INFINITY, found = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      most = fmax(most, top_of(s, i, point, up));
  most = ranks_max(most);
#pragma omp parallel for schedule(static) reduction(max : found)
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      if (top_of(s, i, point, up) >= most) found = fmax(found, s->support[i]);
  *support = ranks_max(found);
  return most;
}

/* Adds V W of a particle at r from the highest place to the sums at all LEVELS places, `step` below
 * each other along -up. A wall counts as water where it is below the place. */
static void add_to_levels(const struct isph *s, const double r[3], double support, double volume,
                          const double up[3], double step, bool wall, double sum[LEVELS]) {
  double along = 0, square = 0;
  for (int a = 0; a < 3; a++) along += r[a] * up[a], square += r[a] * r[a];
  const double across = square - along * along, half = 0.5 * pow(volume, 1.0 / s->dimensions);
  if (across >= support * support) return;
  for (int k = 0; k < LEVELS; k++) {
    const double above = along + k * step, length = sqrt(across + above * above);
    double w, slope, part = 1;
    if (length >= support) continue;
    isph_kernel(s->scene->isph.kernel, s->dimensions, length, support, &w, &slope);
    if (wall) part = fmax(0, fmin(1, 0.5 - 0.5 * above / half));
    sum[k] += part * volume * w;
  }
}

/* Height of the water above or below the gauge, against gravity: where the kernel sum of the water
 * is 1/2, as on the face of a half-space, with the support of its highest particle. NAN if there is
 * no water, or if it ends at the underside of a wall; the top of the highest particle where the sum
 * is below 1/2 everywhere, as in a sheet one particle thick. */
static double level_at(const struct isph *s, const double point[3], const double up[3]) {
  double highest[3], total[LEVELS], height = 0, support;
  const double top = highest_top(s, point, up, &support);
  if (!isfinite(top) || is_covered(s, point, up, top)) return NAN;
  const double begin = top + LEVEL_ABOVE * support, step = LEVEL_RANGE * support / (LEVELS - 1);
  for (int a = 0; a < 3; a++) height += point[a] * up[a];
  for (int a = 0; a < 3; a++) highest[a] = point[a] + (begin - height) * up[a];
  struct isph_image image[8];
  const int images = images_at(s, highest, image);
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[LEVELS] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      for (int k = 0; k < images; k++) {
        double r[3];
        if (is_lid(&image[k], highest, up) || is_open(s, i, &image[k])) continue;
        scaled_separation(s, i, &image[k], highest, r);
        for (int a = 0; a < 3; a++) r[a] *= s->support[i];
        add_to_levels(s, r, support, s->volume[i], up, step, false, sum);
      }
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, LEVELS, total);
  for (size_t j = 0; j < s->boundary_count; j++) {
    double r[3];
    if (s->boundary_kind[j] == BOUNDARY_WALL && s->wall_boxes[s->boundary_box[j]].tank) continue;
    separation(s, s->boundary_position[j], highest, r);
    add_to_levels(s, r, support, isph_wall_volume(s, j), up, step, true, total);
  }
  for (int k = 1; k < LEVELS; k++)
    if (total[k] >= 0.5 && total[k - 1] < 0.5)
      return begin - step * (k - (total[k] - 0.5) / (total[k] - total[k - 1]));
  return top;
}

size_t isph_read_gauge(const struct isph *s, const double point[3], double *number) {
  const double *g = s->scene->gravity, strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  size_t n = 4;
  double up[3], height = 0;
  fit(s, point, number);
  if (!isph_has_head(s)) return n;
  for (int a = 0; a < 3; a++) up[a] = -g[a] / strength, height += up[a] * point[a];
  number[n++] = height + number[0] / (s->density * strength);
  if (s->on.surface) number[n++] = level_at(s, point, up);
  return n;
}
