#include "ct2model/scanner/restore.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/gaussian.h"

/* The share of grain u, 0 <= u <= 1, is that which minimises
 *
 *   |g - H A u|^2 / 2 + lambda TV(u),   lambda = SURFACE P (1 + f)^2 / s^2,
 *
 * g the scan, A the grey of the grain at a place, H the scanner's blur with the voxel's own
 * average, TV the total variation (Rudin, Osher and Fatemi 1992), smoothed by ROUNDING; by
 * accelerated projected gradients (FISTA, Beck and Teboulle 2009).
 *
 * With the noise power P = variance times the volume it is correlated over, -log likelihood is
 * |g - H A u|^2 / (2 P); a surface of s^2, the square of the blur (a voxel at least), costs
 * SURFACE: grains have no relief much finer than the scanner can see. A fringe f raises the
 * scanner's transfer of relief of the blur's size, the period 2 pi s, 1 + f times
 * (edge_fit_transfer), its square in the likelihood; surface costs as much more. SURFACE and ROUNDS
 * were fitted to generated sands of blur 0.5 to 3 voxels and contrast 4 to 30 times the noise
 * (docs/notes/2026-11-23-scanner.md). */
#define PI 3.14159265358979323846
static const double SURFACE = 0.09, ROUNDING = 0.1;
enum { ROUNDS = 30, LEVELS = 255 };
/* Noise is taken as correlated over a length of so many voxels at least, as finer noise makes
 * relief between the voxels; and over no more than the blur, as what is longer is the grains'
 * texture. */
#define CORRELATION_LEAST 0.6

/* In voxels: worked on at a time, at most; held in memory as levels, at most; and from where on
 * voxels are averaged as far as the blur allows. */
static const double WORKED = 24e6, HELD = 1.5e9, FULL = 150e6;
/* In blurs: beyond this a slab's surroundings do not matter. */
static const double MARGIN = 7.0;

struct slab {
  size_t size[3];
  double sigma[3], fringe[3], stretch[3];
  double lambda, step; /* of the surface, of a round */
  float *grey, *grain, *u, *y, *a, *b, *work;
};

static void slab_end(struct slab *slab) {
  float **all[] = {&slab->grey, &slab->grain, &slab->u, &slab->y, &slab->a, &slab->b, &slab->work};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) memory_free(all[i]);
}

static enum status slab_start(size_t voxels, struct slab *slab) {
  enum status status = STATUS_OK;
  float **all[] = {&slab->grey, &slab->grain, &slab->u, &slab->y, &slab->a, &slab->b, &slab->work};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    TRY(memory_allocate(all[i], voxels, sizeof(float), "the scan without its blur"));
cleanup:
  return status;
}

/* out = H in; `in` is lost. */
static void blur(const struct slab *slab, float *in, float *out) {
  gaussian_filter(in, slab->size, slab->sigma, slab->work, in);
  laplacian_subtract(in, slab->size, slab->fringe, out);
}

/* The largest square of the scanner's transfer: the gradient's Lipschitz constant. */
static double largest_transfer(double fringe) {
  double most = 1.0;
  for (double x = 0.0; x < 10.0; x += 0.01) most = fmax(most, exp(-0.5 * x) * (1.0 + fringe * x));
  return most * most;
}

/* The grey of the grain around each voxel: what its inner voxels have over what a grain of grey 1
 * has there, which a fringe raises near surfaces; 1 far from all. Grains differ by some per cent,
 * heavy minerals by more than their contrast. */
static void find_grain(struct slab *slab) {
  const size_t n = slab->size[0] * slab->size[1] * slab->size[2];
  double fine[3], wide[3];
  for (int d = 0; d < 3; d++) {
    fine[d] = 1.0 / slab->stretch[d];
    wide[d] = fmax(1.6 * slab->sigma[d], 1.5);
  }
  gaussian_filter(slab->grey, slab->size, fine, slab->work, slab->a);
  for (size_t i = 0; i < n; i++) slab->u[i] = slab->y[i] = slab->a[i] > 0.5f ? 1.0f : 0.0f;
  gaussian_filter(slab->u, slab->size, slab->sigma, slab->work, slab->a);
  blur(slab, slab->y, slab->b);
  for (size_t i = 0; i < n; i++) {
    const float inner = slab->u[i] > 0.0f && slab->a[i] > 0.98f ? 1.0f : 0.0f;
    slab->u[i] = slab->grey[i] * inner;
    slab->y[i] = slab->b[i] * inner;
  }
  gaussian_filter(slab->u, slab->size, wide, slab->work, slab->u);
  gaussian_filter(slab->y, slab->size, wide, slab->work, slab->y);
  for (size_t i = 0; i < n; i++) {
    const float grain = (slab->u[i] + 1e-5f) / (slab->y[i] + 1e-5f);
    slab->grain[i] = fminf(fmaxf(grain, 0.5f), 4.0f);
  }
}

/* weight = lambda / sqrt(|grad y|^2 + ROUNDING^2), forward differences. */
TARGETS static void surface_weights(const float *restrict y, const float *restrict y_next,
                                    const float *restrict z_next, const float inverse[3],
                                    float lambda, size_t n, float *restrict weight) {
  const float floor2 = (float)(ROUNDING * ROUNDING);
  for (size_t x = 0; x < n; x++) {
    const float dx = x + 1 < n ? (y[x + 1] - y[x]) * inverse[0] : 0.0f;
    const float dy = (y_next[x] - y[x]) * inverse[1], dz = (z_next[x] - y[x]) * inverse[2];
    weight[x] = lambda / sqrtf(dx * dx + dy * dy + dz * dz + floor2);
  }
}

struct neighbours {
  const float *y_next, *y_last, *z_next, *z_last;
};

/* gradient += div(weight grad y). */
TARGETS static void add_surface(const float *restrict y, const struct neighbours *near,
                                const float *restrict weight, const float *restrict weight_y,
                                const float *restrict weight_z, const float square[3], size_t n,
                                float *restrict gradient) {
  for (size_t x = 0; x < n; x++)
    gradient[x] +=
        square[1] *
            (weight[x] * (near->y_next[x] - y[x]) - weight_y[x] * (y[x] - near->y_last[x])) +
        square[2] * (weight[x] * (near->z_next[x] - y[x]) - weight_z[x] * (y[x] - near->z_last[x]));
  for (size_t x = 0; x + 1 < n; x++) {
    const float flow = square[0] * weight[x] * (y[x + 1] - y[x]);
    gradient[x] += flow;
    gradient[x + 1] -= flow;
  }
}

/* Adds the surface's part to the gradient in b; a is lost. */
static void pull_surface(struct slab *slab) {
  const size_t nx = slab->size[0], ny = slab->size[1], nz = slab->size[2];
  float inverse[3], square[3];
  for (int d = 0; d < 3; d++) {
    inverse[d] = (float)(1.0 / slab->stretch[d]);
    square[d] = inverse[d] * inverse[d];
  }
#pragma omp parallel
  {
#pragma omp for schedule(static)
    for (size_t row = 0; row < ny * nz; row++) {
      const float *at = slab->y + row * nx;
      surface_weights(at, row % ny + 1 < ny ? at + nx : at, row / ny + 1 < nz ? at + ny * nx : at,
                      inverse, (float)slab->lambda, nx, slab->a + row * nx);
    }
#pragma omp for schedule(static)
    for (size_t row = 0; row < ny * nz; row++) {
      const float *at = slab->y + row * nx, *weight = slab->a + row * nx;
      const bool first_y = row % ny == 0, first_z = row / ny == 0;
      const struct neighbours near = {row % ny + 1 < ny ? at + nx : at, first_y ? at : at - nx,
                                      row / ny + 1 < nz ? at + ny * nx : at,
                                      first_z ? at : at - ny * nx};
      add_surface(at, &near, weight, first_y ? weight : weight - nx,
                  first_z ? weight : weight - ny * nx, square, nx, slab->b + row * nx);
    }
  }
}

TARGETS static void descend(const float *restrict gradient, float step, float momentum, size_t n,
                            float *restrict u, float *restrict y) {
  for (size_t i = 0; i < n; i++) {
    float next = y[i] + step * gradient[i];
    next = next < 0.0f ? 0.0f : next > 1.0f ? 1.0f : next;
    y[i] = next + momentum * (next - u[i]);
    u[i] = next;
  }
}

TARGETS static void multiply(const float *restrict a, const float *restrict b, size_t n,
                             float *restrict out) {
  for (size_t i = 0; i < n; i++) out[i] = a[i] * b[i];
}

TARGETS static void divide(float *restrict a, const float *restrict b, size_t n) {
  for (size_t i = 0; i < n; i++) a[i] /= b[i];
}

TARGETS static void subtract(const float *restrict a, const float *restrict b, size_t n,
                             float *restrict out) {
  for (size_t i = 0; i < n; i++) out[i] = a[i] - b[i];
}

static void set_surface(struct slab *slab, double lambda, double fringe) {
  slab->lambda = lambda;
  slab->step = 1.0 / (1.05 * largest_transfer(fringe) + 12.0 * lambda / ROUNDING);
}

static void slab_restore(struct slab *slab) {
  const size_t nx = slab->size[0], rows = slab->size[1] * slab->size[2], n = nx * rows;
  double t = 1.0;
  find_grain(slab);
  const double fine[3] = {1.0 / slab->stretch[0], 1.0 / slab->stretch[1], 1.0 / slab->stretch[2]};
  gaussian_filter(slab->grey, slab->size, fine, slab->work, slab->a);
  for (size_t i = 0; i < n; i++)
    slab->u[i] = slab->y[i] = fminf(fmaxf(slab->a[i] / slab->grain[i], 0.0f), 1.0f);
  for (int round = 0; round < ROUNDS; round++) {
    const double next = 0.5 * (1.0 + sqrt(1.0 + 4.0 * t * t));
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < rows; row++)
      multiply(slab->grain + row * nx, slab->y + row * nx, nx, slab->a + row * nx);
    blur(slab, slab->a, slab->b);
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < rows; row++)
      subtract(slab->grey + row * nx, slab->b + row * nx, nx, slab->a + row * nx);
    blur(slab, slab->a, slab->b);
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < rows; row++) divide(slab->b + row * nx, slab->grain + row * nx, nx);
    pull_surface(slab);
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < rows; row++)
      descend(slab->b + row * nx, (float)slab->step, (float)((t - 1.0) / next), nx,
              slab->u + row * nx, slab->y + row * nx);
    t = next;
  }
}

/* ---- slabs of a region ---- */

size_t restore_step(const size_t size[3], const double voxel[3], double blur) {
  double voxels = 1.0, largest = 0.0;
  for (int d = 0; d < 3; d++) {
    voxels *= (double)size[d];
    largest = fmax(largest, voxel[d]);
  }
  size_t step = 1;
  for (size_t s = 2; s <= 4 && voxels / pow((double)step, 3.0) > FULL; s++) {
    bool fits = blur >= 0.9 * (double)s * largest;
    for (int d = 0; d < 3; d++) fits &= size[d] % s == 0;
    if (fits) step = s;
  }
  return step;
}

/* Work slices first to first + size[2] - 1 of the region, greys 0 pore and 1 grain. */
static enum status slab_read(const struct region *region, const struct scanner *scanner,
                             size_t step, size_t first, struct slab *slab) {
  enum status status = STATUS_OK;
  const size_t *n = slab->size, plane = region->size[0] * region->size[1];
  const size_t batch = region_batch(region);
  const float pore = (float)scanner->pore;
  const float scale = (float)(1.0 / (scanner->grain - scanner->pore) / pow((double)step, 3.0));
  float *slices = NULL;
  size_t numbers[64];
  TRY(memory_allocate(&slices, batch * plane, sizeof *slices, "slices"));
  memset(slab->grey, 0, n[0] * n[1] * n[2] * sizeof *slab->grey);
  for (size_t z = 0; z < n[2] * step; z += batch) {
    const size_t count = n[2] * step - z < batch ? n[2] * step - z : batch;
    for (size_t i = 0; i < count; i++) numbers[i] = first * step + z + i;
    TRY(region_read(region, numbers, count, slices));
#pragma omp parallel for schedule(static)
    for (size_t y = 0; y < n[1]; y++)
      for (size_t i = 0; i < count * step; i++) {
        const float *in = slices + (i / step * region->size[1] + y * step + i % step) * // NOLINT
                                       region->size[0];
        float *out = slab->grey + ((z + i / step) / step * n[1] + y) * n[0]; // NOLINT: step > 0
        for (size_t x = 0; x < n[0] * step; x++) out[x / step] += scale * (in[x] - pore); // NOLINT
      }
  }
cleanup:
  memory_free(&slices);
  return status;
}

/* The mean grain share of voxels: u itself has steps within them, of which a surface between voxels
 * would be rough. The Laplacian blurs by a voxel's own variance of 1/12. */
static void slab_keep(struct slab *slab, size_t skipped, size_t count, size_t first,
                      struct coarse *restored) {
  static const double AVERAGE[3] = {-1.0 / 24.0, -1.0 / 24.0, -1.0 / 24.0};
  const size_t plane = slab->size[0] * slab->size[1];
  laplacian_subtract(slab->u, slab->size, AVERAGE, slab->a);
  uint8_t *levels = restored->levels + first * plane;
  for (size_t i = 0; i < count * plane; i++) {
    levels[i] = (uint8_t)(slab->a[skipped * plane + i] * (float)LEVELS + 0.5f);
    restored->histogram.counts[levels[i]]++;
  }
  restored->histogram.total += count * plane;
}

/* Volume (m^3) over which noise is as one voxel's, its power at low frequencies over its variance:
 * of white noise filtered by a Gaussian of that length, (2 sqrt(pi) length)^3, a voxel at least. */
static double noise_volume(double length, const double voxel[3]) {
  double noise = 1.0;
  for (int d = 0; d < 3; d++) noise *= fmax(voxel[d], 2.0 * sqrt(PI) * length);
  return noise;
}

enum status restore_run(const struct region *region, const struct scanner *scanner, double width,
                        struct coarse *restored) {
  enum status status = STATUS_OK;
  struct slab slab = {0};
  struct progress progress;
  const size_t step = restore_step(region->size, region->voxel, width);
  const double contrast = scanner->grain - scanner->pore;
  double voxels = 1.0, volume = 1.0, least = INFINITY;
  *restored = (struct coarse){.step = step, .unit = 1.0 / LEVELS};
  for (int d = 0; d < 3; d++) {
    const double voxel = region->voxel[d] * (double)step;
    restored->size[d] = region->size[d] / step;
    voxels *= (double)restored->size[d];
    volume *= voxel;
    least = fmin(least, voxel);
    /* That a voxel is an average blurs too. */
    slab.sigma[d] = sqrt(width * width / (voxel * voxel) + 1.0 / 12.0);
    slab.fringe[d] = scanner->fringe * width * width / voxel / voxel;
  }
  if (voxels > HELD) return STATUS_OK;
  for (int d = 0; d < 3; d++) slab.stretch[d] = region->voxel[d] * (double)step / least;
  const double length =
      fmin(fmax(scanner->noise_correlation, CORRELATION_LEAST * least), fmax(width, least));
  const double power =
      pow(scanner->noise / contrast, 2.0) * noise_volume(length, region->voxel) / volume;
  const double seen = fmax(width, least);            /* finer than a voxel nothing is */
  const double wide = seen * seen / (least * least); /* of the blur, voxels^2 */
  const size_t plane = restored->size[0] * restored->size[1], nz = restored->size[2];
  const size_t margin = (size_t)ceil(MARGIN * fmax(slab.sigma[2], 1.0));
  size_t depth = (size_t)(WORKED / (double)plane);
  depth = depth > 3 * margin ? depth - 2 * margin : margin;
  if (nz <= depth + margin) depth = nz;
  const size_t most = depth + 2 * margin < nz ? depth + 2 * margin : nz;
  slab.size[0] = restored->size[0];
  slab.size[1] = restored->size[1];
  TRY(memory_allocate(&restored->levels, plane * nz, 1, "the scan without its blur"));
  TRY(grey_histogram_start(-0.5, 1.0, LEVELS + 1, &restored->histogram));
  TRY(slab_start(plane * most, &slab));
  set_surface(&slab, SURFACE * power * pow(1.0 + scanner->fringe, 2.0) / wide, scanner->fringe);
  progress_start(&progress, "restoring", "slices", (double)nz);
  for (size_t z = 0; z < nz; z += depth) {
    const size_t count = nz - z < depth ? nz - z : depth, first = z > margin ? z - margin : 0;
    const size_t end = z + count + margin < nz ? z + count + margin : nz;
    slab.size[2] = end - first;
    TRY(slab_read(region, scanner, step, first, &slab));
    slab_restore(&slab);
    slab_keep(&slab, z - first, count, z, restored);
    progress_update(&progress, (double)(z + count), NULL);
  }
  progress_end(&progress);
cleanup:
  slab_end(&slab);
  if (status != STATUS_OK) coarse_end(restored);
  return status;
}
