/* Porosity of soil, and the inertia that it adds to the water in it (M15 eq. 9a). The scene's boxes
 * are smoothed over the support (M15 section 4) in isph/soil.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_POROSITY_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_POROSITY_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/constants.h"

/* Inertia coefficient (M15 eq. 9a). */
static inline double inertia_coefficient(double eps) {
  return 1 + INERTIA_ADDED * (1 - eps) / eps;
}

/* Whether `property` is nonzero for any porous region. */
static inline bool isph_any_soil(const struct scene *scene,
                                 double (*property)(const struct region *)) {
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_POROUS && property(&scene->regions[k]) != 0) return true;
  return false;
}

static inline bool isph_porosity_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  const struct lattice *lattice = context->lattice;
  if (!context->has_porous) {
    snprintf(why, EFFECT_WHY, "no porous region");
    return false;
  }
  size_t dry = 0;
  for (size_t i = 0; i < lattice->count; i++)
    dry += lattice->kind[i] == SITE_EMPTY && lattice->region != NULL && lattice->region[i] > 0 &&
           context->scene->regions[lattice->region[i] - 1].type == REGION_POROUS;
  if (dry > 0)
    snprintf(why, EFFECT_WHY,
             "porous regions; %zu of their points start dry: no water region covers them", dry);
  else
    snprintf(why, EFFECT_WHY, "porous regions, full of water at the start");
  return true;
}

#endif

EFFECT(isph_porosity, .model = "porosity of boxes smoothed over the support",
       .citation = "Morimoto et al. 2015 section 4", .wanted = isph_porosity_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, soil),
       .budget = 1u << BUDGET_SOIL_PRESSURE | 1u << BUDGET_SOIL_ENTRY)
