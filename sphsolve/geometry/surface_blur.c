#include "sphsolve/geometry/surface_blur.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "sphsolve/geometry/resample.h"

/* In standard deviations of the blur: cut-off radius of the kernel; largest distance that is
 * computed from the blurred pore fraction; distance from which on the old value is kept. */
#define REACH 4.0
#define FRACTION_USED_TO 2.5
#define FRACTION_UNUSED_FROM 3.0
/* In spacings: a narrower blur is not resolved by the pore fractions of sites. */
#define DEVIATION_MIN 0.9
/* Standard deviation, in spacings, of the smooth step from wall to pore that is blurred. The pore
 * fraction of a voxel is the steepest possible step, but its result depends on where walls lie
 * between the sites: walls halfway between sites would have 1.1 times their distance after the
 * blur. The amplitude of this step at periods of half a spacing and less is below 1 % (exp(-2 pi^2
 * STEP_DEVIATION^2)). */
#define STEP_DEVIATION 0.5
enum { TAPS_MOST = 64, MATCH_ROUNDS = 16 };
/* Tolerance: relative error of the porosity; that of k is about five times as large. */
#define POROSITY_TOLERANCE 1e-5

static double spacing_of(const struct lattice *l) {
  return cbrt(l->spacing[0] * l->spacing[1] * l->spacing[2]);
}

/* Index of the value `reach` before `i` on a periodic axis of n values. Of a mirrored axis, where i
 * and n - 1 - i are equal, only the first `held` values are stored. */
static size_t held_at(size_t i, size_t n, size_t held, size_t reach) {
  const size_t j = (i + n * (reach / n + 1) - reach) % n;
  return j < held ? j : n - 1 - j;
}

/* Number of values that stay in the L1 cache while all taps are applied. */
enum { BLOCK = 1024 };

/* Convolution along x: out [outer][held]. */
static void blur_lines(const float *in, size_t n, size_t held, size_t outer, const float *taps,
                       size_t reach, float *out) {
#pragma omp parallel for schedule(static)
  for (size_t o = 0; o < outer; o++)
    for (size_t first = 0; first < held; first += BLOCK) {
      const size_t count = held - first < BLOCK ? held - first : BLOCK;
      float padded[BLOCK + 2 * TAPS_MOST], *row = out + o * held + first;
      for (size_t i = 0; i < count + 2 * reach; i++)
        padded[i] = in[o * held + held_at(first + i, n, held, reach)];
      for (size_t i = 0; i < count; i++) row[i] = 0.0f;
      for (size_t t = 0; t <= 2 * reach; t++)
        for (size_t i = 0; i < count; i++) row[i] += taps[t] * padded[i + t];
    }
}

/* Convolution along the axis of `stride` values: out [outer][held][stride]. */
static void blur_axis(const float *in, size_t n, size_t held, size_t stride, size_t outer,
                      const float *taps, size_t reach, float *out) {
  const size_t blocks = (stride + BLOCK - 1) / BLOCK;
#pragma omp parallel for schedule(static) collapse(2)
  for (size_t o = 0; o < outer; o++)
    for (size_t b = 0; b < blocks; b++) {
      const size_t first = b * BLOCK, count = stride - first < BLOCK ? stride - first : BLOCK;
      const float *base = in + o * held * stride + first;
      for (size_t i = 0; i < held; i++) {
        float *row = out + (o * held + i) * stride + first;
        for (size_t s = 0; s < count; s++) row[s] = 0.0f;
        for (size_t t = 0; t <= 2 * reach; t++) {
          const float *from = base + held_at(i + t, n, held, reach) * stride;
          for (size_t s = 0; s < count; s++) row[s] += taps[t] * from[s];
        }
      }
    }
}

/* image, work: [planes][size 1][size 0]; `planes` is half the size for a mirrored lattice. */
static void blur(const struct lattice *l, double deviation, size_t planes, float **image,
                 float **work) {
  size_t stride = 1;
  const size_t held[3] = {l->size[0], l->size[1], planes};
  const size_t count = held[0] * held[1] * held[2];
  float taps[2 * TAPS_MOST + 1];
  for (int a = 0; a < 3; a++) {
    const double sigma = deviation / l->spacing[a];
    const size_t n = l->size[a], wanted = (size_t)ceil(REACH * sigma);
    const size_t reach = wanted < TAPS_MOST ? wanted : TAPS_MOST;
    double sum = 0.0;
    if (n == 1 || interrupt_alone()) continue;
    for (size_t t = 0; t <= 2 * reach; t++)
      sum += exp(-0.5 * pow(((double)t - (double)reach) / sigma, 2.0));
    for (size_t t = 0; t <= 2 * reach; t++)
      taps[t] = (float)(exp(-0.5 * pow(((double)t - (double)reach) / sigma, 2.0)) / sum);
    const size_t outer = count / held[a] / stride;
    if (stride == 1)
      blur_lines(*image, n, held[a], outer, taps, reach, *work);
    else
      blur_axis(*image, n, held[a], stride, outer, taps, reach, *work);
    float *blurred = *work;
    *work = *image, *image = blurred;
    stride *= held[a];
  }
}

/* The t with share = Phi(t), 0 < share < 1, to 1e-6: one step of Newton's method from a first guess
 * that is good to 5e-4 (Hastings 1955, sheet 67). */
static double normal_quantile(double share) {
  const double p = fmin(share, 1.0 - share), w = sqrt(-2.0 * log(p));
  double t = (2.30753 + 0.27061 * w) / (1.0 + w * (0.99229 + 0.04481 * w)) - w;
  t -= (0.5 * erfc(-t / sqrt(2.0)) - p) * sqrt(2.0 * M_PI) * exp(0.5 * t * t);
  return share < 0.5 ? t : -t;
}

/* Wall distance after the blur from the pore fraction `share` around a site: that of a flat wall
 * with this fraction as far as the blur reaches, and beyond that at least the magnitude of the old
 * distance. */
static double distance_of(double share, double width, double old) {
  const double far = copysign(fmax(fabs(old), FRACTION_USED_TO * width), share - 0.5);
  if (fmin(share, 1.0 - share) < 0.5 * erfc(FRACTION_UNUSED_FROM / sqrt(2.0))) return far;
  const double t = normal_quantile(share);
  const double part = fmin(
      fmax((FRACTION_UNUSED_FROM - fabs(t)) / (FRACTION_UNUSED_FROM - FRACTION_USED_TO), 0.0), 1.0);
  return part * t * width + (1.0 - part) * far;
}

/* Porosity with all walls `moved` (m) into the grains; 1 if no grains are left. */
static double porosity_of(const struct lattice *l, double moved) {
  return 1.0 - 1.0 / (1.0 + lattice_void_ratio(l, moved));
}

/* Moves the walls by at most `most` (m) such that the porosity becomes `wanted`: false position,
 * where the value at an end that is kept twice is halved ("Illinois": Dowell, Jarratt 1971). */
static void match_porosity(struct lattice *l, double wanted, double most) {
  double low = -most, high = most, moved = 0.0;
  double below = porosity_of(l, low) - wanted, above = porosity_of(l, high) - wanted;
  int stayed = 0; /* which end was kept last: -1 the low one, 1 the high one */
  for (int round = 0; round < MATCH_ROUNDS && above > below && !interrupt_alone(); round++) {
    moved = (low * above - high * below) / (above - below);
    const double off = porosity_of(l, moved) - wanted;
    if (fabs(off) <= POROSITY_TOLERANCE * wanted) break;
    if (off < 0.0) {
      low = moved, below = off;
      if (stayed == 1) above *= 0.5;
      stayed = 1;
    } else {
      high = moved, above = off;
      if (stayed == -1) below *= 0.5;
      stayed = -1;
    }
  }
#pragma omp parallel for schedule(static)
  for (size_t s = 0; s < l->count; s++) l->wall_distance[s] += (float)moved;
}

static enum status blur_walls(struct lattice *out, double deviation) {
  enum status status = STATUS_OK;
  float *image = NULL, *work = NULL;
  const double h = spacing_of(out);
  const bool mirrored = lattice_is_mirrored(out);
  const double width = hypot(deviation, STEP_DEVIATION * h); /* of the step after the blur */
  const size_t planes = mirrored ? (out->size[2] + 1) / 2 : out->size[2];
  const size_t count = out->size[0] * out->size[1] * planes;
  TRY(memory_allocate(&image, count, sizeof *image, "a lattice"));
  TRY(memory_allocate(&work, count, sizeof *work, "a lattice"));
#pragma omp parallel for schedule(static)
  for (size_t s = 0; s < count; s++)
    image[s] = 0.5f * erfcf(out->wall_distance[s] / (float)(-M_SQRT2 * STEP_DEVIATION * h));
  const double wanted = porosity_of(out, 0.0);
  blur(out, deviation, planes, &image, &work);
  TRY(interrupt_look());
#pragma omp parallel for schedule(static)
  for (size_t s = 0; s < count; s++)
    out->wall_distance[s] =
        (float)distance_of((double)image[s], width, (double)out->wall_distance[s]);
  if (mirrored) lattice_mirror_distances(out);
  match_porosity(out, wanted, width);
  TRY(interrupt_look());
  lattice_set_kinds(out, 0.0f, (float)(1e-3 * h));
cleanup:
  MEMORY_FREE(&image, &work);
  return status;
}

enum status lattice_blur(const struct lattice *fine, double deviation, const struct lattice *level,
                         double *scale, struct lattice *out) {
  enum status status = STATUS_OK;
  struct lattice blurred = {0};
  /* As coarse as the blur allows; the sites need not be the model's own. */
  const double spacing = fmax(spacing_of(fine), fmin(spacing_of(level), deviation));
  const double taken = fmax(deviation, DEVIATION_MIN * spacing);
  *scale = deviation * deviation / (taken * taken);
  TRY(lattice_sample(fine, spacing, 0.0, &blurred));
  TRY(blur_walls(&blurred, taken));
  TRY(lattice_resample(&blurred, spacing_of(level), 0.0, out));
cleanup:
  lattice_free(&blurred);
  return status;
}
