/* Indicator of calm free water (isph/linear.h), 0 .. 1: it is 1 where the water is thick, not
 * compressed by an impact and of low convective acceleration:
 *   calm = s c f/r0 / (D^2 + f/r0),   D = max(0, - div v),   c = 1/(1 + (q/q_0)^2),
 *   q = |v . grad v| / f,   f the strength of the driving force,   s = s_0 (1 - l).
 * Waves have to persist there. So biharmonic viscosity (isph/biharmonic.h) replaces the artificial
 * viscosity, which keeps all other water in order but damps waves; densities hardly relax beside
 * the surface (effects/relaxation.h); and the surface is shifted too (effects/shifting.h).
 *
 * - D: the switch of Cullen, Dehnen (2010, Mon. Not. R. Astron. Soc. 408, eq. 13) with D^2 for the
 *   rate of compression and sqrt(f r0), the velocity scale of the artificial viscosity, for the
 *   signal velocity.
 * - c: in a standing wave of steepness k A, q is at most (k A)^2/2; q_0 is that of half the
 *   steepness at which one breaks (.62; Penney, Price 1952, Phil. Trans. R. Soc. A 244). Water that
 *   runs from a breaking dam has a q of .2 and more. Velocities are those in the scene's frame:
 *   beside any wave, fast uniform flow has a large q.
 * - s_0: a morphological opening (Matheron 1975) of the water, with steps between neighbours as the
 *   length. A particle is inside if no surface is within THICKNESS_HOPS neighbours, and the water
 *   is thick within THICKNESS_HOPS + 1 neighbours of an inside particle. A neighbour is at most two
 *   rows away: a layer on a floor is thick from 2 THICKNESS_HOPS + 2 rows on. In thin water impacts
 *   occur particle by particle, and voids close.
 * - l: the largest value in the neighbourhood of surface (phi_top - phi - a)/(b - a), limited to 0
 *   .. 1, with a and b LOOSE_FROM and LOOSE_FULL: how much looser its top row is than that of a
 *   lattice. The top row of a wave on 16 rows lacks at most .003 of phi, on 24 rows .009. Stirred
 *   water, whose top row lacks more, would stay swollen, by most of a row after rain, if its
 *   density did not relax there.
 *
 * A wave on 16 rows has a mean 1 - calm of 5e-6. */
#ifndef TOSUI_SPHSOLVE_ISPH_CALM_H
#define TOSUI_SPHSOLVE_ISPH_CALM_H

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/constants.h"

#define THICKNESS_HOPS 2

/* s calm of particle i, on the surface or beside it: how far its density is left unrelaxed
 * (effects/relaxation.h) and it is shifted (effects/shifting.h); 0 in scenes without calm water.
 * The factor s, which calm already contains, counts twice: with calm alone water that rain has
 * stirred stays 1.2 mm too high of 131.5 mm. */
static inline double isph_calm_surface(const struct isph *s, size_t i) {
  return s->calm != NULL ? s->thick[i] * s->calm[i] : 0;
}

/* Rate, 1/s, at which calm water has to expand in order to keep its volume. In a step each particle
 * moves along a straight line, x + dt v, which changes volumes by
 *   det(1 + dt grad v) - 1 = dt div v - dt^2/2 tr((grad v)^2) + ...   (div v small):
 * without divergence a wave shrinks in every step, by as much as 1e-4 of its depth in a period, and
 * the pressure does work on it. So div v = dt/2 tr((grad v)^2), the constraint of the places to
 * second order (that of SHAKE: Ryckaert, Ciccotti, Berendsen 1977, J. Comput. Phys. 23), with which
 * the step is symplectic (Leimkuhler, Skeel 1994, J. Comput. Phys. 112). In stirred water grad v is
 * that of single particles, and means nothing for the volume. */
static inline double isph_calm_expansion(const struct isph *s, size_t i) {
  const float *g = s->gradient[i];
  double trace = 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) trace += (double)g[3 * a + b] * (double)g[3 * b + a];
  return s->calm[i] * s->dt / 2 * trace;
}

/* Whether the scene can have calm water; otherwise s->calm is NULL. */
bool isph_has_calm(const struct isph *s);
/* Collective: finds the thickness factor s of all own particles, s->thick, from s->surface and
 * s->kernel_sum. */
void isph_calm_thickness(struct isph *s);
/* Finds s->calm of all own particles from s->thick, velocities and their gradients. */
void isph_calm_find(struct isph *s);

#endif
