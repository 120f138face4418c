/* Force of the water's pressure on named walls. */
#ifndef TOSUI_SPHSOLVE_ISPH_WALL_FORCE_H
#define TOSUI_SPHSOLVE_ISPH_WALL_FORCE_H

#include "sphsolve/isph/state.h"

/* Whether wall box b is the first box of a named region. */
static inline bool isph_wall_has_name(const struct isph *s, size_t b) {
  const struct region *region = b > 0 ? s->wall_boxes[b].region : NULL;
  return region != NULL && *region->name != '\0' && region == &s->scene->regions[region->first];
}

/* Force, N, on the wall of box b including the other boxes of its polygon; in a 2-D scene, on one
 * spacing along y. Collective; needs a fresh state. */
void isph_wall_force(const struct isph *s, size_t b, double force[3]);

#endif
