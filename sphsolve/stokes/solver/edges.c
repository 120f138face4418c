#include "sphsolve/stokes/solver/edges.h"

#include <math.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "sphsolve/geometry/wall_shape.h"
#include "sphsolve/stokes/effects/wall_subvoxel.h"
#include "sphsolve/stokes/solver/cuts.h"

static double distance(const struct stokes_operator *op, size_t site) {
  return op->lattice->wall_distance[site] / op->stencil->unit;
}

/* The site next to another along an axis, with periodic wrapping. */
static size_t beside(const struct lattice *l, const size_t at[3], size_t site, int axis, bool up) {
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  const size_t last = (l->size[axis] - 1) * step[axis];
  return up ? (at[axis] + 1 < l->size[axis] ? site + step[axis] : site - last)
            : (at[axis] > 0 ? site - step[axis] : site + last);
}

/* Whether a line of sites along an axis ends at this site: a wall, or the surface of soil. */
static bool ends_line(const struct stokes_operator *op, size_t other) {
  return op->lattice->kind[other] == SITE_WALL ||
         (op->soil && stokes_soil_is(op->soil, op->lattice, other));
}

/* `packed`: index of the site in its packed row. */
static bool is_edge(const struct stokes_operator *op, const size_t at[3], size_t site,
                    size_t packed) {
  const size_t row = site / op->grid->size[0];
  if (op->soil && stokes_soil_is(op->soil, op->lattice, site))
    return false; /* the velocity in soil does not vanish linearly at a wall */
  for (int c = 0; c < op->stencil->axis_count; c++)
    for (int up = 0; up < 2; up++)
      if (ends_line(op, beside(op->lattice, at, site, op->stencil->axes[c], up)) ||
          stokes_cut_beside(op, row, packed, op->stencil->axes[c], up))
        return true;
  return false;
}

/* At soil, half a spacing away, the slope of the velocity is reduced by the slip. */
static struct stokes_wall_quadrature soil_quadrature(const struct stokes_operator *op, size_t other,
                                                     int axis) {
  const struct stokes_soil_site soil = stokes_soil_at(op->soil, op->lattice, other);
  struct stokes_wall_quadrature end = stokes_wall_quadrature(0.5, 0.5, op->stencil->spacing[axis]);
  const double left = 1.0 / (1.0 + 2.0 * soil.slip);
  end.velocity *= left;
  end.force *= left * fmax(1.0 - 8.0 * soil.permeability, -8.0);
  return end;
}

static struct stokes_edge find_edge(const struct stokes_operator *op, const size_t at[3],
                                    size_t site, size_t packed, float moving[3]) {
  const struct lattice *l = op->lattice;
  const double d_a = distance(op, site);
  double velocity = 0.0, force = 0.0, from_wall[3] = {0.0};
  double shares = 0.0; /* sum of the shares of the axes; more than 1 in a corner */
  for (int c = 0; c < op->stencil->axis_count; c++) {
    double share = 0.0;
    for (int up = 0; up < 2; up++) {
      const int a = op->stencil->axes[c];
      const size_t other = beside(l, at, site, a, up);
      const struct stokes_cut *cut = stokes_cut_beside(op, site / op->grid->size[0], packed, a, up);
      if (cut) {
        const struct stokes_wall_quadrature end = stokes_wall_quadrature(
            (double)cut->before, (double)cut->behind, op->stencil->spacing[a]);
        velocity += end.velocity;
        force += end.force;
        share = fmax(share, end.share);
        continue;
      }
      if (!ends_line(op, other)) continue;
      if (l->kind[other] != SITE_WALL) {
        const struct stokes_wall_quadrature end = soil_quadrature(op, other, a);
        velocity += end.velocity;
        force += end.force;
        share = 1.0;
        continue;
      }
      const struct stokes_wall_quadrature end =
          stokes_wall_quadrature(d_a, -distance(op, other), op->stencil->spacing[a]);
      const struct region *region = stokes_wall_region(op, other);
      velocity += end.velocity;
      force += end.force;
      for (int b = 0; region && b < 3; b++)
        from_wall[b] += (end.wall - end.velocity) * region->velocity[b] / op->velocity_unit;
      share = fmax(share, end.share);
    }
    shares += share;
  }
  struct wall_shape wall;
  wall_shape_find(l, site, op->stencil->unit, &wall);
  const double curvature = wall.curvature * op->stencil->unit;
  const double bend = 1.0 / (1.0 - 0.5 * fmax(d_a, WALL_DISTANCE_FLOOR) * curvature);
  for (int a = 0; moving && a < 3; a++) moving[a] = (float)(from_wall[a] / fmax(shares, 1.0));
  return (struct stokes_edge){.velocity = (float)(velocity * bend / fmax(shares, 1.0)),
                              .force = (float)(force * bend / fmax(shares, 1.0))};
}

enum status stokes_edges_build(struct stokes_operator *op) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], begin = stokes_grid_begin(grid), end = stokes_grid_end(grid);
  size_t *start = NULL;
  TRY(memory_allocate(&op->edge_start, grid->rows + 1, sizeof *start, "edges of the pores"));
  if (op->wall != WALL_SUBVOXEL) return STATUS_OK;
  start = op->edge_start;
#pragma omp parallel for schedule(dynamic, 16)
  for (size_t row = begin; row < end; row++) {
    size_t n = 0;
    if (interrupt_alone() || stokes_grid_is_y_image(grid, row)) continue;
    for (size_t i = 0; i < nx; i++) {
      const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
      if (stokes_grid_is_active(grid, row, i) && is_edge(op, at, row * nx + i, n++))
        start[row + 1]++;
    }
  }
  TRY(interrupt_look());
  for (size_t row = 0; row < grid->rows; row++) start[row + 1] += start[row];
  const size_t count = start[grid->rows];
  TRY(memory_allocate(&op->edges, count, sizeof *op->edges, "edges of the pores"));
  if (op->drag)
    TRY(memory_allocate(&op->edge_moving, count, sizeof *op->edge_moving, "edges of the pores"));
#pragma omp parallel for schedule(dynamic, 16)
  for (size_t row = begin; row < end; row++) {
    size_t n = 0, e = start[row];
    if (interrupt_alone() || stokes_grid_is_y_image(grid, row)) continue;
    for (size_t i = 0; i < nx; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
      if (is_edge(op, at, row * nx + i, n)) {
        op->edges[e] =
            find_edge(op, at, row * nx + i, n, op->edge_moving ? op->edge_moving[e] : NULL);
        op->edges[e++].at = (uint32_t)n;
      }
      n++;
    }
  }
  status = interrupt_look();
cleanup:
  return status;
}
