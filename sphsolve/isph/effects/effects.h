/* What method isph is made of, and when a scene calls for it. Equations and sources stand in
 * effects/isph_*.h, beside the functions that compute them, and in docs/physics/isph.md. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_EFFECTS_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_EFFECTS_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"

#define WHY(...) snprintf(why, EFFECT_WHY, __VA_ARGS__)

static inline bool isph_always(const struct effect_context *context, char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  WHY("method isph; form %s", scene->isph.form == FORM_M15 ? "m15 (forces over eps)" : "akbari");
  return true;
}

static inline bool isph_relaxation_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  double alpha = context->scene->isph.alpha;
  if (isnan(alpha))
    WHY("tau = %g s", context->scene->isph.tau);
  else
    WHY("alpha = %g", alpha);
  return isnan(alpha) || alpha > 0;
}

static inline bool isph_surface_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  WHY(context->has_surface ? "the regions leave sites empty" : "the regions fill the domain");
  return context->has_surface;
}

/* 0: no soil; else counts porous regions that `property` holds for. */
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
    WHY("no porous region");
    return false;
  }
  size_t dry = 0;
  for (size_t i = 0; i < lattice->count; i++)
    dry += lattice->kind[i] == SITE_EMPTY && lattice->region != NULL && lattice->region[i] > 0 &&
           context->scene->regions[lattice->region[i] - 1].type == REGION_POROUS;
  if (dry > 0)
    WHY("porous regions; %zu of their sites start dry: no water region covers them", dry);
  else
    WHY("porous regions, full of water at the start");
  return true;
}

static inline double isph_linear_of(const struct region *region) {
  return region->alpha;
}
static inline double isph_forchheimer_of(const struct region *region) {
  return region->beta;
}
static inline double isph_motion_of(const struct region *region) {
  const double *v = region->soil_velocity;
  return fabs(v[0]) + fabs(v[1]) + fabs(v[2]);
}

static inline bool isph_linear_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_linear_of) && context->kinematic_viscosity > 0;
  WHY(on ? "soil with alpha > 0" : "no soil with alpha > 0");
  return on;
}

static inline bool isph_forchheimer_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_forchheimer_of);
  WHY(on ? "soil with beta > 0" : "no soil with beta > 0");
  return on;
}

static inline bool isph_soil_moving_wanted(const struct effect_context *context,
                                           char why[EFFECT_WHY]) {
  bool on = isph_any_soil(context->scene, isph_motion_of);
  WHY(on ? "a porous region has a velocity" : "no soil moves");
  return on;
}

static inline bool isph_turbulence_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  if (scene->turbulence != SWITCH_AUTO) {
    WHY("the scene says so");
    return scene->turbulence == SWITCH_ON;
  }
  bool on = context->has_surface && context->driving > 0 && scene->isph.smagorinsky > 0;
  WHY(on ? "free-surface flow under gravity; C_s = %g" : "no surface flow",
      scene->isph.smagorinsky);
  return on;
}

static inline bool isph_viscosity_wanted(const struct effect_context *context,
                                         char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  bool eddies = isph_turbulence_wanted(context, unused),
       on = context->kinematic_viscosity > 0 || eddies;
  WHY(on ? "nu = %g m^2/s%s" : "an ideal fluid", context->kinematic_viscosity,
      eddies ? " and eddies" : "");
  return on;
}

static inline double isph_viscosity_dt(const struct effect_context *context) {
  double least = 1;
  for (size_t k = 0; k < context->scene->region_count; k++)
    if (context->scene->regions[k].type == REGION_POROUS)
      least = fmin(least, context->scene->regions[k].porosity);
  (void)least; /* nu_E T = nu dt / C_r: soil only slows it */
  return 0.1 * context->spacing * context->spacing / fmax(context->kinematic_viscosity, 1e-300);
}

static inline bool isph_shifting_wanted(const struct effect_context *context,
                                        char why[EFFECT_WHY]) {
  enum switch_state state = context->scene->shifting;
  if (state != SWITCH_AUTO) {
    WHY(state == SWITCH_ON ? "the scene says so"
                           : "the scene says so; particles may clump where the water strains");
    return state == SWITCH_ON;
  }
  WHY("keeps particles evenly spread");
  return true;
}

static inline bool isph_calming_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool on = context->has_surface && context->driving > 0;
  WHY(on ? "a surface under gravity is never quite still without" : "no surface under gravity");
  return on;
}

/* Only where nothing but a steady force, the same at every place, can give the water energy. */
static inline bool isph_energy_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  const struct scene *scene = context->scene;
  bool round = false;
  for (int a = 0; a < 3; a++) round = round || (scene->periodic[a] && scene->driving[a] != 0);
  bool on = isph_calming_wanted(context, unused) && !context->has_inflow &&
            !context->has_moving_wall && !isph_any_soil(scene, isph_motion_of) && !round;
  WHY(on ? "a surface under a force, and nothing else drives the water"
         : "no surface under a force, or something else drives the water");
  return on;
}

/* Whether a wall of the given kind of slip is there. */
static inline bool isph_wall_kind(const struct effect_context *context, bool slip) {
  const struct scene *scene = context->scene;
  for (int a = 0; a < 3; a++)
    if (!scene->periodic[a] && scene->isph.slip == slip && (scene->dimensions == 3 || a != 1))
      return true;
  for (size_t k = 0; k < scene->region_count; k++)
    if (scene->regions[k].type == REGION_WALL && scene->regions[k].slip == slip) return true;
  return false;
}

static inline bool isph_no_slip_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  char unused[EFFECT_WHY];
  bool on = isph_wall_kind(context, false) && isph_viscosity_wanted(context, unused);
  WHY(on ? "closed sides or wall regions, not said to slip" : "no wall that holds the water");
  return on;
}

static inline bool isph_slip_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool on = isph_wall_kind(context, true);
  WHY(on ? "walls with slip = true" : "no wall with slip = true");
  return on;
}

static inline bool isph_moving_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  WHY(context->has_moving_wall ? "a wall region has a velocity" : "no wall moves");
  return context->has_moving_wall;
}

static inline bool isph_open_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  WHY(context->has_inflow ? "inflow regions" : "no inflow region");
  return context->has_inflow;
}

#define EFFECT_OF(symbol, wanted_function, dt_function, read_fields, write_fields, words, source)  \
  static const struct effect effect_##symbol = {.name = #symbol,                                   \
                                                .model = words,                                    \
                                                .citation = source,                                \
                                                .methods = METHOD_BIT_ISPH,                        \
                                                .reads = read_fields,                              \
                                                .writes = write_fields,                            \
                                                .wanted = wanted_function,                         \
                                                .dt_max = dt_function}

EFFECT_OF(isph_projection, isph_always, NULL, FIELD_BIT(POSITION),
          FIELD_BIT(VELOCITY) | FIELD_BIT(PRESSURE) | FIELD_BIT(MATRIX) | FIELD_BIT(SUPPORT) |
              FIELD_BIT(ID),
          "projection onto div v = 0 by a symmetric pressure equation",
          "Morimoto et al. 2015 (18)-(25), as corrected in docs/physics/isph.md");
EFFECT_OF(isph_relaxation, isph_relaxation_wanted, NULL, FIELD_BIT(VOLUME_FRACTION), 0,
          "density error fades with time tau", "Asai et al. 2012; Morimoto et al. 2015 (26)-(31)");
EFFECT_OF(isph_surface, isph_surface_wanted, NULL, FIELD_BIT(VOLUME_FRACTION),
          FIELD_BIT(SURFACE_FLAG), "P = 0 half a particle above the outermost",
          "after Nair, Tomar 2014");
EFFECT_OF(isph_porosity, isph_porosity_wanted, NULL, FIELD_BIT(POSITION),
          FIELD_BIT(POROSITY) | FIELD_BIT(SOIL), "porosity of boxes smoothed over the support",
          "Morimoto et al. 2015 section 4");
EFFECT_OF(isph_drag_linear, isph_linear_wanted, NULL, FIELD_BIT(POROSITY), FIELD_BIT(VELOCITY),
          "a = alpha nu (1-eps)^2 / (eps^3 D50^2), implicit", "Morimoto et al. 2015 (9c)");
EFFECT_OF(isph_drag_forchheimer, isph_forchheimer_wanted, NULL, FIELD_BIT(POROSITY),
          FIELD_BIT(VELOCITY), "b = beta (1-eps) / (eps^3 D50), Newton-linearised",
          "Morimoto et al. 2015 (9d)");
EFFECT_OF(isph_soil_moving, isph_soil_moving_wanted, NULL, FIELD_BIT(SOIL), FIELD_BIT(POROSITY),
          "soil boxes move and drag the water along", "Morimoto et al. 2015 section 4(1)");
EFFECT_OF(isph_viscosity, isph_viscosity_wanted, isph_viscosity_dt, FIELD_BIT(VELOCITY),
          FIELD_BIT(VELOCITY), "nu_E lap v, nu_E = (nu + nu_T)/eps", "Morimoto et al. 2015 (22)");
EFFECT_OF(isph_turbulence, isph_turbulence_wanted, NULL, FIELD_BIT(VELOCITY),
          FIELD_BIT(EDDY_VISCOSITY), "Smagorinsky, outside soil",
          "Smagorinsky 1963; Morimoto et al. 2015 (3)");
EFFECT_OF(isph_shifting, isph_shifting_wanted, NULL, FIELD_BIT(VELOCITY),
          FIELD_BIT(POSITION) | FIELD_BIT(SHIFT), "particles drift to where they are sparse",
          "Lind et al. 2012; Skillen et al. 2013");
EFFECT_OF(isph_calming, isph_calming_wanted, NULL, FIELD_BIT(VELOCITY), FIELD_BIT(VELOCITY),
          "a floor under the eddy viscosity, .08 r0 sqrt(|f| r0)", "docs/physics/isph.md");
EFFECT_OF(isph_energy, isph_energy_wanted, NULL, FIELD_BIT(VELOCITY),
          FIELD_BIT(VELOCITY) | FIELD_BIT(POSITION), "what a step lifts out of nothing is let down",
          "docs/physics/isph.md");
EFFECT_OF(isph_wall_no_slip, isph_no_slip_wanted, NULL, FIELD_BIT(VELOCITY),
          FIELD_BIT(IMAGE_VELOCITY), "mirrored images v_w + (v_w - v) d_w/d",
          "Takeda et al. 1994; Morris et al. 1997");
EFFECT_OF(isph_wall_slip, isph_slip_wanted, NULL, FIELD_BIT(VELOCITY), FIELD_BIT(IMAGE_VELOCITY),
          "mirrored images, normal velocity only", "Asai et al. 2013");
EFFECT_OF(isph_wall_moving, isph_moving_wanted, NULL, 0, FIELD_BIT(WALL_VELOCITY),
          "walls move with prescribed velocity", "Asai et al. 2013");
EFFECT_OF(isph_open_side, isph_open_wanted, NULL, FIELD_BIT(PRESSURE), FIELD_BIT(POSITION),
          "fixed head or flux on a side", "docs/physics/isph.md");

#undef WHY
#undef EFFECT_OF
#endif
