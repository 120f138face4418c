/* Soil with pores smaller than the sites of a lattice: transfer of the porosity and permeability of
 * its fluid sites to other lattices. All functions do nothing for a lattice without soil. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_SOIL_H
#define TOSUI_SPHSOLVE_GEOMETRY_SOIL_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

static inline bool lattice_is_soil(const struct lattice *lattice, size_t site) {
  return lattice->micro_porosity != NULL && lattice->micro_porosity[site] > 0.0f;
}

/* Allocates both fields, initially 0. */
enum status lattice_soil_allocate(struct lattice *lattice);
/* Copies the soil of one site of another lattice; walls have none. */
static inline void lattice_soil_copy(const struct lattice *from, size_t site, struct lattice *to,
                                     size_t at) {
  if (from->micro_porosity == NULL || to->micro_porosity == NULL || to->kind[at] != SITE_FLUID)
    return;
  to->micro_porosity[at] = from->micro_porosity[site];
  to->micro_permeability[at] = from->micro_permeability[site];
}

/* Soil of each fluid site of `out` from the sites of `fine` that it covers. It is soil if more of
 * the pore volume is soil than is open pore, with the mean porosity and the geometric mean of the
 * permeability. Sizes, spacings and kinds of `out` must be set. */
enum status lattice_soil_resample(const struct lattice *fine, struct lattice *out);
/* The largest permeability of the soil, m^2; 0 without soil. */
double lattice_soil_most(const struct lattice *lattice);
/* `scaled` is a copy of `lattice` with all soil permeabilities multiplied by `factor`. Only
 * scaled->micro_permeability is allocated and must be freed; all other arrays are shared. */
enum status lattice_soil_scale(const struct lattice *lattice, double factor,
                               struct lattice *scaled);
/* lattice_soil_same: whether `count` sites from `low` and from `high` have the same soil.
 * lattice_soil_mirror: makes the upper half of a mirrored lattice the image of the lower half. */
bool lattice_soil_same(const struct lattice *lattice, size_t low, size_t high, size_t count);
void lattice_soil_mirror(struct lattice *lattice);

#endif
