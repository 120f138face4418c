#include "sphsolve/stokes/solver/multigrid.h"
#include "sphsolve/stokes/constants.h"

#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"

#define SWEEPS 2
#define SWEEPS_COARSEST 16
/* Constant values on blocks make the coarse operator too stiff by a factor of two (Braess 1995). */
#define OVERCORRECTION 0.5f
#define PARALLEL_FROM 20000

static enum status allocate(float **values, const struct stokes_multigrid_level *l) {
  const size_t used = (l->end - l->begin + 2) * l->size[0] * l->size[1];
  return memory_allocate_sparse(values, l->count, sizeof(float), used, "multigrid");
}

enum status stokes_multigrid_build(const size_t size[3], const struct slabs *slabs, int shared,
                                   struct stokes_multigrid *m) {
  enum status status = STATUS_OK;
  memset(m, 0, sizeof *m);
  size_t n[3] = {size[0], size[1], size[2]};
  for (bool more = true; more && m->level_count < MULTIGRID_LEVELS;) {
    struct stokes_multigrid_level *l = &m->levels[m->level_count++];
    memcpy(l->size, n, sizeof l->size);
    l->count = n[0] * n[1] * n[2];
    l->shift = m->level_count;
    l->end = n[2];
    if (RANKS && slabs->start && m->level_count <= shared) {
      l->slabs = slabs;
      l->begin = slabs_coarse(slabs->begin, l->shift);
      l->end = slabs_coarse(slabs->end, l->shift);
    } else if (RANKS && m->level_count > 1 && m->levels[m->level_count - 2].slabs) {
      const size_t ranks = (size_t)ranks_count();
      TRY(memory_allocate(&l->start, ranks + 1, sizeof *l->start, "multigrid"));
      for (size_t r = 0; r <= ranks; r++) l->start[r] = slabs_coarse(slabs->start[r], l->shift);
    }
    for (int a = 0; a < 3; a++) TRY(allocate(&l->face[a], l));
    TRY(allocate(&l->mass, l));
    TRY(allocate(&l->inverse, l));
    TRY(allocate(&l->u, l));
    TRY(allocate(&l->b, l));
    TRY(allocate(&l->r, l));
    more = n[0] > 2 || n[1] > 2 || n[2] > 2;
    for (int a = 0; a < 3; a++) n[a] = (n[a] + 1) / 2;
  }
  return STATUS_OK;
cleanup:
  stokes_multigrid_free(m);
  return status;
}

void stokes_multigrid_free(struct stokes_multigrid *m) {
  for (int i = 0; i < m->level_count; i++) {
    struct stokes_multigrid_level *l = &m->levels[i];
    for (int a = 0; a < 3; a++) memory_free(&l->face[a]);
    MEMORY_FREE(&l->start, &l->mass, &l->inverse, &l->u, &l->b, &l->r);
  }
  m->level_count = 0;
}

static size_t index_of(const struct stokes_multigrid_level *l, size_t i, size_t j, size_t k) {
  return (k * l->size[1] + j) * l->size[0] + i;
}

/* The site beyond the face in positive direction of `axis`. */
static size_t next_of(const struct stokes_multigrid_level *l, size_t i, size_t j, size_t k,
                      int axis) {
  size_t at[3] = {i, j, k};
  at[axis] = at[axis] + 1 < l->size[axis] ? at[axis] + 1 : 0;
  return index_of(l, at[0], at[1], at[2]);
}

/* First site of this rank, and the end of its sites. */
static size_t first_of(const struct stokes_multigrid_level *l) {
  return RANKS ? l->begin * l->size[0] * l->size[1] : 0;
}
static size_t end_of(const struct stokes_multigrid_level *l) {
  return RANKS ? l->end * l->size[0] * l->size[1] : l->count;
}

/* Exchanges the planes next to those of this rank. */
static void fill_ghosts(const struct stokes_multigrid_level *l, float *values) {
  if (!RANKS || l->slabs == NULL) return;
  slabs_post(l->slabs, l->shift, values, l->size[0] * l->size[1] * sizeof *values, 1);
  ranks_wait();
}

/* Range of coarse sites that this rank computes: on a level that every rank has, those above its
 * part of `fine`. */
static void share_range(const struct stokes_multigrid_level *fine,
                        const struct stokes_multigrid_level *coarse, size_t *first, size_t *end) {
  *first = 0, *end = coarse->count;
  if (!RANKS || fine->slabs == NULL) return;
  const size_t plane = coarse->size[0] * coarse->size[1];
  *first = slabs_coarse(fine->slabs->begin, coarse->shift) * plane;
  *end = slabs_coarse(fine->slabs->end, coarse->shift) * plane;
}

/* Gathers the values of such a level on all ranks. */
static void gather(const struct stokes_multigrid_level *coarse, float *values) {
  if (!RANKS || coarse->start == NULL) return;
  ranks_gather(values, coarse->start, coarse->size[0] * coarse->size[1] * sizeof *values);
}

/* Each coarse site collects its own values: no two threads write to the same location. */
static void coarsen_level(const struct stokes_multigrid_level *fine,
                          struct stokes_multigrid_level *coarse) {
  size_t first, end;
  share_range(fine, coarse, &first, &end);
#pragma omp parallel for schedule(static) if (fine->count > PARALLEL_FROM)
  for (size_t c = first; c < end; c++) {
    const size_t at[3] = {c % coarse->size[0], c / coarse->size[0] % coarse->size[1],
                          c / coarse->size[0] / coarse->size[1]};
    float face[3] = {0.0f}, mass = 0.0f;
    for (size_t s = 0; s < 8; s++) {
      const size_t i = 2 * at[0] + (s & 1), j = 2 * at[1] + (s >> 1 & 1), k = 2 * at[2] + (s >> 2);
      if (i >= fine->size[0] || j >= fine->size[1] || k >= fine->size[2]) continue;
      const size_t f = index_of(fine, i, j, k), along[3] = {i, j, k};
      mass += fine->mass[f];
      for (int a = 0; a < 3; a++)
        if (along[a] == 2 * at[a] + 1 || along[a] + 1 == fine->size[a]) face[a] += fine->face[a][f];
    }
    coarse->mass[c] = mass;
    for (int a = 0; a < 3; a++)
      coarse->face[a][c] = coarse->size[a] > 1 ? OVERCORRECTION * face[a] : 0.0f;
  }
}

/* Adds the couplings of a plane's sites to the diagonals at their ends. */
static void add_couplings(struct stokes_multigrid_level *l, size_t k) {
  for (size_t j = 0; j < l->size[1]; j++)
    for (size_t i = 0; i < l->size[0]; i++) {
      const size_t s = index_of(l, i, j, k);
      for (int a = 0; a < 3; a++) {
        l->r[s] += l->face[a][s];
        l->r[next_of(l, i, j, k, a)] += l->face[a][s];
      }
    }
}

static void invert_diagonal(struct stokes_multigrid_level *l) {
  const size_t first = first_of(l), end = end_of(l);
  if (end > first) memcpy(l->r + first, l->mass + first, (end - first) * sizeof *l->r);
  /* In the order of the whole lattice, so that the results are identical on any number of ranks. */
  const bool ghost = RANKS && l->slabs != NULL && l->end > l->begin;
  if (ghost && l->begin > 0) add_couplings(l, l->begin - 1);
  for (size_t k = l->begin; k < l->end; k++) add_couplings(l, k);
  if (ghost && l->begin == 0) add_couplings(l, l->size[2] - 1);
  for (size_t s = first; s < end; s++) l->inverse[s] = l->r[s] > 0.0f ? 1.0f / l->r[s] : 0.0f;
}

void stokes_multigrid_coarsen(struct stokes_multigrid *m) {
  for (int i = 0; i < m->level_count; i++) {
    if (i > 0) {
      struct stokes_multigrid_level *l = &m->levels[i];
      coarsen_level(&m->levels[i - 1], l);
      gather(l, l->mass);
      for (int a = 0; a < 3; a++) gather(l, l->face[a]);
    }
    fill_ghosts(&m->levels[i], m->levels[i].face[2]);
    invert_diagonal(&m->levels[i]);
  }
}

/* r = b - T u on row (j, k). */
static void residual_row(const struct stokes_multigrid_level *l, size_t j, size_t k) {
  const size_t nx = l->size[0], row = index_of(l, 0, j, k);
  const size_t up_y = next_of(l, 0, j, k, 1), up_z = next_of(l, 0, j, k, 2);
  const size_t down_y = index_of(l, 0, j > 0 ? j - 1 : l->size[1] - 1, k);
  const size_t down_z = index_of(l, 0, j, k > 0 ? k - 1 : l->size[2] - 1);
  const float *u = l->u + row, *tx = l->face[0] + row;
  const float *uy = l->u + up_y, *uz = l->u + up_z, *vy = l->u + down_y, *vz = l->u + down_z;
  const float *ty = l->face[1] + row, *tz = l->face[2] + row;
  const float *sy = l->face[1] + down_y, *sz = l->face[2] + down_z;
  const float *mass = l->mass + row, *b = l->b + row;
  float *r = l->r + row;
  for (size_t i = 0; i < nx; i++)
    r[i] = b[i] - mass[i] * u[i] - ty[i] * (u[i] - uy[i]) - sy[i] * (u[i] - vy[i]) -
           tz[i] * (u[i] - uz[i]) - sz[i] * (u[i] - vz[i]);
  for (size_t i = 0; i + 1 < nx; i++) r[i] -= tx[i] * (u[i] - u[i + 1]);
  for (size_t i = 1; i < nx; i++) r[i] -= tx[i - 1] * (u[i] - u[i - 1]);
  r[nx - 1] -= tx[nx - 1] * (u[nx - 1] - u[0]);
  r[0] -= tx[nx - 1] * (u[0] - u[nx - 1]);
}

static void residual(struct stokes_multigrid_level *l) {
  const size_t first = RANKS ? l->size[1] * l->begin : 0;
  const size_t end = RANKS ? l->size[1] * l->end : l->size[1] * l->size[2];
  fill_ghosts(l, l->u);
#pragma omp parallel for schedule(static) if (l->count > PARALLEL_FROM)
  for (size_t row = first; row < end; row++)
    residual_row(l, row % l->size[1], row / l->size[1]); // NOLINT: a row to do is of size[1] > 0
}

static void smooth(struct stokes_multigrid_level *l, int sweeps, bool from_zero) {
  for (int s = 0; s < sweeps; s++) {
    const bool first = s == 0 && from_zero;
    if (!first) residual(l);
    const float *r = first ? l->b : l->r;
    const size_t begin = first_of(l), end = end_of(l);
#pragma omp parallel for simd schedule(static) if (l->count > PARALLEL_FROM)
    for (size_t i = begin; i < end; i++)
      l->u[i] = (first ? 0.0f : l->u[i]) + (float)DAMPING * l->inverse[i] * r[i];
  }
}

static void restrict_residual(const struct stokes_multigrid_level *fine,
                              struct stokes_multigrid_level *coarse) {
  size_t first, end;
  share_range(fine, coarse, &first, &end);
#pragma omp parallel for schedule(static) if (fine->count > PARALLEL_FROM)
  for (size_t c = first; c < end; c++) {
    const size_t I = 2 * (c % coarse->size[0]), J = 2 * (c / coarse->size[0] % coarse->size[1]);
    const size_t K = 2 * (c / coarse->size[0] / coarse->size[1]);
    float sum = 0.0f;
    for (size_t k = K; k < K + 2 && k < fine->size[2]; k++)
      for (size_t j = J; j < J + 2 && j < fine->size[1]; j++)
        for (size_t i = I; i < I + 2 && i < fine->size[0]; i++)
          sum += fine->r[index_of(fine, i, j, k)];
    coarse->b[c] = sum;
  }
  gather(coarse, coarse->b);
}

static void prolong(const struct stokes_multigrid_level *coarse,
                    struct stokes_multigrid_level *fine) {
  const size_t first = RANKS ? fine->size[1] * fine->begin : 0;
  const size_t end = RANKS ? fine->size[1] * fine->end : fine->size[1] * fine->size[2];
#pragma omp parallel for schedule(static) if (fine->count > PARALLEL_FROM)
  for (size_t row = first; row < end; row++) {
    const size_t j = row % fine->size[1], k = row / fine->size[1];
    const float *from = coarse->u + index_of(coarse, 0, j / 2, k / 2);
    float *to = fine->u + index_of(fine, 0, j, k);
    for (size_t i = 0; i < fine->size[0]; i++) to[i] += from[i / 2];
  }
}

/* Without mass T is singular: a constant left in b by rounding would be amplified by up to two to
 * the power of the number of levels. */
static void remove_constant(struct stokes_multigrid_level *l) {
  double sum = 0.0, mass = 0.0, sites = 0.0;
  for (size_t i = 0; i < l->count; i++) {
    if (!(l->inverse[i] > 0.0f)) continue;
    sum += (double)l->b[i];
    mass += (double)l->mass[i];
    sites += 1.0;
  }
  if (!(sites > 0.0) || mass > 0.0) return;
  for (size_t i = 0; i < l->count; i++)
    if (l->inverse[i] > 0.0f) l->b[i] -= (float)(sum / sites);
}

static void cycle(struct stokes_multigrid *m, int i, int visits) {
  struct stokes_multigrid_level *l = &m->levels[i];
  if (i == m->level_count - 1) {
    remove_constant(l);
    smooth(l, SWEEPS_COARSEST, true);
    return;
  }
  smooth(l, SWEEPS, true);
  for (int v = 0; v < visits; v++) {
    residual(l);
    restrict_residual(l, l + 1);
    cycle(m, i + 1, visits);
    prolong(l + 1, l);
    smooth(l, SWEEPS, false);
  }
}

void stokes_multigrid_cycle(struct stokes_multigrid *m, int visits) {
  cycle(m, 0, visits);
}
