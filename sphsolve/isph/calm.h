/* How far free water (isph/linear.h) is thick, calm and not struck, 0 .. 1:
 *   calm = s c f/r0 / (D^2 + f/r0),   D = max(0, - div v),   c = 1/(1 + (q/q_0)^2),
 *   q = |v . grad v| / f,   f the strength of the driving force,   s = s_0 (1 - l).
 * There waves are to live: biharmonic viscosity (isph/biharmonic.h) takes the place of artificial
 * viscosity, which keeps all other water in order and damps them; densities hardly relax beside the
 * surface (effects/relaxation.h), and the surface is shifted too (effects/shifting.h).
 *
 * - D: the switch of Cullen, Dehnen (2010, Mon. Not. R. Astron. Soc. 408, eq. 13) with D^2 for the
 *   rate of compression and sqrt(f r0), the velocity of artificial viscosity, for that of signals.
 * - c: in a standing wave of steepness k A q is at most (k A)^2/2; q_0 is that of half of the
 *   steepness at which one breaks (.62; Penney, Price 1952, Phil. Trans. R. Soc. A 244). Water that
 *   runs from a dam has q of .2 and more. Velocities are those in the scene's frame: water that is
 *   carried along fast and uniformly has large q beside any wave.
 * - s_0: a morphological opening (Matheron 1975) of the water, by neighbours for lengths. Inside is
 *   what no surface is within THICKNESS_HOPS neighbours of, thick what an inside is within one more
 *   of. A neighbour is two rows away at most: a layer on a floor is thick from 2 THICKNESS_HOPS + 2
 *   rows on. Thin water strikes particle by particle, and voids shut in it.
 * - l: the most of a neighbourhood's surface (phi_top - phi - a)/(b - a), held to 0 to 1, a and b
 *   LOOSE_FROM, LOOSE_FULL: how much looser its top row is than a lattice's. A wave's on 16 rows
 *   lacks at most .003 of phi, on 24 .009. Stirred water, whose top row lacks more, would stay
 *   swollen, by most of a row after rain, if its density did not relax there.
 * A wave on 16 rows has 1 - calm = 5e-6 in the mean. */
#ifndef TOSUI_SPHSOLVE_ISPH_CALM_H
#define TOSUI_SPHSOLVE_ISPH_CALM_H

#include "sphsolve/isph/state.h"

#define CALM_CONVECTION 0.05 /* q_0 */
#define THICKNESS_HOPS 2
#define LOOSE_FROM 0.02 /* of the kernel sum, above what waves lack */
#define LOOSE_FULL 0.06 /* and below what stirring leaves */

/* s calm: how far particle i, on the surface or beside it, keeps its density (effects/relaxation.h)
 * and is shifted (effects/shifting.h); 0 without such water. s, which calm holds already, counts
 * twice: by calm alone water that rain has stirred stays 1.2 mm of 131.5 too high. */
static inline double isph_calm_surface(const struct isph *s, size_t i) {
  return s->calm != NULL ? s->thick[i] * s->calm[i] : 0;
}

/* Whether the scene has such water; else s->calm is NULL. */
bool isph_has_calm(const struct isph *s);
/* Collective: s of all own particles, to s->thick, by s->surface and s->kernel_sum. */
void isph_calm_thickness(struct isph *s);
/* s->calm of all own particles, by s->thick, velocities and their gradients. */
void isph_calm_find(struct isph *s);

#endif
