#include "sphsolve/isph/isph_state.h"

static bool inside(const struct scene *scene, const struct region *region, const double x[3]) {
  for (int a = 0; a < 3; a++) {
    if (scene->dimensions == 2 && a == 1) continue;
    if (x[a] < region->box[a] || x[a] >= region->box[a + 3]) return false;
  }
  return true;
}

/* 1 + the region whose water fills x, 0 for none; *claimed: whether any region covers x. */
static uint16_t water_at(const struct scene *scene, const double x[3], bool saturated,
                         bool *claimed) {
  uint16_t water = 0;
  *claimed = false;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    if (!inside(scene, region, x)) continue;
    uint16_t here = (uint16_t)(k + 1);
    switch (region->type) {
    case REGION_WATER:
      water = here, *claimed = true;
      break;
    case REGION_WALL:
      water = 0, *claimed = true;
      break;
    case REGION_EMPTY:
      water = 0, *claimed = false;
      break;
    case REGION_POROUS:
      *claimed = true;
      if ((saturated || region->saturated) && water == 0) water = here;
      break;
    case REGION_INFLOW:
      break;
    }
  }
  return water;
}

void isph_fill(const struct scene *scene, const struct lattice *lattice, uint16_t *fill,
               struct isph_filling *filling) {
  bool saturated = true, dry = false;
  size_t claimed_count = 0;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_WATER) saturated = false;
  for (int a = 0; a < 3; a++)
    if (scene->periodic[a] && scene->driving[a] != 0) saturated = true;
  for (int pass = 0; pass < 2; pass++) {
    size_t site = 0;
    for (size_t k = 0; k < lattice->size[2]; k++)
      for (size_t j = 0; j < lattice->size[1]; j++)
        for (size_t i = 0; i < lattice->size[0]; i++, site++) {
          double x[3] = {lattice->origin[0] + (double)i * lattice->spacing[0],
                         lattice->origin[1] + (double)j * lattice->spacing[1],
                         lattice->origin[2] + (double)k * lattice->spacing[2]};
          bool claimed;
          uint16_t water = water_at(scene, x, saturated, &claimed);
          if (pass == 0) {
            claimed_count += claimed;
          } else {
            if (fill != NULL) fill[site] = water;
            if (!claimed || water == 0) dry = true;
          }
        }
    filling->full = claimed_count == lattice->count;
    if (filling->full) saturated = true;
  }
  filling->saturated = saturated;
  filling->surface = !filling->full || (dry && !saturated);
}
