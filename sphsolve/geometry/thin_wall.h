/* Walls between neighbouring sites. A wall thinner than the spacing may have no site in it; the
 * sites on its two sides are then both fluid, and only the surface between them tells that they are
 * not neighbours. The segment between two sites is followed through the surface of the model from
 * which the lattice was sampled (lattice.surface), or through the wall regions of a domain
 * (lattice.boxes). A wall on it separates them if the segment
 * crosses both of its faces; if it grazes them it only cuts off a piece of a convex grain, and the
 * fluid goes around it. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_THIN_WALL_H
#define TOSUI_SPHSOLVE_GEOMETRY_THIN_WALL_H

#include <stdbool.h>

#include "sphsolve/geometry/lattice.h"

/* One face of the wall that separates two sites, seen from the nearer of them. */
struct thin_wall_side {
  double before, behind; /* m: distances of the near site before, of the far site behind the face's
                          * tangent plane */
  double normal[3];      /* unit vector out of the wall, x, y, z */
};

/* Whether a wall separates site `at` from the one `step` further, both fluid, across periodic
 * boundaries. near, far: its faces towards the two, filled if so; they may be NULL. Both directions
 * of a link give the same answer. */
bool thin_wall_cuts(const struct lattice *lattice, const size_t at[3], const int step[3],
                    struct thin_wall_side *near, struct thin_wall_side *far);

/* Whether a link is known to be open without following it. The sites of the box that it spans are
 * all fluid, and none of their faces is cut (lattice.cut): a wall on the link would end within the
 * box, and fluid would go around. Or the box is one cell of a lattice that is the surface itself,
 * whose walls have sites; where they are stepped (lattice.stepped), a way over faces must lead
 * across it. */
bool thin_wall_open_box(const struct lattice *lattice, const size_t at[3], const int step[3]);

/* Fills lattice->cut from the links over faces; it stays NULL if no wall separates two fluid sites
 * that share a face. */
enum status thin_wall_find_faces(struct lattice *lattice);

/* Faces that no water passes, for finite volumes whose cells are cut by the walls: those of
 * lattice.cut, and the two of a wall site between fluid sites along an axis, where the wall is
 * thinner than two spacings and such a cell would be open on either side, unless fluid sites lead
 * around it in the next row. Bits as in lattice.cut;
 * NULL if there are none. Free with memory_free. */
enum status thin_wall_closed_faces(const struct lattice *lattice, uint8_t **closed);

/* For methods that know sites alone, no links: of two sites that a cut face separates, the one
 * nearer to the wall becomes wall, as far behind its surface as it was before it. The wall is
 * thicker then than it is, by up to a spacing. Lattice->cut is NULL afterwards. Collective. */
enum status thin_wall_fill(struct lattice *lattice);

/* Whether the face of a site towards the next one along an axis is cut. */
static inline bool thin_wall_on_face(const struct lattice *lattice, size_t site, int axis) {
  return lattice->cut != NULL && (lattice->cut[site] >> axis & 1) != 0;
}

#endif
