/* Walls given by a polygon or a circle, in soil without a surface: their outline, not the boxes of
 * sites that stand for it elsewhere. Wall particles fill the cells of the lattice by the share of
 * the wall in them, at its centre, and the water fills what is left. The mirror is the plane
 * through the outline's nearest point.
 *
 * Along an outline water also interacts with the images of its neighbours. For a plane wall of
 * normal n, and particles i and j at distances d_i and d_j before it,
 *   r' = x_i - x_j' = r_t + (d_i + d_j) n,   |r'|^2 = r^2 + 4 d_i d_j,   q' = q,   v_t' = v_t,
 * so that with slope' = slope(|r'|) a pair adds V_j slope' (v_i - v_j).r_t to the divergence, V_j
 * slope' (q_i - q_j) r_t to the gradient and 2 V_i V_j k slope' to the matrix (the method of
 * images, as in isph/reflection.h). At a curved wall n is along the sum of the normals of both.
 * Without images the rows beside a wall have four fifths of their weight along it, as if the soil
 * began .15 spacings before the wall. What is along n, the wall's particles contribute as at all
 * walls.
 *
 * Without a surface alone: under one the fronts and ponds that constants were fitted to have walls
 * of boxes. Limits: images of images are left out, where water is between two walls. */
#ifndef TOSUI_SPHSOLVE_ISPH_OUTLINE_H
#define TOSUI_SPHSOLVE_ISPH_OUTLINE_H

#include "sphsolve/isph/state.h"

/* The nearest wall with an outline. */
struct isph_facing {
  int32_t box;                /* 0: none is within the largest support */
  double distance, normal[3]; /* of its outline; into the water */
};

/* Whether a region is a wall that may count by the outline of its polygon, and whether it does. */
bool isph_may_have_outline(const struct scene *scene, const struct region *region);
bool isph_has_outline(const struct isph *s, const struct region *region);
/* Distance from x to the outline of a box that has one, negative inside, and the normal there.
 * Infinite farther than the largest support from the box. */
double isph_outline_distance(const struct isph *s, const struct isph_wall_box *box,
                             const double x[3], double normal[3]);
struct isph_facing isph_outline_facing(const struct isph *s, const double x[3]);

/* Places that represent a cell of the lattice, and how many there are along an axis. */
#define OUTLINE_PLACES 64
static inline int isph_outline_places(const struct isph *s) {
  return s->dimensions == 3 ? 4 : 8;
}
/* Place n of the cell around a centre. */
void isph_outline_place(const struct isph *s, const double centre[3], int n, double x[3]);

/* What images add to row i of the pressure equation, which has its pairs: returns their part of the
 * diagonal; adds the sum of a_ij (x_i - x_j).f to *fall and that of 2 V_i V_j slope' to *whole. */
double isph_outline_row(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                        const double f[3], double *fall, double *whole);
/* What they add to the divergence of v at particle i. */
double isph_outline_divergence(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                               double (*v)[3]);
/* What they add to the sums for the gradient of q, and for it times mobilities over that of i.
 * across: what q rises by across periodic sides, by image code. */
void isph_outline_gradient(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                           const double *q, const double *across, double gradient[3],
                           double flux[3]);

/* Whether boundary particle j is of a wall with an outline. */
static inline bool isph_is_of_outline(const struct isph *s, size_t j) {
  return s->boundary_kind[j] == BOUNDARY_WALL && s->wall_boxes[s->boundary_box[j]].outline != NULL;
}
/* Whether particle i has such images. */
static inline bool isph_faces_outline(const struct isph *s, size_t i) {
  return s->facing != NULL && s->facing[i].box > 0;
}

#endif
