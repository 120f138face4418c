#include "sphsolve/geometry/percolation.h"

#include <math.h>
#include <string.h>

#include "common/interrupt.h"
#include "common/memory.h"
#include "common/node_memory.h"
#include "common/ranks.h"

/* Sites between two looks for a signal. */
#define LOOK_EVERY 65536

/* A flood through the fluid that remembers how often it has gone around the box. Where it meets
 * itself with another count there is a path around, which flows if its closing vector has a
 * component along the force. */
struct flood {
  const struct lattice *lattice;
  double closing_work[3]; /* driving times the length of the box */
  bool corners, whole;    /* `whole`: a pore is flooded to its end, whether it flows or not */
  uint8_t *label;         /* per site: 0 unvisited, else visited */
  int16_t (*turns)[3];    /* per site */
  uint32_t *queue;        /* of one pore */
};

static bool work_is_done(const struct flood *flood, const int turns[3]) {
  double work = 0, scale = 0;
  for (int a = 0; a < 3; a++) {
    work += flood->closing_work[a] * turns[a];
    scale += fabs(flood->closing_work[a] * turns[a]);
  }
  return fabs(work) > 1e-9 * scale;
}

/* Floods the pore of `seed`; its sites are left in queue[0..count). */
static bool flood_pore(struct flood *flood, size_t seed, size_t *count) {
  const struct lattice *l = flood->lattice;
  bool flows = false;
  size_t head = 0, tail = 0;
  flood->queue[tail++] = (uint32_t)seed;
  flood->label[seed] = 1;
  memset(flood->turns[seed], 0, sizeof flood->turns[seed]);
  while (head < tail && (flood->whole || !flows)) {
    if (head % LOOK_EVERY == 0 && interrupt_alone()) break;
    const size_t site = flood->queue[head++];
    const size_t at[3] = {site % l->size[0], site / l->size[0] % l->size[1],
                          site / (l->size[0] * l->size[1])};
    for (int s = 0; s < (flood->corners ? 27 : 6); s++) {
      static const int faces[6] = {4, 10, 12, 14, 16, 22};
      const int step = flood->corners ? s : faces[s];
      const int move[3] = {step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
      int turns[3];
      size_t to[3];
      for (int a = 0; a < 3; a++) {
        const long n = (long)l->size[a], next = (long)at[a] + move[a];
        turns[a] = flood->turns[site][a] + (next < 0 ? -1 : next >= n ? 1 : 0);
        to[a] = (size_t)((next + n) % n);
      }
      const size_t next = (to[2] * l->size[1] + to[1]) * l->size[0] + to[0];
      if (l->kind[next] != SITE_FLUID) continue;
      if (!flood->label[next]) {
        flood->label[next] = 1;
        for (int b = 0; b < 3; b++) flood->turns[next][b] = (int16_t)turns[b];
        flood->queue[tail++] = (uint32_t)next;
        continue;
      }
      for (int b = 0; b < 3; b++) turns[b] -= flood->turns[next][b];
      if (!flows && (turns[0] || turns[1] || turns[2])) flows = work_is_done(flood, turns);
    }
  }
  *count = tail;
  return flows;
}

enum status percolation_find(const struct lattice *lattice, const double driving[3], bool corners,
                             uint8_t *flowing, bool *flows) {
  enum status status = STATUS_OK;
  struct flood flood = {
      .lattice = lattice, .corners = corners, .whole = flowing != NULL, .label = flowing};
  uint8_t *own = NULL;
  *flows = false;
  if (lattice->count > UINT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%zu sites: paths are followed through 2^32 at most", lattice->count);
  for (int a = 0; a < 3; a++)
    flood.closing_work[a] = driving[a] * (double)lattice->size[a] * lattice->spacing[a];
  if (flowing == NULL) {
    TRY(memory_allocate(&own, lattice->count, 1, "labels of the pores"));
    flood.label = own;
  }
  TRY(memory_allocate(&flood.turns, lattice->count, sizeof *flood.turns, "paths in the pores"));
  TRY(memory_allocate(&flood.queue, lattice->fluid_count + 1, sizeof *flood.queue, "pore queue"));
  for (size_t s = 0; s < lattice->count && (flood.whole || !*flows); s++) {
    size_t count;
    if (lattice->kind[s] != SITE_FLUID || flood.label[s]) continue;
    if (!flood_pore(&flood, s, &count)) continue;
    *flows = true;
    for (size_t q = 0; q < count && flood.whole; q++)
      flood.label[flood.queue[q]] = PERCOLATION_FLOWS;
  }
  status = interrupt_look();
cleanup:
  memory_free(&own);
  memory_free(&flood.turns);
  memory_free(&flood.queue);
  return status;
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
  /* The lattice is held once on a machine: none writes while another may read it. */
  ranks_sum(0);
  for (size_t r = 0; r <= ranks; r++) start[r] = lattice->count * r / ranks;
  const size_t own = (size_t)ranks_own();
  for (size_t s = start[own]; s < start[own + 1]; s++)
    if (lattice->kind[s] == SITE_FLUID && flowing[s] != PERCOLATION_FLOWS)
      lattice->kind[s] = SITE_WALL;
  node_share(lattice->kind, start, 1);
  lattice->fluid_count -= *closed;
  lattice->wall_count += *closed;
cleanup:
  memory_free(&flowing);
  memory_free(&start);
  return status;
}
