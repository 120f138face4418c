/* Bodies of free water whose levels follow from what enters and leaves them, and their basins: the
 * empty places that their water may rise into. */
#ifndef TOSUI_SPHSOLVE_DARCY_BASIN_H
#define TOSUI_SPHSOLVE_DARCY_BASIN_H

#include <stdbool.h>

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

struct basin {
  bool found;         /* false: the water region has no site, or its body was found by another */
  double level, brim; /* m: of the water at the start; above which it flows over */
};

/* Finds the bodies of water of a scene, each by its first water region, and marks their basins with
 * 1 + its index in `open` [lattice->count], where open_water_find has marked its waters. An error
 * of input if a water would not stay at rest, or is in one space with another. A basin ends at the
 * height at which its water would flow down on another way, or into another basin. `basins`
 * [regions]: zero before. */
enum status basin_find(const struct scene *scene, const struct lattice *lattice, uint16_t *open,
                       struct basin *basins);

#endif
