#include "sphsolve/geometry/other_sides.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/side_distance.h"

/* Where a mirrored site comes from. */
static size_t source(size_t i, size_t n) {
  return i < n ? i : 2 * n - 1 - i;
}

enum status lattice_mirror_sides(const struct lattice *wrapped, struct lattice *mirrored) {
  enum status status = STATUS_OK;
  const size_t *n = wrapped->size;
  float *distance = NULL;
  *mirrored = *wrapped;
  mirrored->kind = NULL, mirrored->wall_distance = NULL, mirrored->region = NULL;
  TRY(memory_allocate(&distance, wrapped->count, sizeof *distance, "a lattice"));
  memcpy(distance, wrapped->wall_distance, wrapped->count * sizeof *distance);
  sides_forget(n, wrapped->spacing, distance);
  for (size_t i = 0; i < wrapped->count; i++)
    if (!isfinite(distance[i])) {
      /* No wall beside it inside: as far as it said, and one spacing at least. */
      const float own = wrapped->wall_distance[i];
      distance[i] = copysignf(fmaxf(fabsf(own), (float)wrapped->spacing[0]), own);
    }
  mirrored->size[0] = 2 * n[0], mirrored->size[1] = 2 * n[1];
  mirrored->count = 4 * wrapped->count;
  mirrored->bulk_count = 4 * wrapped->bulk_count;
  mirrored->fluid_count = 4 * wrapped->fluid_count;
  mirrored->wall_count = 4 * wrapped->wall_count;
  TRY(memory_allocate(&mirrored->kind, mirrored->count, 1, "a lattice"));
  TRY(memory_allocate(&mirrored->wall_distance, mirrored->count, sizeof *distance, "a lattice"));
  for (size_t at = 0; at < mirrored->count; at++) {
    const size_t i = at % mirrored->size[0], j = at / mirrored->size[0] % mirrored->size[1];
    const size_t k = at / mirrored->size[0] / mirrored->size[1];
    const size_t from = (k * n[1] + source(j, n[1])) * n[0] + source(i, n[0]);
    mirrored->kind[at] = wrapped->kind[from];
    mirrored->wall_distance[at] = distance[from];
  }
cleanup:
  memory_free(&distance);
  if (status != STATUS_OK) lattice_free(mirrored);
  return status;
}
