/* What the water's pressure does to walls that have a name. */
#ifndef TOSUI_SPHSOLVE_ISPH_WALL_FORCE_H
#define TOSUI_SPHSOLVE_ISPH_WALL_FORCE_H

#include "sphsolve/isph/state.h"

/* Whether wall box b is a region with a name. */
static inline bool isph_wall_has_name(const struct isph *s, size_t b) {
  const struct region *region = b > 0 ? s->wall_boxes[b].region : NULL;
  return region != NULL && *region->name != '\0' && region == &s->scene->regions[region->first];
}

/* Force on the wall of box b, with the other boxes of its polygon, N, of a 2-D scene's one spacing
 * along y. Collective; of a fresh state. */
void isph_wall_force(const struct isph *s, size_t b, double force[3]);

#endif
