/* Windows in the sides of the domain: where they are, and the pressure on them. */
#ifndef TOSUI_SPHSOLVE_ISPH_WINDOW_H
#define TOSUI_SPHSOLVE_ISPH_WINDOW_H

#include "sphsolve/isph/state.h"

/* The highest head, m, that a region of given head has. */
double isph_window_highest(const struct region *inflow);
/* Whether a lattice's site is the first before a window of an inflow across an axis. */
bool isph_window_has_site(const struct lattice *lattice, const struct region *inflow, int axis,
                          bool at_low, const size_t at[3]);
/* Pressure of a side of given head at height z (m), Pa. */
double isph_window_pressure(const struct isph *s, const struct isph_open_side *side, double z);
/* The head is prescribed on the side itself, at least half a spacing in front of the boundary
 * particles. Their pressure is the linear extrapolation from the particle through the side, so that
 * a pair counts 1 + d_j/d_i times with the difference to the side, which is returned. `r`: from the
 * boundary particle, or its image; `to_side`: from the particle's own foot on the side. */
double isph_window_stretch(const struct isph *s, const double xi[3], uint32_t entry,
                           const double r[3], double to_side[3]);
/* The open side through which x has left the domain, or -1. */
int isph_window_behind(const struct isph *s, const double x[3]);
/* Distance of x in front of a window, m; INFINITY if it is not in front of it. */
double isph_window_depth(const struct isph *s, const struct isph_open_side *side,
                         const double x[3]);
/* Whether x is within a spacing of a window. */
bool isph_window_is_near(const struct isph *s, const double x[3]);

#endif
