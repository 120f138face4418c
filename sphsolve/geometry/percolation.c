#include "sphsolve/geometry/percolation.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/node_memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/thin_wall.h"

/* Pores as unions of runs, i.e. of maximal rows of fluid sites along x (union-find with path
 * halving, Tarjan, van Leeuwen 1984; of runs, He, Chao, Suzuki 2008, IEEE Trans. Image Process.
 * 17). A run stores how often the path from its parent winds around the box along each axis. Two
 * runs of one pore that meet with different winding numbers close a path around the box, which
 * carries flow if its closing vector has a component along the force. */
struct runs {
  const struct lattice *lattice;
  double closing_work[3]; /* driving force times the length of the box */
  size_t count;
  size_t *start;        /* [rows + 1]: first run of a row */
  uint32_t (*sites)[2]; /* first and last along x */
  uint32_t *parent;     /* a root is its own parent */
  int32_t (*turns)[3];  /* winding numbers relative to the parent */
  uint8_t *flows;       /* valid for roots */
};

static bool work_is_done(const struct runs *runs, const int turns[3]) {
  double work = 0, scale = 0;
  for (int a = 0; a < 3; a++) {
    work += runs->closing_work[a] * turns[a];
    scale += fabs(runs->closing_work[a] * turns[a]);
  }
  return fabs(work) > 1e-9 * scale;
}

/* The end of the run of fluid that begins at `x`, and the first fluid site from `x` on; nx if there
 * is none. cut: that of the row (lattice.h), or NULL. */
static size_t run_end(const uint8_t *kind, const uint8_t *cut, size_t nx, size_t x) {
  bool ended = false;
  for (; x < nx && kind[x] == SITE_FLUID && !ended; x++) ended = cut != NULL && (cut[x] & 1) != 0;
  return x;
}
static size_t run_begin(const uint8_t *kind, size_t nx, size_t x) {
  while (x < nx && kind[x] != SITE_FLUID) x++;
  return x;
}

static enum status find_runs(struct runs *runs) {
  enum status status = STATUS_OK;
  const struct lattice *l = runs->lattice;
  const size_t nx = l->size[0], rows = l->size[1] * l->size[2];
  TRY(memory_allocate(&runs->start, rows + 1, sizeof *runs->start, "pieces of the pores"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++) {
    const uint8_t *kind = l->kind + row * nx, *cut = l->cut ? l->cut + row * nx : NULL;
    for (size_t x = run_begin(kind, nx, 0); x < nx;
         x = run_begin(kind, nx, run_end(kind, cut, nx, x)))
      runs->start[row + 1]++;
  }
  for (size_t row = 0; row < rows; row++) runs->start[row + 1] += runs->start[row];
  runs->count = runs->start[rows];
  if (runs->count > UINT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%zu pieces of pores: paths are followed through 2^32 at most",
             runs->count);
  TRY(memory_allocate(&runs->sites, runs->count, sizeof *runs->sites, "pieces of the pores"));
  TRY(memory_allocate(&runs->parent, runs->count, sizeof *runs->parent, "paths in the pores"));
  TRY(memory_allocate(&runs->turns, runs->count, sizeof *runs->turns, "paths in the pores"));
  TRY(memory_allocate(&runs->flows, runs->count, 1, "paths in the pores"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < rows; row++) {
    const uint8_t *kind = l->kind + row * nx, *cut = l->cut ? l->cut + row * nx : NULL;
    size_t n = runs->start[row];
    for (size_t x = run_begin(kind, nx, 0); x < nx; n++) {
      const size_t end = run_end(kind, cut, nx, x);
      runs->parent[n] = (uint32_t)n;
      runs->sites[n][0] = (uint32_t)x, runs->sites[n][1] = (uint32_t)(end - 1);
      x = run_begin(kind, nx, end);
    }
  }
cleanup:
  return status;
}

/* Root of a run, and the winding numbers from the root to the run. */
static size_t find_root(struct runs *runs, size_t n, int turns[3]) {
  memset(turns, 0, 3 * sizeof *turns);
  while (runs->parent[n] != n) {
    const size_t above = runs->parent[n];
    for (int a = 0; a < 3; a++) {
      runs->turns[n][a] += runs->turns[above][a];
      turns[a] += runs->turns[n][a];
    }
    runs->parent[n] = runs->parent[above];
    n = runs->parent[n];
  }
  return n;
}

/* Joins two touching runs; `step`: winding numbers from the first to the second. */
static void join(struct runs *runs, size_t first, size_t second, const int step[3]) {
  int low[3], high[3], between[3];
  const size_t a = find_root(runs, first, low), b = find_root(runs, second, high);
  for (int i = 0; i < 3; i++) between[i] = low[i] + step[i] - high[i]; /* from root a to root b */
  if (a == b) {
    if (!runs->flows[a] && (between[0] || between[1] || between[2]))
      runs->flows[a] = work_is_done(runs, between);
    return;
  }
  const size_t root = a < b ? a : b, child = a < b ? b : a;
  runs->parent[child] = (uint32_t)root;
  runs->flows[root] |= runs->flows[child];
  for (int i = 0; i < 3; i++) runs->turns[child][i] = a < b ? between[i] : -between[i];
}

/* Whether two runs of rows beside each other along `axis` touch; reach: 1 if edges count, too. */
static bool runs_touch(const struct runs *runs, size_t row, int axis, const uint32_t one[2],
                       const uint32_t two[2], uint32_t reach) {
  const struct lattice *l = runs->lattice;
  if (l->cut == NULL) return one[0] <= two[1] + reach && two[0] <= one[1] + reach;
  const size_t first = one[0] > two[0] ? one[0] : two[0], last = one[1] < two[1] ? one[1] : two[1];
  for (size_t x = first; x <= last; x++)
    if (!thin_wall_on_face(l, row * l->size[0] + x, axis)) return true;
  return false;
}

/* Joins the touching runs of two rows beside each other along `axis`, `step` turns apart; with
 * `corners` also across edges. */
static void join_rows(struct runs *runs, size_t row, size_t other, int axis, const int step[3],
                      bool corners) {
  const size_t end = runs->start[row + 1], end_other = runs->start[other + 1];
  const uint32_t last = (uint32_t)runs->lattice->size[0] - 1, reach = corners ? 1 : 0;
  for (size_t i = runs->start[row], j = runs->start[other]; i < end && j < end_other;) {
    const uint32_t *one = runs->sites[i], *two = runs->sites[j];
    if (runs_touch(runs, row, axis, one, two, reach)) join(runs, i, j, step);
    if (one[1] < two[1])
      i++;
    else
      j++;
  }
  if (!corners || runs->start[row] == end || runs->start[other] == end_other) return;
  /* Across the periodic boundary along x. */
  if (runs->sites[end - 1][1] == last && runs->sites[runs->start[other]][0] == 0)
    join(runs, end - 1, runs->start[other], (const int[3]){step[0] + 1, step[1], step[2]});
  if (runs->sites[runs->start[row]][0] == 0 && runs->sites[end_other - 1][1] == last)
    join(runs, runs->start[row], end_other - 1, (const int[3]){step[0] - 1, step[1], step[2]});
}

/* Thin walls are known between faces only: where there are any, edges join nothing. */
static enum status join_all(struct runs *runs, bool corners) {
  const size_t ny = runs->lattice->size[1], nz = runs->lattice->size[2];
  const uint32_t last = (uint32_t)runs->lattice->size[0] - 1;
  static const int steps[4][2] = {{1, 0}, {0, 1}, {1, 1}, {-1, 1}};
  corners = corners && runs->lattice->cut == NULL;
  for (size_t row = 0, j = 0, k = 0; row < ny * nz && !interrupt_alone(); row++, j++) {
    if (j == ny) j = 0, k++;
    const size_t begin = runs->start[row], end = runs->start[row + 1];
    if (begin == end) continue;
    if (runs->sites[begin][0] == 0 && runs->sites[end - 1][1] == last &&
        !thin_wall_on_face(runs->lattice, row * runs->lattice->size[0] + last, 0))
      join(runs, end - 1, begin, (const int[3]){1, 0, 0});
    for (int s = 0; s < (corners ? 4 : 2); s++) {
      const long y = (long)j + steps[s][0], z = (long)k + steps[s][1];
      const int turns[3] = {0, y < 0 ? -1 : y >= (long)ny, z >= (long)nz};
      const long to_y = y - turns[1] * (long)ny, to_z = z - turns[2] * (long)nz;
      join_rows(runs, row, (size_t)to_z * ny + (size_t)to_y, 1 + s, turns, corners);
    }
  }
  return interrupt_look();
}

enum status percolation_find(const struct lattice *lattice, const double driving[3], bool corners,
                             uint8_t *flowing, bool *flows) {
  enum status status = STATUS_OK;
  struct runs runs = {.lattice = lattice};
  *flows = false;
  for (int a = 0; a < 3; a++)
    runs.closing_work[a] = driving[a] * (double)lattice->size[a] * lattice->spacing[a];
  TRY(find_runs(&runs));
  TRY(join_all(&runs, corners));
  for (size_t row = 0; row < lattice->size[1] * lattice->size[2]; row++)
    for (size_t n = runs.start[row]; n < runs.start[row + 1]; n++) {
      int turns[3];
      if (!runs.flows[find_root(&runs, n, turns)]) continue;
      *flows = true;
      if (flowing != NULL)
        memset(flowing + row * lattice->size[0] + runs.sites[n][0], PERCOLATION_FLOWS,
               runs.sites[n][1] - runs.sites[n][0] + 1);
    }
cleanup:
  MEMORY_FREE(&runs.start, &runs.sites, &runs.parent, &runs.turns, &runs.flows);
  return status;
}

const char *percolation_none(const struct lattice *lattice) {
  return lattice->micro_porosity != NULL
             ? "no pore or soil leads through the model along the force: k is 0; resolve the "
               "throats "
               "with smaller voxels, or look at the greys or labels taken as soil"
             : "no pore leads through the model along the force: k is 0; resolve the throats with "
               "smaller voxels, or look at the threshold";
}

enum status percolation_close(struct lattice *lattice, const double driving[3], size_t *closed,
                              bool *flows) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  uint8_t *flowing = NULL;
  size_t *start = NULL;
  *closed = 0;
  TRY(memory_allocate(&flowing, lattice->count, 1, "labels of the pores"));
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "shares of the ranks"));
  TRY(percolation_find(lattice, driving, false, flowing, flows));
  for (size_t s = 0; s < lattice->count && *flows; s++)
    *closed += lattice->kind[s] == SITE_FLUID && flowing[s] != PERCOLATION_FLOWS;
  if (*closed == 0) goto cleanup;
  /* The ranks of a machine share the lattice: none may write while another may read it. */
  ranks_sum(0);
  for (size_t r = 0; r <= ranks; r++) start[r] = lattice->count * r / ranks;
  const size_t rank = (size_t)ranks_own();
  for (size_t s = start[rank]; s < start[rank + 1]; s++)
    if (lattice->kind[s] == SITE_FLUID && flowing[s] != PERCOLATION_FLOWS)
      lattice->kind[s] = SITE_WALL;
  node_share(lattice->kind, start, 1);
  lattice->fluid_count -= *closed;
  lattice->wall_count += *closed;
cleanup:
  MEMORY_FREE(&flowing, &start);
  return status;
}
