/* Water that passes a plane across an axis. */
#ifndef TOSUI_SPHSOLVE_ISPH_SECTION_H
#define TOSUI_SPHSOLVE_ISPH_SECTION_H

#include <stdbool.h>

#include "sphsolve/isph/state.h"

/* Whether water in soil fills its room: no surface, and no walls that move. */
static inline bool isph_fills_room(const struct isph *s) {
  return s->on.links && !s->on.surface && !s->on.moving_walls;
}

/* Flux through a plane, m^3/s, positive along the axis. Collective. */
double isph_section_flux(const struct isph *s, const struct flux_plane *plane);

#endif
