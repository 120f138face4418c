/* Two surfaces are computed from the labels, and the smoother one is used wherever it agrees with
 * them.
 *
 * Narrow: labels blurred by a Gaussian G of 0.7 voxels. For a wall at 18 degrees to the voxels,
 * whose stairs repeat every 3.2 voxels, 0.4 of their height remains.
 *
 * Wide: 2 G - G G with 1.6 voxels. Its transfer function 1 - (1 - g)^2, where g is that of the
 * Gaussian, leaves 0.02 of such stairs. Its second moment is zero, so that curved walls are
 * displaced only to fourth order, where a Gaussian displaces them in proportion to the curvature
 * ("twicing": Tukey 1977; the same idea as Taubin's smoothing without shrinking, 1995). It rounds
 * or opens corners, contacts and pores of a few voxels; where it leaves voxels on the wrong side,
 * or changes the local volume, the narrow surface is used.
 *
 * Where grain or pore ends in an edge, as the walls of a foam do at its windows, both surfaces cut
 * the edge off. The local difference in volume between labels and surface is compensated by moving
 * the surface (docs/physics/restoration.md). */
#include "ct2model/scan/label_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

#define SQRT2 1.4142135623730951
/* Greys represent distances from the surface up to this, in voxels. */
#define DISTANCE_MAX 1.5f
/* Criteria for the narrow surface, in voxels: depth of a voxel on the wrong side of the wide
 * surface, and mean displacement of the wall that the local error in volume amounts to. From the
 * first value on the narrow surface contributes, from the second on it is used alone. From turned
 * slits, tubes, ducts and spheres (docs/physics/restoration.md). */
static const float DEPTH_LIMITS[2] = {0.06f, 0.2f}, OFFSET_LIMITS[2] = {0.04f, 0.12f};
/* SPREAD: distance, in voxels, to which a voxel on the wrong side affects its neighbours.
 * LOCAL_DEVIATION: standard deviation of the local average. BLEND_DEVIATION: that over which one
 * surface blends into the other. */
enum { SPREAD = 3 };
#define LOCAL_DEVIATION 2.0
#define BLEND_DEVIATION 1.0
/* Below this local amount of surface, in voxel faces, no volume is compared. */
#define SURFACE_MIN 0.02f

enum { REACH = 7, TAPS = 2 * REACH + 1 };

struct kernel {
  int reach;
  float weight[TAPS];
};

struct drawing {
  const uint8_t *grain;
  const size_t *size;
  const bool *reflect;
  struct kernel narrow_kernel, wide_once, wide_twice, local, blend;
  uint8_t *walls; /* the narrow surface, then the result */
  uint8_t *wide;
  const uint8_t *judged; /* the surface that is compared with the labels */
  uint8_t *narrow_share; /* weight of the narrow surface, 0 to 255 */
};

static struct kernel gaussian(double deviation) {
  struct kernel k = {.reach = (int)ceil(3.0 * deviation)};
  float sum = 0.0f;
  for (int d = -k.reach; d <= k.reach; d++)
    sum += k.weight[d + k.reach] = (float)exp(-0.5 * pow((double)d / deviation, 2.0));
  for (int t = 0; t <= 2 * k.reach; t++) k.weight[t] /= sum;
  return k;
}

/* Index i + d on an axis of n voxels that is periodic, or mirrored as models are, about the first
 * face and the last centre. */
static size_t wrapped_index(size_t i, long d, size_t n, bool reflect) {
  const long count = (long)n;
  long at = (long)i + d;
  if (reflect && n > 1) {
    while (at < 0 || at >= count) at = at < 0 ? -1 - at : 2 * count - 2 - at;
    return (size_t)at;
  }
  while (at < 0) at += count;
  while (at >= count) at -= count;
  return (size_t)at;
}

static float clamp(float value, float low, float high) {
  return value < low ? low : value > high ? high : value; /* fminf would be a function call */
}

static uint8_t grey_of(float distance) {
  const float part = clamp(distance, -DISTANCE_MAX, DISTANCE_MAX) / (2.0f * DISTANCE_MAX) + 0.5f;
  return (uint8_t)lroundf((float)LABEL_GREY * part);
}

static float distance_of(uint8_t grey) {
  return ((float)grey / (float)LABEL_GREY - 0.5f) * 2.0f * DISTANCE_MAX;
}

/* Volume fraction of grain in a voxel, by its distance from the surface. */
static float grain_fraction(uint8_t grey) {
  return clamp(0.5f + distance_of(grey), 0.0f, 1.0f);
}

/* A quantity per voxel that is filtered. */
typedef float quantity(const struct drawing *d, size_t voxel);

static float is_grain(const struct drawing *d, size_t voxel) {
  return (float)d->grain[voxel];
}
/* Volume that the surface assigns to grain in excess of the labels. */
static float excess(const struct drawing *d, size_t voxel) {
  return grain_fraction(d->judged[voxel]) - (float)d->grain[voxel];
}
/* Measure of surface that sums to one voxel across it: the integral of 6 t (1 - t), 0 < t < 1. */
static float surface_measure(const struct drawing *d, size_t voxel) {
  const float part = grain_fraction(d->judged[voxel]);
  return 6.0f * part * (1.0f - part);
}
static float wrong_side_depth(const struct drawing *d, size_t voxel) {
  const float distance = distance_of(d->wide[voxel]);
  return clamp(d->grain[voxel] ? -distance : distance, 0.0f, DISTANCE_MAX);
}
static float share(const struct drawing *d, size_t voxel) {
  return (float)d->narrow_share[voxel] / 255.0f;
}

/* Adds a row times `weight`, or takes the maximum if `weight` is NULL. */
static void gather(float *sum, const float *from, size_t n, const float *weight) {
  if (weight == NULL)
    for (size_t i = 0; i < n; i++) sum[i] = sum[i] > from[i] ? sum[i] : from[i];
  else
    for (size_t i = 0; i < n; i++) sum[i] += *weight * from[i];
}

/* Filters slice z of a quantity by a kernel, or if that is NULL takes the maximum (at least 0) over
 * SPREAD voxels on each side. work: two slices, and a row extended at both ends. */
static inline void filter(const struct drawing *d, quantity *of, const struct kernel *kernel,
                          size_t z, float *work, float *out) {
  const size_t nx = d->size[0], ny = d->size[1], plane = nx * ny;
  const int reach = kernel == NULL ? SPREAD : kernel->reach;
  float *one = work, *planes = one + plane, *row = planes + plane;
  memset(planes, 0, plane * sizeof *planes);
  memset(out, 0, plane * sizeof *out);
  for (int t = -reach; t <= reach; t++) {
    const size_t from = wrapped_index(z, t, d->size[2], d->reflect[2]) * plane;
    for (size_t p = 0; p < plane; p++) one[p] = of(d, from + p);
    gather(planes, one, plane, kernel == NULL ? NULL : &kernel->weight[t + reach]);
  }
  for (size_t y = 0; y < ny; y++) {
    memset(one, 0, nx * sizeof *one);
    for (int t = -reach; t <= reach; t++)
      gather(one, planes + wrapped_index(y, t, ny, d->reflect[1]) * nx, nx,
             kernel == NULL ? NULL : &kernel->weight[t + reach]);
    for (int t = -reach; t < 0; t++) row[t + reach] = one[wrapped_index(0, t, nx, d->reflect[0])];
    memcpy(row + reach, one, nx * sizeof *one);
    for (int t = 0; t < reach; t++)
      row[(size_t)reach + nx + (size_t)t] = one[wrapped_index(nx - 1, t + 1, nx, d->reflect[0])];
    for (int t = 0; t <= 2 * reach; t++)
      gather(out + y * nx, row + t, nx, kernel == NULL ? NULL : &kernel->weight[t]);
  }
}

/* Processes one slice in a stage of the computation. work: as for `filter`; a, b: a slice each. */
typedef void stage(const struct drawing *d, size_t z, float *work, float *a, float *b);

/* The distance from the surface follows from the blurred labels: at a flat wall they are 1/2, with
 * the kernel's value at 0 as their slope. */
static void draw_surfaces(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  const float peak = (float)(1.0 / sqrt(2.0 * M_PI));
  const float narrow_slope = peak / (float)LABEL_SMOOTHING;
  const float wide_slope = peak * (float)((2.0 - 1.0 / SQRT2) / LABEL_SMOOTHING_WIDE);
  filter(d, is_grain, &d->narrow_kernel, z, work, a);
  for (size_t p = 0; p < plane; p++)
    d->walls[z * plane + p] = grey_of((a[p] - 0.5f) / narrow_slope);
  filter(d, is_grain, &d->wide_once, z, work, a);
  filter(d, is_grain, &d->wide_twice, z, work, b);
  for (size_t p = 0; p < plane; p++)
    d->wide[z * plane + p] = grey_of((2.0f * a[p] - b[p] - 0.5f) / wide_slope);
}

static float ramp(float value, const float between[2]) {
  return clamp((value - between[0]) / (between[1] - between[0]), 0.0f, 1.0f);
}

static void choose_surface(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  uint8_t *narrow = d->narrow_share + z * plane;
  filter(d, wrong_side_depth, NULL, z, work, a);
  for (size_t p = 0; p < plane; p++)
    narrow[p] = (uint8_t)lroundf(255.0f * ramp(a[p], DEPTH_LIMITS));
  filter(d, excess, &d->local, z, work, a);
  filter(d, surface_measure, &d->local, z, work, b);
  for (size_t p = 0; p < plane; p++) {
    const float off = b[p] > SURFACE_MIN ? fabsf(a[p]) / b[p] : 0.0f;
    const uint8_t by_volume = (uint8_t)lroundf(255.0f * ramp(off, OFFSET_LIMITS));
    if (by_volume > narrow[p]) narrow[p] = by_volume;
  }
}

static void blend_surfaces(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  uint8_t *walls = d->walls + z * plane;
  const uint8_t *wide = d->wide + z * plane;
  (void)b;
  filter(d, share, &d->blend, z, work, a);
  for (size_t p = 0; p < plane; p++)
    walls[p] = (uint8_t)lroundf((float)wide[p] + a[p] * ((float)walls[p] - (float)wide[p]));
}

/* Compensates the local error in volume; the result goes to `wide`, which is no longer needed. */
static void correct_volume(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  const uint8_t *walls = d->walls + z * plane;
  uint8_t *moved = d->wide + z * plane;
  filter(d, excess, &d->local, z, work, a);
  filter(d, surface_measure, &d->local, z, work, b);
  for (size_t p = 0; p < plane; p++)
    moved[p] = grey_of(distance_of(walls[p]) - a[p] / (b[p] + SURFACE_MIN));
}

static enum status each_slice(const struct drawing *d, stage *next) {
  enum status status = STATUS_OK;
  const size_t plane = d->size[0] * d->size[1], room = 2 * plane + d->size[0] + 2 * REACH;
#pragma omp parallel
  {
    float *work = NULL;
    const enum status thread_status =
        memory_allocate(&work, room + 2 * plane, sizeof *work, "slices");
#pragma omp for schedule(static)
    for (size_t z = 0; z < d->size[2]; z++)
      if (thread_status == STATUS_OK) next(d, z, work, work + room, work + room + plane);
    memory_free(&work);
    if (thread_status != STATUS_OK) {
#pragma omp critical
      status = thread_status;
    }
  }
  return status;
}

enum status label_walls(const uint8_t *grain, const size_t size[3], const bool reflect[3],
                        uint8_t *walls) {
  enum status status = STATUS_OK;
  const size_t count = size[0] * size[1] * size[2];
  struct drawing d = {.grain = grain,
                      .size = size,
                      .reflect = reflect,
                      .narrow_kernel = gaussian(LABEL_SMOOTHING),
                      .wide_once = gaussian(LABEL_SMOOTHING_WIDE),
                      .wide_twice = gaussian(LABEL_SMOOTHING_WIDE * SQRT2),
                      .local = gaussian(LOCAL_DEVIATION),
                      .blend = gaussian(BLEND_DEVIATION),
                      .walls = walls};
  TRY(memory_allocate(&d.wide, count, 1, "the smoothed labels"));
  d.judged = d.wide;
  TRY(memory_allocate(&d.narrow_share, count, 1, "the smoothed labels"));
  TRY(each_slice(&d, draw_surfaces));
  TRY(each_slice(&d, choose_surface));
  TRY(each_slice(&d, blend_surfaces));
  d.judged = walls;
  TRY(each_slice(&d, correct_volume));
  memcpy(walls, d.wide, count);
cleanup:
  MEMORY_FREE(&d.wide, &d.narrow_share);
  return status;
}
