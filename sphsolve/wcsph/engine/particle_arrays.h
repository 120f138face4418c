/* Shared by the fluid (particles.c) and the walls (particles_walls.c) of the engine. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLE_ARRAYS_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PARTICLE_ARRAYS_H

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/particles.h"

/* The lines of fields.def of some uses, KEPT | ...; returns the number of arrays. */
enum { KEPT = 1, RESULT = 2, STEP = 4, WALL = 8, FLUID = KEPT | RESULT | STEP };
static inline size_t slot_arrays(struct particles *p, const struct particle_fields *fields,
                                 unsigned uses, struct slot_array list[SLOT_ARRAYS]) {
  size_t n = 0;
#define FIELD(use, type, shape, name, when)                                                        \
  for (int k = 0, all = sizeof p->name / sizeof(void *); (uses & use) && k < all; k++)             \
    list[n++] = (struct slot_array){#name, all > 1 ? k : -1, (type)0.5f == 0,                      \
                                    (void **)&p->name + k, when};
#include "sphsolve/wcsph/engine/fields.def"
#undef FIELD
  return n;
}

static inline size_t slot_bytes(const struct particle_fields *fields, unsigned uses) {
  struct particles none;
  struct slot_array list[SLOT_ARRAYS];
  size_t bytes = 0;
  for (size_t n = slot_arrays(&none, fields, uses, list); n > 0; n--)
    bytes += list[n - 1].wanted ? sizeof(float) : 0;
  return bytes;
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
