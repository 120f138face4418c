/* Reflected particles: water beside a closed side of the domain sees behind it the image of all
 * that stands before it (ghost particles: Colagrossi, Landrini 2003, J. Comput. Phys. 191,
 * section 5.1; Bouscasse et al. 2013, J. Fluids Struct. 42), by pairs that carry a code of the
 * side, as those of periodic images do. With R = 1 - 2 n n, n the side's normal, at the side x_0:
 *   x' = R (x - x_0) + x_0,   v' = R v,   V' = V,   eps' = eps,
 *   q' = q,  q = P - rho f.x, so that P' = P + rho f.(x' - x)       (no flow through: dq/dn = 0)
 * and two sides one after the other in a corner. The kernel sum, the divergence, the gradient and
 * the matrix are then what they are in the middle of water whose plane of symmetry is the side,
 * exact and each other's adjoint. Images that stay in place (isph/wall.c) do not strain with the
 * water, and leave a third of a strain along the wall as divergence: relaxation that answers it
 * took half of a small wave's energy a period.
 *
 * The friction of walls that hold is another matter, and is as for all walls (step.c, viscous);
 * along walls that slip images are neighbours as others are. No image beyond a gap
 * (isph_reflection_part). Sides reflect where the domain is at least a support wide, so that one
 * image is enough, and in scenes without soil and windows. */
#ifndef TOSUI_SPHSOLVE_ISPH_REFLECTION_H
#define TOSUI_SPHSOLVE_ISPH_REFLECTION_H

#include <stdbool.h>
#include <stdint.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/state.h"

/* The images of periodic and of closed sides; needs the largest support and the kernel's scale. */
void isph_images_create(struct isph *s);
/* Parts the pairs whose image lies beyond a gap: their slope fades to 0 where either particle is on
 * a surface whose void lies towards the side (surface_gap). After the surface has travelled. */
void isph_reflection_part(struct isph *s);
/* Whether the void beside particle i lies between it and the side of a reflected pair, 0 .. 1. */
double isph_reflection_gap(const struct isph *s, size_t i, uint32_t entry, const double r[3]);
/* The distance from the sides of the image over that of particle i, as isph_wall_mirror's. */
double isph_reflection_ratio(const struct isph *s, const double xi[3], uint32_t entry,
                             const double r[3]);

/* How far sides that reflect stand behind particle i, 0 .. 1, where it touches one: by what share
 * of sum V slope lies behind them, were water there as on the lattice. */
double isph_reflection_backs(const struct isph *s, size_t i);

/* What P_i - P_j has over q_i - q_j, over rho: f.(x_i - x_j), both on this side of the mirror. r is
 * the pair's separation. */
ROW double isph_fall_between(enum isph_images images, const struct isph *s, const double f[3],
                             const double xi[3], uint32_t entry, const double r[3]) {
  double fall = f[0] * r[0] + f[1] * r[1] + f[2] * r[2];
  const struct isph_image *image = &s->image[entry >> PAIR_BITS];
  for (int a = 0; a < 3 && isph_is_reflected(images, s, entry); a++)
    if (image->turn[a] < 0) fall += f[a] * (xi[a] - s->position[entry & PAIR_MASK][a] - r[a]);
  return fall;
}

#endif
