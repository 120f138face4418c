/* Free surface: P = 0, or the pressure that an effect sets (surface_tension.h), half a particle
 * above the outermost particles.
 *
 * Where neighbours are missing on one side, the row of the pressure equation is closed by a ghost
 * particle in the void (Nair, Tomar 2014, Comput. Fluids 102), placed such that it is exact at
 * rest. In the bulk sum a_ij (x_i - x_j) is 0, so that the missing pairs have the opposite sum of
 * the pairs there are,
 *   Q = sum of a_ij (x_i - x_j) over the pairs there are
 *     = sum of a_ij (x_j - x_i) over the missing ones,
 * and so has one ghost at the surface point x_s = x_i + n d with the coefficient c,
 *   n = Q/|Q|, into the void,   d = V^(1/dimensions)/2,   c = |Q|/d.
 * It adds to the row
 *   c [ P_i - rho f.(x_i - x_s) ] = c P_i + rho f.Q.
 * Where the a_ij of a complete neighbourhood exceed the existing ones by more than |Q|/d, as in
 * drops and sheets, whose Q is small, c is that difference. Water at rest with a level surface then
 * has P = rho g (z_s - z) exactly, and a falling body of water P = 0. The surface weight varies
 * smoothly from 0 to 1, so that there are no jumps when particles pass. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_SURFACE_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_SURFACE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/packing.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/constants.h"

/* Asymmetry of a neighbourhood, |sum V grad W| he / sum V slope r^2, relative to that in the
 * outermost layer of a level surface; `trace` is the sum in the denominator. */
static inline double surface_asymmetry(const struct isph *s, double support,
                                       const double gradient_sum[3], double trace) {
  double length = sqrt(gradient_sum[0] * gradient_sum[0] + gradient_sum[1] * gradient_sum[1] +
                       gradient_sum[2] * gradient_sum[2]);
  return length * support / (trace * s->asymmetry_top);
}

#define SURFACE_FROM 0.5 /* asymmetry from which on a particle begins to be on the surface */

/* Surface weight of a particle, 0 .. 1, from the asymmetry of its neighbourhood (walls count as
 * neighbours). The kernel sum alone is not sufficient: that of water entering soil is above 1, as
 * its volume grows before its particles have spread, and a front not recognised as a surface loses
 * half its speed. The weight is 1 from an asymmetry of .8, 0 below .5: the second layer of a
 * surface at 45 degrees has .28, disorder of a tenth of a spacing up to .33.
 *
 * Sheets one particle thick and drops, which are symmetric, are recognised by a kernel sum below .8
 * to .72 (the outermost layer of a level surface has .79). Walls above the water level make a
 * neighbourhood more symmetric: in a tank's corner the asymmetry is a quarter, and the kernel sum
 * .87, of which .45 is from walls (`walls`); so .35 of the walls' part is not counted.
 *
 * In free water a sheet or a jet is also recognised by the least eigenvalue of the moment sum V
 * slope r r, which is 1 in the bulk: the weight is 1 below .2, 0 above .4. The outermost layer of a
 * level surface has .5 (and its asymmetry), disorder no less; a smaller value means that neighbours
 * are missing on both sides. An impact squeezes the sheet that runs up a wall to kernel sums above
 * .8; being symmetric, it would count as inner water, with four times the pressure that stops it.
 */
static inline double surface_weight(const struct isph *s, double support, double kernel_sum,
                                    double walls, const double gradient_sum[3],
                                    const double moment[6], const double wall_moment[6]) {
  double trace =
      moment[0] + moment[3] + moment[5] + wall_moment[0] + wall_moment[3] + wall_moment[5];
  if (!(trace > 0)) return 1;
  double asymmetry = (surface_asymmetry(s, support, gradient_sum, trace) - SURFACE_FROM) /
                     (SURFACE_FULL - SURFACE_FROM);
  double thin = (SURFACE_THIN + SURFACE_WALLS * walls - kernel_sum) / SURFACE_THIN_RANGE,
         w = asymmetry > thin ? asymmetry : thin;
  if (!s->on.soil && w < 1) {
    double whole[6];
    for (int k = 0; k < 6; k++) whole[k] = moment[k] + wall_moment[k];
    const double least = symmetric_least(whole, s->dimensions == 2, SURFACE_MOMENT);
    w = fmax(w, (SURFACE_MOMENT - least) / (0.5 * SURFACE_MOMENT));
  }
  return w < 0 ? 0 : w > 1 ? 1 : w;
}

/* Whether the void beside particle i lies between it and a wall, 0 .. 1: 1 within 30 degrees of the
 * wall's normal, 0 beyond 45. r points from the wall to the particle, `mirror` is that of
 * isph_wall_mirror. A particle on the surface leaves out the image behind a wall that water has not
 * reached yet: with it the divergence would count the gap as full of water, and the pressure would
 * draw the front of water in soil to the wall at 1.3 times its speed. */
static inline double surface_gap(const struct isph *s, size_t i, const double r[3],
                                 const double mirror[6]) {
  const double *m = s->gradient_sum[i]; /* points into the void */
  double length = 0, distance = 0, towards = 0, across[3];
  symmetric_times(mirror, r, across);
  for (int a = 0; a < 3; a++) {
    length += m[a] * m[a], distance += across[a] * r[a];
    towards -= across[a] * m[a];
  }
  if (!(towards > 0)) return 0;
  return fmin(1, fmax(0, 4 * towards * towards / (length * distance) - 2));
}

/* Degree to which the pressure carries the weight of particle i: 0 in free flight, 1 from half of
 * the pressure on that water at rest has half a particle under its surface. The gradient of the
 * reduced pressure q keeps water at rest exactly still, but it contains the driving force only as
 * far as there are neighbours. Water that no pressure carries has to fall by the force itself: with
 * grad q alone a level sheet one particle thick falls with .4 g. */
static inline double surface_carried(const struct isph *s, size_t i, double size) {
  const double *f = s->force;
  double force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  if (force == 0) return 1; /* P = q */
  double outside = s->surface_pressure != NULL ? s->surface_pressure[i] : 0;
  double carried = (s->pressure[i] - outside) / fmax(0.25 * size * s->density * force, 1e-300);
  return fmax(0, fmin(1, carried));
}

/* Whether it does not carry all the weight of particle i: surface_carried is below 1. */
static inline bool surface_falls(const struct isph *s, size_t i) {
  const double *f = s->force, force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  const double outside = s->surface_pressure != NULL ? s->surface_pressure[i] : 0;
  const double most = 4 * fmax(0, s->pressure[i] - outside) / (s->density * force); /* size */
  return force > 0 && !(most * most * (s->dimensions == 3 ? most : 1) > s->volume[i]);
}

/* Contribution of the surface to the diagonal and to the right-hand side of row i; `pairs` is the
 * sum of the a_ij of its neighbours. A second projection solves for an increment of the pressure,
 * with neither force nor a pressure outside. A drop or a sheet backed by a side with its image
 * (`backed`, 0 .. 1) lies on that side, with few neighbours but all those behind it: its ghost is
 * that of a level surface, which carries it. So is the ghost of what began as a level top: over
 * larger particles, in soil, that may have as few neighbours, and is not at rest with more than
 * |Q|/d. */
static inline void surface_row(const struct isph *s, size_t i, double pairs, double backed,
                               double *coefficient, double *load) {
  double w = s->surface[i];
  *coefficient = *load = 0;
  if (w <= 0) return;
  double size = s->size[i];
  double scale = 2 * s->volume[i] * s->mobility[i];
  const double *f = s->force;
  double m[3];
  isph_packing_void(s, i, m);
  double moment = scale * sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  double missing = scale * s->slope_sum / (size * size) - pairs;
  *coefficient = w * fmax(moment / isph_packing_depth(s, i, size),
                          (1 - fmax(backed, (double)s->packing[i][5])) * missing);
  if (s->solve.again) return;
  *load = -w * s->density * scale * (f[0] * m[0] + f[1] * m[1] + f[2] * m[2]);
  if (s->surface_pressure != NULL) *load += *coefficient * s->surface_pressure[i];
}

/* Closes the gradients of q = P - rho f.x and of P at particle i against the void; returns the
 * degree to which the pressure carries its weight. */
static inline double surface_close(const struct isph *s, size_t i, double reduced[3],
                                   double own[3]) {
  static const double none[3] = {0};
  const bool again = s->solve.again;
  const double *f = again ? none : s->force;
  double m[3];
  isph_packing_void(s, i, m);
  double w = s->surface[i];
  double size = s->size[i];
  double length = sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]);
  double outside = s->surface_pressure != NULL && !again ? s->surface_pressure[i] : 0;
  double pressure = s->pressure[i] - outside;
  double d = isph_packing_depth(s, i, size) / fmax(length, 1e-30);
  double level = pressure + s->density * d * (f[0] * m[0] + f[1] * m[1] + f[2] * m[2]);
  for (int a = 0; a < 3 && w > 0; a++) {
    reduced[a] -= 2 * w * level * m[a];
    own[a] -= 2 * w * pressure * m[a];
  }
  return again ? 1 : surface_carried(s, i, size);
}

static inline bool isph_surface_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           context->has_surface ? "the regions leave points empty" : "the regions fill the domain");
  return context->has_surface;
}

#endif

EFFECT(isph_surface, .model = "P = 0 half a particle above the outermost",
       .citation = "after Nair, Tomar 2014", .wanted = isph_surface_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, surface))
