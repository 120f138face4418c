/* Sides of given head that let waves out; the equation and its sources: isph/radiation.h. It stands
 * before the open sides in the registry, so that their columns move by the new heads. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_RADIATION_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_RADIATION_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/method.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/radiation.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/window.h"
#include "sphsolve/plan/plan.h"

/* The lowest place, m, at which free water can be before an inflow's window across an axis;
 * INFINITY: there is soil or wall before all of it. */
static inline double radiation_bed(const struct effect_context *context,
                                   const struct region *inflow, int axis, bool at_low) {
  const struct lattice *l = context->lattice;
  double bed = INFINITY;
  size_t site = 0;
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0]; i++, site++) {
        const size_t at[3] = {i, j, k};
        const size_t r = l->region != NULL ? l->region[site] : 0;
        if (l->kind[site] == SITE_WALL || !isph_window_has_site(l, inflow, axis, at_low, at))
          continue;
        if (r > 0 && context->scene->regions[r - 1].type == REGION_POROUS) continue;
        bed = fmin(bed, l->origin[2] + ((double)k - 0.5) * l->spacing[2]);
      }
  return bed;
}

static inline bool radiation_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  const size_t n = isph_radiation_count(context->scene);
  snprintf(why, EFFECT_WHY,
           n > 0 ? "sides of given head with radiates = true"
                 : "no side of given head has radiates = true");
  return n > 0;
}

/* Waves need gravity and a surface; those that leave, an upright side with free water before it. */
static inline enum status isph_refuse_radiation(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double *g = scene->gravity;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    bool at_low = false;
    if (!region->radiates) continue;
    if (!(g[2] < 0) || g[0] != 0 || g[1] != 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: radiates: waves need a force.gravity along -z; give it, or leave the key "
                  "out",
                  scene->path, region->line);
    if (!context->has_surface)
      return FAIL(
          STATUS_INPUT,
          "%s:%d: radiates: water fills the domain, so there are no waves to let out; leave "
          "room above it, or the key out",
          scene->path, region->line);
    const int axis = scene_inflow_axis(scene, region, &at_low);
    if (axis == 2)
      return FAIL(STATUS_INPUT,
                  "%s:%d: radiates: waves leave by an upright side, and this one lies in the floor "
                  "or the top; leave the key out",
                  scene->path, region->line);
    const double bed = radiation_bed(context, region, axis, at_low);
    if (!isfinite(bed))
      return FAIL(STATUS_INPUT,
                  "%s:%d: radiates: there is soil or wall before all of this side, and no wave in "
                  "it; leave the key out",
                  scene->path, region->line);
    const double head = isph_window_highest(region);
    if (!(head > bed))
      return FAIL(
          STATUS_INPUT,
          "%s:%d: radiates: its head of %g m is not above the lowest free water that the "
          "box lies before, at %g m, so that no wave gets there; raise it, or leave the key "
          "out",
          scene->path, region->line, head, bed);
  }
  return STATUS_OK;
}

/* The heads of the next step. */
static inline enum status isph_radiation_arrive(void *state, double dt) {
  isph_radiation_follow(state, dt);
  isph_apply_tables(state, dt);
  return STATUS_OK;
}

#endif

EFFECT(isph_radiation, .model = "depth at a side by (sqrt(h_0) + (u - u_m)/(2 sqrt(g)))^2",
       .citation = "Flather 1976; Hedstrom 1979", .wanted = radiation_wanted,
       .refuse = isph_refuse_radiation, .numbers = "radiation", .numbers_each = RADIATION_NUMBERS,
       .things = isph_radiation_count, .arrive = isph_radiation_arrive)
