/* Soil with pores below the sites of a lattice: porosity and permeability of its fluid sites,
 * carried to other lattices. All do nothing for a lattice without. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_SOIL_H
#define TOSUI_SPHSOLVE_GEOMETRY_SOIL_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

static inline bool lattice_is_soil(const struct lattice *lattice, size_t site) {
  return lattice->micro_porosity != NULL && lattice->micro_porosity[site] > 0.0f;
}

/* Room for both fields, 0. */
enum status lattice_soil_allocate(struct lattice *lattice);
/* That of one site of another lattice; walls have none. */
static inline void lattice_soil_copy(const struct lattice *from, size_t site, struct lattice *to,
                                     size_t at) {
  if (from->micro_porosity == NULL || to->micro_porosity == NULL || to->kind[at] != SITE_FLUID)
    return;
  to->micro_porosity[at] = from->micro_porosity[site];
  to->micro_permeability[at] = from->micro_permeability[site];
}

/* Of the sites of `fine` that a fluid site of `out` covers, those that most of the pore side are:
 * soil has their mean porosity and the geometric mean of their permeability. Sizes, spacings and
 * kinds of `out` are set before. */
enum status lattice_soil_resample(const struct lattice *fine, struct lattice *out);
/* The largest permeability of its soil, m^2; 0 without. */
double lattice_soil_most(const struct lattice *lattice);
/* `scaled` is `lattice` but for its permeabilities, in memory of their own, which are times
 * `factor`: to be freed alone. */
enum status lattice_soil_scale(const struct lattice *lattice, double factor,
                               struct lattice *scaled);
/* Whether two planes hold the same; and makes the upper half of a mirrored lattice the image of the
 * lower. */
bool lattice_soil_same(const struct lattice *lattice, size_t low, size_t high, size_t count);
void lattice_soil_mirror(struct lattice *lattice);

#endif
