/* What method wcsph is made of, and when a scene calls for it. Equations and sources stand in
 * effects/NAME.h, beside the pair functions. */
#ifndef TOSUI_SPHSOLVE_WCSPH_EFFECTS_WCSPH_EFFECTS_H
#define TOSUI_SPHSOLVE_WCSPH_EFFECTS_WCSPH_EFFECTS_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/modes.h"
#include "sphsolve/wcsph/plan.h"
#include "sphsolve/plan/plan.h"

#define WHY_WCSPH(...) snprintf(why, EFFECT_WHY, __VA_ARGS__)

static inline bool wcsph_frozen(const struct effect_context *context) {
  return context->scene->wcsph.wall == WALL_FROZEN;
}

static inline struct lattice_modes wcsph_modes_of(const struct effect_context *context) {
  const struct lattice *lattice = context->lattice;
  return lattice_modes_find(lattice->dimensions, lattice->spacing, context->smoothing_length);
}

static inline bool wcsph_body_force_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  if (context->driving > 0)
    WHY_WCSPH("force: %.4g m/s^2", context->driving);
  else
    WHY_WCSPH("no gravity, acceleration or pressure gradient");
  return context->driving > 0;
}

/* Monaghan (1992): a force moves a particle from rest by at most h/32 a step. */
static inline double wcsph_body_force_dt(const struct effect_context *context) {
  return 0.25 * sqrt(context->smoothing_length / context->driving);
}

static inline bool wcsph_frozen_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  WHY_WCSPH("wall = \"%s\"", wcsph_frozen(context) ? "frozen" : "adami or subvoxel");
  return wcsph_frozen(context);
}

static inline bool wcsph_continuity_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  WHY_WCSPH(wcsph_frozen(context) ? "wall = \"frozen\": densities are summed"
                                  : "walls are not frozen: nothing may pin particles to them");
  return !wcsph_frozen(context);
}

static inline bool wcsph_viscosity_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  WHY_WCSPH("viscosity %.4g m^2/s", context->kinematic_viscosity);
  return context->kinematic_viscosity > 0;
}

static inline double wcsph_viscosity_dt(const struct effect_context *context) {
  return 2 / (context->kinematic_viscosity * wcsph_modes_of(context).laplacian);
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
  WHY_WCSPH(!context->has_wall ? "no walls"
            : on               ? "chosen by wcsph.wall"
                               : "wcsph.wall is another");
  return on;
}
static inline bool wcsph_wall_frozen_wanted(const struct effect_context *context,
                                            char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_FROZEN, why);
}
static inline bool wcsph_wall_adami_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_ADAMI, why);
}
static inline bool wcsph_wall_subvoxel_wanted(const struct effect_context *context,
                                              char why[EFFECT_WHY]) {
  return wcsph_wall_wanted(context, WALL_SUBVOXEL, why);
}

static inline bool wcsph_wall_moving_wanted(const struct effect_context *context,
                                            char why[EFFECT_WHY]) {
  WHY_WCSPH(context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall && context->has_wall;
}

static inline bool wcsph_shifting_wanted(const struct effect_context *context,
                                         char why[EFFECT_WHY]) {
  enum switch_state chosen = context->scene->shifting;
  if (chosen != SWITCH_AUTO) {
    WHY_WCSPH("the scene says %s", chosen == SWITCH_ON ? "on" : "off");
    return chosen == SWITCH_ON;
  }
  const bool frozen = wcsph_frozen(context), stays = wcsph_stays(context, NULL);
  WHY_WCSPH(frozen  ? "summed densities keep particles apart as the paper has it"
            : stays ? "particles stay on their sites"
                    : "differences of pressure do not keep particles apart");
  return !frozen && !stays;
}

static inline bool wcsph_advection_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  return wcsph_stays(context, why);
}

/* See shifting.h. */
static inline double wcsph_shifting_dt(const struct effect_context *context) {
  return SHIFTING_STABLE / (SHIFTING_STRENGTH_LEAST * context->velocity_scale *
                            context->smoothing_length * wcsph_modes_of(context).crowding);
}

static const struct effect effect_body_force = {
    .name = "body_force",
    .model = "gravity, acceleration and mean pressure gradient, the same everywhere",
    .citation = "Saomoto et al. 2006, eq. 7",
    .methods = METHOD_BIT_WCSPH,
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_body_force_wanted,
    .dt_max = wcsph_body_force_dt};
static const struct effect effect_density_summation = {
    .name = "density_summation",
    .model = "density summed over fluid and grains, pressure c^2 (rho - rho_lattice) or c^2 rho",
    .citation = "Saomoto et al. 2006, eq. 6",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION),
    .writes = FIELD_BIT(DENSITY),
    .wanted = wcsph_frozen_wanted};
static const struct effect effect_pressure_symmetric = {
    .name = "pressure_symmetric",
    .model = "pressure force, symmetric in the pair",
    .citation = "Saomoto et al. 2006, eq. 7",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(DENSITY),
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_frozen_wanted,
    .dt_max = wcsph_pressure_dt};
static const struct effect effect_pressure_difference = {
    .name = "pressure_difference",
    .model = "pressure force from pressure differences, blind to the particle lattice",
    .citation = "Morris, Fox, Zhu 1997",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(PRESSURE),
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_continuity_wanted,
    .dt_max = wcsph_pressure_dt};
static const struct effect effect_density_continuity = {
    .name = "density_continuity",
    .model = "pressure from the divergence of the velocity",
    .citation = "Monaghan 1994, eq. 2.4",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(VELOCITY),
    .writes = FIELD_BIT(PRESSURE),
    .wanted = wcsph_continuity_wanted};
static const struct effect effect_pressure_diffusion = {
    .name = "pressure_diffusion",
    .model = "diffusion of pressure against checkerboards",
    .citation = "Molteni, Colagrossi 2009, eq. 9",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(PRESSURE),
    .writes = FIELD_BIT(PRESSURE),
    .wanted = wcsph_continuity_wanted};
static const struct effect effect_viscosity_morris = {.name = "viscosity_morris",
                                                      .model = "laminar viscosity",
                                                      .citation = "Morris, Fox, Zhu 1997, eq. 22",
                                                      .methods = METHOD_BIT_WCSPH,
                                                      .reads =
                                                          FIELD_BIT(POSITION) | FIELD_BIT(VELOCITY),
                                                      .writes = FIELD_BIT(VELOCITY),
                                                      .wanted = wcsph_viscosity_wanted,
                                                      .dt_max = wcsph_viscosity_dt};
static const struct effect effect_wall_frozen = {
    .name = "wall_frozen",
    .model = "grains are frozen fluid particles; every gap is one spacing too wide",
    .citation = "Saomoto et al. 2006",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(DENSITY),
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_wall_frozen_wanted};
static const struct effect effect_wall_adami = {
    .name = "wall_adami",
    .model = "dummy wall particles with extrapolated velocity and pressure",
    .citation = "Adami, Hu, Adams 2012, eqs. 23, 27",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(VELOCITY) | FIELD_BIT(PRESSURE),
    .writes = FIELD_BIT(IMAGE_VELOCITY),
    .wanted = wcsph_wall_adami_wanted};
static const struct effect effect_wall_subvoxel = {
    .name = "wall_subvoxel",
    .model = "no-slip at the true surface, second-order image velocity",
    .citation = "Morris, Fox, Zhu 1997, eq. 25; after Basa, Quinlan, Lastiwka 2009",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(VELOCITY) | FIELD_BIT(WALL_DISTANCE),
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_wall_subvoxel_wanted};
static const struct effect effect_wall_moving = {
    .name = "wall_moving",
    .model = "walls with a prescribed velocity in their own plane",
    .citation = "Morris, Fox, Zhu 1997, eq. 25",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(WALL_VELOCITY),
    .wanted = wcsph_wall_moving_wanted};
static const struct effect effect_advection = {
    .name = "advection",
    .model = "particles stay on their sites, the fluid flows past them",
    .citation = "Lind, Stansby 2016; Nasar et al. 2019",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(VELOCITY),
    .writes = FIELD_BIT(VELOCITY),
    .wanted = wcsph_advection_wanted};
static const struct effect effect_shifting = {
    .name = "shifting",
    .model = "particles are nudged to where they are fewer",
    .citation = "Lind et al. 2012, eq. 15; Sun et al. 2019, eq. 2",
    .methods = METHOD_BIT_WCSPH,
    .reads = FIELD_BIT(POSITION) | FIELD_BIT(SHIFT),
    .writes = FIELD_BIT(SHIFT) | FIELD_BIT(VELOCITY),
    .wanted = wcsph_shifting_wanted,
    .dt_max = wcsph_shifting_dt};

#undef WHY_WCSPH
#endif
