#include "sphsolve/isph/levels.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

#define COARSEST_SWEEPS 12

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

/* Number of cells along a length, such that it can be halved often. Even along a periodic axis,
 * because layers of cells are processed in two colours. */
static int cells_for(double length, double wanted, bool periodic) {
  int n = (int)fmax(1, periodic ? floor(length / wanted) : ceil(length / wanted)), step = 1;
  while (3 * step <= n) step *= 2;
  if (periodic) return n < 2 ? 2 : n < step ? step : n / step * step;
  return (n + step - 1) / step * step;
}

enum status levels_shape(struct levels *levels, const double extent[3], const bool used[3],
                         const bool periodic[3], double spacing) {
  struct level *fine = &levels->at[0];
  for (int a = 0; a < 3; a++) {
    const double length = extent[a] + 1e-6 * spacing;
    levels->used[a] = used[a];
    fine->periodic[a] = periodic[a];
    fine->cells[a] = used[a] ? cells_for(length, 2 * spacing, periodic[a]) : 1;
    fine->nodes[a] = used[a] && !periodic[a] ? fine->cells[a] + 1 : fine->cells[a];
    fine->h[a] = used[a] ? (periodic[a] ? extent[a] : length) / fine->cells[a] : 1;
    if (!periodic[a]) fine->h[a] = fmax(fine->h[a], used[a] ? spacing : 1);
  }
  enum status status = reserve_level(fine);
  levels->count = 1;
  while (status == STATUS_OK && levels->count < LEVELS) {
    struct level *coarse = &levels->at[levels->count];
    fine = coarse - 1;
    bool coarser = false;
    for (int a = 0; a < 3; a++) {
      bool halve = used[a] && fine->cells[a] % 2 == 0 && fine->cells[a] >= 4;
      coarser = coarser || halve;
      coarse->periodic[a] = fine->periodic[a];
      coarse->cells[a] = halve ? fine->cells[a] / 2 : fine->cells[a];
      coarse->h[a] = halve ? 2 * fine->h[a] : fine->h[a];
      coarse->nodes[a] = used[a] && !fine->periodic[a] ? coarse->cells[a] + 1 : coarse->cells[a];
    }
    if (!coarser) break;
    status = reserve_level(coarse);
    levels->count++;
  }
  return status;
}

/* Nodes at the corners of the cell whose lowest node is (i, j, k), and their places; 4 in 2-D, 8 in
 * 3-D. */
static int corners_of(const bool used[3], const struct level *level, int i, int j, int k,
                      size_t node[8], int corner[8][3]) {
  int n = 0, top = used[1] ? 1 : 0;
  for (int c = 0; c <= 1; c++)
    for (int b = 0; b <= top; b++)
      for (int a = 0; a <= 1; a++) {
        node[n] = level_node(level, a ? level->upper[0][i] : i, b ? level->upper[1][j] : j,
                             c ? level->upper[2][k] : k);
        corner[n][0] = a, corner[n][1] = b, corner[n][2] = c;
        n++;
      }
  return n;
}

/* Stiffness matrix of multilinear elements with the cells' k, plus the ties. Cells in layers of the
 * same parity share no node, so that the order of summation does not depend on the threads. */
static void assemble_level(const bool used[3], struct level *level) {
  double local[8][8];
  size_t node[8];
  int corner[8][3];
  int n = corners_of(used, level, 0, 0, 0, node, corner);
  double volume = level->h[0] * level->h[1] * level->h[2];
  for (int p = 0; p < n; p++)
    for (int q = 0; q < n; q++) {
      local[p][q] = 0;
      for (int a = 0; a < 3; a++) {
        if (!used[a]) continue;
        double term = volume / (level->h[a] * level->h[a]);
        for (int b = 0; b < 3; b++) {
          bool same = corner[p][b] == corner[q][b];
          if (b == a)
            term *= same ? 1 : -1;
          else if (used[b])
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
          corners_of(used, level, i, j, k, at, place);
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

/* Mean coefficient of the cells of a coarser level. */
static void coarsen(const struct level *fine, struct level *coarse) {
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
}

/* The coarse nodes on both sides of fine node `at` along axis a, or twice the one that coincides
 * with it. */
static inline void between(const struct level *fine, const struct level *coarse, int a, int at,
                           int first[3], int second[3]) {
  const bool halved = fine->cells[a] > coarse->cells[a]; /* and never less: levels_shape */
  first[a] = second[a] = halved ? at / 2 : at;
  if (halved && at % 2) second[a] = coarse->upper[a][first[a]];
}

/* Restriction (down) coarse = P^T fine, or prolongation fine += P coarse. */
static void transfer(const struct level *fine, const struct level *coarse, const double *from,
                     double *to, bool down) {
  int first[3], second[3];
  if (down) memset(to, 0, coarse->node_count * sizeof *to);
  for (int k = 0; k < fine->nodes[2]; k++) {
    between(fine, coarse, 2, k, first, second);
    for (int j = 0; j < fine->nodes[1]; j++) {
      between(fine, coarse, 1, j, first, second);
      for (int i = 0; i < fine->nodes[0]; i++) {
        between(fine, coarse, 0, i, first, second);
        size_t here = level_node(fine, i, j, k);
        double sum = 0;
        for (int c = 0; c < 8; c++) {
          size_t there = level_node(coarse, c & 1 ? second[0] : first[0],
                                    c & 2 ? second[1] : first[1], c & 4 ? second[2] : first[2]);
          if (down)
            to[there] += from[here] / 8;
          else
            sum += from[there] / 8;
        }
        if (!down) to[here] += sum;
      }
    }
  }
}

/* Loops over nodes are compiled separately for grids in a plane, where the stencil's rows on both
 * sides of it are 0. Small grids are processed by one thread, since starting a team of threads
 * takes longer. */
#define NODE_FUNCTION static inline __attribute__((always_inline))
#define NODES_SERIAL_MAX 4096

static bool is_plane(const struct level *level) {
  return level->nodes[1] == 1;
}

/* Sum of the stencil of a node, without its diagonal, times x. */
NODE_FUNCTION double off_middle(const struct level *level, const double *x, int i, int j, int k,
                                size_t node, bool plane) {
  const float *stencil = &level->stencil[27 * node];
  int at[3][3] = {{level->lower[0][i], i, level->upper[0][i]},
                  {level->lower[1][j], j, level->upper[1][j]},
                  {level->lower[2][k], k, level->upper[2][k]}};
  double sum = 0;
  for (int c = 0; c < 3; c++)
    for (int b = plane ? 1 : 0; b < (plane ? 2 : 3); b++) {
      const double *row = x + level_node(level, 0, at[1][b], at[2][c]);
      const float *s = stencil + 9 * c + 3 * b;
      sum += (double)s[0] * row[at[0][0]] + (double)s[1] * row[i] + (double)s[2] * row[at[0][2]];
    }
  return sum - (double)stencil[13] * x[node];
}

NODE_FUNCTION void smooth_nodes(struct level *level, bool backward, int k, bool plane) {
  for (int jj = 0; jj < level->nodes[1]; jj++)
    for (int ii = 0; ii < level->nodes[0]; ii++) {
      int i = backward ? level->nodes[0] - 1 - ii : ii;
      int j = backward ? level->nodes[1] - 1 - jj : jj;
      size_t node = level_node(level, i, j, k);
      level->x[node] = (level->b[node] - off_middle(level, level->x, i, j, k, node, plane)) /
                       (double)level->stencil[27 * node + 13];
    }
}

static void smooth_layer(struct level *level, bool backward, int k) {
  if (is_plane(level))
    smooth_nodes(level, backward, k, true);
  else
    smooth_nodes(level, backward, k, false);
}

/* Gauss-Seidel sweep by layers of two colours; the backward sweep is the exact reverse of the
 * forward one. */
static void smooth(struct level *level, bool backward) {
  const int layers = level->nodes[2];
  for (int colour = 0; colour < 2; colour++) {
    const int parity = backward ? 1 - colour : colour;
    if (level->node_count <= NODES_SERIAL_MAX) {
      for (int k = parity; k < layers; k += 2) smooth_layer(level, backward, k);
      continue;
    }
#pragma omp parallel for schedule(static)
    for (int k = parity; k < layers; k += 2) smooth_layer(level, backward, k);
  }
}

NODE_FUNCTION void residual_of_nodes(struct level *level, int k, bool plane) {
  for (int j = 0; j < level->nodes[1]; j++)
    for (int i = 0; i < level->nodes[0]; i++) {
      size_t node = level_node(level, i, j, k);
      level->r[node] = level->b[node] - off_middle(level, level->x, i, j, k, node, plane) -
                       (double)level->stencil[27 * node + 13] * level->x[node];
    }
}

static void residual_of_layer(struct level *level, int k) {
  if (is_plane(level))
    residual_of_nodes(level, k, true);
  else
    residual_of_nodes(level, k, false);
}

static void find_residual(struct level *level) {
  const int layers = level->nodes[2];
  if (level->node_count <= NODES_SERIAL_MAX) {
    for (int k = 0; k < layers; k++) residual_of_layer(level, k);
    return;
  }
#pragma omp parallel for schedule(static)
  for (int k = 0; k < layers; k++) residual_of_layer(level, k);
}

static void cycle(struct levels *levels, int depth) {
  struct level *level = &levels->at[depth];
  memset(level->x, 0, level->node_count * sizeof *level->x);
  if (depth == levels->count - 1) {
    for (int sweep = 0; sweep < COARSEST_SWEEPS; sweep++) smooth(level, false), smooth(level, true);
    return;
  }
  struct level *coarse = level + 1;
  smooth(level, false);
  find_residual(level);
  transfer(level, coarse, level->r, coarse->b, true);
  cycle(levels, depth + 1);
  transfer(level, coarse, coarse->x, level->x, false);
  smooth(level, true);
}

void levels_assemble(struct levels *levels) {
  for (int l = 0; l < levels->count; l++) {
    struct level *level = &levels->at[l], *finer = level - 1;
    if (l > 0) {
      coarsen(finer, level);
      transfer(finer, level, finer->tie, level->tie, true);
    }
    assemble_level(levels->used, level);
  }
}

void levels_cycle(struct levels *levels) {
  cycle(levels, 0);
}

void levels_free(struct levels *levels) {
  for (int l = 0; l < LEVELS; l++) {
    struct level *level = &levels->at[l];
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
}
