/* The same sample with its sides closed otherwise, to find how much k depends on them. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_OTHER_SIDES_H
#define TOSUI_SPHSOLVE_GEOMETRY_OTHER_SIDES_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* A lattice that wraps round, mirrored at the sides of `axes` (x, y, z) instead: twice the sites
 * along each. Distances that reach beyond such a side are found anew from what is inside. Free with
 * lattice_free. */
enum status lattice_mirror_sides(const struct lattice *wrapped, const bool axes[3],
                                 struct lattice *mirrored);

/* A crop that ct2model mirrored along z, mirrored alike along x or y where that is the flow's axis
 * and its pores do not meet there: wrapped round along the flow it lets less through, by halves,
 * and k along x and y is to mean what it means along z. Any other lattice stays as it is. */
enum status lattice_mirror_flow(const struct scene *scene, struct lattice *lattice);

/* A lattice that wraps round with walls on its sides, as in a tube: `layers` sites of wall after
 * the last along x and y. Free with lattice_free. */
enum status lattice_close_sides(const struct lattice *wrapped, size_t layers,
                                struct lattice *closed);

#endif
