#include "sphsolve/geometry/throats.h"

#include <stdlib.h>

#include "common/memory.h"
#include "sphsolve/geometry/thin_wall.h"

static uint32_t root_of(uint32_t *parent, uint32_t site) {
  while (parent[site] != site) site = parent[site] = parent[parent[site]];
  return site;
}

/* Label of the pore of each fluid site, its lowest site index: connected over faces with periodic
 * boundaries, by union-find with path halving (Tarjan, van Leeuwen 1984). */
static enum status find_pores(const struct lattice *l, uint32_t **pore) {
  if (l->count > UINT32_MAX)
    return FAIL(STATUS_INPUT, "%zu points: pores are told apart of 2^32 at most", l->count);
  const enum status status = memory_allocate(pore, l->count, sizeof **pore, "labels of the pores");
  if (status != STATUS_OK) return status;
  const size_t step[3] = {1, l->size[0], l->size[0] * l->size[1]};
  for (size_t s = 0; s < l->count; s++) (*pore)[s] = (uint32_t)s;
  for (size_t s = 0; s < l->count; s++) {
    if (l->kind[s] != SITE_FLUID) continue;
    for (int a = 0; a < 3; a++) {
      const size_t at = s / step[a] % l->size[a];
      const size_t next = at + 1 < l->size[a] ? s + step[a] : s - at * step[a];
      if (l->kind[next] != SITE_FLUID || thin_wall_on_face(l, s, a)) continue;
      const uint32_t one = root_of(*pore, (uint32_t)s), other = root_of(*pore, (uint32_t)next);
      (*pore)[one > other ? one : other] = one > other ? other : one;
    }
  }
  for (size_t s = 0; s < l->count; s++) (*pore)[s] = root_of(*pore, (uint32_t)s);
  return STATUS_OK;
}

/* The site of `fine` that contains the centre of a site of `coarse`. */
static size_t site_below(const struct lattice *fine, const struct lattice *coarse, size_t site) {
  const size_t at[3] = {site % coarse->size[0], site / coarse->size[0] % coarse->size[1],
                        site / (coarse->size[0] * coarse->size[1])};
  size_t to[3];
  for (int a = 0; a < 3; a++) {
    const double from_edge = coarse->origin[a] - fine->origin[a] +
                             (double)at[a] * coarse->spacing[a] + 0.5 * fine->spacing[a];
    const double place = from_edge / fine->spacing[a];
    to[a] = place > 0.0 ? (size_t)place % fine->size[a] : 0;
  }
  return (to[2] * fine->size[1] + to[1]) * fine->size[0] + to[0];
}

/* A piece of a pore: its labels in two lattices. */
struct piece {
  uint32_t whole, part;
};

static int by_whole(const void *a, const void *b) {
  const struct piece *p = a, *q = b;
  if (p->whole != q->whole) return p->whole < q->whole ? -1 : 1;
  return p->part == q->part ? 0 : p->part < q->part ? -1 : 1;
}

/* Number of parts of all wholes, minus one for each whole. */
static size_t count_cuts(struct piece *piece, size_t count) {
  size_t cuts = 0;
  qsort(piece, count, sizeof *piece, by_whole);
  for (size_t i = 1; i < count; i++)
    cuts += piece[i].whole == piece[i - 1].whole && piece[i].part != piece[i - 1].part;
  return cuts;
}

enum status throats_compare(const struct lattice *fine, const struct lattice *coarse,
                            struct throats *throats) {
  enum status status = STATUS_OK;
  uint32_t *before = NULL, *after = NULL, *sites = NULL;
  struct piece *piece = NULL;
  size_t n = 0;
  *throats = (struct throats){0};
  for (int a = 0; a < 3; a++)
    if ((double)coarse->size[a] * coarse->spacing[a] >
        1.5 * (double)fine->size[a] * fine->spacing[a])
      return STATUS_OK;
  TRY(find_pores(fine, &before));
  TRY(find_pores(coarse, &after));
  TRY(memory_allocate(&sites, coarse->count, sizeof *sites, "sizes of the pores"));
  TRY(memory_allocate(&piece, coarse->fluid_count + 1, sizeof *piece, "pieces of the pores"));
  for (size_t s = 0; s < coarse->count; s++) sites[after[s]]++;
  for (size_t s = 0; s < coarse->count; s++) {
    if (coarse->kind[s] != SITE_FLUID || sites[after[s]] < 2) continue;
    const size_t below = site_below(fine, coarse, s);
    if (fine->kind[below] == SITE_FLUID)
      piece[n++] = (struct piece){.whole = before[below], .part = after[s]};
  }
  throats->closed = count_cuts(piece, n);
  for (size_t i = 0; i < n; i++)
    piece[i] = (struct piece){.whole = piece[i].part, .part = piece[i].whole};
  throats->opened = count_cuts(piece, n);
cleanup:
  MEMORY_FREE(&before, &after, &sites, &piece);
  return status;
}
