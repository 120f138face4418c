#include "sphsolve/isph/multigrid.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/levels.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/ranks.h"

struct isph_multigrid {
  struct levels levels;
  double origin[3];
  size_t capacity, layer_capacity;
  uint32_t *base; /* [own particles]: lowest node of the particle's cell */
  float (*fraction)[3];
  uint32_t *order; /* own particles by layer of cells, each near the next in memory */
  /* [nodes or cells]: sums in whole numbers of a unit, independent of their order */
  int64_t *whole;
  size_t whole_room;
  uint32_t *layer_start;
};

/* Sets up the grid over a box around the particles of all ranks. */
static enum status shape(struct isph *s, struct isph_multigrid *grid) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  double most[6], extent[3];
  bool used[3];
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], s->position[i][a]);
      high[a] = fmax(high[a], s->position[i][a]);
    }
  for (int a = 0; a < 3; a++) most[a] = high[a], most[3 + a] = -low[a];
  ranks_max_all(most, 6);
  for (int a = 0; a < 3; a++) {
    used[a] = s->dimensions == 3 || a != 1;
    grid->origin[a] = s->periodic[a] ? s->low[a] : -most[3 + a];
    extent[a] = (s->periodic[a] ? s->high[a] : most[a]) - grid->origin[a];
  }
  return levels_shape(&grid->levels, extent, used, s->periodic, s->spacing);
}

/* Weights of the 8 corners of the cell of own particle i, 4 in 2-D. */
static inline void weights_of(const struct isph_multigrid *grid, size_t i, double weight[8]) {
  const double x = (double)grid->fraction[i][0], y = (double)grid->fraction[i][1],
               z = (double)grid->fraction[i][2];
  const double plane[4] = {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y};
  const int n = grid->levels.used[1] ? 4 : 2; /* y is 0 in 2-D */
  for (int c = 0; c < n; c++) weight[c] = plane[c] * (1 - z), weight[n + c] = plane[c] * z;
}

/* Nodes around the cell of own particle i. */
static inline int particle_corners(const struct isph_multigrid *grid, size_t i, size_t node[8]) {
  const struct level *fine = &grid->levels.at[0];
  const size_t base = grid->base[i];
  size_t step[3], stride = 1;
  int n = 0;
  for (int a = 0; a < 3; a++) { /* across a periodic side back to the first */
    const size_t nodes = (size_t)fine->nodes[a];
    const bool last = fine->periodic[a] && base / stride % nodes == nodes - 1;
    step[a] = last ? stride - nodes * stride : stride;
    stride *= nodes;
  }
  for (size_t c = 0; c < 2; c++)
    for (size_t b = 0; b < (grid->levels.used[1] ? 2 : 1); b++, n += 2) {
      node[n] = base + b * step[1] + c * step[2];
      node[n + 1] = node[n] + step[0];
    }
  return n;
}

/* Sums over all particles are taken in whole numbers of a unit that depends on the largest value
 * only, so that they do not depend on the order, nor on the number of ranks. They have room for
 * SUM_HEADROOM times the largest value. */
#define SUM_HEADROOM 0x1p16

static double unit_of(const struct isph *s, const double *value) {
  double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const double size = fabs(value[i]);
    most = size > most ? size : most;
  }
  most = ranks_max(most);
  int exponent = 0;
  frexp(most, &exponent);
  return most > 0 && isfinite(most) ? ldexp(SUM_HEADROOM / 0x1p62, exponent) : 1;
}

/* Adds up the integer sums of all ranks; `sums` are those times `unit`. */
static void add_up(const struct isph_multigrid *grid, size_t n, double unit, double *sums) {
  ranks_sum_whole(grid->whole, n);
#pragma omp parallel for schedule(static)
  for (size_t k = 0; k < n; k++) sums[k] = unit * (double)grid->whole[k];
}

/* Distributes value[i] of all particles to the nodes around them, by layers of two colours. */
static void gather(const struct isph *s, const double *value, double *nodes) {
  const struct isph_multigrid *grid = s->multigrid;
  const struct level *fine = &grid->levels.at[0];
  const double unit = unit_of(s, value), scale = 1 / unit;
  memset(grid->whole, 0, fine->node_count * sizeof *grid->whole);
  for (int parity = 0; parity < 2; parity++) {
#pragma omp parallel for schedule(dynamic, 1)
    for (int k = parity; k < fine->cells[s->cells.axis[2]]; k += 2)
      for (uint32_t p = grid->layer_start[k]; p < grid->layer_start[k + 1]; p++) {
        size_t i = grid->order[p], node[8];
        double weight[8], scaled = scale * value[s->local.begin + i];
        int n = particle_corners(grid, i, node);
        weights_of(grid, i, weight);
        for (int c = 0; c < n; c++) grid->whole[node[c]] += (int64_t)(weight[c] * scaled);
      }
  }
  add_up(grid, fine->node_count, unit, nodes);
}

/* Mobilities times volumes, over the volume of a cell. At an edge of soil with links (isph/link.h),
 * and wherever soil lies under a surface, a particle counts with the mean mobility of its pairs:
 * its own smoothed mobility may be 1e9 times smaller than the coefficients that couple it to the
 * water outside, and a grid that resists so much more than the matrix would mistake the error of
 * that water for an error of the soil's pressure. */
static void find_mobilities(const struct isph *s, double cell, double *value) {
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const bool mixed = s->on.links ? s->ground[i] == GROUND_MIXED : s->on.soil && s->on.surface;
    value[i] = (mixed ? s->pair_mobility[i] : s->mobility[i]) * s->volume[i] / cell;
  }
}

/* What a particle fills along one axis, in cells. */
struct filled {
  double low, high;
  int first, last;
};

static struct filled filled_along(const struct isph *s, size_t i, int a) {
  const struct isph_multigrid *grid = s->multigrid;
  const double h = grid->levels.at[0].h[a];
  const double low = (s->position[i][a] - 0.5 * s->size[i] - grid->origin[a]) / h,
               high = low + s->size[i] / h;
  if (!grid->levels.used[a]) return (struct filled){0, 1, 0, 0};
  return (struct filled){low, high, (int)floor(low), (int)floor(high)};
}

static double share_in(const struct filled *at, int cell) {
  return (fmin(at->high, cell + 1) - fmax(at->low, cell)) / (at->high - at->low);
}

/* The cell of this number along axis a; beyond the grid the one at its end. */
static size_t cell_within(const struct level *fine, int a, int cell) {
  const int n = fine->cells[a];
  if (fine->periodic[a]) return (size_t)((cell % n + n) % n);
  return (size_t)(cell < 0 ? 0 : cell < n ? cell : n - 1);
}

/* Mean mobility of the finest cells. A particle counts in all cells that it fills: in soil of
 * porosity eps its side is spacing/sqrt(eps), in 3-D spacing/cbrt(eps), and many cells hold the
 * centre of none, which would be holes of the grid where water is. */
static void find_coefficients(const struct isph *s) {
  struct isph_multigrid *grid = s->multigrid;
  struct level *fine = &grid->levels.at[0];
  const double volume = fine->h[0] * fine->h[1] * fine->h[2];
  double *value = s->work[1];
  find_mobilities(s, volume, value);
  const double unit = unit_of(s, value), scale = 1 / unit;
  memset(grid->whole, 0, fine->cell_count * sizeof *grid->whole);
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const struct filled x = filled_along(s, i, 0), y = filled_along(s, i, 1),
                        z = filled_along(s, i, 2);
    for (int c = z.first; c <= z.last; c++)
      for (int b = y.first; b <= y.last; b++) {
        const double part = scale * value[i] * share_in(&y, b) * share_in(&z, c);
        const size_t row =
            (cell_within(fine, 2, c) * (size_t)fine->cells[1] + cell_within(fine, 1, b)) *
            (size_t)fine->cells[0];
        for (int k = x.first; k <= x.last; k++) {
          const int64_t more = (int64_t)(part * share_in(&x, k));
#pragma omp atomic
          grid->whole[row + cell_within(fine, 0, k)] += more;
        }
      }
  }
  add_up(grid, fine->cell_count, unit, fine->k);
}

enum status multigrid_build(struct isph *s) {
  enum status status = STATUS_OK;
  if (s->multigrid == NULL)
    TRY(memory_allocate(&s->multigrid, 1, sizeof *s->multigrid, "the preconditioner"));
  struct isph_multigrid *grid = s->multigrid;
  TRY(shape(s, grid));
  struct level *fine = &grid->levels.at[0];
  const size_t own = s->local.end - s->local.begin, sums = fine->node_count; /* cells are fewer */
  if (own > grid->capacity) {
    size_t n = own + own / 4;
    TRY(memory_resize(&grid->base, n, sizeof *grid->base, "the preconditioner"));
    TRY(memory_resize(&grid->fraction, n, sizeof *grid->fraction, "the preconditioner"));
    TRY(memory_resize(&grid->order, n, sizeof *grid->order, "the preconditioner"));
    grid->capacity = n;
  }
  if (sums > grid->whole_room) {
    TRY(memory_resize(&grid->whole, sums + sums / 4, sizeof *grid->whole, "the preconditioner"));
    grid->whole_room = sums + sums / 4;
  }
  const int along = s->cells.axis[2];
  size_t layers = (size_t)fine->cells[along], plane = 1;
  for (int a = 0; a < along; a++) plane *= (size_t)fine->nodes[a];
  if (layers + 1 > grid->layer_capacity) {
    TRY(memory_resize(&grid->layer_start, 2 * layers + 1, sizeof *grid->layer_start,
                      "the preconditioner"));
    grid->layer_capacity = 2 * layers + 1;
  }
  memset(grid->layer_start, 0, (layers + 1) * sizeof *grid->layer_start);
  for (size_t i = 0; i < own; i++) {
    int at[3];
    for (int a = 0; a < 3; a++) {
      const double x = s->position[s->local.begin + i][a];
      double scaled = grid->levels.used[a] ? (x - grid->origin[a]) / fine->h[a] : 0;
      at[a] = (int)fmin(fmax(0, floor(scaled)), fine->cells[a] - 1);
      grid->fraction[i][a] = (float)fmin(fmax(0, scaled - at[a]), 1);
    }
    grid->base[i] = (uint32_t)level_node(fine, at[0], at[1], at[2]);
    grid->layer_start[at[along] + 1]++;
  }
  for (size_t k = 0; k < layers; k++) grid->layer_start[k + 1] += grid->layer_start[k];
  for (size_t i = 0; i < own; i++) {
    const size_t layer = grid->base[i] / plane % (size_t)fine->nodes[along];
    grid->order[grid->layer_start[layer]++] = (uint32_t)i;
  }
  for (size_t k = layers; k > 0; k--) grid->layer_start[k] = grid->layer_start[k - 1];
  grid->layer_start[0] = 0;
  find_coefficients(s);
  gather(s, s->tied, fine->tie);
  levels_assemble(&grid->levels);
cleanup:
  return status;
}

void multigrid_apply(struct isph *s, const double *r, double *z) {
  struct isph_multigrid *grid = s->multigrid;
  struct level *fine = &grid->levels.at[0];
  gather(s, r, fine->b);
  levels_cycle(&grid->levels);
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double weight[8], sum = r[i] / s->diagonal[i];
    size_t node[8];
    int n = particle_corners(grid, i - s->local.begin, node);
    weights_of(grid, i - s->local.begin, weight);
    for (int c = 0; c < n; c++) sum += weight[c] * fine->x[node[c]];
    z[i] = sum;
  }
}

size_t multigrid_nodes(const struct isph *s) {
  return s->multigrid->levels.at[0].node_count;
}

size_t multigrid_number(const struct isph *s, size_t node, bool back) {
  static const int plain[3] = {0, 1, 2};
  const int *from = back ? s->cells.axis : plain, *to = back ? plain : s->cells.axis;
  const int *n = s->multigrid->levels.at[0].nodes;
  size_t at[3];
  for (int k = 0; k < 3; node /= (size_t)n[from[k++]]) at[from[k]] = node % (size_t)n[from[k]];
  return (at[to[2]] * (size_t)n[to[1]] + at[to[1]]) * (size_t)n[to[0]] + at[to[0]];
}

size_t multigrid_row_before(const struct isph *s, const double x[3]) {
  const struct isph_multigrid *grid = s->multigrid;
  const struct level *fine = &grid->levels.at[0];
  int at[3] = {0};
  for (int k = 1; k < 3; k++) {
    const int a = s->cells.axis[k];
    if (grid->levels.used[a])
      at[a] = (int)fmin(fmax(0, (x[a] - grid->origin[a]) / fine->h[a]), fine->cells[a] - 1);
  }
  return multigrid_number(s, level_node(fine, at[0], at[1], at[2]), false);
}

int multigrid_interpolation(const struct isph *s, size_t i, size_t node[8], double weight[8]) {
  weights_of(s->multigrid, i, weight);
  return particle_corners(s->multigrid, i, node);
}

int multigrid_row(const struct isph *s, size_t node, size_t column[27], double value[27]) {
  const struct level *fine = &s->multigrid->levels.at[0];
  const size_t nx = (size_t)fine->nodes[0], ny = (size_t)fine->nodes[1];
  const size_t i = node % nx, j = node / nx % ny, k = node / nx / ny;
  const int at[3][3] = {{fine->lower[0][i], (int)i, fine->upper[0][i]},
                        {fine->lower[1][j], (int)j, fine->upper[1][j]},
                        {fine->lower[2][k], (int)k, fine->upper[2][k]}};
  int n = 0;
  for (int c = 0; c < 27; c++) {
    const double entry = (double)fine->stencil[27 * node + (size_t)c];
    if (entry == 0 && c != 13) continue;
    column[n] = level_node(fine, at[0][c % 3], at[1][c / 3 % 3], at[2][c / 9]);
    value[n++] = entry;
  }
  return n;
}

void multigrid_free(struct isph *s) {
  struct isph_multigrid *grid = s->multigrid;
  if (grid == NULL) return;
  levels_free(&grid->levels);
  memory_free(&grid->base);
  memory_free(&grid->fraction);
  memory_free(&grid->order);
  memory_free(&grid->whole);
  memory_free(&grid->layer_start);
  memory_free(&s->multigrid);
}
