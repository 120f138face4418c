#include "sphsolve/stokes/solver/operator.h"
#include "sphsolve/stokes/constants.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "sphsolve/stokes/effects/soil_viscosity.h"
#include "sphsolve/stokes/effects/wall_subvoxel.h"
#include "sphsolve/stokes/solver/cuts.h"
#include "sphsolve/stokes/solver/edges.h"
#include "sphsolve/geometry/moment.h"
#include "sphsolve/geometry/wall_shape.h"

/* Coefficients of one site: its momentum equation with the walls around it, and its sums over pore
 * sites. */
struct site_sums {
  double diagonal, parabola, pore_sum, pore_gradient[3], drag[3];
  double moment[3][3];     /* sum over pore sites of g_ab times the vector to b */
  double surface;          /* part of D due to the surface of soil beside a pore */
  double unweighted[3][3]; /* with soil: the moment without weights by mobility */
  double lost[3][3];       /* the weighted moment minus the one that B inverts */
  double jump_gradient[3]; /* sum of g_ab times the jump of mobility: along the soil's normal */
  double axis_jump[3];     /* sum of the jumps to the two nearest sites along each axis */
  double inverse[3][3];    /* B */
  struct wall_shape wall;  /* of the nearest wall; zero if there is none */
  double cut_normal[3];    /* weighted sum of the normals of thin walls */
  bool smooth;             /* the wall distances are consistent with a smooth surface */
};

static double distance(const struct stokes_operator *op, size_t site) {
  return op->lattice->wall_distance[site] / op->stencil->unit;
}

static void add_wall(const struct stokes_operator *op, const struct stokes_offset *offset,
                     size_t site, size_t other, struct site_sums *sums) {
  const struct region *region = stokes_wall_region(op, other);
  if (region && region->slip) return; /* moves with the fluid: no shear */
  double factor = 1.0;                /* frozen: wall velocity at the wall site itself */
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

/* A wall thinner than the spacing, with a neighbour behind it. */
static void add_cut(const struct stokes_operator *op, const struct stokes_cut *cut,
                    struct site_sums *sums) {
  const struct stokes_offset *offset = &op->stencil->offsets[cut->offset];
  double factor = op->wall == WALL_ADAMI ? 2.0 : 1.0;
  if (op->wall == WALL_SUBVOXEL) {
    const struct stokes_wall_image image =
        stokes_wall_image((double)cut->before, (double)cut->behind, offset->r);
    factor = 1.0 + image.linear;
    sums->parabola += offset->viscous * image.parabola;
  }
  sums->diagonal += offset->viscous * factor;
  for (int a = 0; a < 3; a++) sums->cut_normal[a] += offset->viscous * (double)cut->normal[a];
}

/* stokes_soil_at for `site`; returns *last, the result for the site *known, if both are of the same
 * kind. */
static const struct stokes_soil_site *soil_beside(const struct stokes_operator *op, size_t site,
                                                  size_t *known, struct stokes_soil_site *last) {
  if (!stokes_soil_alike(op->soil, op->lattice, site, *known)) {
    *last = stokes_soil_at(op->soil, op->lattice, site);
    *known = site;
  }
  return last;
}

/* Adds a link to or from soil, or a link between pores of a model with soil. */
static void add_soil(const struct stokes_operator *op, const struct stokes_offset *offset,
                     const struct stokes_soil_site *own, const struct stokes_soil_site *other,
                     struct site_sums *sums) {
  const struct stokes_stencil *stencil = op->stencil;
  const double mobility = stokes_soil_weight(own->mobility, other->mobility);
  const double relative = mobility / own->relative; /* weight of the pressure difference */
  sums->diagonal += offset->viscous * stokes_soil_weight(own->viscosity, other->viscosity);
  sums->pore_sum += offset->viscous * mobility;
  if (!own->soil && other->soil)
    sums->surface += offset->viscous * stokes_soil_parabola(other->slip);
  const double jump = (other->relative - own->relative) / (other->relative + own->relative);
  for (int a = 0; a < stencil->axis_count; a++) {
    const double g = offset->gradient[stencil->axes[a]];
    sums->pore_gradient[a] += g * mobility;
    sums->jump_gradient[a] += g * jump;
    if (offset->step[0] * offset->step[0] + offset->step[1] * offset->step[1] +
            offset->step[2] * offset->step[2] ==
        1)
      sums->axis_jump[a] += offset->step[stencil->axes[a]] != 0 ? jump : 0.0;
    for (int c = 0; c < stencil->axis_count; c++) {
      const int axis = stencil->axes[c];
      const double moment = g * offset->step[axis] * stencil->spacing[axis];
      sums->moment[a][c] += relative * moment;
      sums->unweighted[a][c] += moment;
    }
  }
}

/* Sets the moment m that the correction B inverts, at a site beside the surface of soil with normal
 * n. Along the surface the pressure gradient is continuous, and differences are weighted by the
 * mobilities of their links, as in m. Across it the gradient jumps as the mobility does, so that
 * differences weighted by mobilities are already those of the site's own gradient, and the
 * unweighted moment m' is correct:
 *   m = T m T + n (n.m'.n) n,   T = 1 - n n. */
static void set_soil_moment(int axes, struct site_sums *sums) {
  double n[3] = {0}, length = 0.0, across = 0.0;
  for (int a = 0; a < axes; a++) length = hypot(length, sums->jump_gradient[a]);
  memcpy(sums->lost, sums->moment, sizeof sums->lost);
  if (length > 1e-6)
    for (int a = 0; a < axes; a++) n[a] = sums->jump_gradient[a] / length;
  for (int a = 0; a < axes; a++)
    for (int c = 0; c < axes; c++) across += n[a] * sums->unweighted[a][c] * n[c];
  if (length > 1e-6) moment_free_normal(axes, n, sums->moment);
  for (int a = 0; length > 1e-6 && a < axes; a++)
    for (int c = 0; c < axes; c++) sums->moment[a][c] += (across - 1.0) * n[a] * n[c];
  /* A layer one site thick has a surface on both sides, whose normals cancel in the sum. */
  for (int a = 0; a < axes; a++) {
    if (fabs(sums->axis_jump[a]) < JUMP_ONE_SIDE_MAX) continue;
    for (int c = 0; c < axes; c++) sums->moment[a][c] = sums->moment[c][a] = 0.0;
    sums->moment[a][a] = sums->unweighted[a][a];
  }
  for (int a = 0; a < axes; a++)
    for (int c = 0; c < axes; c++) sums->lost[a][c] -= sums->moment[a][c];
}

static void add_pore(const struct stokes_operator *op, const struct stokes_offset *offset,
                     struct site_sums *sums) {
  const struct stokes_stencil *stencil = op->stencil;
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
}

/* Beside a thin wall the distances on its two sides give no normal; its faces do. */
static void set_cut_normal(struct site_sums *sums) {
  const double *n = sums->cut_normal, length = hypot(hypot(n[0], n[1]), n[2]);
  sums->wall.curvature = 0.0;
  if (length > 0.0)
    for (int a = 0; a < 3; a++) sums->wall.normal[a] = n[a] / length;
}

static void find_correction(const struct stokes_operator *op, struct site_sums *sums) {
  const int axes = op->stencil->axis_count;
  double normal[3] = {0}, moment[3][3] = {{0}};
  for (int a = 0; a < axes; a++) {
    normal[a] = sums->wall.normal[op->stencil->axes[a]];
    for (int c = 0; c < axes; c++) moment[a][c] = sums->moment[a][c];
  }
  moment_free_normal(axes, normal, moment);
  moment_invert_bounded(axes, moment, sums->inverse);
}

/* cut .. cut_end: the cut links of the site. */
static void sum_site(const struct stokes_operator *op, const size_t at[3],
                     const struct stokes_cut *cut, const struct stokes_cut *cut_end,
                     struct site_sums *sums) {
  const struct stokes_stencil *stencil = op->stencil;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], site = (at[2] * grid->size[1] + at[1]) * nx + at[0];
  const struct stokes_cut *first_cut = cut;
  *sums = (struct site_sums){.smooth = true};
  struct stokes_soil_site own = {0}, last;
  size_t known = site; /* the site to which `last` belongs */
  if (op->soil) own = last = stokes_soil_at(op->soil, op->lattice, site);
  /* Towards walls within soil the velocity is linear, with the viscosity of soil. */
  const double viscosity = own.soil ? stokes_soil_weight(own.viscosity, own.viscosity) : 1.0;
  double linear = 0.0; /* part of the diagonal due to walls, without curvature */
  for (int o = 0; o < stencil->offset_count; o++) {
    const struct stokes_offset *offset = &stencil->offsets[o];
    const size_t row = stokes_grid_row(grid, at[1], at[2], offset->step[1], offset->step[2]);
    const long x = ((long)at[0] + offset->step[0]) % (long)nx;
    const size_t i = (size_t)(x < 0 ? x + (long)nx : x), other = row * nx + i;
    const bool is_cut = cut < cut_end && cut->offset == (uint32_t)o;
    if (is_cut) {
      const double before = sums->diagonal;
      add_cut(op, cut++, sums);
      sums->diagonal += (viscosity - 1.0) * (sums->diagonal - before);
      linear += sums->diagonal - before;
    } else if (stokes_grid_is_active(grid, row, i) && op->soil) {
      add_soil(op, offset, &own, soil_beside(op, other, &known, &last), sums);
    } else if (stokes_grid_is_active(grid, row, i)) {
      add_pore(op, offset, sums);
    } else if (op->lattice->kind[other] == SITE_WALL) {
      const double before = sums->diagonal;
      add_wall(op, offset, site, other, sums);
      sums->diagonal += (viscosity - 1.0) * (sums->diagonal - before);
      linear += sums->diagonal - before;
    } else {
      /* a pore without through-flow: at rest */
      sums->diagonal += offset->viscous * (op->wall == WALL_ADAMI ? 2.0 : 1.0);
    }
  }
  if (!sums->smooth) sums->parabola = 0.0;
  if (op->soil) set_soil_moment(stencil->axis_count, sums);
  if (linear > 0.0) wall_shape_find(op->lattice, site, stencil->unit, &sums->wall);
  if (cut_end > first_cut) set_cut_normal(sums);
  const double curvature = sums->wall.curvature * stencil->unit;
  if (sums->parabola > 0.0 && !own.soil) {
    const double d_a = fmax(distance(op, site), WALL_DISTANCE_FLOOR);
    sums->parabola /= 1.0 - 0.5 * d_a * curvature;
    sums->diagonal += fmax(sums->parabola * curvature / d_a, -0.5 * linear);
  }
  sums->parabola = fmin(sums->parabola + sums->surface, WALL_PARABOLA_MAX);
  if (own.soil) sums->diagonal += (1.0 - sums->parabola) / own.permeability;
  find_correction(op, sums);
}

static void store(struct stokes_operator *op, size_t n, const struct site_sums *sums) {
  const int axes = op->stencil->axis_count;
  op->diagonal[n] = (float)sums->diagonal;
  op->pore_sum[n] = (float)sums->pore_sum;
  op->parabola[n] = (float)(1.0 - sums->parabola);
  for (int a = 0; a < axes; a++) {
    for (int c = a; c < axes; c++)
      op->correction[stokes_symmetric(axes, a, c) * op->n + n] = (float)sums->inverse[a][c];
    op->pore_gradient[(size_t)a * op->n + n] = (float)sums->pore_gradient[a];
    for (int c = 0; op->soil && c < axes; c++)
      op->soil->force_defect[(size_t)a * op->n + n] +=
          (float)(sums->lost[a][c] * op->force[op->stencil->axes[c]]);
    if (op->drag) op->drag[(size_t)a * op->n + n] = (float)sums->drag[op->stencil->axes[a]];
  }
}

/* Clears `inner` [nx] at the sites of the row beginning at `row` that differ in kind (pore, or soil
 * of its kind) from the site `step` further along the row beginning at `other`. */
static void clear_unlike(const struct stokes_operator *op, size_t row, size_t other, int step,
                         uint8_t *inner) {
  const long nx = (long)op->grid->size[0];
  long x = step % nx < 0 ? step % nx + nx : step % nx;
  for (long i = 0; i < nx; i++, x = x + 1 < nx ? x + 1 : 0)
    if (inner[i] && !stokes_soil_alike(op->soil, op->lattice, row + (size_t)i, other + (size_t)x))
      inner[i] = 0;
}

/* For each site of a row, whether all its neighbours are pore sites or, with soil, of the same kind
 * as the site itself. `line` [nx + 2 reach]: work space. */
static void find_inner(const struct stokes_operator *op, size_t row, uint8_t *line,
                       uint8_t *inner) {
  const struct stokes_stencil *stencil = op->stencil;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0];
  memset(inner, 1, nx);
  for (int o = 0; o < stencil->offset_count;) {
    const int *step = stencil->offsets[o].step;
    const size_t other =
        stokes_grid_row(grid, row % grid->size[1], row / grid->size[1], step[1], step[2]);
    uint8_t *at = line + STOKES_REACH;
    for (size_t i = 0; i < nx; i++) at[i] = (uint8_t)stokes_grid_is_active(grid, other, i);
    for (size_t i = 0; i < STOKES_REACH; i++) {
      at[nx + i] = at[i % nx];
      at[-1 - (long)i] = at[nx - 1 - i % nx];
    }
    /* the offsets of one row are consecutive */
    for (; o < stencil->offset_count && stencil->offsets[o].step[1] == step[1] &&
           stencil->offsets[o].step[2] == step[2];
         o++) {
      const uint8_t *shifted = at + stencil->offsets[o].step[0];
      for (size_t i = 0; i < nx; i++) inner[i] &= shifted[i];
      if (op->soil) clear_unlike(op, row * nx, other * nx, stencil->offsets[o].step[0], inner);
    }
  }
}

static enum status build_sites(struct stokes_operator *op) {
  enum status status = STATUS_OK;
  const struct stokes_grid *grid = op->grid;
  const size_t nx = grid->size[0], length = 2 * nx + 2 * STOKES_REACH;
  struct site_sums whole = {.smooth = true}; /* of a site with pore sites on all sides */
  uint8_t *lines = NULL;
  TRY(memory_allocate(&lines, (size_t)op->threads * length, 1, "row buffers"));
  for (int o = 0; o < op->stencil->offset_count; o++)
    add_pore(op, &op->stencil->offsets[o], &whole);
  find_correction(op, &whole);
#pragma omp parallel for schedule(dynamic, 16) num_threads(op->threads)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    size_t n = grid->row_start[row];
    uint8_t *inner = lines + (size_t)omp_get_thread_num() * length, *line = inner + nx;
    if (n == grid->row_start[row + 1] || interrupt_alone()) continue;
    find_inner(op, row, line, inner);
    struct site_sums alike = {0}; /* of the last site of the row surrounded by its own soil */
    size_t known = SIZE_MAX;      /* that site */
    for (size_t i = 0; i < nx; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      const size_t at[3] = {i, row % grid->size[1], row / grid->size[1]};
      struct site_sums own;
      const struct site_sums *sums = &whole;
      size_t cut_end;
      const size_t cut = stokes_cuts_of(op, row, n - grid->row_start[row], &cut_end);
      if (!inner[i] || cut < cut_end) {
        sum_site(op, at, op->cuts + cut, op->cuts + cut_end, &own);
        sums = &own;
      } else if (op->soil && stokes_soil_is(op->soil, op->lattice, row * nx + i)) {
        if (known == SIZE_MAX || !stokes_soil_alike(op->soil, op->lattice, known, row * nx + i))
          sum_site(op, at, NULL, NULL, &alike);
        known = row * nx + i;
        sums = &alike;
      }
      store(op, n++, sums);
    }
  }
  status = interrupt_look();
cleanup:
  memory_free(&lines);
  return status;
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
                                  const struct scene *scene, enum wall_scheme wall,
                                  double stabilisation, double velocity_unit, const double force[3],
                                  struct stokes_operator *op) {
  enum status status = STATUS_OK;
  memset(op, 0, sizeof *op);
  op->stencil = stencil;
  op->grid = grid;
  op->lattice = lattice;
  op->scene = scene;
  op->velocity_unit = velocity_unit;
  memcpy(op->force, force, sizeof op->force);
  op->wall = wall;
  op->rows = stokes_rows_best();
  op->stabilisation = op->laplace = stabilisation;
  op->components = stencil->axis_count + 1;
  op->n = grid->active;
  op->threads = omp_get_max_threads();
  /* space for one convolution in double precision, and three rows of a gradient */
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
  TRY(stokes_soil_build(lattice, grid, force, stencil->unit, &op->soil));
  if (op->soil) op->laplace *= stokes_stencil_moment(stencil);
  const size_t slots = op->soil ? 4 * (size_t)stokes_soil_sums(op->soil) : 4;
  const size_t ghosts = 2 * (size_t)(grid->reach + grid->images) * grid->size[1];
  TRY(memory_allocate_sparse(&op->field, slots * grid->rows * grid->stride, sizeof *op->field,
                             slots * (grid->row_end - grid->row_begin + ghosts) * grid->stride,
                             "fields on the lattice"));
  TRY(memory_allocate(&op->scratch, (size_t)op->threads * op->scratch_size, sizeof *op->scratch,
                      "row buffers"));
  TRY(stokes_cuts_build(op));
  TRY(build_sites(op));
  TRY(stokes_edges_build(op));
  if (op->soil) memory_free(&op->soil->enclosed);
  return STATUS_OK;
cleanup:
  stokes_operator_free(op);
  return status;
}

void stokes_operator_free(struct stokes_operator *op) {
  MEMORY_FREE(&op->diagonal, &op->parabola, &op->pore_sum, &op->pore_gradient, &op->correction,
              &op->drag);
  stokes_soil_free(&op->soil);
  MEMORY_FREE(&op->edges, &op->edge_start, &op->edge_moving, &op->cuts, &op->cut_start,
              &op->row_flux, &op->field, &op->scratch);
}

void stokes_operator_flux(struct stokes_operator *op, const double force[3], const double *x,
                          const float *p_gradient, double flux[3]) {
  const struct stokes_grid *grid = op->grid;
  const int axes = op->stencil->axis_count;
#pragma omp parallel for schedule(static) num_threads(op->threads)
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    double *sum = op->row_flux + 3 * row;
    memset(sum, 0, 3 * sizeof *sum);
    for (int a = 0; a < axes; a++) {
      const size_t begin = (size_t)a * op->n + grid->row_start[row];
      const size_t end = (size_t)a * op->n + grid->row_start[row + 1];
      const int axis = op->stencil->axes[a];
      if (stokes_grid_cancels(grid, axis)) continue;
      for (size_t i = begin; i < end; i++) sum[a] += x[i];
      for (size_t e = op->edge_start[row]; e < op->edge_start[row + 1]; e++) {
        const size_t at = begin + op->edges[e].at;
        /* Between two walls the force term is never larger than the velocity term; in a corner it
         * would be, because the force is shared among the walls. It is therefore limited. */
        double slope = (double)op->edges[e].velocity * x[at];
        if (op->edge_moving) slope += (double)op->edge_moving[e][axis];
        const double most = fabs(slope);
        const double bend = (double)op->edges[e].force * (force[axis] - (double)p_gradient[at]);
        sum[a] += slope + fmax(-most, fmin(bend, most));
      }
    }
  }
  memset(flux, 0, 3 * sizeof *flux);
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++)
    for (int a = 0; a < axes; a++)
      flux[op->stencil->axes[a]] +=
          stokes_grid_weight(grid, row) * op->row_flux[3 * row + (size_t)a];
  ranks_sum_all(flux, 3);
}
