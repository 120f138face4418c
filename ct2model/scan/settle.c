#include "ct2model/scan/settle.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"

enum { PORE, SOIL, GRAIN };

static int phase_of(uint8_t kind) {
  return kind == MICRO_PORE ? PORE : kind == MICRO_GRAIN ? GRAIN : SOIL;
}

/* Number of voxels of each phase within `rim` voxels, and sum of the levels of soil among them. */
struct phase_counts {
  int count[3], levels;
};

static struct phase_counts count_phases(const struct micro *m, const size_t at[3], size_t rim) {
  struct phase_counts phase_counts = {{0}, 0};
  size_t first[3], end[3];
  for (int d = 0; d < 3; d++) {
    first[d] = at[d] > rim ? at[d] - rim : 0;
    end[d] = at[d] + rim < m->size[d] ? at[d] + rim + 1 : m->size[d];
  }
  for (size_t z = first[2]; z < end[2]; z++)
    for (size_t y = first[1]; y < end[1]; y++) {
      const uint8_t *row = m->kind + (z * m->size[1] + y) * m->size[0];
      for (size_t x = first[0]; x < end[0]; x++) {
        const int phase = phase_of(row[x]);
        phase_counts.count[phase]++;
        phase_counts.levels += phase == SOIL ? row[x] : 0;
      }
    }
  return phase_counts;
}

static uint8_t without_edge(const struct micro *m, const size_t at[3], uint8_t kind,
                            double middle) {
  if (phase_of(kind) != SOIL) return kind;
  const struct phase_counts c = count_phases(m, at, SETTLE_RIM);
  const double least = SETTLE_SHARE * (c.count[PORE] + c.count[SOIL] + c.count[GRAIN]);
  if (c.count[PORE] <= least || c.count[GRAIN] <= least) return kind;
  return kind < middle ? MICRO_PORE : MICRO_GRAIN;
}

/* Whether all six neighbours have the same phase as the voxel. */
static bool is_inside(const struct micro *m, const size_t at[3], const uint8_t *kind) {
  const size_t step[3] = {1, m->size[0], m->size[0] * m->size[1]};
  const int phase = phase_of(*kind);
  for (int d = 0; d < 3; d++) {
    if (at[d] > 0 && phase_of(kind[-(ptrdiff_t)step[d]]) != phase) return false;
    if (at[d] + 1 < m->size[d] && phase_of(kind[step[d]]) != phase) return false;
  }
  return true;
}

/* The phase of a voxel without noise. A level at an edge is not noise: its grey decides, in
 * without_edge. */
static uint8_t without_noise(const struct micro *m, const size_t at[3], uint8_t kind) {
  const struct phase_counts c = count_phases(m, at, 1);
  const int all = c.count[PORE] + c.count[SOIL] + c.count[GRAIN];
  int phase = phase_of(kind);
  const bool edge =
      phase == SOIL && c.count[PORE] > SETTLE_SHARE * all && c.count[GRAIN] > SETTLE_SHARE * all;
  if (c.count[phase] <= SETTLE_SPECK * all && !edge)
    for (int p = 0; p < 3; p++)
      if (c.count[p] > c.count[phase]) phase = p;
  if (phase != SOIL) return phase == PORE ? MICRO_PORE : MICRO_GRAIN;
  return (uint8_t)((c.levels + c.count[SOIL] / 2) / c.count[SOIL]);
}

/* One round over all voxels, which removes edges or noise. Returns the number of voxels whose phase
 * changed. */
static size_t settle_round(const struct micro *m, bool edges, double middle, uint8_t *settled) {
  const size_t nx = m->size[0], ny = m->size[1], nz = m->size[2];
  size_t changed = 0;
#pragma omp parallel for schedule(static) reduction(+ : changed)
  for (size_t row = 0; row < ny * nz; row++)
    for (size_t x = 0; x < nx; x++) {
      const size_t at[3] = {x, row % ny, row / ny}; // NOLINT: has rows
      const uint8_t *kind = m->kind + row * nx + x;
      const bool inside = phase_of(*kind) != SOIL && is_inside(m, at, kind);
      uint8_t *to = settled + row * nx + x;
      *to = edges    ? without_edge(m, at, *kind, middle)
            : inside ? *kind
                     : without_noise(m, at, *kind);
      changed += phase_of(*to) != phase_of(*kind);
    }
  return changed;
}

enum status settle(struct micro *m, double middle, double *noisy) {
  enum status status = STATUS_OK;
  const size_t count = m->size[0] * m->size[1] * m->size[2];
  uint8_t *settled = NULL;
  TRY(memory_allocate(&settled, count, 1, "the labels"));
  for (int round = 0; round < 3; round++) {
    uint8_t *before = m->kind;
    const size_t changed = settle_round(m, round == 1, middle, settled);
    if (round == 0) *noisy = (double)changed / (double)count;
    m->kind = settled;
    settled = before;
  }
cleanup:
  memory_free(&settled);
  return status;
}
