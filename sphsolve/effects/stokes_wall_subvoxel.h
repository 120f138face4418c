/* No-slip at the true surface, from the signed wall distances d of the sites (units: spacings):
 *   v_b = -v_a d_b / d_a - (F - G p)_a / (2 nu) d_b (d_a + d_b)
 * linear: Morris, Fox, Zhu 1997 eq. 28 with distances from the surface instead of from planes;
 * parabola: after Basa, Quinlan, Lastiwka 2009, continued by the momentum equation. */
#ifndef TOSUI_SPHSOLVE_EFFECTS_STOKES_WALL_SUBVOXEL_H
#define TOSUI_SPHSOLVE_EFFECTS_STOKES_WALL_SUBVOXEL_H

#include <math.h>
#include <stdbool.h>

/* A fluid site on the surface itself would make the quotient infinite. */
#define WALL_DISTANCE_FLOOR 0.02
/* Distances of two sites differ by no more than they are apart; beyond this they are noise. */
#define WALL_SMOOTH_TOLERANCE 1.1
/* Upper bound of the sum of c_ab d_b (d_a + d_b) / 2: what a pore one site wide has. Keeps the
 * force on a site positive whatever the distances are. */
#define WALL_PARABOLA_MAX 0.75

struct wall_image {
  double linear;   /* d_b / d_a */
  double parabola; /* d_b (d_a + d_b) / 2 */
  bool smooth;
};

static inline struct wall_image wall_subvoxel(double d_a, double d_b, double r)
{
  struct wall_image image;
  image.smooth = d_a + d_b <= WALL_SMOOTH_TOLERANCE * r;
  d_a = fmax(d_a, WALL_DISTANCE_FLOOR);
  d_b = fmax(fmin(d_b, r - d_a), 0.0);
  image.linear = d_b / d_a;
  image.parabola = 0.5 * d_b * (d_a + d_b);
  return image;
}

#endif
