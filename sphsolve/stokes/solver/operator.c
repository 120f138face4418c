#include "sphsolve/stokes/solver/operator.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/solver/cuts.h"

void stokes_operator_unpack(struct stokes_operator *op, const float *packed, int slot,
                            int component) {
  const struct stokes_grid *grid = op->grid;
  float *field = stokes_operator_field(op, slot);
#pragma omp for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    if (!stokes_grid_is_y_image(grid, row))
      op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks, packed + grid->row_start[row],
                       field + row * grid->stride);
  stokes_grid_post(grid, component, field, grid->stride * sizeof *field);
}

#define SLOTS_PER_SUM 4 /* slots from the fields of one sum over weights of soil to the next */

static void scale_row(const struct stokes_operator *op, size_t row, const float *packed,
                      const float *weight, float *field) {
  const struct stokes_grid *grid = op->grid;
  const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
  float *scaled = op->scratch + (size_t)omp_get_thread_num() * op->scratch_size;
  for (size_t i = 0; i < count; i++) scaled[i] = weight[start + i] * packed[i];
  op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks, scaled,
                   field + row * grid->stride);
}

/* Unpacks the weighted fields for the sums over links to soil. */
static void unpack_weighted(struct stokes_operator *op, const struct stokes_weights *weights,
                            const float *packed, int slot, int component) {
  const struct stokes_grid *grid = op->grid;
#pragma omp for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    for (int s = 0; s < weights->count; s++)
      scale_row(op, row, packed + grid->row_start[row], weights->value[s],
                stokes_operator_field(op, slot + s * SLOTS_PER_SUM));
  for (int s = 0; s < weights->count; s++)
    stokes_grid_post(grid, component, stokes_operator_field(op, slot + s * SLOTS_PER_SUM),
                     grid->stride * sizeof(float));
}

static void unpack_viscous(struct stokes_operator *op, const float *packed, int slot,
                           int component) {
  if (op->soil)
    unpack_weighted(op, &op->soil->viscosity, packed, slot, component);
  else
    stokes_operator_unpack(op, packed, slot, component);
}

static void unpack_pressure(struct stokes_operator *op, const float *packed) {
  const int slot = op->stencil->axis_count;
  if (op->soil)
    unpack_weighted(op, &op->soil->mobility, packed, slot, 3);
  else
    stokes_operator_unpack(op, packed, slot, 3);
}

/* Packed values of a convolution of one field on one row; the result lies in the buffers of the
 * thread. */
static const float *convolve(const struct stokes_operator *op,
                             const struct stokes_convolution *convolution, int component,
                             size_t row) {
  const struct stokes_grid *grid = op->grid;
  const float *field = stokes_operator_field(op, component), *rows[STOKES_CLASS_MAX][4];
  const size_t j = row % grid->size[1], k = row / grid->size[1];
  for (int c = 0; c < convolution->class_count; c++) {
    const struct stokes_class *class = &convolution->classes[c];
    for (int r = 0; r < class->row_count; r++)
      rows[c][r] = field + grid->stride * stokes_grid_row(grid, j, k, class->dj[r], class->dk[r]);
  }
  float *out = op->scratch + (size_t)omp_get_thread_num() * op->scratch_size;
  float *packed = out + grid->stride, *scratch = packed + grid->stride;
  op->rows->convolve(convolution, (const float *const(*)[4])rows, grid->size[0], grid->stride,
                     scratch, out);
  op->rows->pack(grid->mask + row * grid->chunks, grid->chunks, out, packed);
  stokes_cuts_subtract(op, convolution, row, field, packed);
  return packed;
}

/* The same with weights, where there is soil; the result lies in a separate buffer. */
static const float *convolve_weighted(const struct stokes_operator *op,
                                      const struct stokes_convolution *convolution, int slot,
                                      size_t row, const struct stokes_weights *weights) {
  const struct stokes_grid *grid = op->grid;
  const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
  const float *sum = convolve(op, convolution, slot, row);
  if (!op->soil->rows[row]) return sum; /* weights are 1 and 0 */
  float *out =
      op->scratch + ((size_t)omp_get_thread_num() + 1) * op->scratch_size - 2 * grid->stride;
  for (size_t i = 0; i < count; i++) out[i] = weights->value[0][start + i] * sum[i];
  for (int s = 1; s < weights->count; s++) {
    sum = convolve(op, convolution, slot + s * SLOTS_PER_SUM, row);
    for (size_t i = 0; i < count; i++) out[i] += weights->value[s][start + i] * sum[i];
  }
  return out;
}

static const float *convolve_viscous(const struct stokes_operator *op, int slot, size_t row) {
  const struct stokes_convolution *laplace = &op->stencil->laplace;
  return op->soil ? convolve_weighted(op, laplace, slot, row, &op->soil->viscosity)
                  : convolve(op, laplace, slot, row);
}

static const float *convolve_mobile(const struct stokes_operator *op,
                                    const struct stokes_convolution *convolution, int slot,
                                    size_t row) {
  return op->soil ? convolve_weighted(op, convolution, slot, row, &op->soil->mobility)
                  : convolve(op, convolution, slot, row);
}

static void viscous_row(const struct stokes_operator *op, int component, size_t row, const float *x,
                        bool add, float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const float *sum = convolve_viscous(op, component, row);
  for (size_t i = start; i < end; i++)
    y[i] = (add ? y[i] : 0.0f) + op->diagonal[i] * x[i] - sum[i - start];
}

/* y = g p on one row, before correction. */
static void gradient_row(const struct stokes_operator *op, size_t row, const float *p, float *y) {
  const size_t n = op->n, start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  for (int a = 0; a < op->stencil->axis_count; a++) {
    const float *own = op->pore_gradient + (size_t)a * n;
    const float *sum =
        convolve_mobile(op, &op->stencil->gradient[op->stencil->axes[a]], op->components - 1, row);
    float *out = y + (size_t)a * n;
    for (size_t i = start; i < end; i++) out[i] = sum[i - start] - own[i] * p[i];
    if (op->soil)
      for (size_t i = start; i < end; i++) out[i] /= op->soil->relative[i];
  }
}

/* y = B y for the packed values from start to end. */
static void correct(const struct stokes_operator *op, size_t start, size_t end, float *y) {
  for (size_t i = start; i < end; i++) {
    float corrected[3];
    stokes_correct(op, i, y, op->n, corrected);
    for (int a = 0; a < op->stencil->axis_count; a++) y[(size_t)a * op->n + i] = corrected[a];
  }
}

/* `packed`: a component of the velocity at the sites of a row, in a model with soil. It is divided
 * by the mobility of the site (that of the links is in the weights) and unpacked to one field for
 * each sum over the weights. */
static void unpack_flux(struct stokes_operator *op, size_t row, int slot, float *packed) {
  const struct stokes_grid *grid = op->grid;
  const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
  float *scaled = packed + grid->stride;
  for (int s = 0; s < op->soil->mobility.count; s++) {
    const float *weight = op->soil->mobility.value[s] + start;
    for (size_t i = 0; i < count; i++)
      scaled[i] = weight[i] * packed[i] / op->soil->relative[start + i];
    op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks, scaled,
                     stokes_operator_field(op, slot + s * SLOTS_PER_SUM) + row * grid->stride);
  }
}

/* Unpacks the velocity B (v + gamma g p) whose flux the continuity equation balances. */
static void unpack_corrected(struct stokes_operator *op, const float *x, const float *gradient) {
  const struct stokes_grid *grid = op->grid;
  const int axes = op->stencil->axis_count;
  float *corrected = op->scratch + (size_t)omp_get_thread_num() * op->scratch_size;
  const float gamma = (float)op->stabilisation;
#pragma omp for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
    for (int a = 0; a < axes && !stokes_grid_is_y_image(grid, row); a++) {
      memset(corrected, 0, count * sizeof *corrected);
      for (int b = 0; b < axes; b++) {
        const float *c = op->correction + stokes_symmetric(axes, a, b) * op->n + start;
        const float *v = x + (size_t)b * op->n + start, *g = gradient + (size_t)b * op->n + start;
        if (op->soil) {
          const float *m = op->soil->relative + start;
          for (size_t i = 0; i < count; i++) corrected[i] += c[i] * (v[i] + gamma * m[i] * g[i]);
          continue;
        }
        for (size_t i = 0; i < count; i++) corrected[i] += c[i] * (v[i] + gamma * g[i]);
      }
      if (op->soil) {
        unpack_flux(op, row, a, corrected);
        continue;
      }
      op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks, corrected,
                       stokes_operator_field(op, a) + row * grid->stride);
    }
  }
  for (int a = 0; a < axes; a++) {
    stokes_grid_post(grid, op->stencil->axes[a], stokes_operator_field(op, a),
                     grid->stride * sizeof(float));
    for (int s = 1; op->soil && s < op->soil->mobility.count; s++)
      stokes_grid_post(grid, op->stencil->axes[a], stokes_operator_field(op, a + s * SLOTS_PER_SUM),
                       grid->stride * sizeof(float));
  }
}

/* gamma L p on one row. */
static void stabilisation_row(const struct stokes_operator *op, size_t row, const float *p,
                              float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const float gamma = (float)op->laplace;
  const float *sum = convolve_mobile(op, &op->stencil->laplace, op->components - 1, row);
  for (size_t i = start; i < end; i++) y[i] = gamma * (op->pore_sum[i] * p[i] - sum[i - start]);
}

/* Adds the divergence of the corrected velocity; a site's own values are read back from the
 * field. */
static void divergence_row(const struct stokes_operator *op, size_t row, float *y) {
  const struct stokes_grid *grid = op->grid;
  const size_t start = grid->row_start[row], end = grid->row_start[row + 1];
  float *corrected =
      op->scratch + ((size_t)omp_get_thread_num() + 1) * op->scratch_size - grid->stride;
  for (int a = 0; a < op->stencil->axis_count; a++) {
    const float *own = op->pore_gradient + (size_t)a * op->n;
    op->rows->pack(grid->mask + row * grid->chunks, grid->chunks,
                   stokes_operator_field(op, a) + row * grid->stride, corrected);
    if (op->soil)
      for (size_t i = start; i < end; i++) corrected[i - start] /= op->soil->mobility.value[0][i];
    const float *sum = convolve_mobile(op, &op->stencil->gradient[op->stencil->axes[a]], a, row);
    for (size_t i = start; i < end; i++) y[i] += sum[i - start] + own[i] * corrected[i - start];
  }
}

/* Evaluates equations of one row of sites; x: input, y: output. */
typedef void row_function(const struct stokes_operator *op, size_t row, const float *x, float *y);

/* In a parallel region: calls a function for all rows that have sites; rows that depend on other
 * ranks come last, after the ghosts have arrived. */
static void for_rows(const struct stokes_operator *op, row_function *function, const float *x,
                     float *y) {
  const struct stokes_grid *grid = op->grid;
  for (int part = 0; part < STOKES_PARTS; part++) {
    stokes_grid_await(grid, part);
#pragma omp for schedule(static)
    for (size_t n = 0; n < stokes_grid_part(grid, part); n++) {
      const size_t row = stokes_grid_nth(grid, part, n);
      if (grid->row_start[row] < grid->row_start[row + 1]) function(op, row, x, y);
    }
  }
}

static void pressure_row(const struct stokes_operator *op, size_t row, const float *x, float *y) {
  const size_t pressure = (size_t)op->stencil->axis_count * op->n;
  gradient_row(op, row, x + pressure, y);
  stabilisation_row(op, row, x + pressure, y + pressure);
}

static void continuity_row(const struct stokes_operator *op, size_t row, const float *x, float *y) {
  (void)x;
  divergence_row(op, row, y + (size_t)op->stencil->axis_count * op->n);
}

static void momentum_row(const struct stokes_operator *op, size_t row, const float *x, float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  correct(op, start, end, y);
  for (int a = 0; a < op->stencil->axis_count; a++) {
    float *ya = y + (size_t)a * op->n;
    for (size_t i = start; i < end; i++) ya[i] *= op->parabola[i];
    viscous_row(op, a, row, x + (size_t)a * op->n, true, ya);
  }
}

static void one_component_row(const struct stokes_operator *op, size_t row, const float *x,
                              float *y) {
  viscous_row(op, 0, row, x, false, y);
}

void stokes_operator_apply(struct stokes_operator *op, const float *x, float *y) {
  const int axes = op->stencil->axis_count;
#pragma omp parallel num_threads(op->threads)
  {
    unpack_pressure(op, x + (size_t)axes * op->n);
    for_rows(op, pressure_row, x, y);
    unpack_corrected(op, x, y);
    for_rows(op, continuity_row, x, y);
    for (int a = 0; a < axes; a++)
      unpack_viscous(op, x + (size_t)a * op->n, a, op->stencil->axes[a]);
    for_rows(op, momentum_row, x, y);
  }
}

void stokes_operator_apply_viscous(struct stokes_operator *op, int component, const float *x,
                                   float *y) {
  const int sums = op->soil ? op->soil->viscosity.count : 0;
  if (op->soil && !op->soil->thick_layer) op->soil->viscosity.count = 1;
#pragma omp parallel num_threads(op->threads)
  {
    unpack_viscous(op, x, 0, component);
    for_rows(op, one_component_row, x, y);
  }
  if (op->soil) op->soil->viscosity.count = sums;
}

void stokes_operator_apply_gradient(struct stokes_operator *op, const float *p, float *y) {
#pragma omp parallel num_threads(op->threads)
  {
    unpack_pressure(op, p);
    for_rows(op, gradient_row, p, y);
  }
}

void stokes_operator_clear_plane(const struct stokes_operator *op, float *y) {
  const struct stokes_grid *grid = op->grid;
  if (!grid->mirrored || grid->size[2] % 2 == 0) return;
  const size_t first = grid->row_start[grid->row_end - grid->size[1]];
  for (int c = 0; c < op->components; c++) {
    const int component = c + 1 < op->components ? op->stencil->axes[c] : 3;
    if (grid->parity[component] < 0.0f)
      memset(y + (size_t)c * op->n + first, 0, (op->n - first) * sizeof *y);
  }
}
