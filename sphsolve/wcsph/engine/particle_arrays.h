/* Shared by the fluid (particles.c) and the walls (particles_walls.c) of the engine. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLE_ARRAYS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLE_ARRAYS_H

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/particles.h"

/* An array with 4 bytes per slot, and whether a run needs it. */
struct slot_array {
  void **array;
  bool wanted;
};

static inline size_t count_wanted(const struct slot_array *list, size_t n) {
  size_t wanted = 0;
  /* cppcheck-suppress uninitvar ; the callers fill the first n entries in the argument n itself */
  for (size_t i = 0; i < n; i++) wanted += list[i].wanted;
  return wanted;
}

/* Indices of a site, x, y, z. */
static inline void site_of(const struct lattice *lattice, size_t i, size_t at[3]) {
  at[0] = i % lattice->size[0];
  at[1] = i / lattice->size[0] % lattice->size[1];
  at[2] = i / (lattice->size[0] * lattice->size[1]);
}

/* Makes the walls within `range` of fluid, ordered in clusters; single rank only. */
enum status particles_make_walls(const struct lattice *lattice, double range,
                                 const struct particle_fields *fields, struct particles *particles);

#endif
