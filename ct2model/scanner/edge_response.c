#include "ct2model/scanner/edge_response.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/surface/specks.h"
#include "ct2model/surface/surfels.h"

double edge_bin_distance(size_t bin) {
  return ((double)bin + 0.5) / EDGE_FINE - EDGE_REACH;
}

/* ---- fit ---- */

/* The non-empty bins within reach: distance, number of voxels and mean grey of each. */
struct filled {
  size_t count;
  double distance[EDGE_BINS], n[EDGE_BINS], mean[EDGE_BINS];
};

static void find_filled(const struct edge_response *response, double reach, struct filled *filled) {
  filled->count = 0;
  for (size_t i = 0; i < EDGE_BINS; i++) {
    if (fabs(edge_bin_distance(i)) > reach || response->count[i] < 1.0) continue;
    filled->distance[filled->count] = edge_bin_distance(i);
    filled->n[filled->count] = response->count[i];
    filled->mean[filled->count++] = response->sum[i] / response->count[i];
  }
}

/* Fits a + b u + c v to the bins by least squares, where u is the step response and v the fringe
 * response. A finite `fringe` fixes c at b * fringe. Returns the sum of squared residuals. */
static double fit_linear(const struct filled *filled, double deviation, double shift, double fringe,
                         double out[3]) {
  const bool fringe_fixed = isfinite(fringe);
  const int unknowns = fringe_fixed ? 2 : 3;
  double m[3][4] = {{0}}, residual = 0.0, step[EDGE_BINS], bell[EDGE_BINS];
  for (size_t i = 0; i < filled->count; i++) {
    const double t = (filled->distance[i] - shift) / deviation, n = filled->n[i];
    step[i] = erfc(t / sqrt(2.0));
    bell[i] = exp(-0.5 * t * t);
    double row[4] = {1.0, 0.5 * step[i], -t * bell[i] / sqrt(2.0 * M_PI), filled->mean[i]};
    if (fringe_fixed) row[1] += fringe * row[2];
    for (int a = 0; a < unknowns; a++)
      for (int b = 0; b < 4; b++) m[a][b] += n * row[a] * row[b];
  }
  for (int p = 0; p < unknowns; p++) { /* positive definite: no pivots needed */
    if (!(m[p][p] > 0.0)) return INFINITY;
    for (int a = 0; a < unknowns; a++) {
      if (a == p) continue;
      const double factor = m[a][p] / m[p][p];
      for (int b = p; b < 4; b++) m[a][b] -= factor * m[p][b];
    }
  }
  for (int p = 0; p < unknowns; p++) out[p] = m[p][3] / m[p][p];
  if (fringe_fixed) out[2] = fringe * out[1];
  for (size_t i = 0; i < filled->count; i++) {
    const double t = (filled->distance[i] - shift) / deviation;
    residual += filled->n[i] * pow(out[0] + out[1] * 0.5 * step[i] -
                                       out[2] * t * bell[i] / sqrt(2.0 * M_PI) - filled->mean[i],
                                   2.0);
  }
  return residual;
}

bool edge_fit_find(const struct edge_response *response, double reach, double fringe,
                   struct edge_fit *fit) {
  double count = 0.0, least = INFINITY, deviation = 0.0, shift = 0.0, linear[3] = {0};
  struct filled filled;
  *fit = (struct edge_fit){.deviation = NAN};
  find_filled(response, reach, &filled);
  for (size_t i = 0; i < filled.count; i++) count += filled.n[i];
  if (count < EDGE_VOXELS || filled.count < EDGE_BINS_LEAST) return false;
  double deviations[2] = {0.3, fmin(reach, 5.0)}, shifts[2] = {-0.6, 0.6};
  for (int round = 0; round < 5; round++) {
    double best[2] = {deviation, shift};
    for (int i = 0; i <= 20; i++)
      for (int j = 0; j <= 12; j++) {
        const double s = deviations[0] * pow(deviations[1] / deviations[0], i / 20.0);
        const double d = shifts[0] + (shifts[1] - shifts[0]) * j / 12.0;
        double found[3] = {0};
        const double residual = fit_linear(&filled, s, d, fringe, found);
        if (!(residual < least) || !(found[1] > 0.0) || !(found[2] > -0.3 * found[1])) continue;
        least = residual;
        best[0] = s;
        best[1] = d;
        memcpy(linear, found, sizeof linear);
      }
    if (!isfinite(least)) return false;
    deviation = best[0];
    shift = best[1];
    const double step = pow(deviations[1] / deviations[0], 1.0 / 10.0),
                 shift_step = (shifts[1] - shifts[0]) / 6.0;
    deviations[0] = deviation / step;
    deviations[1] = deviation * step;
    shifts[0] = shift - shift_step;
    shifts[1] = shift + shift_step;
  }
  *fit = (struct edge_fit){.deviation = deviation,
                           .fringe = linear[2] / linear[1],
                           .pore = linear[0],
                           .grain = linear[0] + linear[1],
                           .shift = shift,
                           .residual = sqrt(least / count)};
  return true;
}

/* Variance, in voxels^2, that the widths of the voxel and of the bins add to that of the blur. */
static const double WIDTH_VARIANCE = (1.0 + 1.0 / (EDGE_FINE * EDGE_FINE)) / 12.0;

double edge_fit_blur(const struct edge_fit *fit) {
  return sqrt(fmax(fit->deviation * fit->deviation - WIDTH_VARIANCE, 0.01));
}

double edge_fit_deviation(double blur) {
  return hypot(blur, sqrt(WIDTH_VARIANCE));
}

double edge_fit_transfer(const struct edge_fit *fit, double frequency) {
  const double x = pow(2.0 * M_PI * frequency * fit->deviation, 2.0);
  return exp(-0.5 * x) * (1.0 + fit->fringe * x);
}

/* ---- surfaces ---- */

enum status edge_distances(const float *smooth, const size_t size[3], const double stretch[3],
                           double limit, float *distance) {
  enum status status = STATUS_OK;
  const size_t nx = size[0], rows = size[1] * size[2], words = phase_words(nx);
  int16_t *field = NULL;
  uint64_t *bits = NULL;
  struct surfels surfels = {0};
  TRY(memory_allocate(&field, nx * rows, sizeof *field, "a window of the scan"));
  TRY(memory_allocate(&bits, rows * words, sizeof *bits, "a window of the scan"));
  for (size_t i = 0; i < nx * rows; i++) {
    const float value = fminf(fmaxf((smooth[i] - 0.5f) * 8192.0f, -32767.0f), 32767.0f);
    field[i] = (int16_t)(value > 0.0f ? (int)value + 1 : (int)value - 1);
  }
  for (size_t row = 0; row < rows; row++) phase_row(field + row * nx, nx, bits + row * words);
  TRY(surfels_build(field, bits, size, stretch, &surfels));
  const size_t strips = (size[1] + SURFELS_SIDE - 1) / SURFELS_SIDE;
  const double voxel[3] = {1.0, 1.0, 1.0};
#pragma omp parallel for schedule(dynamic)
  for (size_t strip = 0; strip < strips * size[2]; strip++) {
    size_t near = SURFELS_NOWHERE, at[3] = {0, strip % strips * SURFELS_SIDE, strip / strips};
    double last[SURFELS_SIDE] = {limit, limit, limit, limit};
    for (; at[0] < nx; at[0] += SURFELS_SIDE) {
      struct surfel_points points;
      surfel_points_place(at, size, voxel, stretch, limit, &points);
      surfels_distances(&surfels, &points, &near);
      surfel_points_bound(stretch[0], limit, last, &points);
      for (size_t p = 0; p < SURFELS_POINTS; p++) {
        const size_t x = at[0] + p % SURFELS_SIDE, y = at[1] + p / SURFELS_SIDE;
        const size_t i = (at[2] * size[1] + y) * nx + x;
        if (x < nx && y < size[1])
          distance[i] = (float)(field[i] > 0 ? -points.distance[p] : points.distance[p]);
      }
    }
  }
cleanup:
  surfels_end(&surfels);
  MEMORY_FREE(&field, &bits);
  return status;
}

/* The gradient of a voxel within reach needs the distances of its neighbours. */
double edge_response_limit(double reach, const double stretch[3]) {
  return reach + fmin(1.001 * fmax(stretch[0], fmax(stretch[1], stretch[2])), 2.0);
}

/* The voxel that contains a point, given in voxel coordinates; false outside the window. */
static bool voxel_at(const double point[3], const size_t size[3], size_t *voxel) {
  size_t at[3];
  for (int d = 0; d < 3; d++) {
    if (!(point[d] > -0.5) || !(point[d] < (double)size[d] - 0.5)) return false;
    at[d] = (size_t)(point[d] + 0.5);
  }
  *voxel = (at[2] * size[1] + at[1]) * size[0] + at[0];
  return true;
}

void edge_response_add(const float *grey, const float *smooth, const float *distance,
                       const size_t size[3], const double stretch[3], double reach,
                       const size_t middle[3], struct edge_response response[]) {
  const size_t step[3] = {1, size[0], size[0] * size[1]};
  for (size_t i = 0; i < step[2] * size[2]; i++) {
    const size_t at[3] = {i % size[0], i / size[0] % size[1], i / step[2]};
    const double d = (double)distance[i];
    double normal[3] = {0}, length = 0.0, ends[2][3];
    size_t pore, grain;
    if (!(fabs(d) < reach)) continue;
    for (int a = 0; a < 3; a++) {
      if (size[a] == 1) continue;
      if (at[a] == 0 || at[a] + 1 == size[a]) goto next;
      normal[a] =
          0.5 * ((double)distance[i + step[a]] - (double)distance[i - step[a]]) / stretch[a];
      length += normal[a] * normal[a];
    }
    length = sqrt(length);
    if (!(length > EDGE_NORMAL)) continue; /* between two surfaces */
    for (int a = 0; a < 3; a++)
      for (int side = 0; side < 2; side++)
        ends[side][a] =
            (double)at[a] + normal[a] / length * ((side ? -reach : reach) - d) / stretch[a];
    if (!voxel_at(ends[0], size, &pore) || !voxel_at(ends[1], size, &grain)) continue;
    const double clear = EDGE_CLEAR * reach - 0.5;
    if ((double)distance[pore] < clear || (double)distance[grain] > -clear) continue;
    if (smooth[grain] > (float)EDGE_GRAIN_MOST || smooth[grain] < (float)EDGE_GRAIN_LEAST ||
        smooth[pore] > (float)EDGE_PORE_MOST)
      continue;
    const double bin = (d + EDGE_REACH) * EDGE_FINE;
    if (bin >= 0.0 && bin < EDGE_BINS) {
      size_t octant = 0;
      for (int a = 0; middle != NULL && a < 3; a++) octant |= (size_t)(at[a] >= middle[a]) << a;
      response[octant].sum[(size_t)bin] += (double)grey[i];
      response[octant].count[(size_t)bin] += 1.0;
    }
  next:;
  }
}
