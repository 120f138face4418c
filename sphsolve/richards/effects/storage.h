/* Water content by van Genuchten (1980), eq. 3 with m = 1 - 1/n:
 *   theta = theta_r + (theta_s - theta_r) (1 + (alpha |h|)^n)^-m,   h < 0
 * richards/retention.c. */
#ifndef TOSUI_SPHSOLVE_RICHARDS_EFFECTS_STORAGE_H
#define TOSUI_SPHSOLVE_RICHARDS_EFFECTS_STORAGE_H

#include <stdio.h>

#include "sphsolve/plan/plan.h"

static inline bool richards_storage_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  (void)context;
  snprintf(why, EFFECT_WHY, "the soil has a retention curve");
  return true;
}

#endif

EFFECT(richards_storage, .model = "water that soil holds at a suction",
       .citation = "van Genuchten 1980, eq. 3", .wanted = richards_storage_wanted)
