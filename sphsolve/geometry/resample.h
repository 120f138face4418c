/* The walls of one lattice on sites of another spacing: a solve need not stand on the voxels that
 * its model came in. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_RESAMPLE_H
#define TOSUI_SPHSOLVE_GEOMETRY_RESAMPLE_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* A lattice of the same body with sites as near to `spacing` (m) apart as its periods allow, walls
 * moved by `offset` (m) into the grains. An even number of sites along z where `fine` is its own
 * mirror image in z, so that the mirror planes lie between sites. An axis of one site keeps one.
 * Free with lattice_free. */
enum status lattice_resample(const struct lattice *fine, double spacing, double offset,
                             struct lattice *out);

/* Gives the lattice the sites that the scene asks for (lattice.spacing), if it does. */
enum status lattice_take_spacing(const struct scene *scene, struct lattice *lattice);

/* What lattice_resample will make of it: the sites along each axis and their number. */
enum status lattice_resampled_size(const struct lattice *fine, double spacing, size_t size[3],
                                   size_t *count);

/* Whether layer k is that of size[2] - 1 - k, kinds and distances alike: the lattice is mirrored
 * about its middle, and about its ends. */
bool lattice_is_mirrored(const struct lattice *lattice);
/* Rounding may make the two halves of a mirrored lattice unlike in the last bit. */
void lattice_mirror_distances(struct lattice *lattice);

/* Kinds of all sites by the sign of their distances, `offset` (m) added, which are `least` (m) and
 * more in size afterwards; and how many of each kind there are. */
void lattice_take_kinds(struct lattice *lattice, float offset, float least);

/* Pore volume over grain volume, sites on the surface counted in part; with all walls `moved` (m)
 * into the grains. */
double lattice_void_ratio(const struct lattice *lattice, double moved);

#endif
