/* Wells and drains as holes in the soil, whose faces lie anywhere between the sites. */
#ifndef TOSUI_SPHSOLVE_DARCY_HOLE_H
#define TOSUI_SPHSOLVE_DARCY_HOLE_H

#include "sphsolve/darcy/state.h"

/* Finds `outside` of all sites in soil that is full, and else the faces that drains cut; leaves
 * them NULL without wells and drains. richards_free frees them. */
enum status richards_holes_create(struct richards *s);
/* Sets the fluxes of the faces that drains cut, at a time. */
void richards_holes_flux(struct richards *s, double time);
/* What the half of a site towards its face at the high or low end of an axis conducts, over that of
 * half a spacing of its soil. */
static inline double richards_hole_factor(const struct richards *s, size_t i, int axis, bool high) {
  return s->outside == NULL ? 1 : 0.5 / (double)s->outside[6 * i + 2 * (size_t)axis + high];
}

#endif
