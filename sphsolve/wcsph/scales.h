/* Criteria by which the effects of method wcsph are switched on, and their limits of the time
 * step. */
#ifndef TOSUI_SPHSOLVE_WCSPH_SCALES_H
#define TOSUI_SPHSOLVE_WCSPH_SCALES_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/modes.h"

/* Whether particles stay on their lattice points (advection in effects/registry.def); `why` may be
 * NULL. */
bool wcsph_eulerian(const struct effect_context *context, char why[EFFECT_WHY]);
/* Speed of sound that limits the time step, m/s: in narrow pores, whose gradients are corrected for
 * missing neighbours, sound is faster than in open fluid. In random packings of spheres a run is
 * stable with a step for twice the speed, but not with one for 1.5 times. */
double wcsph_sound_for_dt(const struct effect_context *context);
/* Diffusion coefficient of the pressure, m^2/s (effects/pressure_diffusion.h): next to walls gamma
 * c^2; 0 with frozen walls. */
double wcsph_diffusion(const struct effect_context *context);

static inline bool wcsph_frozen(const struct effect_context *context) {
  return context->scene->wcsph.wall == WALL_FROZEN;
}

static inline struct lattice_modes wcsph_modes_of(const struct effect_context *context) {
  const struct lattice *lattice = context->lattice;
  return lattice_modes_find(context->kernel, lattice->dimensions, lattice->spacing,
                            context->smoothing_length);
}

static inline bool wcsph_frozen_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, "wall = \"%s\"",
           wcsph_frozen(context) ? "frozen" : "adami or subvoxel");
  return wcsph_frozen(context);
}

static inline bool wcsph_continuity_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY,
           wcsph_frozen(context) ? "wall = \"frozen\": densities are summed"
                                 : "walls are not frozen: nothing may pin particles to them");
  return !wcsph_frozen(context);
}

static inline double wcsph_pressure_dt(const struct effect_context *context) {
  struct lattice_modes modes = wcsph_modes_of(context);
  bool absolute = wcsph_frozen(context) && context->scene->wcsph.equation_of_state == EOS_ABSOLUTE;
  return lattice_modes_dt(&modes, absolute, wcsph_sound_for_dt(context), 0,
                          wcsph_diffusion(context));
}

static inline bool wcsph_wall_wanted(const struct effect_context *context, enum wall_scheme scheme,
                                     char why[EFFECT_WHY]) {
  bool on = context->has_wall && context->scene->wcsph.wall == scheme;
  snprintf(why, EFFECT_WHY,
           !context->has_wall ? "no walls"
           : on               ? "chosen by wcsph.wall"
                              : "wcsph.wall is another");
  return on;
}

#endif
