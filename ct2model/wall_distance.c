#include "ct2model/wall_distance.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/connect.h"
#include "ct2model/resample.h"
#include "ct2model/surfels.h"

enum { BAND_LAYERS = 4 };               /* model voxels from the surface with exact distances */
static const double SLAB_VOXELS = 64e6; /* of the field held at a time */

/* A slab: the field (positive in the grain, 8192 a contrast) of the slices first .. first + depth
 * - 1, counted without wrapping; slice_of says which slice of the region that is. */
struct slab {
  const struct region *region;
  const struct wall_request *request;
  double factor[3], stretch[3], unit; /* unit: m a stretched voxel */
  double band;                        /* stretched voxels */
  long first;
  size_t depth;
  int16_t *field;
};

static size_t slice_of(const struct slab *slab, long z) {
  long n = (long)slab->region->size[2];
  if (slab->request->mirror) return (size_t)(z < 0 ? 0 : z >= n ? n - 1 : z);
  return (size_t)(((z % n) + n) % n);
}

static enum status slab_read(struct slab *slab) {
  enum status status = STATUS_OK;
  float *greys = NULL;
  size_t plane = slab->region->size[0] * slab->region->size[1];
  size_t batch = region_batch(slab->region);
  double scale = 8192.0 / slab->request->contrast;
  TRY(memory_allocate(&greys, batch * plane, sizeof *greys, "slices"));
  for (size_t z = 0; z < slab->depth; z += batch) {
    size_t n = slab->depth - z < batch ? slab->depth - z : batch, numbers[64];
    for (size_t i = 0; i < n; i++) numbers[i] = slice_of(slab, slab->first + (long)(z + i));
    TRY(region_read(slab->region, numbers, n, greys));
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < n * plane; i++) {
      double value = ((double)greys[i] - slab->request->threshold) * scale;
      /* Away from zero, so that the sign is that of the grey against the threshold. */
      value = value > 0.0 ? fmin(ceil(value), 32767.0) : fmax(floor(value), -32767.0);
      slab->field[z * plane + i] = (int16_t)value;
    }
  }
cleanup:
  memory_free(&greys);
  return status;
}

static bool is_speck(const struct part *part, const void *context) {
  return part->voxels < *(const size_t *)context && !part->at_border;
}

/* Islands far smaller than a model voxel are noise to the model and would spoil the distances
 * around them: they take the phase around them. */
static enum status slab_remove_specks(struct slab *slab, size_t *specks) {
  enum status status = STATUS_OK;
  uint8_t *grain = NULL;
  struct parts parts = {0};
  const size_t size[3] = {slab->region->size[0], slab->region->size[1], slab->depth};
  const bool periodic[3] = {true, true, false};
  size_t voxels = size[0] * size[1] * size[2];
  size_t limit = (size_t)fmin(64.0, slab->factor[0] * slab->factor[1] * slab->factor[2] / 8.0);
  if (limit < 2) return STATUS_OK;
  TRY(memory_allocate(&grain, voxels, 1, "grain voxels"));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < voxels; i++) grain[i] = slab->field[i] > 0;
  size_t changed = 0;
  for (uint8_t phase = 0; phase < 2; phase++) {
    TRY(parts_find(grain, size, periodic, phase, &parts));
    changed += parts_paint(&parts, is_speck, &limit, phase == 0, grain);
    parts_end(&parts);
  }
  *specks += changed;
  if (changed == 0) goto cleanup;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < voxels; i++) {
    if ((slab->field[i] > 0) != (grain[i] != 0))
      slab->field[i] = (int16_t)(slab->field[i] == 0 ? 1 : -slab->field[i]);
  }
cleanup:
  parts_end(&parts);
  memory_free(&grain);
  return status;
}

/* Grain share of a voxel cut by the plane that its grey gradient says; 0 or 1 where no
 * neighbour is of the other phase. */
static float voxel_fraction(const struct slab *slab, size_t x, size_t y, size_t z) {
  size_t nx = slab->region->size[0], ny = slab->region->size[1], plane = nx * ny;
  const int16_t *at = slab->field + z * plane;
  const int16_t *up = z + 1 < slab->depth ? at + plane : at, *down = z > 0 ? at - plane : at;
  size_t here = y * nx + x;
  int16_t value = at[here];
  int16_t around[6] = {at[y * nx + (x + 1) % nx],
                       at[y * nx + (x + nx - 1) % nx],
                       at[(y + 1) % ny * nx + x],
                       at[(y + ny - 1) % ny * nx + x],
                       up[here],
                       down[here]};
  bool cut = false;
  double slope = 0.0;
  for (int d = 0; d < 3; d++) {
    cut |= (around[2 * d] > 0) != (value > 0) || (around[2 * d + 1] > 0) != (value > 0);
    slope += 0.5 * fabs((double)around[2 * d] - (double)around[2 * d + 1]);
  }
  if (!cut || slope == 0.0) return value > 0 ? 1.0f : 0.0f;
  return (float)fmin(1.0, fmax(0.0, 0.5 + (double)value / slope));
}

/* Grain fraction and surface area of the slices z0 <= z < z1 of the region. */
static enum status slab_fractions(const struct slab *slab, size_t z0, size_t z1,
                                  struct resampler *area, struct wall_result *result) {
  enum status status = STATUS_OK;
  float *shares = NULL;
  size_t nx = slab->region->size[0], ny = slab->region->size[1], plane = nx * ny;
  const double *voxel = slab->region->voxel;
  size_t changes[3] = {0, 0, 0};
  TRY(memory_allocate(&shares, area->batch * plane, sizeof *shares, "grain fractions"));
  for (size_t z = z0; z < z1; z += area->batch) {
    size_t n = z1 - z < area->batch ? z1 - z : area->batch;
    size_t cx = 0, cy = 0, cz = 0;
#pragma omp parallel for schedule(static) reduction(+ : cx, cy, cz)
    for (size_t row = 0; row < n * ny; row++) {
      size_t y = row % ny, deep = (size_t)((long)(z + row / ny) - slab->first);
      const int16_t *at = slab->field + deep * plane + y * nx;
      bool last_y = y + 1 == ny, last_z = z + row / ny + 1 == slab->region->size[2];
      for (size_t x = 0; x < nx; x++) {
        shares[row * nx + x] = voxel_fraction(slab, x, y, deep);
        bool grain = at[x] > 0;
        if (x + 1 < nx) cx += grain != (at[x + 1] > 0);
        if (!last_y) cy += grain != (at[x + nx] > 0);
        if (!last_z) cz += grain != (at[x + plane] > 0);
      }
    }
    changes[0] += cx;
    changes[1] += cy;
    changes[2] += cz;
    TRY(resampler_feed(area, z, n, shares, result->grain_fraction));
  }
  /* Faces show 3/2 of an isotropic surface. */
  result->surface_area +=
      2.0 / 3.0 *
      ((double)changes[0] * voxel[1] * voxel[2] + (double)changes[1] * voxel[0] * voxel[2] +
       (double)changes[2] * voxel[0] * voxel[1]);
cleanup:
  memory_free(&shares);
  return status;
}

/* Sign of the trilinear field at a point (stretched, z from the slab's first slice). */
static bool in_grain(const struct slab *slab, const double point[3]) {
  const size_t *size = slab->region->size;
  long low[3];
  double part[3], value = 0.0;
  for (int d = 0; d < 3; d++) {
    double at = point[d] / slab->stretch[d] - 0.5;
    low[d] = (long)floor(at);
    part[d] = at - (double)low[d];
  }
  for (unsigned c = 0; c < 8; c++) {
    long at[3];
    double weight = 1.0;
    for (unsigned d = 0; d < 3; d++) {
      at[d] = low[d] + (long)(c >> d & 1);
      weight *= (c >> d & 1) != 0 ? part[d] : 1.0 - part[d];
    }
    size_t x = (size_t)(at[0] + (long)size[0]) % size[0];
    size_t y = (size_t)(at[1] + (long)size[1]) % size[1];
    size_t z = at[2] < 0 ? 0 : at[2] >= (long)slab->depth ? slab->depth - 1 : (size_t)at[2];
    value += weight * slab->field[(z * size[1] + y) * size[0] + x];
  }
  return value > 0.0;
}

/* The upper mirror plane: the middle of the last layer, in slices. */
static double mirror_plane(const struct slab *slab) {
  return ((double)slab->request->size[2] - 0.5) * slab->factor[2];
}

/* Slices that bear the surface: none beyond the mirror plane, where the image is the surface. */
static size_t surface_depth(const struct slab *slab) {
  double last = ceil(mirror_plane(slab) + 0.5) - (double)slab->first;
  return slab->request->mirror && last < (double)slab->depth ? (size_t)last : slab->depth;
}

static double mirrored_distance(const struct slab *slab, const struct surfels *surfels,
                                const double point[3]) {
  double best = surfels_distance(surfels, point, slab->band);
  if (!slab->request->mirror) return best;
  /* Images by reflection about z = 0 and about the middle of the last layer. */
  double offset = (double)slab->first * slab->stretch[2], z = point[2] + offset;
  double plane = mirror_plane(slab) * slab->stretch[2];
  const double images[2] = {-z, 2.0 * plane - z};
  for (int i = 0; i < 2; i++) {
    double away = i == 0 ? z : plane - z;
    if (away > best + 1.0) continue;
    const double image[3] = {point[0], point[1], images[i] - offset};
    best = surfels_distance(surfels, image, best);
  }
  return best;
}

static void slab_distances(const struct slab *slab, const struct surfels *surfels, size_t k0,
                           size_t k1, float *distance) {
  const size_t *size = slab->request->size;
#pragma omp parallel for schedule(dynamic, 4)
  for (size_t row = k0 * size[1]; row < k1 * size[1]; row++) {
    for (size_t x = 0; x < size[0]; x++) {
      const size_t at[3] = {x, row % size[1], row / size[1]};
      double point[3];
      for (int d = 0; d < 3; d++)
        point[d] = ((double)at[d] + 0.5) * slab->factor[d] * slab->stretch[d];
      point[2] -= (double)slab->first * slab->stretch[2];
      double best = mirrored_distance(slab, surfels, point);
      double sign = in_grain(slab, point) ? -1.0 : 1.0;
      distance[row * size[0] + x] =
          best < slab->band ? (float)(sign * best * slab->unit) : INFINITY;
    }
  }
}

/* Layers k0 <= k < k1: how many fit the memory for one slab. */
static size_t slab_layers(const struct slab *slab, size_t k0) {
  double plane = (double)slab->region->size[0] * (double)slab->region->size[1];
  double halo = 2.0 * (slab->band / slab->stretch[2] + 2.0);
  double whole = (double)slab->region->size[2];
  size_t left = slab->request->size[2] - k0;
  if (slab->request->mirror && (whole + 2.0) * plane <= SLAB_VOXELS) return left;
  double layers = floor((SLAB_VOXELS / plane - halo) / slab->factor[2]);
  if (layers < 1.0) layers = 1.0;
  return (double)left < layers ? left : (size_t)layers;
}

static void slab_range(struct slab *slab, size_t k0, size_t k1) {
  double halo = slab->band / slab->stretch[2] + 2.0;
  double low = floor((double)k0 * slab->factor[2] - halo);
  double high = ceil((double)k1 * slab->factor[2] + halo);
  if (slab->request->mirror) {
    low = fmax(low, -1.0);
    high = fmin(high, (double)slab->region->size[2] + 1.0);
  }
  slab->first = (long)low;
  slab->depth = (size_t)(high - low);
}

static void slab_start(const struct region *region, const struct wall_request *request,
                       struct slab *slab) {
  *slab = (struct slab){.region = region, .request = request};
  slab->unit = fmin(region->voxel[0], fmin(region->voxel[1], region->voxel[2]));
  double spacing = 0.0;
  for (int d = 0; d < 3; d++) {
    slab->factor[d] = (double)region->size[d] / (double)request->size[d];
    slab->stretch[d] = region->voxel[d] / slab->unit;
    spacing = fmax(spacing, slab->factor[d] * slab->stretch[d]);
  }
  slab->band = fmax(BAND_LAYERS * spacing, 8.0) + 1.0;
}

static enum status one_slab(struct slab *slab, size_t k0, size_t k1, struct resampler *area,
                            struct wall_result *result) {
  enum status status = STATUS_OK;
  struct surfels surfels = {0};
  slab_range(slab, k0, k1);
  const size_t size[3] = {slab->region->size[0], slab->region->size[1], slab->depth};
  size_t z0 = (size_t)((double)k0 * slab->factor[2]), z1 = (size_t)((double)k1 * slab->factor[2]);
  if (k1 == slab->request->size[2]) z1 = slab->region->size[2];
  TRY(memory_allocate(&slab->field, size[0] * size[1] * size[2], sizeof *slab->field,
                      "greys of a slab"));
  TRY(slab_read(slab));
  TRY(slab_remove_specks(slab, &result->specks));
  TRY(slab_fractions(slab, z0, z1, area, result));
  if (!slab->request->distances) goto cleanup;
  const size_t bearing[3] = {size[0], size[1], surface_depth(slab)};
  TRY(surfels_build(slab->field, bearing, slab->stretch, &surfels));
  slab_distances(slab, &surfels, k0, k1, result->distance);
cleanup:
  surfels_end(&surfels);
  memory_free(&slab->field);
  return status;
}

enum status wall_measure(const struct region *region, const struct wall_request *request,
                         struct wall_result *result) {
  enum status status = STATUS_OK;
  struct slab slab;
  struct resampler area = {0};
  struct progress progress;
  size_t sites = request->size[0] * request->size[1] * request->size[2];
  memset(result, 0, sizeof *result);
  TRY(memory_allocate(&result->distance, sites, sizeof *result->distance, "wall distances"));
  TRY(memory_allocate(&result->grain_fraction, sites, sizeof *result->grain_fraction,
                      "grain fractions"));
  TRY(resampler_start(FILTER_AREA, region->size, request->size, region_batch(region), &area));
  slab_start(region, request, &slab);
  progress_start(&progress, "surface", "layers", (double)request->size[2]);
  for (size_t k0 = 0; k0 < request->size[2];) {
    size_t k1 = k0 + slab_layers(&slab, k0);
    TRY(one_slab(&slab, k0, k1, &area, result));
    progress_update(&progress, (double)k1, NULL);
    k0 = k1;
  }
  progress_end(&progress);
cleanup:
  resampler_end(&area);
  if (status != STATUS_OK) wall_result_end(result);
  return status;
}

void wall_result_end(struct wall_result *result) {
  memory_free(&result->distance);
  memory_free(&result->grain_fraction);
}
