/* The same sample with other boundary conditions on its sides, to find how much k depends on
 * them. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_OTHER_SIDES_H
#define TOSUI_SPHSOLVE_GEOMETRY_OTHER_SIDES_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"

/* Copy of a periodic lattice that is mirrored at its sides along `axes` (x, y, z): twice the sites
 * along each. Distances that reach across such a side are computed again from the inside only. Free
 * with lattice_free. */
enum status lattice_mirror_sides(const struct lattice *wrapped, const bool axes[3],
                                 struct lattice *mirrored);

/* Mirrors a crop that ct2model mirrored along z also along x or y, if that is the axis of the flow
 * and the pores do not continue across the boundary there. Wrapped around, the discontinuous pores
 * would reduce k by up to a half, and k along x and y should mean the same as along z. Any other
 * lattice stays unchanged. */
enum status lattice_mirror_flow(const struct scene *scene, struct lattice *lattice);

/* Copy of a periodic lattice with walls on its sides, as in a tube: `layers` sites of wall after
 * the last site along x and y. Free with lattice_free. */
enum status lattice_close_sides(const struct lattice *wrapped, size_t layers,
                                struct lattice *closed);

#endif
