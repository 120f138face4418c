/* No-slip walls: images behind them have the velocity v_w + (v_w - v_i) d_j/d_i (Takeda, Miyama,
 * Sekiya 1994; Morris et al. 1997), and the viscosity of wall_viscosity (turbulence.h);
 * isph/viscosity.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_NO_SLIP_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_WALL_NO_SLIP_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/effects/viscosity.h"
#include "sphsolve/isph/effects/wall_slip.h"

static inline bool isph_no_slip_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  bool on = isph_wall_kind(context, false) && isph_viscosity_wanted(context, unused);
  snprintf(why, EFFECT_WHY,
           on ? "closed sides or wall regions, not said to slip" : "no wall that holds the water");
  return on;
}

#endif

EFFECT(isph_wall_no_slip, .model = "mirrored images v_w + (v_w - v) d_w/d",
       .citation = "Takeda et al. 1994; Morris et al. 1997", .wanted = isph_no_slip_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, no_slip))
