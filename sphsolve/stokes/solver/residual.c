/* The operator of operator.c in double precision, for residuals. */
#include "sphsolve/stokes/solver/operator.h"

#include <omp.h>
#include <string.h>

#include "sphsolve/stokes/solver/cuts.h"

static void unpack_double(struct stokes_operator *op, int component, const double *packed) {
  const struct stokes_grid *grid = op->grid;
  double *field = (double *)(void *)op->field;
#pragma omp for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    if (stokes_grid_is_y_image(grid, row)) continue;
    const double *p = packed + grid->row_start[row];
    double *out = field + row * grid->stride;
    memset(out, 0, grid->stride * sizeof *out);
    for (size_t c = 0; c < grid->chunks; c++)
      for (unsigned bits = grid->mask[row * grid->chunks + c]; bits; bits &= bits - 1)
        out[c * STOKES_LANES + (size_t)__builtin_ctz(bits)] = *p++;
  }
  stokes_grid_post(grid, component, field, grid->stride * sizeof *field);
  stokes_grid_await(grid, 1);
}

/* Unpacks the weighted fields for the sums over links to soil. */
static void unpack_weighted(struct stokes_operator *op, int component,
                            const struct stokes_weights *weights, const double *packed) {
  const struct stokes_grid *grid = op->grid;
  for (int s = 0; s < weights->count; s++) {
    double *field = (double *)(void *)op->field + (size_t)s * grid->rows * grid->stride;
#pragma omp for schedule(static)
    for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
      size_t n = grid->row_start[row];
      double *out = field + row * grid->stride;
      memset(out, 0, grid->stride * sizeof *out);
      for (size_t c = 0; c < grid->chunks; c++)
        for (unsigned bits = grid->mask[row * grid->chunks + c]; bits; bits &= bits - 1, n++)
          out[c * STOKES_LANES + (size_t)__builtin_ctz(bits)] =
              (double)weights->value[s][n] * packed[n];
    }
    stokes_grid_post(grid, component, field, grid->stride * sizeof *field);
    stokes_grid_await(grid, 1);
  }
}

static const double *convolve_field(const struct stokes_operator *op,
                                    const struct stokes_convolution *convolution,
                                    const double *field, size_t row) {
  const struct stokes_grid *grid = op->grid;
  const double *rows[STOKES_CLASS_MAX][4];
  double *out = (double *)(void *)(op->scratch + (size_t)omp_get_thread_num() * op->scratch_size);
  double *packed = out + grid->stride, *scratch = packed + grid->stride + STOKES_LANES;
  for (int c = 0; c < convolution->class_count; c++) {
    const struct stokes_class *class = &convolution->classes[c];
    for (int r = 0; r < class->row_count; r++)
      rows[c][r] =
          field + grid->stride * stokes_grid_row(grid, row % grid->size[1], row / grid->size[1],
                                                 class->dj[r], class->dk[r]);
  }
  op->rows->convolve_double(convolution, (const double *const(*)[4])rows, grid->size[0],
                            grid->stride, scratch, out);
  double *p = packed;
  for (size_t c = 0; c < grid->chunks; c++)
    for (unsigned bits = grid->mask[row * grid->chunks + c]; bits; bits &= bits - 1)
      *p++ = out[c * STOKES_LANES + (size_t)__builtin_ctz(bits)];
  stokes_cuts_subtract_double(op, convolution, row, field, packed);
  return packed;
}

/* `weights`: those with which the fields were unpacked; NULL: there is no soil. */
static const double *convolve_double(const struct stokes_operator *op,
                                     const struct stokes_convolution *convolution,
                                     const struct stokes_weights *weights, size_t row) {
  const struct stokes_grid *grid = op->grid;
  const double *field = (const double *)(const void *)op->field;
  const double *sum = convolve_field(op, convolution, field, row);
  if (weights == NULL || !op->soil->rows[row]) return sum;
  const size_t start = grid->row_start[row], count = grid->row_start[row + 1] - start;
  double *out =
      (double *)(void *)(op->scratch + ((size_t)omp_get_thread_num() + 1) * op->scratch_size) -
      grid->stride;
  for (size_t i = 0; i < count; i++) out[i] = (double)weights->value[0][start + i] * sum[i];
  for (int s = 1; s < weights->count; s++) {
    sum = convolve_field(op, convolution, field + (size_t)s * grid->rows * grid->stride, row);
    for (size_t i = 0; i < count; i++) out[i] += (double)weights->value[s][start + i] * sum[i];
  }
  return out;
}

static const struct stokes_weights *mobility_of(const struct stokes_operator *op) {
  return op->soil ? &op->soil->mobility : NULL;
}
static const struct stokes_weights *viscosity_of(const struct stokes_operator *op) {
  return op->soil ? &op->soil->viscosity : NULL;
}

/* Pressure terms of one row: the gradient, before correction, and the stabilisation. */
static void pressure_terms(const struct stokes_operator *op, size_t row, const double *p,
                           float *residual) {
  const int axes = op->stencil->axis_count;
  const size_t n = op->n, start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  for (int a = 0; a < axes; a++) {
    const double *sum =
        convolve_double(op, &op->stencil->gradient[op->stencil->axes[a]], mobility_of(op), row);
    const float *own = op->pore_gradient + (size_t)a * n;
    float *raw = residual + (size_t)a * n;
    for (size_t i = start; i < end; i++) raw[i] = (float)(sum[i - start] - (double)own[i] * p[i]);
    if (op->soil)
      for (size_t i = start; i < end; i++)
        raw[i] = raw[i] / op->soil->relative[i] - op->soil->force_defect[(size_t)a * n + i];
  }
  const double *sum = convolve_double(op, &op->stencil->laplace, mobility_of(op), row);
  for (size_t i = start; i < end; i++)
    residual[(size_t)axes * n + i] =
        (float)(-op->laplace * ((double)op->pore_sum[i] * p[i] - sum[i - start]));
}

static void divergence_terms(const struct stokes_operator *op, int axis, size_t row,
                             const double *v, float *continuity) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const double *sum =
      convolve_double(op, &op->stencil->gradient[op->stencil->axes[axis]], mobility_of(op), row);
  const float *own = op->pore_gradient + (size_t)axis * op->n;
  for (size_t i = start; i < end; i++)
    continuity[i] -= (float)(sum[i - start] + (double)own[i] * v[i]);
}

/* `momentum`: on entry the pressure gradient, on return the residual. */
static void viscous_terms(const struct stokes_operator *op, int axis, size_t row, double force,
                          const double *v, float *momentum) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const double *sum = convolve_double(op, &op->stencil->laplace, viscosity_of(op), row);
  const float *drag = op->drag ? op->drag + (size_t)axis * op->n : NULL;
  for (size_t i = start; i < end; i++)
    momentum[i] =
        (float)((double)op->parabola[i] * (force - (double)momentum[i]) +
                (drag ? (double)drag[i] : 0.0) - ((double)op->diagonal[i] * v[i] - sum[i - start]));
}

/* Kernel average of the unpacked velocity at every wall site, into the second field. */
static void average_at_walls(const struct stokes_operator *op, int component) {
  const struct stokes_grid *grid = op->grid;
  const double *field = (const double *)(const void *)op->field;
  double *average = (double *)(void *)op->field + grid->rows * grid->stride;
#pragma omp for schedule(static)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    for (size_t i = 0; i < grid->stride; i++) {
      double sum = 0.0, weight = 0.0;
      const bool wall = i < grid->size[0] && !stokes_grid_is_active(grid, row, i) &&
                        !stokes_wall_slips(op, row * grid->size[0] + i);
      for (int o = 0; wall && o < op->stencil->offset_count; o++) {
        const struct stokes_offset *offset = &op->stencil->offsets[o];
        const size_t other = stokes_grid_row(grid, row % grid->size[1], row / grid->size[1],
                                             offset->step[1], offset->step[2]);
        long x = (long)i + offset->step[0];
        while (x < 0) x += (long)grid->size[0];
        while (x >= (long)grid->size[0]) x -= (long)grid->size[0];
        if (!stokes_grid_is_active(grid, other, (size_t)x)) continue;
        sum += offset->weight * field[other * grid->stride + (size_t)x];
        weight += offset->weight;
      }
      average[row * grid->stride + i] = weight > 0.0 ? sum / weight : 0.0;
    }
  stokes_grid_post(grid, component, average, grid->stride * sizeof *average);
  stokes_grid_await(grid, 1);
}

/* Adds the difference between the average, which Adami walls mirror, and the site's own velocity,
 * which the operator mirrors. */
static void adami_terms(const struct stokes_operator *op, size_t row, const double *v,
                        float *momentum) {
  const struct stokes_grid *grid = op->grid;
  const double *average = (const double *)(const void *)op->field + grid->rows * grid->stride;
  const size_t start = grid->row_start[row], end = grid->row_start[row + 1];
  const double *sum = convolve_field(op, &op->stencil->laplace, average, row);
  for (size_t i = start; i < end; i++) {
    const double walls = 0.5 * ((double)op->diagonal[i] - (double)op->pore_sum[i]);
    momentum[i] += (float)(walls * v[i] - sum[i - start]);
  }
}

/* packed = a component of B (v + gamma g p), divided by the mobility where there is soil. */
static void correct(const struct stokes_operator *op, int axis, const double *x,
                    const float *gradient, double *packed) {
  const int axes = op->stencil->axis_count;
#pragma omp for schedule(static)
  for (size_t i = 0; i < op->n; i++) {
    packed[i] = 0.0;
    for (int a = 0; a < axes; a++) {
      const size_t at = (size_t)a * op->n + i;
      packed[i] += (double)op->correction[stokes_symmetric(axes, axis, a) * op->n + i] *
                   (op->soil ? x[at] / (double)op->soil->relative[i] +
                                   op->stabilisation * (double)gradient[at]
                             : x[at] + op->stabilisation * (double)gradient[at]);
    }
  }
}

static void unpack_linked(struct stokes_operator *op, int component,
                          const struct stokes_weights *weights, const double *packed) {
  if (weights)
    unpack_weighted(op, component, weights, packed);
  else
    unpack_double(op, component, packed);
}

void stokes_operator_right_side(const struct stokes_operator *op, const double force[3],
                                float *residual) {
  const size_t axes = (size_t)op->stencil->axis_count, n = op->n;
  for (size_t a = 0; a < axes; a++) {
    const double along = force[op->stencil->axes[a]];
    const float *drag = op->drag ? op->drag + a * n : NULL;
    float *momentum = residual + a * n;
#pragma omp parallel for schedule(static) num_threads(op->threads)
    for (size_t i = 0; i < n; i++)
      momentum[i] = (float)((double)op->parabola[i] * along + (drag ? (double)drag[i] : 0.0));
  }
  memset(residual + axes * n, 0, n * sizeof *residual);
}

void stokes_operator_residual(struct stokes_operator *op, const double force[3], const double *x,
                              double *work, float *residual) {
  const int axes = op->stencil->axis_count;
  const struct stokes_grid *grid = op->grid;
  const double *p = x + (size_t)axes * op->n;
  float *continuity = residual + (size_t)axes * op->n;
#pragma omp parallel num_threads(op->threads)
  {
    unpack_linked(op, 3, mobility_of(op), p);
#pragma omp for schedule(static)
    for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
      if (grid->row_start[row] < grid->row_start[row + 1]) pressure_terms(op, row, p, residual);
    for (int a = 0; a < axes; a++) {
      correct(op, a, x, residual, work);
      unpack_linked(op, op->stencil->axes[a], mobility_of(op), work);
#pragma omp for schedule(static)
      for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
        if (grid->row_start[row] < grid->row_start[row + 1])
          divergence_terms(op, a, row, work, continuity);
    }
#pragma omp for schedule(static)
    for (size_t i = 0; i < op->n; i++) {
      float gradient[3];
      stokes_correct(op, i, residual, op->n, gradient);
      for (int a = 0; a < axes; a++) residual[(size_t)a * op->n + i] = gradient[a];
    }
    for (int a = 0; a < axes; a++) {
      const double *v = x + (size_t)a * op->n;
      unpack_linked(op, op->stencil->axes[a], viscosity_of(op), v);
#pragma omp for schedule(static)
      for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
        if (grid->row_start[row] < grid->row_start[row + 1])
          viscous_terms(op, a, row, force[op->stencil->axes[a]], v, residual + (size_t)a * op->n);
      if (op->wall != WALL_ADAMI) continue;
      average_at_walls(op, op->stencil->axes[a]);
#pragma omp for schedule(static)
      for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
        if (grid->row_start[row] < grid->row_start[row + 1])
          adami_terms(op, row, v, residual + (size_t)a * op->n);
    }
  }
}
