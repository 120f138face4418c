/* Cells that walls cut, for finite volumes whose unknowns stand on the sites of a lattice: which
 * share of each face, and of the volume, is open. The flux between two sites, open share of the
 * face times the slope of the head between them, is that of Purvis and Burkhalter (1979) and Ng,
 * Min, Gibou (2009, J. Comput. Phys. 228): symmetric, conservative, exact for uniform flow along a
 * plane wall anywhere, and of second order beside curved ones. The head of a site whose centre lies
 * in the wall is that of the water in its cell, continued to the centre.
 *
 * Shapes are those that the scene gives, along lines through the cells: exact in 2-D. A cell is
 * divided into small cubes, and two of them belong to one part of it if the straight way between
 * their middles crosses no wall; a face is open where a part of either cell reaches the same piece
 * of it by such a way. So the way of any flux is a chain of straight lines that no wall crosses:
 * a wall is tight however thin it is, and however walls meet. What a thin wall parts from the site
 * of a cell is added to the cell beside it on that side.
 */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_WALL_CUTS_H
#define TOSUI_SPHSOLVE_GEOMETRY_WALL_CUTS_H

#include "sphsolve/geometry/lattice.h"

struct wall_cuts {
  float (*face)[3][2]; /* [sites]: share of the face at the low and the high end of each axis that
                        * is open to both of its cells; NULL: no cell is cut */
  float *volume;       /* [sites]: open share of the cell */
  /* [sites]: of a wall site with an open part, 1 + 2 axis + high of the site beside it that this
   * part leads to, or WALL_CUTS_OWN where its centre is in no wall; else 0 */
  uint8_t *joined;
};
#define WALL_CUTS_OWN 7

/* Finds the cut cells of a domain's lattice. Free with wall_cuts_free, also after a failure. */
enum status wall_cuts_find(const struct scene *scene, const struct lattice *lattice,
                           struct wall_cuts *cuts);
void wall_cuts_free(struct wall_cuts *cuts);

/* Of a domain's lattice, or one that was sampled from it: the faces over which no way leads from a
 * site to the next, bits as in lattice.cut (also set beside walls that are sites). Free with
 * memory_free. */
enum status wall_cuts_closed_faces(const struct scene *scene, const struct lattice *lattice,
                                   uint8_t **closed);

/* The site, itself or beside it, that says what fills the open part of a cell; a wall site: none,
 * or what is at its centre (wall_cuts_own). */
size_t wall_cuts_site(const struct wall_cuts *cuts, const struct scene *scene,
                      const struct lattice *lattice, size_t site);

/* Whether a wall site counts by what is at its centre. */
static inline bool wall_cuts_own(const struct wall_cuts *cuts, size_t site) {
  return cuts->joined != NULL && cuts->joined[site] == WALL_CUTS_OWN;
}
static inline double wall_cuts_face(const struct wall_cuts *cuts, size_t site, int axis,
                                    bool high) {
  return cuts->face == NULL ? 1 : (double)cuts->face[site][axis][high];
}
static inline double wall_cuts_volume(const struct wall_cuts *cuts, size_t site) {
  return cuts->face == NULL ? 1 : (double)cuts->volume[site];
}

#endif
