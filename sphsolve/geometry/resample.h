/* Resampling of a lattice: the spacing of a solve is independent of the voxels of its model. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_RESAMPLE_H
#define TOSUI_SPHSOLVE_GEOMETRY_RESAMPLE_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* Lattice of the same body with a spacing as close to `spacing` (m) as its periods allow, walls
 * moved by `offset` (m) into the grains. The number of sites along z is even if `fine` is its own
 * mirror image in z, so that the mirror planes lie between sites. An axis of one site keeps one
 * site. Free with lattice_free. */
enum status lattice_resample(const struct lattice *fine, double spacing, double offset,
                             struct lattice *out);

/* The same without the walls between neighbouring sites (lattice.cut), for a lattice that is only
 * sampled anew. */
enum status lattice_sample(const struct lattice *fine, double spacing, double offset,
                           struct lattice *out);

/* Resamples the lattice to the spacing that the scene asks for (lattice.spacing), if any. */
enum status lattice_apply_spacing(const struct scene *scene, struct lattice *lattice);

/* Sites along each axis, and their number, of the lattice that lattice_resample would make. */
enum status lattice_resampled_size(const struct lattice *fine, double spacing, size_t size[3],
                                   size_t *count);

/* Whether layer k equals layer size[2] - 1 - k in kinds, distances and soil, i.e. the lattice is
 * mirror symmetric about its middle and its ends. */
bool lattice_is_mirrored(const struct lattice *lattice);
/* Copies the lower half of the distances to the upper half: rounding may make the two halves of a
 * mirrored lattice differ in the last bit. */
void lattice_mirror_distances(struct lattice *lattice);

/* Adds `offset` (m) to all wall distances, limits their magnitude to at least `least` (m), and sets
 * the kinds of all sites by their sign and the number of sites of each kind. */
void lattice_set_kinds(struct lattice *lattice, float offset, float least);

/* Void ratio with all walls `moved` (m) into the grains; sites on the surface count in part. */
double lattice_void_ratio(const struct lattice *lattice, double moved);

#endif
