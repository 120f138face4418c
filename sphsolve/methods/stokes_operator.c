#include "sphsolve/methods/stokes_operator.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/effects/stokes_wall_subvoxel.h"

struct builder {
  struct stokes_operator *op;
  const struct lattice *lattice;
  const struct scene *scene;
  enum wall_scheme wall;
  double velocity_unit;
};

/* What the walls around one site do to its momentum equation, and its sums over pore sites. */
struct site_sums {
  double diagonal, parabola, pore_sum, pore_gradient[3], drag[3];
  double flux_velocity, flux_force;
  bool smooth; /* the wall distances are those of a surface */
};

static double distance(const struct builder *b, size_t site) {
  return b->lattice->wall_distance[site] / b->op->stencil->unit;
}

static const struct region *wall_region(const struct builder *b, size_t site) {
  if (!b->scene || !b->lattice->region || b->lattice->region[site] == 0) return NULL;
  return &b->scene->regions[b->lattice->region[site] - 1];
}

static void add_wall(const struct builder *b, const struct stokes_offset *offset, size_t site,
                     size_t other, struct site_sums *sums) {
  const struct region *region = wall_region(b, other);
  if (region && region->slip) return; /* moves along: no shear */
  double factor = 1.0;                /* frozen: at rest where it is */
  if (b->wall == WALL_ADAMI) factor = 2.0;
  if (b->wall == WALL_SUBVOXEL) {
    const struct wall_image image =
        wall_subvoxel(distance(b, site), -distance(b, other), offset->r);
    factor = 1.0 + image.linear;
    sums->parabola += offset->viscous * image.parabola;
    sums->smooth = sums->smooth && image.smooth;
  }
  sums->diagonal += offset->viscous * factor;
  for (int a = 0; region && a < 3; a++)
    sums->drag[a] += offset->viscous * factor * region->velocity[a] / b->velocity_unit;
}

static void sum_site(const struct builder *b, const size_t at[3], struct site_sums *sums) {
  const struct stokes_stencil *stencil = b->op->stencil;
  const struct stokes_grid *grid = b->op->grid;
  const size_t nx = grid->size[0], site = (at[2] * grid->size[1] + at[1]) * nx + at[0];
  *sums = (struct site_sums){.flux_velocity = 1.0, .smooth = true};
  for (int o = 0; o < stencil->offset_count; o++) {
    const struct stokes_offset *offset = &stencil->offsets[o];
    const size_t row = stokes_grid_row(grid, at[1], at[2], offset->step[1], offset->step[2]);
    const long x = ((long)at[0] + offset->step[0]) % (long)nx;
    const size_t i = (size_t)(x < 0 ? x + (long)nx : x), other = row * nx + i;
    const int *step = offset->step;
    if (stokes_grid_is_active(grid, row, i)) {
      sums->diagonal += offset->viscous;
      sums->pore_sum += offset->viscous;
      for (int a = 0; a < 3; a++) sums->pore_gradient[a] += offset->gradient[a];
    } else if (b->lattice->kind[other] == SITE_WALL) {
      add_wall(b, offset, site, other, sums);
      if (b->wall == WALL_SUBVOXEL && abs(step[0]) + abs(step[1]) + abs(step[2]) == 1) {
        const struct wall_quadrature end =
            wall_quadrature(distance(b, site), -distance(b, other), offset->r);
        sums->flux_velocity += end.velocity;
        sums->flux_force += end.force;
      }
    } else {
      sums->diagonal += offset->viscous; /* a pore that cannot flow: at rest */
    }
  }
  if (!sums->smooth) sums->parabola = 0.0;
  sums->parabola = fmin(sums->parabola, WALL_PARABOLA_MAX);
}

static void build_sites(const struct builder *b) {
  struct stokes_operator *op = b->op;
  const struct stokes_grid *grid = op->grid;
#pragma omp parallel for schedule(dynamic, 16)
  for (size_t row = 0; row < grid->rows; row++) {
    size_t n = grid->row_start[row];
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      struct site_sums sums;
      sum_site(b, (const size_t[3]){i, row % grid->size[1], row / grid->size[1]}, &sums);
      op->diagonal[n] = (float)sums.diagonal;
      op->pore_sum[n] = (float)sums.pore_sum;
      op->parabola[n] = (float)(1.0 - sums.parabola);
      if (op->flux_velocity) {
        op->flux_velocity[n] = (float)sums.flux_velocity;
        op->flux_force[n] = (float)sums.flux_force;
      }
      for (int a = 0; a < op->stencil->axis_count; a++) {
        op->pore_gradient[(size_t)a * op->n + n] = (float)sums.pore_gradient[op->stencil->axes[a]];
        if (op->drag) op->drag[(size_t)a * op->n + n] = (float)sums.drag[op->stencil->axes[a]];
      }
      n++;
    }
  }
}

static bool walls_move(const struct scene *scene) {
  for (size_t r = 0; scene && r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type == REGION_WALL &&
        (region->velocity[0] != 0.0 || region->velocity[1] != 0.0 || region->velocity[2] != 0.0))
      return true;
  }
  return false;
}

enum status stokes_operator_build(const struct stokes_stencil *stencil,
                                  const struct stokes_grid *grid, const struct lattice *lattice,
                                  const struct scene *scene, enum wall_scheme wall, double tau,
                                  double velocity_unit, struct stokes_operator *op) {
  enum status status = STATUS_OK;
  memset(op, 0, sizeof *op);
  op->stencil = stencil;
  op->grid = grid;
  op->rows = stokes_rows_best();
  op->tau = tau;
  op->components = stencil->axis_count + 1;
  op->n = grid->active;
  op->threads = omp_get_max_threads();
  /* one convolution in double precision, and a row beside it */
  op->scratch_size = 2 * (stokes_rows_scratch(grid->stride) + 3 * grid->stride);
  const size_t axes = (size_t)stencil->axis_count;
  TRY(memory_allocate(&op->diagonal, op->n, sizeof *op->diagonal, "diagonal"));
  TRY(memory_allocate(&op->parabola, op->n, sizeof *op->parabola, "parabola factors"));
  TRY(memory_allocate(&op->pore_sum, op->n, sizeof *op->pore_sum, "pore sums"));
  TRY(memory_allocate(&op->pore_gradient, axes * op->n, sizeof *op->pore_gradient,
                      "pore gradients"));
  if (walls_move(scene))
    TRY(memory_allocate(&op->drag, axes * op->n, sizeof *op->drag, "drag of moving walls"));
  if (wall == WALL_SUBVOXEL) {
    TRY(memory_allocate(&op->flux_velocity, op->n, sizeof *op->flux_velocity, "flux weights"));
    TRY(memory_allocate(&op->flux_force, op->n, sizeof *op->flux_force, "flux weights"));
  }
  TRY(memory_allocate(&op->field, 4 * grid->rows * grid->stride, sizeof *op->field,
                      "fields on the lattice"));
  TRY(memory_allocate(&op->scratch, (size_t)op->threads * op->scratch_size, sizeof *op->scratch,
                      "row buffers"));
  build_sites(&(struct builder){op, lattice, scene, wall, velocity_unit});
  return STATUS_OK;
cleanup:
  stokes_operator_free(op);
  return status;
}

void stokes_operator_free(struct stokes_operator *op) {
  memory_free(&op->diagonal);
  memory_free(&op->parabola);
  memory_free(&op->pore_sum);
  memory_free(&op->pore_gradient);
  memory_free(&op->drag);
  memory_free(&op->flux_velocity);
  memory_free(&op->flux_force);
  memory_free(&op->field);
  memory_free(&op->scratch);
}

static float *field_of(const struct stokes_operator *op, int component) {
  return op->field + (size_t)component * op->grid->rows * op->grid->stride;
}

static void unpack(struct stokes_operator *op, const float *packed, int component) {
  const struct stokes_grid *grid = op->grid;
  float *field = field_of(op, component);
#pragma omp for schedule(static)
  for (size_t row = 0; row < grid->rows; row++)
    op->rows->unpack(grid->mask + row * grid->chunks, grid->chunks, packed + grid->row_start[row],
                     field + row * grid->stride);
}

/* Packed values of one convolution of one field on one row; the result lies in the buffers of the
 * thread. */
static const float *convolve(const struct stokes_operator *op,
                             const struct stokes_convolution *convolution, int component,
                             size_t row) {
  const struct stokes_grid *grid = op->grid;
  const float *field = field_of(op, component), *rows[STOKES_CLASS_MAX][4];
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
  return packed;
}

static void viscous_row(const struct stokes_operator *op, int component, size_t row, const float *x,
                        float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const float *sum = convolve(op, &op->stencil->laplace, component, row);
  for (size_t i = start; i < end; i++) y[i] = op->diagonal[i] * x[i] - sum[i - start];
}

static void gradient_row(const struct stokes_operator *op, int axis, size_t row, const float *p,
                         bool add, float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const float *own = op->pore_gradient + (size_t)axis * op->n;
  const float *sum =
      convolve(op, &op->stencil->gradient[op->stencil->axes[axis]], op->components - 1, row);
  for (size_t i = start; i < end; i++) {
    const float g = op->parabola[i] * (sum[i - start] - own[i] * p[i]);
    y[i] = add ? y[i] + g : g;
  }
}

static void continuity_row(const struct stokes_operator *op, size_t row, const float *x, float *y) {
  const size_t start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const int axes = op->stencil->axis_count;
  const float tau = (float)op->tau, *p = x + (size_t)axes * op->n;
  const float *sum = convolve(op, &op->stencil->laplace, axes, row);
  for (size_t i = start; i < end; i++) y[i] = tau * (op->pore_sum[i] * p[i] - sum[i - start]);
  for (int a = 0; a < axes; a++) {
    const float *v = x + (size_t)a * op->n, *own = op->pore_gradient + (size_t)a * op->n;
    sum = convolve(op, &op->stencil->gradient[op->stencil->axes[a]], a, row);
    for (size_t i = start; i < end; i++) y[i] += sum[i - start] + own[i] * v[i];
  }
}

void stokes_operator_apply(struct stokes_operator *op, const float *x, float *y) {
  const int axes = op->stencil->axis_count;
  const float *p = x + (size_t)axes * op->n;
#pragma omp parallel num_threads(op->threads)
  {
    for (int c = 0; c < op->components; c++) unpack(op, x + (size_t)c * op->n, c);
#pragma omp for schedule(static)
    for (size_t row = 0; row < op->grid->rows; row++) {
      if (op->grid->row_start[row] == op->grid->row_start[row + 1]) continue;
      for (int a = 0; a < axes; a++) {
        viscous_row(op, a, row, x + (size_t)a * op->n, y + (size_t)a * op->n);
        gradient_row(op, a, row, p, true, y + (size_t)a * op->n);
      }
      continuity_row(op, row, x, y + (size_t)axes * op->n);
    }
  }
}

void stokes_operator_apply_viscous(struct stokes_operator *op, int count, const float *x,
                                   float *y) {
#pragma omp parallel num_threads(op->threads)
  {
    for (int c = 0; c < count; c++) unpack(op, x + (size_t)c * op->n, c);
#pragma omp for schedule(static)
    for (size_t row = 0; row < op->grid->rows; row++) {
      if (op->grid->row_start[row] == op->grid->row_start[row + 1]) continue;
      for (int c = 0; c < count; c++)
        viscous_row(op, c, row, x + (size_t)c * op->n, y + (size_t)c * op->n);
    }
  }
}

void stokes_operator_apply_gradient(struct stokes_operator *op, const float *p, float *y) {
  const int axes = op->stencil->axis_count;
#pragma omp parallel num_threads(op->threads)
  {
    unpack(op, p, axes);
#pragma omp for schedule(static)
    for (size_t row = 0; row < op->grid->rows; row++) {
      if (op->grid->row_start[row] == op->grid->row_start[row + 1]) continue;
      for (int a = 0; a < axes; a++) gradient_row(op, a, row, p, false, y + (size_t)a * op->n);
    }
  }
}

/* The same operator in double precision, for residuals; not in a hurry. */
static void unpack_double(struct stokes_operator *op, const double *packed, double *field) {
  const struct stokes_grid *grid = op->grid;
#pragma omp for schedule(static)
  for (size_t row = 0; row < grid->rows; row++) {
    const double *p = packed + grid->row_start[row];
    double *out = field + row * grid->stride;
    memset(out, 0, grid->stride * sizeof *out);
    for (size_t c = 0; c < grid->chunks; c++)
      for (unsigned bits = grid->mask[row * grid->chunks + c]; bits; bits &= bits - 1)
        out[c * STOKES_LANES + (size_t)__builtin_ctz(bits)] = *p++;
  }
}

static const double *convolve_double(const struct stokes_operator *op,
                                     const struct stokes_convolution *convolution,
                                     const double *field, size_t row) {
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], pitch = grid->stride + 2 * STOKES_LANES;
  double *out = (double *)(void *)(op->scratch + (size_t)omp_get_thread_num() * op->scratch_size);
  double *packed = out + grid->stride, *partial = packed + grid->stride + STOKES_LANES;
  for (int m = 0; m <= convolution->reach; m++)
    memset(partial + (size_t)m * pitch, 0, nx * sizeof *partial);
  for (int c = 0; c < convolution->class_count; c++) {
    const struct stokes_class *class = &convolution->classes[c];
    for (int r = 0; r < class->row_count; r++) {
      const double sign = r < class->plus_count ? 1.0 : -1.0;
      const double *u =
          field + grid->stride * stokes_grid_row(grid, row % grid->size[1], row / grid->size[1],
                                                 class->dj[r], class->dk[r]);
      for (int m = 0; m <= convolution->reach; m++) {
        const double f = sign * class->c_double[m];
        double *sum = partial + (size_t)m * pitch;
        for (size_t i = 0; i < nx; i++) sum[i] += f * u[i];
      }
    }
  }
  for (size_t i = 0; i < nx; i++) {
    out[i] = convolution->odd_x ? 0.0 : partial[i];
    for (int m = 1; m <= convolution->reach; m++) {
      const double *sum = partial + (size_t)m * pitch;
      const double left = sum[(i + nx - (size_t)m % nx) % nx], right = sum[(i + (size_t)m) % nx];
      out[i] += convolution->odd_x ? right - left : right + left;
    }
  }
  double *p = packed;
  for (size_t c = 0; c < grid->chunks; c++)
    for (unsigned bits = grid->mask[row * grid->chunks + c]; bits; bits &= bits - 1)
      *p++ = out[c * STOKES_LANES + (size_t)__builtin_ctz(bits)];
  return packed;
}

static void residual_row(const struct stokes_operator *op, int axis, size_t row, double force,
                         const double *x, const double *field, float *residual) {
  const struct stokes_stencil *stencil = op->stencil;
  const struct stokes_convolution *gradient = &stencil->gradient[stencil->axes[axis]];
  const size_t n = op->n, start = op->grid->row_start[row], end = op->grid->row_start[row + 1];
  const size_t shift = (size_t)axis * n, last = (size_t)stencil->axis_count * n;
  const double *v = x + shift, *p = x + last;
  const double *v_field = field, *p_field = field + op->grid->rows * op->grid->stride;
  const float *own = op->pore_gradient + shift;
  float *momentum = residual + shift, *continuity = residual + last;
  /* Force and pressure gradient nearly cancel, as do viscous sums: added up before rounding. The
   * buffers of the thread hold one convolution, so the first is parked in the second's place. */
  double *parked =
      (double *)(void *)(op->scratch + ((size_t)omp_get_thread_num() + 1) * op->scratch_size) -
      (end - start);
  const double *sum = convolve_double(op, gradient, p_field, row);
  for (size_t i = start; i < end; i++)
    parked[i - start] = (double)op->parabola[i] * (force - sum[i - start] + (double)own[i] * p[i]);
  sum = convolve_double(op, &stencil->laplace, v_field, row);
  for (size_t i = start; i < end; i++)
    momentum[i] = (float)(parked[i - start] + (op->drag ? (double)op->drag[shift + i] : 0.0) -
                          ((double)op->diagonal[i] * v[i] - sum[i - start]));
  sum = convolve_double(op, gradient, v_field, row);
  for (size_t i = start; i < end; i++)
    continuity[i] -= (float)(sum[i - start] + (double)own[i] * v[i]);
  if (axis > 0) return;
  sum = convolve_double(op, &stencil->laplace, p_field, row);
  for (size_t i = start; i < end; i++)
    continuity[i] -= (float)(op->tau * ((double)op->pore_sum[i] * p[i] - sum[i - start]));
}

void stokes_operator_residual(struct stokes_operator *op, const double force[3], const double *x,
                              float *residual) {
  const int axes = op->stencil->axis_count;
  double *field = (double *)(void *)op->field;
  memset(residual + (size_t)axes * op->n, 0, op->n * sizeof *residual);
#pragma omp parallel num_threads(op->threads)
  {
    unpack_double(op, x + (size_t)axes * op->n, field + op->grid->rows * op->grid->stride);
    for (int a = 0; a < axes; a++) {
      unpack_double(op, x + (size_t)a * op->n, field);
#pragma omp for schedule(static)
      for (size_t row = 0; row < op->grid->rows; row++)
        if (op->grid->row_start[row] < op->grid->row_start[row + 1])
          residual_row(op, a, row, force[op->stencil->axes[a]], x, field, residual);
    }
  }
}

void stokes_operator_flux(const struct stokes_operator *op, const double force[3], const double *x,
                          const float *p_gradient, double flux[3]) {
  memset(flux, 0, 3 * sizeof *flux);
  for (int a = 0; a < op->stencil->axis_count; a++) {
    const int axis = op->stencil->axes[a];
    const double *v = x + (size_t)a * op->n;
    const float *gradient = p_gradient + (size_t)a * op->n;
    for (size_t i = 0; i < op->n; i++) {
      if (!op->flux_velocity) {
        flux[axis] += v[i];
        continue;
      }
      const double net = force[axis] - (double)gradient[i] / (double)op->parabola[i];
      flux[axis] += (double)op->flux_velocity[i] * v[i] + (double)op->flux_force[i] * net;
    }
  }
}
