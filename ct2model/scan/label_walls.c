/* Two surfaces are drawn through the labels, and the smoother is taken where it keeps to them.
 *
 * Narrow: labels blurred by a Gaussian G of .7 voxels. Of a wall at 18 degrees to the voxels, whose
 * stairs repeat every 3.2 voxels, .4 of their height is left.
 *
 * Wide: 2 G - G G with 1.6 voxels. Its transfer 1 - (1 - g)^2, g that of the Gaussian, leaves .02 of
 * such stairs, and its second moment is zero, so that it moves bent walls only by their fourth
 * order, where a Gaussian moves them with the curvature ("twicing": Tukey 1977; the same idea as
 * smoothing without shrinking of Taubin 1995). Corners, contacts and pores of a few voxels it rounds
 * or opens; there it leaves voxels on the wrong side, or other volume than the labels have around,
 * and the narrow one stands.
 *
 * Where grain or pore ends in an edge, as the walls of a foam do at its windows, both cut it off.
 * What the labels have there and the surface has not is given back by moving the surface about it
 * (docs/notes/2026-11-26-twentieth-hour.md). */
#include "ct2model/scan/label_walls.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

#define SQRT2 1.4142135623730951
/* Greys are distances from the surface, in voxels, as far as this. */
#define FARTHEST 1.5f
/* The depth of a voxel on the wrong side, and how far the mean wall about a place is off the
 * labels' volume (voxels): from the first on the narrow surface has a share, from the second on it
 * stands alone. Of turned slits, tubes, ducts and spheres (docs/notes/2026-11-23-walls-labels.md).
 */
static const float DEPTH[2] = {0.06f, 0.2f}, OFF[2] = {0.04f, 0.12f};
/* Voxels about one on the wrong side that go with it; the deviation of what "about a place" is, and
 * that over which one surface goes over into the other. */
enum { AROUND = 3 };
#define ABOUT 2.0
#define PASSAGE 1.0
/* Where less surface than this is about a place, in faces of voxels, none is judged. */
#define NO_SURFACE 0.02f

enum { REACH = 7, TAPS = 2 * REACH + 1 };

struct kernel {
  int reach;
  float weight[TAPS];
};

struct drawing {
  const uint8_t *grain;
  const size_t *size;
  const bool *reflect;
  struct kernel narrow_kernel, wide_once, wide_twice, about, passage;
  uint8_t *walls; /* narrow, then the result */
  uint8_t *wide;
  const uint8_t *judged; /* the one that is held against the labels */
  uint8_t *narrow_share; /* 0 to 255 */
};

static struct kernel gaussian(double deviation) {
  struct kernel k = {.reach = (int)ceil(3.0 * deviation)};
  float sum = 0.0f;
  for (int d = -k.reach; d <= k.reach; d++)
    sum += k.weight[d + k.reach] = (float)exp(-0.5 * pow((double)d / deviation, 2.0));
  for (int t = 0; t <= 2 * k.reach; t++) k.weight[t] /= sum;
  return k;
}

/* Index i + d of n, periodic, or mirrored as models are: about the first face and the last centre.
 */
static size_t beyond(size_t i, long d, size_t n, bool reflect) {
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
  return value < low ? low : value > high ? high : value; /* unlike fminf, no call */
}

static uint8_t grey_of(float distance) {
  const float part = clamp(distance, -FARTHEST, FARTHEST) / (2.0f * FARTHEST) + 0.5f;
  return (uint8_t)lroundf((float)LABEL_GREY * part);
}

static float distance_of(uint8_t grey) {
  return ((float)grey / (float)LABEL_GREY - 0.5f) * 2.0f * FARTHEST;
}

/* Grain's part of a voxel at a distance from the surface. */
static float part_of(uint8_t grey) {
  return clamp(0.5f + distance_of(grey), 0.0f, 1.0f);
}

/* What is blurred or looked at; grain, greys: the voxel's. */
typedef float quantity(const struct drawing *d, size_t voxel);

static float is_grain(const struct drawing *d, size_t voxel) {
  return (float)d->grain[voxel];
}
/* What the surface gives to the grains more than the labels do. */
static float excess(const struct drawing *d, size_t voxel) {
  return part_of(d->judged[voxel]) - (float)d->grain[voxel];
}
/* Whose sum across the surface is one voxel: the integral of 6 t (1 - t) over 0 < t < 1. */
static float surface(const struct drawing *d, size_t voxel) {
  const float part = part_of(d->judged[voxel]);
  return 6.0f * part * (1.0f - part);
}
static float wrong_side(const struct drawing *d, size_t voxel) {
  const float distance = distance_of(d->wide[voxel]);
  return clamp(d->grain[voxel] ? -distance : distance, 0.0f, FARTHEST);
}
static float share(const struct drawing *d, size_t voxel) {
  return (float)d->narrow_share[voxel] / 255.0f;
}

/* Along one axis: sums by the kernel's weights, or the greatest where that is NULL. */
static void gather(float *sum, const float *from, size_t n, const float *weight) {
  if (weight == NULL)
    for (size_t i = 0; i < n; i++) sum[i] = sum[i] > from[i] ? sum[i] : from[i];
  else
    for (size_t i = 0; i < n; i++) sum[i] += *weight * from[i];
}

/* Slice z of a quantity, blurred by a kernel; without one, the greatest AROUND each voxel, or 0.
 * work: two slices and a row with both its ends. */
static inline void filter(const struct drawing *d, quantity *of, const struct kernel *kernel,
                          size_t z, float *work, float *out) {
  const size_t nx = d->size[0], ny = d->size[1], plane = nx * ny;
  const int reach = kernel == NULL ? AROUND : kernel->reach;
  float *one = work, *planes = one + plane, *row = planes + plane;
  memset(planes, 0, plane * sizeof *planes);
  memset(out, 0, plane * sizeof *out);
  for (int t = -reach; t <= reach; t++) {
    const size_t from = beyond(z, t, d->size[2], d->reflect[2]) * plane;
    for (size_t p = 0; p < plane; p++) one[p] = of(d, from + p);
    gather(planes, one, plane, kernel == NULL ? NULL : &kernel->weight[t + reach]);
  }
  for (size_t y = 0; y < ny; y++) {
    memset(one, 0, nx * sizeof *one);
    for (int t = -reach; t <= reach; t++)
      gather(one, planes + beyond(y, t, ny, d->reflect[1]) * nx, nx,
             kernel == NULL ? NULL : &kernel->weight[t + reach]);
    for (int t = -reach; t < 0; t++) row[t + reach] = one[beyond(0, t, nx, d->reflect[0])];
    memcpy(row + reach, one, nx * sizeof *one);
    for (int t = 0; t < reach; t++)
      row[(size_t)reach + nx + (size_t)t] = one[beyond(nx - 1, t + 1, nx, d->reflect[0])];
    for (int t = 0; t <= 2 * reach; t++)
      gather(out + y * nx, row + t, nx, kernel == NULL ? NULL : &kernel->weight[t]);
  }
}

/* One slice of a stage; room: of `filter`, then two slices. */
typedef void stage(const struct drawing *d, size_t z, float *work, float *a, float *b);

/* Of a flat wall the blurred labels are half at the surface and have there the kernel's value at 0
 * as their slope. */
static void draw(const struct drawing *d, size_t z, float *work, float *a, float *b) {
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

static void judge(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  uint8_t *narrow = d->narrow_share + z * plane;
  filter(d, wrong_side, NULL, z, work, a);
  for (size_t p = 0; p < plane; p++) narrow[p] = (uint8_t)lroundf(255.0f * ramp(a[p], DEPTH));
  filter(d, excess, &d->about, z, work, a);
  filter(d, surface, &d->about, z, work, b);
  for (size_t p = 0; p < plane; p++) {
    const float off = b[p] > NO_SURFACE ? fabsf(a[p]) / b[p] : 0.0f;
    const uint8_t by_volume = (uint8_t)lroundf(255.0f * ramp(off, OFF));
    if (by_volume > narrow[p]) narrow[p] = by_volume;
  }
}

static void join(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  uint8_t *walls = d->walls + z * plane;
  const uint8_t *wide = d->wide + z * plane;
  (void)b;
  filter(d, share, &d->passage, z, work, a);
  for (size_t p = 0; p < plane; p++)
    walls[p] = (uint8_t)lroundf((float)wide[p] + a[p] * ((float)walls[p] - (float)wide[p]));
}

/* Into `wide`, which is done with. */
static void give_back(const struct drawing *d, size_t z, float *work, float *a, float *b) {
  const size_t plane = d->size[0] * d->size[1];
  const uint8_t *walls = d->walls + z * plane;
  uint8_t *moved = d->wide + z * plane;
  filter(d, excess, &d->about, z, work, a);
  filter(d, surface, &d->about, z, work, b);
  for (size_t p = 0; p < plane; p++)
    moved[p] = grey_of(distance_of(walls[p]) - a[p] / (b[p] + NO_SURFACE));
}

static enum status each_slice(const struct drawing *d, stage *next) {
  enum status status = STATUS_OK;
  const size_t plane = d->size[0] * d->size[1], room = 2 * plane + d->size[0] + 2 * REACH;
#pragma omp parallel
  {
    float *work = NULL;
    const enum status mine = memory_allocate(&work, room + 2 * plane, sizeof *work, "slices");
#pragma omp for schedule(static)
    for (size_t z = 0; z < d->size[2]; z++)
      if (mine == STATUS_OK) next(d, z, work, work + room, work + room + plane);
    memory_free(&work);
    if (mine != STATUS_OK) {
#pragma omp critical
      status = mine;
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
                      .about = gaussian(ABOUT),
                      .passage = gaussian(PASSAGE),
                      .walls = walls};
  TRY(memory_allocate(&d.wide, count, 1, "the smoothed labels"));
  d.judged = d.wide;
  TRY(memory_allocate(&d.narrow_share, count, 1, "the smoothed labels"));
  TRY(each_slice(&d, draw));
  TRY(each_slice(&d, judge));
  TRY(each_slice(&d, join));
  d.judged = walls;
  TRY(each_slice(&d, give_back));
  memcpy(walls, d.wide, count);
cleanup:
  memory_free(&d.wide);
  memory_free(&d.narrow_share);
  return status;
}
