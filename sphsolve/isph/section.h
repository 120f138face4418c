/* Water that passes a plane across an axis. */
#ifndef TOSUI_SPHSOLVE_ISPH_SECTION_H
#define TOSUI_SPHSOLVE_ISPH_SECTION_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* Whether water fills its room: no surface, and no walls that move. */
static inline bool isph_fills_room(const struct isph *s) {
  return s->on.links && !s->on.surface && !s->on.moving_walls;
}

/* Where water fills its room: finds `section_room`, the area of each plane of the scene that is
 * open to water, m^2 (m in 2-D). All volumes that water has at the start, m^3 (m^2) at x, are added
 * between begin, which allocates it (isph_free frees it), and end. Without them it is 0. */
enum status isph_sections_begin(struct isph *s);
void isph_sections_add(struct isph *s, const double x[3], double volume);
void isph_sections_end(struct isph *s, const struct lattice *lattice);

/* Flux through a plane, m^3/s, positive along the axis. Collective. `room`: the area of the plane
 * that is open to water, m^2, or m in 2-D; 0 if it is not known, as a surface may cross the plane:
 * then the volumes of the particles count. */
double isph_section_flux(const struct isph *s, const struct flux_plane *plane, double room);

#endif
