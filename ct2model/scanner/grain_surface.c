#include "ct2model/scanner/grain_surface.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>

#include "common/variants.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/grains.h"

/* |grad u| is computed as sqrt(|grad u|^2 + ROUNDING^2), which is differentiable at 0. */

/* The rows adjacent to a row; at the ends of the volume the row itself. */
struct rows {
  const float *y_next, *y_last, *z_next, *z_last;
};

/* weight = cost / |grad u|, by forward differences. At a contact u falls to 0 on both sides. */
TARGETS static void find_weights(const float *restrict u, const struct rows *near,
                                 const uint8_t *restrict contact, const float inverse[3],
                                 float cost, size_t n, float *restrict weight) {
  const float *restrict y_next = near->y_next, *restrict z_next = near->z_next;
  for (size_t x = 0; x < n; x++) {
    const unsigned c = contact[x];
    const float next = x + 1 < n ? u[x + 1] : u[x];
    const float dx = (c & GRAINS_NEXT(0) ? 0.0F : next) - u[x];
    const float dy = (c & GRAINS_NEXT(1) ? 0.0F : y_next[x]) - u[x];
    const float dz = (c & GRAINS_NEXT(2) ? 0.0F : z_next[x]) - u[x];
    const float ex = c & GRAINS_LAST(0) ? u[x] : 0.0F;
    const float ey = c & GRAINS_LAST(1) ? u[x] : 0.0F;
    const float ez = c & GRAINS_LAST(2) ? u[x] : 0.0F;
    weight[x] = cost / sqrtf((dx * dx + ex * ex) * inverse[0] + (dy * dy + ey * ey) * inverse[1] +
                             (dz * dz + ez * ez) * inverse[2] + (float)ROUNDING * (float)ROUNDING);
  }
}

/* downhill += the divergence of weight grad u. One loop without special cases at the ends: rows are
 * short, and the remainder of each loop would not be vectorised. */
TARGETS static void add_pull(const float *restrict u, const struct rows *near,
                             const uint8_t *restrict contact, const float *restrict weight,
                             const float *restrict weight_y, const float *restrict weight_z,
                             const float inverse[3], size_t n, float *restrict downhill) {
  const float *restrict y_next = near->y_next, *restrict y_last = near->y_last;
  const float *restrict z_next = near->z_next, *restrict z_last = near->z_last;
  const float along = inverse[0], across = inverse[1], over = inverse[2];
  for (size_t x = 0; x < n; x++) {
    const unsigned c = contact[x];
    const float w = weight[x];
    const float up = w * ((c & GRAINS_NEXT(1) ? 0.0F : y_next[x]) - u[x]);
    const float down = c & GRAINS_LAST(1) ? w * u[x] : weight_y[x] * (u[x] - y_last[x]);
    const float above = w * ((c & GRAINS_NEXT(2) ? 0.0F : z_next[x]) - u[x]);
    const float below = c & GRAINS_LAST(2) ? w * u[x] : weight_z[x] * (u[x] - z_last[x]);
    const float next = x + 1 < n ? u[x + 1] : u[x], last = x > 0 ? u[x - 1] : u[x];
    const float w_last = x > 0 ? weight[x - 1] : w;
    const float right = along * w * ((c & GRAINS_NEXT(0) ? 0.0F : next) - u[x]);
    const float left = c & GRAINS_LAST(0) ? along * w * u[x] : along * w_last * (u[x] - last);
    downhill[x] = downhill[x] + (across * (up - down) + over * (above - below)) - left + right;
  }
}

double grain_surface_stiffness(const struct grain_surface *surface) {
  return 12.0 * surface->cost / (double)(float)ROUNDING;
}

/* Rows of one slice: the weights, or the pull by those of this slice and of the one before. */
static void slice_weights(const struct grain_surface *surface, const float inverse[3],
                          const float *share, size_t z, float *weight) {
  const size_t nx = surface->size[0], ny = surface->size[1], nz = surface->size[2];
  for (size_t y = 0; y < ny; y++) {
    const size_t row = (z * ny + y) * nx;
    const float *at = share + row;
    const struct rows near = {y + 1 < ny ? at + nx : at, NULL, z + 1 < nz ? at + ny * nx : at,
                              NULL};
    find_weights(at, &near, surface->contacts + row, inverse, (float)surface->cost, nx,
                 weight + y * nx);
  }
}

static void slice_pull(const struct grain_surface *surface, const float inverse[3],
                       const float *share, size_t z, const float *weight, const float *weight_z,
                       float *downhill) {
  const size_t nx = surface->size[0], ny = surface->size[1], nz = surface->size[2];
  for (size_t y = 0; y < ny; y++) {
    const size_t row = (z * ny + y) * nx;
    const float *at = share + row, *own = weight + y * nx;
    const struct rows near = {y + 1 < ny ? at + nx : at, y > 0 ? at - nx : at,
                              z + 1 < nz ? at + ny * nx : at, z > 0 ? at - ny * nx : at};
    add_pull(at, &near, surface->contacts + row, own, y > 0 ? own - nx : own, weight_z + y * nx,
             inverse, nx, downhill + row);
  }
}

/* Slice by slice, while the weights are in the cache: each thread has two slices of `work`. */
void grain_surface_pull(const struct grain_surface *surface, const float *share, float *work,
                        float *downhill) {
  const size_t plane = surface->size[0] * surface->size[1], nz = surface->size[2];
  const size_t threads = (size_t)omp_get_max_threads(), most = nz / 2 > 0 ? nz / 2 : 1;
  const size_t parts = threads < most ? threads : most;
  float inverse[3];
  for (int d = 0; d < 3; d++) inverse[d] = (float)(1.0 / pow(surface->stretch[d], 2.0));
#pragma omp parallel for schedule(static) num_threads(parts)
  for (size_t part = 0; part < parts; part++) {
    const size_t first = nz * part / parts, end = nz * (part + 1) / parts;
    float *slices = work + 2 * part * plane;
    if (first > 0)
      slice_weights(surface, inverse, share, first - 1, slices + (first - 1) % 2 * plane);
    for (size_t z = first; z < end; z++) {
      const float *own = slices + z % 2 * plane;
      slice_weights(surface, inverse, share, z, slices + z % 2 * plane);
      slice_pull(surface, inverse, share, z, own, z > 0 ? slices + (z - 1) % 2 * plane : own,
                 downhill);
    }
  }
}
