/* Statistical error. The uncertainty of a mean over the sample follows from its variation within
 * the sample: the box is divided into blocks, and the variance of the mean is estimated from their
 * sums of the integrand of D* (closure.h: |grad phi|^2). This holds for conduction and for most of
 * D_T. D_L at high Peclet numbers depends on few quantities: the differences of the water's
 * velocity, averaged over the length of the box, between columns along the flow. In terms of waves
 * k across the flow it contains
 *   the sum over k of C_k = -Re(u'_k conj(b_k)) / D,   u', b: means over columns.
 * Each wave is one random realisation, whose square is as uncertain as it is large (a complex
 * normal amplitude: standard deviation = mean, so that C_k^2 / 2 is an estimate of its variance).
 *
 * Periodicity. Water in a larger sample would leave its fast column after a while; here it enters
 * the same one again in each period. For a velocity with the spectrum S(k), advected with U and
 * spread with D_T, D_L is the sum over the wave numbers q = 2 pi n / W along the flow of
 *   S D_T k^2 / ((U q)^2 + (D_T k^2)^2) = (S W / 2 U) coth(r),   r = W D_T k^2 / (2 U),
 * of which the term n = 0, the columns, is 1 / r; in an infinite soil, the integral over q, it is
 * S W / (2 U) (Koch, Brady 1987, J. Fluid Mech. 180, 387, for the integral). Each wave is therefore
 * too large by
 *   C_k r (coth(r) - 1).
 * In a box that is its own mirror image along the flow every streamline returns to its place: then
 * all of C_k is in excess.
 *
 * Sides. Where a sample that is not mirrored adjoins its periodic copy the pores do not match: over
 * one correlation length of the velocity, D* is not that of the soil. */
#include "sphsolve/solute/sample_size.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow.h"

#define WAVES 16 /* wave numbers across the flow, along each axis: shorter waves are negligible */
#define BLOCKS 4 /* along each axis */
#define DIRECTIONS 4     /* directions that are transformed: the solver's three axes and the flow */
#define DIRECTION_FLOW 3 /* the last of them */
enum { ROW = 2 * WAVES + 1 };

/* Columns along the flow: the sum of u' and the mean of b over the pores, for each direction. */
struct columns {
  int n[2];
  double *flux[DIRECTIONS], *mean[DIRECTIONS];
  double volume; /* of all pores */
};

static void columns_free(struct columns *c) {
  for (int w = 0; w < DIRECTIONS; w++) {
    MEMORY_FREE(&c->flux[w], &c->mean[w]);
  }
}

static enum status columns_find(const struct solute_closure *closure, struct columns *c) {
  enum status status = STATUS_OK;
  const struct solute_cells *cells = &closure->solver.cells[0];
  *c = (struct columns){.n = {cells->n[0], cells->n[1]}};
  const size_t count = (size_t)c->n[0] * (size_t)c->n[1];
  for (int w = 0; w < DIRECTIONS; w++) {
    TRY(memory_allocate(&c->flux[w], count, sizeof(double), "columns of the flow"));
    TRY(memory_allocate(&c->mean[w], count, sizeof(double), "columns of the flow"));
  }
  for (int j = 0; j < c->n[1]; j++)
    for (int i = 0; i < c->n[0]; i++) {
      double flux[DIRECTIONS] = {0}, mean[DIRECTIONS] = {0}, volume = 0;
      for (int k = 0; k < cells->n[2]; k++) {
        const size_t at = solute_cells_at(cells, i, j, k);
        const int x[3] = {i, j, k};
        const double own = (double)cells->volume[at];
        volume += own;
        for (int a = 0; a < 3; a++) {
          if (closure->b[a] == NULL) continue;
          const double u =
              0.5 * cells->width[a][x[a]] *
                  ((double)cells->flux[a][at] + (double)cells->flux[a][at + cells->stride[a]]) -
              closure->mean[a] * own;
          const double b = closure->b[a][at] * own;
          flux[a] += u, mean[a] += b;
          flux[DIRECTION_FLOW] += closure->mean[a] * u,
              mean[DIRECTION_FLOW] += closure->mean[a] * b;
        }
      }
      const size_t at = (size_t)j * (size_t)c->n[0] + (size_t)i;
      c->volume += volume;
      for (int w = 0; w < DIRECTIONS; w++) {
        c->flux[w][at] = flux[w];
        c->mean[w][at] = volume > 0 ? mean[w] / volume : 0;
      }
    }
cleanup:
  if (status != STATUS_OK) columns_free(c);
  return status;
}

/* Fourier components of `values` (real, imaginary): waves -WAVES .. WAVES along the first axis, 0
 * .. WAVES along the second. */
static void transform(const int n[2], const double *values, double wave[WAVES + 1][ROW][2]) {
  const double turn = 2 * M_PI;
  memset(wave, 0, sizeof(double) * (WAVES + 1) * ROW * 2);
  for (int j = 0; j < n[1]; j++) {
    double row[ROW][2] = {{0}};
    for (int p = 0; p < ROW; p++)
      for (int i = 0; i < n[0]; i++) {
        const double angle = turn * ((p - WAVES) * i % n[0]) / n[0];
        row[p][0] += cos(angle) * values[(size_t)j * (size_t)n[0] + (size_t)i];
        row[p][1] += sin(angle) * values[(size_t)j * (size_t)n[0] + (size_t)i];
      }
    for (int q = 0; q <= WAVES; q++) {
      const double angle = turn * (q * j % n[1]) / n[1], co = cos(angle), si = sin(angle);
      for (int p = 0; p < ROW; p++) {
        wave[q][p][0] += co * row[p][0] - si * row[p][1];
        wave[q][p][1] += co * row[p][1] + si * row[p][0];
      }
    }
  }
}

/* C_k of a wave and its opposite together, longitudinal and transverse. */
static void wave_share(double flux[DIRECTIONS][2], double mean[DIRECTIONS][2], double scale,
                       int dimensions, double share[2]) {
  double each[DIRECTIONS];
  for (int w = 0; w < DIRECTIONS; w++)
    each[w] = -scale * (flux[w][0] * mean[w][0] + flux[w][1] * mean[w][1]);
  share[0] = each[DIRECTION_FLOW];
  share[1] = (each[0] + each[1] + each[2] - each[DIRECTION_FLOW]) / (dimensions - 1);
}

/* Adds the statistical variance of D*, and its excess due to periodicity, from the waves. */
static enum status add_waves(const struct solute_closure *closure, double s,
                             const struct solute_dispersion *d, const bool images[3],
                             double variance[2], double repeats[2]) {
  enum status status = STATUS_OK;
  const struct solute_cells *cells = &closure->solver.cells[0];
  struct columns c = {0};
  double(*wave)[WAVES + 1][ROW][2] = NULL; /* of the fluxes, then of the means */
  double side[3] = {0}, step[2];
  TRY(columns_find(closure, &c));
  TRY(memory_allocate(&wave, 2 * DIRECTIONS, sizeof *wave, "waves across the flow"));
  for (int w = 0; w < DIRECTIONS; w++) {
    transform(c.n, c.flux[w], wave[w]);
    transform(c.n, c.mean[w], wave[DIRECTIONS + w]);
  }
  for (int a = 0; a < 3; a++)
    for (int i = 0; i < cells->n[a]; i++) side[a] += cells->width[a][i];
  for (int a = 0; a < 2; a++) step[a] = 2 * M_PI / side[a];
  const double scale = 2 * s / ((double)c.n[0] * (double)c.n[1] * c.volume);
  /* In a mirrored box the waves (p, q) and (-p, q) are not independent. */
  const bool paired = images[closure->axis[0]] || images[closure->axis[1]];
  for (int q = 0; q <= WAVES && 2 * q < c.n[1]; q++)
    for (int p = -WAVES; p <= WAVES; p++) {
      if (2 * abs(p) >= c.n[0] || (q == 0 && p <= 0)) continue;
      double flux[DIRECTIONS][2], mean[DIRECTIONS][2], share[2];
      for (int w = 0; w < DIRECTIONS; w++) {
        memcpy(flux[w], wave[w][q][p + WAVES], sizeof flux[w]);
        memcpy(mean[w], wave[DIRECTIONS + w][q][p + WAVES], sizeof mean[w]);
      }
      wave_share(flux, mean, scale, closure->dimensions, share);
      const double k2 = pow(p * step[0], 2) + pow(q * step[1], 2);
      const double r = side[2] * d->transverse * k2 / (2 * s);
      const double excess = images[closure->axis[2]] ? 1 : r < 20 ? r * (1 / tanh(r) - 1) : 0;
      for (int t = 0; t < 2; t++) {
        variance[t] += share[t] * share[t] * (paired && p != 0 && q != 0 ? 1 : 0.5);
        repeats[t] += excess * fmax(share[t], 0);
      }
    }
cleanup:
  columns_free(&c);
  memory_free(&wave);
  return status;
}

/* Adds the statistical variance of D* from the sums over blocks of its integrand minus D* times
 * their pore volume. */
static void add_blocks(const struct solute_closure *closure, const struct solute_dispersion *d,
                       const bool images[3], double variance[2]) {
  const struct solute_cells *cells = &closure->solver.cells[0];
  static const int all = BLOCKS * BLOCKS * BLOCKS;
  double sum[BLOCKS * BLOCKS * BLOCKS][2] = {{0}}, volume = 0, square[2] = {0};
  const double value[2] = {d->longitudinal, d->transverse};
  int blocks = 1;
  for (int k = 0; k < cells->n[2]; k++)
    for (int j = 0; j < cells->n[1]; j++)
      for (int i = 0; i < cells->n[0]; i++) {
        const size_t at = solute_cells_at(cells, i, j, k);
        const int x[3] = {i, j, k};
        int block = 0;
        for (int a = 2; a >= 0; a--) block = block * BLOCKS + x[a] * BLOCKS / cells->n[a];
        volume += (double)cells->volume[at];
        for (int t = 0; t < 2; t++) sum[block][t] -= value[t] * (double)cells->volume[at];
        for (int a = 0; a < 3; a++) {
          const double g = (double)cells->conductance[a][at];
          const size_t low = at - cells->stride[a];
          double along = 0, squares = 0;
          if (!(g > 0)) continue;
          for (int p = 0; p < 3; p++) {
            if (closure->b[p] == NULL) continue;
            const double change = closure->b[p][at] - closure->b[p][low] +
                                  (a == p ? solute_cells_apart(cells, a, x[a]) : 0);
            along += closure->direction[closure->axis[p]] * change;
            squares += change * change;
          }
          sum[block][0] += g * along * along;
          sum[block][1] += g * (squares - along * along) / (closure->dimensions - 1);
        }
      }
  for (int b = 0; b < all; b++)
    for (int t = 0; t < 2; t++) square[t] += sum[b][t] * sum[b][t];
  /* In a mirrored box blocks come in pairs that are not independent; an axis with one cell is not
   * divided. */
  double pairs = 1;
  for (int a = 0; a < 3; a++) {
    if (cells->n[a] > 1) blocks *= BLOCKS;
    if (images[closure->axis[a]]) pairs *= 2;
  }
  for (int t = 0; t < 2; t++)
    variance[t] += pairs * square[t] * blocks / (blocks - 1.0) / (volume * volume);
}

enum status solute_sample_size(const struct solute_closure *closure, double diffusion,
                               const struct solute_dispersion *d, const bool images[3],
                               double correlation, struct solute_sample *sample) {
  enum status status = STATUS_OK;
  const struct solute_cells *cells = &closure->solver.cells[0];
  const double s =
      closure->speed > 0 && isfinite(diffusion) ? closure->speed * closure->unit / diffusion : 0;
  double variance[2] = {0}, repeats[2] = {0};
  *sample = (struct solute_sample){{NAN, NAN}, {NAN, NAN}};
  for (int a = 0; a < 3; a++)
    if (cells->n[a] > 1 && cells->n[a] < BLOCKS) return STATUS_OK;
  if (s > 0 && fabs(closure->mean[2]) < AXIS_COSINE_MIN) return STATUS_OK;
  if (s > 0) TRY(add_waves(closure, s, d, images, variance, repeats));
  add_blocks(closure, d, images, variance);
  double sides = 0;
  for (int a = 0; a < 3; a++)
    if (cells->n[a] > 1 && !images[closure->axis[a]])
      sides +=
          correlation / (closure->unit * cells->width[a][0] * cells->n[a]) / closure->dimensions;
  const double value[2] = {d->longitudinal, d->transverse};
  for (int t = 0; t < 2; t++) {
    if (!(value[t] > 0)) continue;
    sample->repeats[t] = repeats[t] / value[t];
    sample->error[t] = hypot(hypot(2 * sqrt(variance[t]) / value[t], sample->repeats[t]), sides);
  }
cleanup:
  return status;
}

void solute_correlation_lengths(const struct solute_flow *f, double length[2]) {
  const double *mean = f->mean_velocity;
  int along = 0;
  for (int a = 1; a < 3; a++)
    if (fabs(mean[a]) > fabs(mean[along])) along = a;
  const float *u = f->velocity[along];
  double average = 0, square = 0, of_axis[3] = {0};
  for (size_t at = 0; at < f->count; at++)
    average += (double)u[at], square += (double)u[at] * (double)u[at];
  average /= (double)f->count;
  const double variance = square / (double)f->count - average * average;
  for (int a = 0; a < 3; a++) {
    double sum = 0.5, before = 1;
    for (int lag = 1; 2 * lag <= f->n[a] && variance > 0; lag++) {
      double products = 0;
      for (int k = 0; k < f->n[2]; k++)
        for (int j = 0; j < f->n[1]; j++)
          for (int i = 0; i < f->n[0]; i++) {
            int x[3] = {i, j, k};
            x[a] += lag;
            products += (double)u[solute_flow_at(f, i, j, k)] *
                        (double)u[solute_flow_at(f, x[0], x[1], x[2])];
          }
      const double now = (products / (double)f->count - average * average) / variance;
      if (now <= 0) {
        sum += 0.5 * before * before / (before - now) - 0.5 * before;
        break;
      }
      sum += 2 * (lag + 1) > f->n[a] ? 0.5 * now : now;
      before = now;
    }
    of_axis[a] = sum * f->spacing[a];
  }
  length[0] = of_axis[along];
  length[1] = f->dimensions == 2 ? of_axis[along == 0 ? 2 : 0]
                                 : 0.5 * (of_axis[(along + 1) % 3] + of_axis[(along + 2) % 3]);
}
