/* Soils at a place, and the drag of their layers. */
#ifndef TOSUI_SPHSOLVE_ISPH_LAYERS_H
#define TOSUI_SPHSOLVE_ISPH_LAYERS_H

#include "sphsolve/isph/state.h"
#include "sphsolve/isph/soil.h"

/* The soils at a place, with their drag a (1/s) and volume fraction w. Starts from {.count = 0}. */
#define ISPH_LAYERS 8
struct isph_layers {
  size_t count;
  struct {
    double w, a;
    const struct region *soil;
  } at[ISPH_LAYERS];
};
/* Adds a soil; not if it has no linear drag, or if there are ISPH_LAYERS already. */
void isph_layers_add(struct isph_layers *layers, double w, double a, const struct region *soil);
/* Finds soil->tensor, the tensor of linear drag (1/s), from soil->normal and soil->plane. */
void isph_layers_close(const struct isph_layers *layers, struct soil_point *soil);

#endif
