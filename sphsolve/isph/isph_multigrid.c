#include "sphsolve/isph/isph_multigrid.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/isph_ranks.h"

#define LEVELS 12
#define COARSEST_SWEEPS 12

struct level {
  int cells[3], nodes[3]; /* an axis that is not used has 1 node and 1 cell of height 1 */
  bool periodic[3];
  double h[3];
  size_t node_count, cell_count, node_capacity, cell_capacity;
  double *k;      /* [cells]: mean coefficient */
  double *tie;    /* [nodes]: what holds the pressure to a given one, lumped */
  float *stencil; /* [nodes][27] */
  double *x, *b, *r;
  int *lower[3], *upper[3]; /* neighbours along an axis; itself where there is none */
};

struct isph_multigrid {
  int level_count;
  bool used[3];
  double origin[3];
  struct level levels[LEVELS];
  size_t capacity, layer_capacity;
  uint32_t *base; /* [own particles]: lowest node of its cell */
  float (*fraction)[3];
  uint32_t *order; /* own particles by layer of cells along z */
  int64_t *whole;  /* [nodes, cells]: sums in units, the same in whatever order */
  size_t whole_room;
  uint32_t *layer_start;
};

static enum status reserve_level(struct level *level) {
  enum status status = STATUS_OK;
  const char *what = "the preconditioner";
  level->node_count = level->cell_count = 1;
  for (int a = 0; a < 3; a++) {
    level->node_count *= (size_t)level->nodes[a];
    level->cell_count *= (size_t)level->cells[a];
  }
  if (level->node_count > level->node_capacity) {
    size_t n = level->node_count + level->node_count / 4;
    TRY(memory_resize(&level->tie, n, sizeof *level->tie, what));
    TRY(memory_resize(&level->stencil, n, 27 * sizeof *level->stencil, what));
    TRY(memory_resize(&level->x, n, sizeof *level->x, what));
    TRY(memory_resize(&level->b, n, sizeof *level->b, what));
    TRY(memory_resize(&level->r, n, sizeof *level->r, what));
    level->node_capacity = n;
  }
  if (level->cell_count > level->cell_capacity) {
    size_t n = level->cell_count + level->cell_count / 4;
    TRY(memory_resize(&level->k, n, sizeof *level->k, what));
    level->cell_capacity = n;
  }
  for (int a = 0; a < 3; a++) {
    int n = level->nodes[a];
    TRY(memory_resize(&level->lower[a], (size_t)n, sizeof *level->lower[a], what));
    TRY(memory_resize(&level->upper[a], (size_t)n, sizeof *level->upper[a], what));
    for (int i = 0; i < n; i++) {
      level->lower[a][i] = i > 0 ? i - 1 : level->periodic[a] ? n - 1 : i;
      level->upper[a][i] = i < n - 1 ? i + 1 : level->periodic[a] ? 0 : i;
    }
  }
  memset(level->tie, 0, level->node_count * sizeof *level->tie);
  memset(level->k, 0, level->cell_count * sizeof *level->k);
cleanup:
  return status;
}

static size_t node_at(const struct level *level, int i, int j, int k) {
  return ((size_t)k * (size_t)level->nodes[1] + (size_t)j) * (size_t)level->nodes[0] + (size_t)i;
}

/* Cells along a length that can be halved often; even along a periodic axis, where the layers of
 * cells are worked on in two colours. */
static int cells_for(double length, double wanted, bool periodic) {
  int n = (int)fmax(1, periodic ? floor(length / wanted) : ceil(length / wanted)), step = 1;
  while (3 * step <= n) step *= 2;
  if (periodic) return n < 2 ? 2 : n < step ? step : n / step * step;
  return (n + step - 1) / step * step;
}

static enum status shape(struct isph *s, struct isph_multigrid *grid) {
  struct level *fine = &grid->levels[0];
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  double most[6];
  for (size_t i = s->share.begin; i < s->share.end; i++)
    for (int a = 0; a < 3; a++) {
      low[a] = fmin(low[a], s->position[i][a]);
      high[a] = fmax(high[a], s->position[i][a]);
    }
  for (int a = 0; a < 3; a++) most[a] = high[a], most[3 + a] = -low[a];
  ranks_max_all(most, 6);
  for (int a = 0; a < 3; a++) high[a] = most[a], low[a] = -most[3 + a];
  for (int a = 0; a < 3; a++) {
    grid->used[a] = s->dimensions == 3 || a != 1;
    fine->periodic[a] = s->periodic[a];
    if (s->periodic[a]) low[a] = s->low[a], high[a] = s->high[a];
    double length = high[a] - low[a] + 1e-6 * s->spacing;
    fine->cells[a] = grid->used[a] ? cells_for(length, 2 * s->spacing, s->periodic[a]) : 1;
    fine->nodes[a] = grid->used[a] && !s->periodic[a] ? fine->cells[a] + 1 : fine->cells[a];
    fine->h[a] = grid->used[a] ? (s->periodic[a] ? high[a] - low[a] : length) / fine->cells[a] : 1;
    if (!s->periodic[a]) fine->h[a] = fmax(fine->h[a], grid->used[a] ? s->spacing : 1);
    grid->origin[a] = low[a];
  }
  enum status status = reserve_level(fine);
  grid->level_count = 1;
  while (status == STATUS_OK && grid->level_count < LEVELS) {
    struct level *coarse = &grid->levels[grid->level_count];
    fine = coarse - 1;
    bool coarser = false;
    for (int a = 0; a < 3; a++) {
      bool halve = grid->used[a] && fine->cells[a] % 2 == 0 && fine->cells[a] >= 4;
      coarser = coarser || halve;
      coarse->periodic[a] = fine->periodic[a];
      coarse->cells[a] = halve ? fine->cells[a] / 2 : fine->cells[a];
      coarse->h[a] = halve ? 2 * fine->h[a] : fine->h[a];
      coarse->nodes[a] =
          grid->used[a] && !fine->periodic[a] ? coarse->cells[a] + 1 : coarse->cells[a];
    }
    if (!coarser) break;
    status = reserve_level(coarse);
    grid->level_count++;
  }
  return status;
}

/* Corners of the cell whose lowest node is (i, j, k), as nodes; 4 in a plane, 8 in space. */
static int corners_of(const struct isph_multigrid *grid, const struct level *level, int i, int j,
                      int k, size_t node[8], int corner[8][3]) {
  int n = 0, top = grid->used[1] ? 1 : 0;
  for (int c = 0; c <= 1; c++)
    for (int b = 0; b <= top; b++)
      for (int a = 0; a <= 1; a++) {
        node[n] = node_at(level, a ? level->upper[0][i] : i, b ? level->upper[1][j] : j,
                          c ? level->upper[2][k] : k);
        corner[n][0] = a, corner[n][1] = b, corner[n][2] = c;
        n++;
      }
  return n;
}

/* Stiffness of multilinear elements with the cells' k, plus the ties. Cells in layers of one parity
 * share no node, so that the sums come in one order whatever the threads. */
static void assemble_level(const struct isph_multigrid *grid, struct level *level) {
  double local[8][8];
  size_t node[8];
  int corner[8][3];
  int n = corners_of(grid, level, 0, 0, 0, node, corner);
  double volume = level->h[0] * level->h[1] * level->h[2];
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      local[p][q] = 0;
      for (int a = 0; a < 3; a++) {
        if (!grid->used[a]) continue;
        double term = volume / (level->h[a] * level->h[a]);
        for (int b = 0; b < 3; b++) {
          bool same = corner[p][b] == corner[q][b];
          if (b == a)
            term *= same ? 1 : -1;
          else if (grid->used[b])
            term *= same ? 1.0 / 3 : 1.0 / 6;
        }
        local[p][q] += term;
      }
    }
  memset(level->stencil, 0, level->node_count * 27 * sizeof *level->stencil);
  for (int parity = 0; parity < 2; parity++) {
#pragma omp parallel for schedule(static)
    for (int k = parity; k < level->cells[2]; k += 2) {
      size_t at[8];
      int place[8][3];
      for (int j = 0; j < level->cells[1]; j++)
        for (int i = 0; i < level->cells[0]; i++) {
          size_t cell =
              ((size_t)k * (size_t)level->cells[1] + (size_t)j) * (size_t)level->cells[0] +
              (size_t)i;
          if (level->k[cell] <= 0) continue;
          corners_of(grid, level, i, j, k, at, place);
          for (int p = 0; p < n; p++)
            for (int q = 0; q < n; q++) {
              int offset = (place[q][0] - place[p][0] + 1) + 3 * (place[q][1] - place[p][1] + 1) +
                           9 * (place[q][2] - place[p][2] + 1);
              level->stencil[27 * at[p] + (size_t)offset] += (float)(level->k[cell] * local[p][q]);
            }
        }
    }
  }
  for (size_t i = 0; i < level->node_count; i++) {
    float *middle = &level->stencil[27 * i + 13];
    *middle += (float)level->tie[i];
    if (!(*middle > 0)) *middle = 1; /* a node without water */
  }
}

/* Mean coefficient and lumped ties of a coarser level. */
static void coarsen(const struct isph_multigrid *grid, const struct level *fine,
                    struct level *coarse) {
  int step[3];
  double share = 1;
  for (int a = 0; a < 3; a++) {
    step[a] = fine->cells[a] / coarse->cells[a];
    share /= step[a];
  }
  for (int k = 0; k < fine->cells[2]; k++)
    for (int j = 0; j < fine->cells[1]; j++)
      for (int i = 0; i < fine->cells[0]; i++) {
        size_t from =
            ((size_t)k * (size_t)fine->cells[1] + (size_t)j) * (size_t)fine->cells[0] + (size_t)i;
        size_t to = ((size_t)(k / step[2]) * (size_t)coarse->cells[1] + (size_t)(j / step[1])) *
                        (size_t)coarse->cells[0] +
                    (size_t)(i / step[0]);
        coarse->k[to] += share * fine->k[from];
      }
  (void)grid;
}

/* Transfers between levels along all axes: coarse = P^T fine, or fine += P coarse. */
static void transfer(const struct level *fine, const struct level *coarse, const double *from,
                     double *to, bool down) {
  int step[3];
  for (int a = 0; a < 3; a++) step[a] = fine->cells[a] / coarse->cells[a];
  if (down) memset(to, 0, coarse->node_count * sizeof *to);
  for (int k = 0; k < fine->nodes[2]; k++)
    for (int j = 0; j < fine->nodes[1]; j++)
      for (int i = 0; i < fine->nodes[0]; i++) {
        int at[3] = {i, j, k}, first[3], second[3];
        for (int a = 0; a < 3; a++) {
          first[a] = second[a] = at[a] / step[a];
          if (at[a] % step[a]) second[a] = coarse->upper[a][first[a]];
        }
        size_t here = node_at(fine, i, j, k);
        double sum = 0;
        for (int c = 0; c < 8; c++) {
          size_t there = node_at(coarse, c & 1 ? second[0] : first[0], c & 2 ? second[1] : first[1],
                                 c & 4 ? second[2] : first[2]);
          if (down)
            to[there] += 0.125 * from[here];
          else
            sum += 0.125 * from[there];
        }
        if (!down) to[here] += sum;
      }
}

/* sum of the stencil of a node without its middle, times x. */
static inline double off_middle(const struct level *level, const double *x, int i, int j, int k,
                                size_t node) {
  const float *stencil = &level->stencil[27 * node];
  int at[3][3] = {{level->lower[0][i], i, level->upper[0][i]},
                  {level->lower[1][j], j, level->upper[1][j]},
                  {level->lower[2][k], k, level->upper[2][k]}};
  double sum = 0;
  for (int c = 0; c < 3; c++)
    for (int b = 0; b < 3; b++) {
      const double *row = x + node_at(level, 0, at[1][b], at[2][c]);
      const float *s = stencil + 9 * c + 3 * b;
      sum += (double)s[0] * row[at[0][0]] + (double)s[1] * row[i] + (double)s[2] * row[at[0][2]];
    }
  return sum - (double)stencil[13] * x[node];
}

/* Gauss-Seidel by planes of two colours; backward is the exact reverse of forward. */
static void smooth(struct level *level, bool backward) {
  int planes = level->nodes[2];
  for (int colour = 0; colour < 2; colour++) {
    int parity = backward ? 1 - colour : colour;
#pragma omp parallel for schedule(static) if (level->node_count > 4096)
    for (int k = parity; k < planes; k += 2)
      for (int jj = 0; jj < level->nodes[1]; jj++)
        for (int ii = 0; ii < level->nodes[0]; ii++) {
          int i = backward ? level->nodes[0] - 1 - ii : ii;
          int j = backward ? level->nodes[1] - 1 - jj : jj;
          size_t node = node_at(level, i, j, k);
          level->x[node] = (level->b[node] - off_middle(level, level->x, i, j, k, node)) /
                           (double)level->stencil[27 * node + 13];
        }
  }
}

static void cycle(struct isph_multigrid *grid, int depth) {
  struct level *level = &grid->levels[depth];
  memset(level->x, 0, level->node_count * sizeof *level->x);
  if (depth == grid->level_count - 1) {
    for (int sweep = 0; sweep < COARSEST_SWEEPS; sweep++) smooth(level, false), smooth(level, true);
    return;
  }
  struct level *coarse = level + 1;
  smooth(level, false);
#pragma omp parallel for schedule(static) if (level->node_count > 4096)
  for (int k = 0; k < level->nodes[2]; k++)
    for (int j = 0; j < level->nodes[1]; j++)
      for (int i = 0; i < level->nodes[0]; i++) {
        size_t node = node_at(level, i, j, k);
        level->r[node] = level->b[node] - off_middle(level, level->x, i, j, k, node) -
                         (double)level->stencil[27 * node + 13] * level->x[node];
      }
  transfer(level, coarse, level->r, coarse->b, true);
  cycle(grid, depth + 1);
  transfer(level, coarse, coarse->x, level->x, false);
  smooth(level, true);
}

/* Weights of the 8 corners of the cell of own particle i. */
static void weights_of(const struct isph_multigrid *grid, size_t i, double weight[8]) {
  double f[3] = {(double)grid->fraction[i][0], (double)grid->fraction[i][1],
                 (double)grid->fraction[i][2]};
  int n = 0, top = grid->used[1] ? 1 : 0;
  for (int c = 0; c <= 1; c++)
    for (int b = 0; b <= top; b++)
      for (int a = 0; a <= 1; a++)
        weight[n++] =
            (a ? f[0] : 1 - f[0]) * (top ? (b ? f[1] : 1 - f[1]) : 1) * (c ? f[2] : 1 - f[2]);
}

/* As corners_of, for the cell of own particle i. */
static int particle_corners(const struct isph_multigrid *grid, size_t i, size_t node[8]) {
  const struct level *fine = &grid->levels[0];
  const uint32_t base = grid->base[i], row = base / (uint32_t)fine->nodes[0];
  const uint32_t x = base - row * (uint32_t)fine->nodes[0], z = row / (uint32_t)fine->nodes[1];
  const uint32_t y = row - z * (uint32_t)fine->nodes[1];
  const size_t right = (size_t)fine->upper[0][x] - x;
  const int above = fine->upper[2][z];
  node[0] = base;
  node[1] = base + right;
  if (!grid->used[1]) {
    node[2] = node_at(fine, (int)x, (int)y, above);
    node[3] = node[2] + right;
    return 4;
  }
  const int behind = fine->upper[1][y];
  node[2] = node_at(fine, (int)x, behind, (int)z);
  node[4] = node_at(fine, (int)x, (int)y, above);
  node[6] = node_at(fine, (int)x, behind, above);
  for (int c = 2; c < 8; c += 2) node[c + 1] = node[c] + right;
  return 8;
}

/* Sums over all particles are taken in whole numbers of a unit that depends on the largest value
 * alone, so that they are the same in any order, on any number of ranks; of MOST of the largest
 * there is room for. */
#define MOST 0x1p16

static double unit_of(const struct isph *s, const double *value) {
  double most = 0;
#pragma omp parallel for schedule(static) reduction(max : most)
  for (size_t i = s->share.begin; i < s->share.end; i++) most = fmax(most, fabs(value[i]));
  most = ranks_max(most);
  int exponent = 0;
  frexp(most, &exponent);
  return most > 0 && isfinite(most) ? ldexp(MOST / 0x1p62, exponent) : 1;
}

/* `sums` are those of all ranks, times `unit`. */
static void add_up(const struct isph_multigrid *grid, size_t n, double unit, double *sums) {
  ranks_sum_whole(grid->whole, n);
#pragma omp parallel for schedule(static)
  for (size_t k = 0; k < n; k++) sums[k] = unit * (double)grid->whole[k];
}

/* Adds value[i] of all particles to the nodes around, by layers of two colours. */
static void gather(const struct isph *s, const double *value, double *nodes) {
  const struct isph_multigrid *grid = s->multigrid;
  const struct level *fine = &grid->levels[0];
  const double unit = unit_of(s, value), scale = 1 / unit;
  memset(grid->whole, 0, fine->node_count * sizeof *grid->whole);
  for (int parity = 0; parity < 2; parity++) {
#pragma omp parallel for schedule(dynamic, 1)
    for (int k = parity; k < fine->cells[2]; k += 2)
      for (uint32_t p = grid->layer_start[k]; p < grid->layer_start[k + 1]; p++) {
        size_t i = grid->order[p], node[8];
        double weight[8], scaled = scale * value[s->share.begin + i];
        int n = particle_corners(grid, i, node);
        weights_of(grid, i, weight);
        for (int c = 0; c < n; c++) grid->whole[node[c]] += (int64_t)(weight[c] * scaled);
      }
  }
  add_up(grid, fine->node_count, unit, nodes);
}

/* Mean coefficient of the cells. */
static void find_coefficients(const struct isph *s) {
  struct isph_multigrid *grid = s->multigrid;
  struct level *fine = &grid->levels[0];
  const size_t nx = (size_t)fine->nodes[0], ny = (size_t)fine->nodes[1];
  const double volume = fine->h[0] * fine->h[1] * fine->h[2];
  double *value = s->work[1];
#pragma omp parallel for schedule(static)
  for (size_t i = s->share.begin; i < s->share.end; i++)
    value[i] = s->mobility[i] * s->volume[i] / volume;
  const double unit = unit_of(s, value), scale = 1 / unit;
  memset(grid->whole, 0, fine->cell_count * sizeof *grid->whole);
  for (size_t i = s->share.begin; i < s->share.end; i++) {
    const size_t base = grid->base[i - s->share.begin], row = base / nx;
    const size_t cell = (row / ny * (size_t)fine->cells[1] + row % ny) * (size_t)fine->cells[0];
    grid->whole[cell + base % nx] += (int64_t)(scale * value[i]);
  }
  add_up(grid, fine->cell_count, unit, fine->k);
}

enum status multigrid_build(struct isph *s) {
  enum status status = STATUS_OK;
  if (s->multigrid == NULL)
    TRY(memory_allocate(&s->multigrid, 1, sizeof *s->multigrid, "the preconditioner"));
  struct isph_multigrid *grid = s->multigrid;
  TRY(shape(s, grid));
  struct level *fine = &grid->levels[0];
  const size_t own = s->share.end - s->share.begin, sums = fine->node_count; /* cells are fewer */
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
  size_t layers = (size_t)fine->cells[2];
  if (layers + 1 > grid->layer_capacity) {
    TRY(memory_resize(&grid->layer_start, 2 * layers + 1, sizeof *grid->layer_start,
                      "the preconditioner"));
    grid->layer_capacity = 2 * layers + 1;
  }
  memset(grid->layer_start, 0, (layers + 1) * sizeof *grid->layer_start);
  for (size_t i = 0; i < own; i++) {
    int at[3];
    for (int a = 0; a < 3; a++) {
      const double x = s->position[s->share.begin + i][a];
      double scaled = grid->used[a] ? (x - grid->origin[a]) / fine->h[a] : 0;
      at[a] = (int)fmin(fmax(0, floor(scaled)), fine->cells[a] - 1);
      grid->fraction[i][a] = (float)fmin(fmax(0, scaled - at[a]), 1);
    }
    grid->base[i] = (uint32_t)node_at(fine, at[0], at[1], at[2]);
    grid->layer_start[at[2] + 1]++;
  }
  for (size_t k = 0; k < layers; k++) grid->layer_start[k + 1] += grid->layer_start[k];
  size_t plane = (size_t)fine->nodes[0] * (size_t)fine->nodes[1];
  for (size_t i = 0; i < own; i++)
    grid->order[grid->layer_start[grid->base[i] / plane]++] = (uint32_t)i;
  for (size_t k = layers; k > 0; k--) grid->layer_start[k] = grid->layer_start[k - 1];
  grid->layer_start[0] = 0;
  find_coefficients(s);
  gather(s, s->tied, fine->tie);
  for (int l = 0; l < grid->level_count; l++) {
    if (l > 0) {
      coarsen(grid, &grid->levels[l - 1], &grid->levels[l]);
      transfer(&grid->levels[l - 1], &grid->levels[l], grid->levels[l - 1].tie, grid->levels[l].tie,
               true);
    }
    assemble_level(grid, &grid->levels[l]);
  }
cleanup:
  return status;
}

void multigrid_apply(struct isph *s, const double *r, double *z) {
  struct isph_multigrid *grid = s->multigrid;
  struct level *fine = &grid->levels[0];
  gather(s, r, fine->b);
  cycle(grid, 0);
#pragma omp parallel for schedule(static)
  for (size_t i = s->share.begin; i < s->share.end; i++) {
    double weight[8], sum = r[i] / s->diagonal[i];
    size_t node[8];
    int n = particle_corners(grid, i - s->share.begin, node);
    weights_of(grid, i - s->share.begin, weight);
    for (int c = 0; c < n; c++) sum += weight[c] * fine->x[node[c]];
    z[i] = sum;
  }
}

size_t multigrid_nodes(const struct isph *s) {
  return s->multigrid->levels[0].node_count;
}

size_t multigrid_number(const struct isph *s, size_t node, bool back) {
  static const int plain[3] = {0, 1, 2};
  const int *from = back ? s->cells.axis : plain, *to = back ? plain : s->cells.axis;
  const int *n = s->multigrid->levels[0].nodes;
  size_t at[3];
  for (int k = 0; k < 3; node /= (size_t)n[from[k++]]) at[from[k]] = node % (size_t)n[from[k]];
  return (at[to[2]] * (size_t)n[to[1]] + at[to[1]]) * (size_t)n[to[0]] + at[to[0]];
}

size_t multigrid_row_before(const struct isph *s, const double x[3]) {
  const struct isph_multigrid *grid = s->multigrid;
  const struct level *fine = &grid->levels[0];
  int at[3] = {0};
  for (int k = 1; k < 3; k++) {
    const int a = s->cells.axis[k];
    if (grid->used[a])
      at[a] = (int)fmin(fmax(0, (x[a] - grid->origin[a]) / fine->h[a]), fine->cells[a] - 1);
  }
  return multigrid_number(s, node_at(fine, at[0], at[1], at[2]), false);
}

int multigrid_interpolation(const struct isph *s, size_t i, size_t node[8], double weight[8]) {
  weights_of(s->multigrid, i, weight);
  return particle_corners(s->multigrid, i, node);
}

int multigrid_row(const struct isph *s, size_t node, size_t column[27], double value[27]) {
  const struct level *fine = &s->multigrid->levels[0];
  const size_t nx = (size_t)fine->nodes[0], ny = (size_t)fine->nodes[1];
  const size_t i = node % nx, j = node / nx % ny, k = node / nx / ny;
  const int at[3][3] = {{fine->lower[0][i], (int)i, fine->upper[0][i]},
                        {fine->lower[1][j], (int)j, fine->upper[1][j]},
                        {fine->lower[2][k], (int)k, fine->upper[2][k]}};
  int n = 0;
  for (int c = 0; c < 27; c++) {
    const double entry = (double)fine->stencil[27 * node + (size_t)c];
    if (entry == 0 && c != 13) continue;
    column[n] = node_at(fine, at[0][c % 3], at[1][c / 3 % 3], at[2][c / 9]);
    value[n++] = entry;
  }
  return n;
}

void multigrid_free(struct isph *s) {
  struct isph_multigrid *grid = s->multigrid;
  if (grid == NULL) return;
  for (int l = 0; l < LEVELS; l++) {
    struct level *level = &grid->levels[l];
    memory_free(&level->k);
    memory_free(&level->tie);
    memory_free(&level->stencil);
    memory_free(&level->x);
    memory_free(&level->b);
    memory_free(&level->r);
    for (int a = 0; a < 3; a++) {
      memory_free(&level->lower[a]);
      memory_free(&level->upper[a]);
    }
  }
  memory_free(&grid->base);
  memory_free(&grid->fraction);
  memory_free(&grid->order);
  memory_free(&grid->whole);
  memory_free(&grid->layer_start);
  memory_free(&s->multigrid);
}
