/* Wells and drains in soil that is full: holes with water in them, whose faces lie anywhere between
 * the sites. */
#ifndef TOSUI_SPHSOLVE_DARCY_HOLE_H
#define TOSUI_SPHSOLVE_DARCY_HOLE_H

#include "sphsolve/darcy/state.h"

/* Finds `outside` of all sites; leaves it NULL without wells and drains. richards_free frees it. */
enum status richards_holes_create(struct richards *s);
/* What the half of a site towards its face at the high or low end of an axis conducts, over that of
 * half a spacing of its soil. */
static inline double richards_hole_factor(const struct richards *s, size_t i, int axis, bool high) {
  return s->outside == NULL ? 1 : 0.5 / (double)s->outside[6 * i + 2 * (size_t)axis + high];
}

#endif
