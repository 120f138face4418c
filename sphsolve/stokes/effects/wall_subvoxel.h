/* No-slip at the true surface, from the signed wall distances d of the sites (units: spacings):
 *   v_b = -v_a d_b / d_a - (F - G p)_a / (2 nu) d_b (d_a + d_b)
 * linear: Morris, Fox, Zhu 1997 with distances from the surface instead of from planes;
 * parabola: after Basa, Quinlan, Lastiwka 2009, continued by the momentum equation. */
#ifndef TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_SUBVOXEL_H
#define TOSUI_SPHSOLVE_STOKES_EFFECTS_WALL_SUBVOXEL_H

#include <math.h>
#include <stdbool.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/stokes/constants.h"

/* Upper bound of the sum of c_ab d_b (d_a + d_b) / 2: its value for a pore one site wide. It keeps
 * the force on a site positive for any distances. */
#define WALL_PARABOLA_MAX 0.75

/* Effect of the curvature of the wall: with the curvature H (Laplacian of d) the second derivative
 * along the normal is v'' = -(F - G p + H v_a / d_a) / (1 - H d_a / 2). */

struct stokes_wall_image {
  double linear;   /* d_b / d_a */
  double parabola; /* d_b (d_a + d_b) / 2 */
  bool smooth;
};

static inline struct stokes_wall_image stokes_wall_image(double d_a, double d_b, double r) {
  struct stokes_wall_image image;
  image.smooth = d_a + d_b <= WALL_SMOOTH_TOLERANCE * r;
  d_a = fmax(d_a, WALL_DISTANCE_FLOOR);
  d_b = fmax(fmin(d_b, r - d_a), 0.0);
  image.linear = d_b / d_a;
  image.parabola = 0.5 * d_b * (d_a + d_b);
  return image;
}

/* Correction of the volume integral of the velocity from its values at the sites. Along a line of
 * sites that ends at a wall the plain sum has the error -(B2(s)/2) dv/dx (Euler, Maclaurin), s the
 * distance of the last site from the wall in spacings, B2(s) = s^2 - s + 1/6; dv/dx = n dv/dn with
 * the component n of the normal along the line, dv/dn = v/d_a + (F - G p) d_a / 2 by the same
 * parabola. Where lines of several axes cut the surface, each axis has the share n^2. */
struct stokes_wall_quadrature {
  double velocity, force; /* factors of v_a and (F - G p)_a */
  double wall;            /* factor of the wall's velocity, for the part of the last cell in it */
  double share;           /* share n^2 of the axis in the surface */
};

static inline struct stokes_wall_quadrature stokes_wall_quadrature(double d_a, double d_b,
                                                                   double step) {
  d_a = fmax(d_a, WALL_DISTANCE_FLOOR);
  d_b = fmax(d_b, 0.0);
  const double n = fmin((d_a + d_b) / step, 1.0), s = fmin(d_a / (d_a + d_b), 1.0);
  const double bernoulli = s * s - s + 1.0 / 6.0;
  const double slope = 0.5 * bernoulli * n * n * n * step;
  return (struct stokes_wall_quadrature){slope / d_a, 0.5 * slope * d_a, (s - 0.5) * n * n, n * n};
}

static inline bool stokes_wall_subvoxel_wanted(const struct effect_context *context,
                                               char why[EFFECT_WHY]) {
  const bool on = context->has_wall && context->scene->stokes.wall == WALL_SUBVOXEL;
  snprintf(why, EFFECT_WHY,
           on ? "no slip at the wall distance; second order" : "stokes.wall is another");
  return on;
}

#endif

EFFECT(stokes_wall_subvoxel,
       .model = "image velocity from the wall distance, continued by the parabola",
       .citation = "Morris, Fox, Zhu 1997; Basa, Quinlan, Lastiwka 2009",
       .wanted = stokes_wall_subvoxel_wanted)
