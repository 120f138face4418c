/* Reflected particles. Water beside a closed side of the domain has as neighbours the mirror images
 * of all particles near the side (ghost particles: Colagrossi, Landrini 2003, J. Comput. Phys. 191,
 * section 5.1; Bouscasse et al. 2013, J. Fluids Struct. 42). These are pairs that carry a code of
 * the side, like those of periodic images. With R = 1 - 2 n n, n the normal of the side at x_0:
 *   x' = R (x - x_0) + x_0,   v' = R v,   V' = V,   eps' = eps,
 *   q' = q,  q = P - rho f.x, so that P' = P + rho f.(x' - x)       (no flow through: dq/dn = 0)
 * and two sides one after the other in a corner. The kernel sum, the divergence, the gradient and
 * the matrix are then what they are inside water with the side as a plane of symmetry: exact, and
 * gradient and divergence adjoint. Images that stay in place (isph/wall.c) do not strain with the
 * water, and leave a third of a strain along the wall as divergence: the relaxation that responds
 * to it would take half of a small wave's energy per period.
 *
 * Friction at no-slip sides is treated as at all other walls (step.c, viscous); along sides with
 * slip, images are neighbours like others. There is no image beyond a gap (isph_reflection_part).
 * In soil rows beside a side that does not reflect have four fifths of their weight along it: to a
 * drain that ends there, the soil is a fifth of a particle thinner.
 * Sides without a window reflect if the domain is at least a support wide, so that one image is
 * enough: of free water if there are no windows at all, and in scenes of soil without a surface. */
#ifndef TOSUI_SPHSOLVE_ISPH_REFLECTION_H
#define TOSUI_SPHSOLVE_ISPH_REFLECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/state.h"

/* Sets the images of periodic and of closed sides; needs the largest support and the kernel's
 * normalisation. */
void isph_images_create(struct isph *s);
/* Separates the pairs whose image lies beyond a gap: their slope goes to 0 where either particle is
 * on a surface whose void lies towards the side (surface_gap). After the surface weights of ghosts
 * are known. */
void isph_reflection_part(struct isph *s);
/* Whether the void beside particle i lies between it and the side of a reflected pair, 0 .. 1:
 * surface_gap. */
double isph_reflection_gap(const struct isph *s, size_t i, uint32_t entry, const double r[3]);
/* Distance of the image from the sides over that of particle i, like that of isph_wall_mirror. */
double isph_reflection_ratio(const struct isph *s, const double xi[3], uint32_t entry,
                             const double r[3]);

/* The way x + t step, t = 0 .. 1, from a particle to an image of another, as light takes it: the
 * part of it within the domain, up to the first side, and so on from there to the other particle
 * itself. */
struct isph_leg {
  double start[3], step[3], from, to; /* start + t step, from <= t <= to */
  bool turned[3];
  int crossed; /* 1 + the axis of the side at its end; 0: none */
};
static inline struct isph_leg isph_first_leg(const double x[3], const double r[3]) {
  return (struct isph_leg){.start = {x[0], x[1], x[2]}, .step = {-r[0], -r[1], -r[2]}};
}
/* Goes on to the next leg of the way; false after the last. */
bool isph_next_leg(const struct isph_image *image, struct isph_leg *leg);

/* Degree, 0 .. 1, to which reflecting sides back particle i; 1 where it touches one. From the share
 * of sum V slope that would lie behind the sides if the water there were a lattice. */
double isph_reflection_backs(const struct isph *s, size_t i);

/* Whether closed sides hold the water, so that its velocity beside them is not that of a plane of
 * symmetry. */
static inline bool isph_sides_hold(const struct isph *s) {
  return s->on.no_slip && !s->wall_boxes[0].slip;
}

/* The x_i - x_j of (P_i - P_j - (q_i - q_j)) / rho = f.(x_i - x_j), with both particles on this
 * side of the mirror. r is the pair's separation. */
ROW void isph_fall_way(enum isph_images images, const struct isph *s, size_t i, uint32_t entry,
                       const four *r, four *way) {
  *way = *r;
  if (images != IMAGES_REFLECTED) return;
  const four straight = FOUR(s->position[i]) - FOUR(s->position[entry & PAIR_MASK]);
  *way += (0.5 - 0.5 * FOUR(s->image[entry >> PAIR_BITS].turn)) * (straight - *r);
}

#endif
