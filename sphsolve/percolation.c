#include "sphsolve/percolation.h"

#include <string.h>

#include "common/memory.h"

/* The box a site was reached in, seen from the seed of its cluster. */
struct winding {
  int8_t box[3];
  bool seen;
};

enum status percolation_find(const struct lattice *lattice, const double direction[3],
                             bool *flows) {
  enum status status = STATUS_OK;
  const size_t *n = lattice->size;
  struct winding *seen = NULL;
  uint32_t *stack = NULL;
  size_t depth;
  *flows = false;
  TRY(memory_allocate(&seen, lattice->count, sizeof *seen, "percolation"));
  TRY(memory_allocate(&stack, lattice->fluid_count + 1, sizeof *stack, "percolation"));
  for (size_t seed = 0; seed < lattice->count; seed++) {
    if (lattice->kind[seed] != SITE_FLUID || seen[seed].seen) continue;
    seen[seed].seen = true;
    stack[0] = (uint32_t)seed;
    depth = 1;
    while (depth > 0) {
      size_t site = stack[--depth];
      size_t at[3] = {site % n[0], site / n[0] % n[1], site / (n[0] * n[1])};
      for (int step = 0; step < 27; step++) {
        int move[3] = {step % 3 - 1, step / 3 % 3 - 1, step / 9 - 1};
        size_t to[3];
        struct winding own = seen[site];
        for (int a = 0; a < 3; a++) {
          long next = (long)at[a] + move[a];
          own.box[a] = (int8_t)(own.box[a] + (next < 0 ? -1 : next >= (long)n[a] ? 1 : 0));
          to[a] = (size_t)((next + (long)n[a]) % (long)n[a]);
        }
        size_t other = (to[2] * n[1] + to[1]) * n[0] + to[0];
        if (lattice->kind[other] != SITE_FLUID) continue;
        if (!seen[other].seen) {
          seen[other] = own;
          stack[depth++] = (uint32_t)other;
          continue;
        }
        double along = 0;
        for (int a = 0; a < 3; a++) along += direction[a] * (own.box[a] - seen[other].box[a]);
        if (along != 0) {
          *flows = true;
          goto cleanup;
        }
      }
    }
  }
cleanup:
  memory_free(&stack);
  memory_free(&seen);
  return status;
}
