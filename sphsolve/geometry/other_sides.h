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

/* The same with walls on those sides, as in a tube: `layers` sites of wall after the last along x
 * and y. Free with lattice_free. */
enum status lattice_close_sides(const struct lattice *wrapped, size_t layers,
                                struct lattice *closed);

#endif
