#include "ct2model/scanner/deblur.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/grain_surface.h"
#include "ct2model/scanner/grains.h"

/* The share of grain is M u, where u, 0 <= u <= 1, minimises
 *
 *   |g - H A u|^2 / 2 + lambda S(u),   lambda = SURFACE N (1 + f')^2 / s^2.
 *
 * Here g is the scan, A the local grey of the grain, H the scanner's blur combined with the average
 * M over a voxel, and S the surface of the grains (grain_surface.h). The minimum is found by
 * accelerated projected gradients (FISTA, Beck and Teboulle 2009). u itself has steps within
 * voxels, which would make a surface interpolated between voxels rough. The gradient of the
 * misfit is divided by A^2, so that grains of all greys are restored with the same cost of surface.
 *
 * With the noise power P, the variance times the correlation volume, -log likelihood is
 * |g - H A u|^2 / (2 P). A surface of s^2, the square of the blur (at least a voxel), costs
 * SURFACE, since grains have no relief much finer than the scanner resolves. Noise correlated over
 * a length l makes less of such relief: its spectrum is P exp(-(l q)^2), and relief that is just
 * resolved has a wavenumber q with (q s)^2 of 1 to 1.5, where exp(-(q s)^2) / (2 sqrt(pi) s), the
 * gain in likelihood by relief, equals lambda q^2. So N = P exp(-RELIEF (l^2 - l0^2) / s^2),
 * relative to the finest noise that voxels resolve, of length l0 = CORRELATION_LEAST. A
 * fringe f raises the scanner's transfer of relief of wavenumber 1 / s by a factor 1 + f'
 * (edge_fit_transfer), which enters the likelihood squared; surface costs more by the same factor.
 * f' = f (blur / s)^2, since voxels do not resolve the fringe of a blur that is finer than they
 * are.
 *
 * Where grains are few blurs wide (restored.h) the minimum is far from 0 and 1: throats are
 * grey, and any threshold closes some of them. There the sum of w u (1 - u) over voxels is added,
 * with w rising slowly from 0 (graduated non-convexity, Blake and Zisserman 1987, Visual
 * Reconstruction): grain and pore become two phases, and a throat is as wide as the pore volume
 * that it contributes to the scan. u then has steps from voxel to voxel, which a narrow Gaussian
 * removes. */
/* Variance that the average over a voxel adds to the blur, voxels^2. */
static const double VOXEL_VARIANCE = 1.0 / 12.0;
struct filters {
  double once[3], twice[3]; /* standard deviations of H and of H^T H, in voxels */
  double fringe[3];         /* of H: weights of the second differences */
  double largest;           /* upper bound of the eigenvalues of H^T H */
  double cost;              /* lambda: cost of a voxel's area of surface */
};

enum status deblur_start(size_t voxels, const struct deblur_scanner *scanner,
                         struct deblur *deblur) {
  enum status status = STATUS_OK;
  *deblur =
      (struct deblur){.scanner = *scanner,
                      .iterations = scanner->two_phases > 0.0 ? ITERATIONS_TWO_PHASES : ITERATIONS};
  float **all[] = {&deblur->grey, &deblur->share, &deblur->grain, &deblur->u,
                   &deblur->y,    &deblur->a,     &deblur->b};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++)
    TRY(memory_allocate(all[i], voxels, sizeof(float), "the scan without its blur"));
  TRY(memory_allocate(&deblur->contacts, voxels, 1, "the scan without its blur"));
cleanup:
  return status;
}

void deblur_end(struct deblur *deblur) {
  float **all[] = {&deblur->grey, &deblur->share, &deblur->grain, &deblur->u,
                   &deblur->y,    &deblur->a,     &deblur->b};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) memory_free(all[i]);
  memory_free(&deblur->contacts);
}

/* The largest eigenvalue of H^T H: the square of the largest transfer. */
static double largest_transfer(double fringe) {
  double most = 1.0;
  for (int i = 0; i < 1000; i++) {
    const double x = 0.01 * i;
    most = fmax(most, exp(-0.5 * x) * (1.0 + fringe * x));
  }
  return most * most;
}

static void choose_filters(const struct deblur_scanner *scanner, struct filters *filters) {
  double blur = 0.0; /* in squares of the shortest voxel edge: the largest over the axes */
  for (int d = 0; d < 3; d++) {
    const double square = pow(scanner->blur[d], 2.0);
    filters->once[d] = sqrt(square + VOXEL_VARIANCE);
    filters->twice[d] = sqrt(2.0 * (square + VOXEL_VARIANCE));
    filters->fringe[d] = scanner->fringe * square;
    blur = fmax(blur, square * pow(scanner->stretch[d], 2.0));
  }
  const double wide = fmax(blur, 1.0);
  const double longer = fmax(
      scanner->correlation * scanner->correlation - CORRELATION_LEAST * CORRELATION_LEAST, 0.0);
  const double noise = scanner->power * exp(-RELIEF * longer / wide);
  filters->cost =
      SURFACE * scanner->surface * noise * pow(1.0 + scanner->fringe * blur / wide, 2.0) / wide;
  filters->largest = 1.05 * largest_transfer(scanner->fringe);
}

/* Estimates the local grey of the grain: the ratio of the scan's greys to those that grain of grey
 * 1 would have, which a fringe raises near surfaces, both averaged over voxels well inside grains;
 * 1 far from all of these. The greys of grains differ by some per cent, those of heavy minerals by
 * more than the contrast. y is 1 in grain, 0 in pore. */
static void find_grain(struct deblur *deblur, const struct filters *filters) {
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  float *a = deblur->a, *b = deblur->b, *work = deblur->share;
  double wide[3];
  for (int d = 0; d < 3; d++) wide[d] = fmax(1.6 * filters->once[d], 1.5);
  gaussian_filter(deblur->y, deblur->size, filters->once, work, a);
  laplacian_subtract(a, deblur->size, filters->fringe, b);
  for (size_t i = 0; i < n; i++) {
    const float inner = deblur->y[i] > 0.0F && a[i] > (float)INNER_LEAST ? 1.0F : 0.0F;
    a[i] = deblur->grey[i] * inner;
    b[i] *= inner;
  }
  gaussian_filter(a, deblur->size, wide, work, a);
  gaussian_filter(b, deblur->size, wide, work, b);
  for (size_t i = 0; i < n; i++) {
    const float grain = (a[i] + 1e-5F) / (b[i] + 1e-5F);
    deblur->grain[i] = fminf(fmaxf(grain, 0.5F), 4.0F);
  }
}

/* Starting values: the grey of the grain from the smoothed scan, not below `least`, and the share
 * of grain. */
static void guess_grain(struct deblur *deblur, const struct filters *filters, float least) {
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  double fine[3];
  for (int d = 0; d < 3; d++) fine[d] = 1.0 / deblur->scanner.stretch[d];
  gaussian_filter(deblur->grey, deblur->size, fine, deblur->share, deblur->u);
  for (size_t i = 0; i < n; i++) deblur->y[i] = deblur->u[i] > 0.5F ? 1.0F : 0.0F;
  find_grain(deblur, filters);
  for (size_t i = 0; i < n; i++) {
    deblur->grain[i] = fmaxf(deblur->grain[i], least);
    deblur->u[i] = fminf(fmaxf(deblur->u[i] / deblur->grain[i], 0.0F), 1.0F);
  }
}

/* Estimates the grey of the grain again from the share of grain restored so far. */
static void find_grain_again(struct deblur *deblur, const struct filters *filters) {
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  for (size_t i = 0; i < n; i++)
    deblur->y[i] = deblur->u[i] * deblur->grain[i] > (float)GREY_SURELY_GRAIN ? 1.0F : 0.0F;
  find_grain(deblur, filters);
}

TARGETS static void multiply(const float *restrict a, const float *restrict b, size_t n,
                             float *restrict out) {
  for (size_t i = 0; i < n; i++) out[i] = a[i] * b[i];
}

TARGETS static void divide_by(const float *restrict a, size_t n, float *restrict out) {
  for (size_t i = 0; i < n; i++) out[i] = out[i] / a[i];
}

TARGETS static void subtract_from(const float *restrict a, size_t n, float *restrict out) {
  for (size_t i = 0; i < n; i++) out[i] = a[i] - out[i];
}

/* Replaces `out`, a row of H A y, by the residual g - H A y; 0 outside the faces of the scan. */
static void row_residual(const void *context, size_t row, float *out) {
  const struct deblur *deblur = context;
  const size_t *n = deblur->size, at[2] = {row % n[1], row / n[1]}; // NOLINT: a volume has a row
  size_t first = deblur->beyond[0][0], end = n[0] - deblur->beyond[0][1];
  for (int d = 0; d < 2; d++) {
    const size_t *beyond = deblur->beyond[d + 1];
    if (at[d] < beyond[0] || at[d] + beyond[1] >= n[d + 1]) first = end = n[0];
  }
  memset(out, 0, first * sizeof *out);
  subtract_from(deblur->grey + row * n[0] + first, end - first, out + first);
  memset(out + end, 0, (n[0] - end) * sizeof *out);
}

static void row_divided(const void *context, size_t row, float *out) {
  const struct deblur *deblur = context;
  divide_by(deblur->grain + row * deblur->size[0], deblur->size[0], out);
}

static void row_kept(const void *context, size_t row, float *out) {
  (void)context, (void)row, (void)out;
}

/* Direction of descent of the misfit: a = H^T (g - H a) / A, where a holds A y at the start. If the
 * slab is compared, deblur->grey holds H^T g and H^T H is a single filter. */
static void descent_of_misfit(struct deblur *deblur, const struct filters *filters) {
  const size_t *size = deblur->size, nx = size[0], rows = size[1] * size[2];
  float *a = deblur->a, *b = deblur->b, *share = deblur->share;
  if (!deblur->compared) {
    gaussian_sharpen(a, size, filters->once, filters->fringe, b, share, row_residual, deblur);
    gaussian_sharpen(share, size, filters->once, filters->fringe, b, a, row_divided, deblur);
    return;
  }
  gaussian_sharpen(a, size, filters->twice, filters->fringe, b, share, row_kept, deblur);
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++) {
    laplacian_subtract_row(share, size, filters->fringe, row, a + row * nx);
    subtract_from(deblur->grey + row * nx, nx, a + row * nx);
    row_divided(deblur, row, a + row * nx);
  }
}

/* A step downhill with momentum; -w (1 - 2 y) is the descent of w y (1 - y), w = `well`. */
TARGETS static void descend(const float *restrict downhill, float step, float momentum, float well,
                            size_t n, float *restrict u, float *restrict y) {
  for (size_t i = 0; i < n; i++) {
    float next = y[i] + step * (downhill[i] + well * (2.0F * y[i] - 1.0F));
    next = next < 0.0F ? 0.0F : next > 1.0F ? 1.0F : next;
    y[i] = next + momentum * (next - u[i]);
    u[i] = next;
  }
}

/* Tells the progress after some iterations. */
static void tell(struct deblur *deblur, int iterations) {
  deblur->iteration += iterations;
  if (deblur->progress != NULL)
    progress_update(deblur->progress,
                    deblur->done + (double)deblur->iteration /
                                       (ITERATIONS_FIRST + COST_OF_GRAINS + deblur->iterations),
                    NULL);
}

/* Iterates from the current u; deblur->grey as descent_of_misfit expects it. */
static void iterate(struct deblur *deblur, const struct filters *filters, int iterations) {
  const size_t nx = deblur->size[0], rows = deblur->size[1] * deblur->size[2];
  struct grain_surface surface = {.cost = filters->cost, .contacts = deblur->contacts};
  memcpy(surface.size, deblur->size, sizeof surface.size);
  memcpy(surface.stretch, deblur->scanner.stretch, sizeof surface.stretch);
  const double step = 1.0 / (filters->largest + grain_surface_stiffness(&surface));
  double t = 1.0;
  float *y = deblur->y, *a = deblur->a;
  memcpy(y, deblur->u, nx * rows * sizeof *y);
  multiply(deblur->grain, y, nx * rows, a);
  for (int iteration = 0; iteration < iterations; iteration++) {
    const double next = 0.5 * (1.0 + sqrt(1.0 + 4.0 * t * t));
    descent_of_misfit(deblur, filters);
    grain_surface_pull(&surface, y, deblur->b, a);
    const double well = WELL * deblur->scanner.two_phases * ramp(iteration, WELL_FIRST, WELL_LAST);
#pragma omp parallel for schedule(static)
    for (size_t at = 0; at < rows * nx; at += nx) {
      descend(a + at, (float)step, (float)((t - 1.0) / next), (float)well, nx, deblur->u + at,
              y + at);
      multiply(deblur->grain + at, y + at, nx, a + at);
    }
    t = next;
    tell(deblur, 1);
  }
}

/* Smooths the steps from voxel to voxel that two phases leave in u. */
static void smooth_steps(struct deblur *deblur) {
  double deviation[3];
  for (int d = 0; d < 3; d++)
    deviation[d] = WELL_SMOOTHED * deblur->scanner.two_phases / deblur->scanner.stretch[d];
  gaussian_filter(deblur->u, deblur->size, deviation, deblur->a, deblur->u);
}

/* Where grains lie close together, the blur hides the pores between them; the scan then seems to
 * show the inside of a darker grain, which would fill these pores. So no grain is taken to be
 * darker at first, and its grey is estimated again once pores have appeared
 * (docs/physics/restoration.md). A slab that the scan fills is one that is compared with a
 * simulated scan restored in the same way; it does without this, as the thresholds in
 * smooth_walls.c were determined so. */
enum status deblur_run(struct deblur *deblur) {
  enum status status = STATUS_OK;
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  const bool whole = deblur->compared;
  struct filters filters = {.largest = 0.0};
  double average[3];
  for (int d = 0; d < 3; d++)
    average[d] = -0.5 * VOXEL_VARIANCE; /* M as a Laplacian: it blurs by twice the weight */
  choose_filters(&deblur->scanner, &filters);
  guess_grain(deblur, &filters, whole ? 0.0F : 1.0F);
  if (whole) {
    gaussian_filter(deblur->grey, deblur->size, filters.once, deblur->share, deblur->a);
    laplacian_subtract(deblur->a, deblur->size, filters.fringe, deblur->grey);
  }
  memset(deblur->contacts, 0, n);
  deblur->iteration = 0;
  iterate(deblur, &filters, ITERATIONS_FIRST);
  if (!whole) find_grain_again(deblur, &filters);
  TRY(grains_find(deblur->u, deblur->size, deblur->scanner.stretch, deblur->contacts));
  tell(deblur, COST_OF_GRAINS);
  iterate(deblur, &filters, deblur->iterations);
  if (deblur->scanner.two_phases > 0.0) smooth_steps(deblur);
  laplacian_subtract(deblur->u, deblur->size, average, deblur->share);
cleanup:
  return status;
}

double deblur_misfit(struct deblur *deblur, const float *grey) {
  const size_t n = deblur->size[0] * deblur->size[1] * deblur->size[2];
  struct filters filters = {.largest = 0.0};
  double square = 0.0;
  choose_filters(&deblur->scanner, &filters);
  multiply(deblur->grain, deblur->u, n, deblur->a);
  gaussian_filter(deblur->a, deblur->size, filters.once, deblur->y, deblur->a);
  laplacian_subtract(deblur->a, deblur->size, filters.fringe, deblur->b);
  for (size_t i = 0; i < n; i++) square += pow((double)deblur->b[i] - (double)grey[i], 2.0);
  return square;
}
