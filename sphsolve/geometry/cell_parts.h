/* What the walls of a scene leave open of one cell of a lattice: its connected parts, and how far
 * they are open to those of the cell beside it.
 *
 * A cell is divided into small cubes. Two of them belong to one part if the straight way between
 * their middles crosses no wall, and a part reaches a face where the straight way from the middle
 * of a cube to the face crosses none. A piece of the face is open to the parts of both cells that
 * reach it. So what flows from part to part has a way along straight lines that no wall crosses: a
 * wall is tight however thin it is, and however walls meet. Lines are cut at the shapes that the
 * scene gives, so that areas are exact in 2-D, and volumes but for what lies between the lines. */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_CELL_PARTS_H
#define TOSUI_SPHSOLVE_GEOMETRY_CELL_PARTS_H

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

/* Most regions that reach into one cell, but for those that others cover there, and ends of one on
 * a line there. */
#define CELL_REGIONS_MAX 128
#define CELL_ENDS_MAX 32

/* The parts that are kept: that which holds the cell's centre, or the largest where that is in a
 * wall; and the largest other. */
enum cell_part { CELL_OWN, CELL_OTHER, CELL_PARTS };

struct cell_parts {
  float volume[CELL_PARTS]; /* over the cell's */
  bool holds_centre;        /* whether the centre is in no wall */
  /* By 2 axis + high: bits of the cubes at a face from which a part reaches it. */
  uint64_t reached[6][CELL_PARTS];
  /* Of these, the ones that a wall ending in the cell parts from its middle: no flux along the axis
   * passes there, though a way leads around the end. */
  uint64_t shaded[6];
};

struct cell {
  const struct scene *scene;
  const struct lattice *lattice;
  double centre[3];
  bool crowded; /* more regions or ends than there is room for: its parts are wrong */
  bool is_cut;  /* whether the surface of a region may be in it; if not, it is one part, or none */
  size_t region_count;
  const struct region *region[CELL_REGIONS_MAX]; /* those that may reach into it, in order */
};

/* Whether a region says where walls are, as itself and not as a box of a shape that does. */
bool cell_counts(const struct scene *scene, const struct region *region);
/* The cell of a site. `regions`: those that count; before the first wall, none makes a difference.
 */
void cell_begin(const struct scene *scene, const struct lattice *lattice,
                const struct region *const *regions, size_t count, size_t site, struct cell *cell);
/* Whether a cell's centre is in no wall. */
bool cell_is_open(struct cell *cell);
/* Parts of a cell; `parts` is all 0 before. */
void cell_find_parts(struct cell *cell, struct cell_parts *parts);
/* Shares of a face that are open to the parts of the cells at its low and its high side. A cell
 * that is NULL is the outside: one part, open wherever the other cell is. */
void cell_find_areas(struct cell *low, const struct cell_parts *low_parts, struct cell *high,
                     const struct cell_parts *high_parts, int axis,
                     float area[CELL_PARTS][CELL_PARTS]);

#endif
