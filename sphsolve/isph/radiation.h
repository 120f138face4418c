/* Open sides that let waves out: the level at the side when beyond it the channel goes on, without
 * waves that come back (a radiation condition).
 *
 * Along the characteristic that comes in from beyond the side, u - 2 sqrt(g h) is that of the flow
 * there, u_m and h_0 (Hedstrom 1979, J. Comput. Phys. 30, 222; Blayo, Debreu 2005, Ocean Modelling
 * 9, 231; to first order Flather 1976: h = h_0 + (u - u_m) sqrt(h_0/g)):
 *
 *   h = (sqrt(h_0) + (u - u_m)/(2 sqrt(g)))^2,
 *
 * h the depth at the side, h_0 that of the given head, u the velocity outwards there, a mean over
 * the depth. u_m is u over the time past, du_m/dt = (u - u_m)/T, so that in the mean the side has
 * its given head, whatever flows through it; at the start it is u. T = 4 L/c, c = sqrt(g h_0), is
 * the period of the slowest free oscillation over the length L of the domain, between a side of
 * given head and one of given flux. With it a level that is off returns as fast as it can without
 * swinging (critical damping): by the balance of the water, L dh/dt = h_0 (u_in - u), what is left
 * after a time of s L/c is (1 + s/2) exp(-s/2). Of a long wave exp(i w t) the part -1/(1 + 2 i w T)
 * is reflected: 8 % of that oscillation, less of all that are faster; what changes much more slowly
 * than in T, as a tide does, finds the given head. */
#ifndef TOSUI_SPHSOLVE_ISPH_RADIATION_H
#define TOSUI_SPHSOLVE_ISPH_RADIATION_H

#include <math.h>

#include "sphsolve/isph/state.h"

/* What is kept of each region with `radiates`, in the order of the regions. */
enum {
  RADIATION_NOW,  /* u, m/s */
  RADIATION_MEAN, /* u_m, m/s */
  RADIATION_FAST, /* 1: u has been above c, of which the run was warned */
  RADIATION_NUMBERS
};

/* h, m, by h_0 (m), u - u_m (m/s) and g (m/s^2). */
static inline double isph_radiation_depth(double still, double excess, double gravity) {
  const double root = fmax(0, sqrt(still) + excess / (2 * sqrt(gravity)));
  return root * root;
}

/* How many regions of a scene let waves out. */
size_t isph_radiation_count(const struct scene *scene);
/* The head at a side by its given one, m; that itself if it does not let waves out. */
double isph_radiation_head(const struct isph *s, const struct isph_open_side *side);
/* Takes up the velocities that isph_open_measure has found, in a step of length dt (s). */
void isph_radiation_follow(struct isph *s, double dt);

#endif
