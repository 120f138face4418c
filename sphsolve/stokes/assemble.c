#include "sphsolve/stokes/operator.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/stokes/effects/wall_subvoxel.h"
#include "sphsolve/geometry/moment.h"
#include "sphsolve/geometry/wall_shape.h"

/* What the walls around one site do to its momentum equation, and its sums over pore sites. */
struct site_sums {
  double diagonal, parabola, pore_sum, pore_gradient[3], drag[3];
  double moment[3][3];    /* sum over pore sites of g_ab times the vector to b */
  struct wall_shape wall; /* the nearest; without where there is none */
  bool smooth;            /* the wall distances are those of a surface */
};

static double distance(const struct stokes_operator *op, size_t site) {
  return op->lattice->wall_distance[site] / op->stencil->unit;
}

static void add_wall(const struct stokes_operator *op, const struct stokes_offset *offset,
                     size_t site, size_t other, struct site_sums *sums) {
  const struct region *region = stokes_wall_region(op, other);
  if (region && region->slip) return; /* moves along: no shear */
  double factor = 1.0;                /* frozen: at rest where it is */
  if (op->wall == WALL_ADAMI) factor = 2.0;
  if (op->wall == WALL_SUBVOXEL) {
    const struct stokes_wall_image image =
        stokes_wall_image(distance(op, site), -distance(op, other), offset->r);
    factor = 1.0 + image.linear;
    sums->parabola += offset->viscous * image.parabola;
    sums->smooth = sums->smooth && image.smooth;
  }
  sums->diagonal += offset->viscous * factor;
  for (int a = 0; region && a < 3; a++)
    sums->drag[a] += offset->viscous * factor * region->velocity[a] / op->velocity_unit;
}

static void sum_site(const struct stokes_operator *op, const size_t at[3], struct site_sums *sums) {
  const struct stokes_stencil *stencil = op->stencil;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], site = (at[2] * grid->size[1] + at[1]) * nx + at[0];
  *sums = (struct site_sums){.smooth = true};
  double linear = 0.0; /* friction of the walls without curvature, beyond that of sites at rest */
  for (int o = 0; o < stencil->offset_count; o++) {
    const struct stokes_offset *offset = &stencil->offsets[o];
    const size_t row = stokes_grid_row(grid, at[1], at[2], offset->step[1], offset->step[2]);
    const long x = ((long)at[0] + offset->step[0]) % (long)nx;
    const size_t i = (size_t)(x < 0 ? x + (long)nx : x), other = row * nx + i;
    if (stokes_grid_is_active(grid, row, i)) {
      sums->diagonal += offset->viscous;
      sums->pore_sum += offset->viscous;
      for (int a = 0; a < stencil->axis_count; a++) {
        const double g = offset->gradient[stencil->axes[a]];
        sums->pore_gradient[a] += g;
        for (int c = 0; c < stencil->axis_count; c++) {
          const int axis = stencil->axes[c];
          sums->moment[a][c] += g * offset->step[axis] * stencil->spacing[axis];
        }
      }
    } else if (op->lattice->kind[other] == SITE_WALL) {
      const double before = sums->diagonal;
      add_wall(op, offset, site, other, sums);
      linear += sums->diagonal - before;
    } else {
      /* a pore that cannot flow: at rest */
      sums->diagonal += offset->viscous * (op->wall == WALL_ADAMI ? 2.0 : 1.0);
    }
  }
  if (!sums->smooth) sums->parabola = 0.0;
  if (linear > 0.0) wall_shape_find(op->lattice, site, stencil->unit, &sums->wall);
  const double curvature = sums->wall.curvature * stencil->unit;
  if (sums->parabola > 0.0) {
    const double d_a = fmax(distance(op, site), WALL_DISTANCE_FLOOR);
    sums->parabola /= 1.0 - 0.5 * d_a * curvature;
    sums->diagonal += fmax(sums->parabola * curvature / d_a, -0.5 * linear);
  }
  sums->parabola = fmin(sums->parabola, WALL_PARABOLA_MAX);
}

static void build_sites(struct stokes_operator *op) {
  const struct stokes_grid *grid = op->grid;
  const int axes = op->stencil->axis_count;
#pragma omp parallel for schedule(dynamic, 16)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    size_t n = grid->row_start[row];
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      struct site_sums sums;
      sum_site(op, (const size_t[3]){i, row % grid->size[1], row / grid->size[1]}, &sums);
      op->diagonal[n] = (float)sums.diagonal;
      op->pore_sum[n] = (float)sums.pore_sum;
      op->parabola[n] = (float)(1.0 - sums.parabola);
      double inverse[3][3], normal[3] = {0};
      for (int a = 0; a < axes; a++) normal[a] = sums.wall.normal[op->stencil->axes[a]];
      moment_free_normal(axes, normal, sums.moment);
      moment_invert_bounded(axes, sums.moment, inverse);
      for (int a = 0; a < axes; a++) {
        for (int c = a; c < axes; c++)
          op->correction[stokes_symmetric(axes, a, c) * op->n + n] = (float)inverse[a][c];
        op->pore_gradient[(size_t)a * op->n + n] = (float)sums.pore_gradient[a];
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
  op->lattice = lattice;
  op->scene = scene;
  op->velocity_unit = velocity_unit;
  op->wall = wall;
  op->rows = stokes_rows_best();
  op->tau = tau;
  op->components = stencil->axis_count + 1;
  op->n = grid->active;
  op->threads = omp_get_max_threads();
  /* one convolution in double precision, and three rows of a gradient */
  op->scratch_size = 2 * stokes_rows_scratch(grid->stride) + 8 * grid->stride;
  const size_t axes = (size_t)stencil->axis_count;
  TRY(memory_allocate(&op->diagonal, op->n, sizeof *op->diagonal, "diagonal"));
  TRY(memory_allocate(&op->parabola, op->n, sizeof *op->parabola, "parabola factors"));
  TRY(memory_allocate(&op->pore_sum, op->n, sizeof *op->pore_sum, "pore sums"));
  TRY(memory_allocate(&op->pore_gradient, axes * op->n, sizeof *op->pore_gradient,
                      "pore gradients"));
  TRY(memory_allocate(&op->correction, axes * (axes + 1) / 2 * op->n, sizeof *op->correction,
                      "gradient corrections"));
  if (walls_move(scene))
    TRY(memory_allocate(&op->drag, axes * op->n, sizeof *op->drag, "drag of moving walls"));
  TRY(memory_allocate(&op->row_flux, 3 * grid->rows, sizeof *op->row_flux, "flux of the rows"));
  const size_t ghosts = 2 * (size_t)(grid->reach + grid->images) * grid->size[1];
  TRY(memory_allocate_sparse(&op->field, 4 * grid->rows * grid->stride, sizeof *op->field,
                             4 * (grid->row_end - grid->row_begin + ghosts) * grid->stride,
                             "fields on the lattice"));
  TRY(memory_allocate(&op->scratch, (size_t)op->threads * op->scratch_size, sizeof *op->scratch,
                      "row buffers"));
  build_sites(op);
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
  memory_free(&op->correction);
  memory_free(&op->drag);
  memory_free(&op->row_flux);
  memory_free(&op->field);
  memory_free(&op->scratch);
}

/* What the ends of lines at walls add to the value of one site in the volume integral: factors of v
 * and (f - G p), and the part of moving walls. */
struct flux_weights {
  double velocity, force, moving[3];
};

static struct flux_weights flux_of_site(const struct stokes_operator *op, const size_t at[3],
                                        size_t site) {
  const struct lattice *l = op->lattice;
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  const double d_a = distance(op, site);
  struct flux_weights w = {0.0, 0.0, {0.0}};
  double shares = 0.0; /* of the axes; more than 1 in a corner */
  for (int c = 0; c < op->stencil->axis_count; c++) {
    double share = 0.0;
    for (int up = 0; up < 2; up++) {
      const int a = op->stencil->axes[c];
      const size_t last = (l->size[a] - 1) * step[a];
      const size_t other = up ? (at[a] + 1 < l->size[a] ? site + step[a] : site - last)
                              : (at[a] > 0 ? site - step[a] : site + last);
      if (l->kind[other] != SITE_WALL) continue;
      const struct stokes_wall_quadrature end =
          stokes_wall_quadrature(d_a, -distance(op, other), op->stencil->spacing[a]);
      const struct region *region = stokes_wall_region(op, other);
      w.velocity += end.velocity;
      w.force += end.force;
      for (int b = 0; region && b < 3; b++)
        w.moving[b] += (end.wall - end.velocity) * region->velocity[b] / op->velocity_unit;
      share = fmax(share, end.share);
    }
    shares += share;
  }
  if (shares > 0.0) {
    struct wall_shape wall;
    wall_shape_find(l, site, op->stencil->unit, &wall);
    const double curvature = wall.curvature * op->stencil->unit;
    const double bend = 1.0 / (1.0 - 0.5 * fmax(d_a, WALL_DISTANCE_FLOOR) * curvature);
    w.velocity *= bend / fmax(shares, 1.0);
    w.force *= bend / fmax(shares, 1.0);
    for (int a = 0; a < 3; a++) w.moving[a] /= fmax(shares, 1.0);
  }
  return w;
}

void stokes_operator_flux(struct stokes_operator *op, const double force[3], const double *x,
                          const float *p_gradient, double flux[3]) {
  const struct stokes_grid *grid = op->grid;
  const int axes = op->stencil->axis_count;
#pragma omp parallel for schedule(static) num_threads(op->threads)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    size_t n = grid->row_start[row];
    double *sum = op->row_flux + 3 * row;
    memset(sum, 0, 3 * sizeof *sum);
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      struct flux_weights w = {0.0, 0.0, {0.0}};
      if (op->wall == WALL_SUBVOXEL)
        w = flux_of_site(op, (const size_t[3]){i, row % grid->size[1], row / grid->size[1]},
                         row * grid->size[0] + i);
      for (int a = 0; a < axes; a++) {
        const size_t at = (size_t)a * op->n + n;
        const int axis = op->stencil->axes[a];
        if (grid->mirrored && grid->parity[axis] < 0.0f) continue; /* both halves cancel */
        /* Between two walls the force bends the profile by no more than its slope is; in a corner
         * it would, as it is shared among the walls. */
        const double slope = w.velocity * x[at] + w.moving[axis], most = fabs(slope);
        const double bend = w.force * (force[axis] - (double)p_gradient[at]);
        sum[a] += x[at] + slope + fmax(-most, fmin(bend, most));
      }
      n++;
    }
  }
  memset(flux, 0, 3 * sizeof *flux);
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    for (int a = 0; a < axes; a++)
      flux[op->stencil->axes[a]] +=
          stokes_grid_weight(grid, row) * op->row_flux[3 * row + (size_t)a];
  ranks_sum_all(flux, 3);
}
