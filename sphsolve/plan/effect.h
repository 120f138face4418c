/* An effect is one term of one equation, switched on by what a scene contains.
 *
 * One file per effect, effects/NAME.h: the equation and its source above, its pair or per-particle
 * function (static inline, so that a loop specialised for a set of effects compiles it in), its
 * descriptor `effect_NAME` below. effects.def lists them in the order of evaluation and is the only
 * registry. A loop that uses the pair function includes the file; nothing else knows of it. */
#ifndef TOSUI_SPHSOLVE_PLAN_EFFECT_H
#define TOSUI_SPHSOLVE_PLAN_EFFECT_H

#include <stdbool.h>
#include <stddef.h>

#include "sphsolve/scene/scene.h"

#define METHOD_BIT_WCSPH 1u
#define METHOD_BIT_STOKES 2u
#define METHOD_BIT_ISPH 4u

/* Fields of a particle or site. The plan allocates the union of what its effects name. */
#define FIELD_LIST                                                                                 \
  X(POSITION, "position")                                                                          \
  X(VELOCITY, "velocity")                                                                          \
  X(DENSITY, "density")                                                                            \
  X(PRESSURE, "pressure")                                                                          \
  X(ACCELERATION, "acceleration")                                                                  \
  X(WALL_DISTANCE, "wall_distance")                                                                \
  X(WALL_VELOCITY, "wall_velocity")                                                                \
  X(IMAGE_VELOCITY, "image_velocity")                                                              \
  X(POROSITY, "porosity")                                                                          \
  X(EDDY_VISCOSITY, "eddy_viscosity")                                                              \
  X(SURFACE_FLAG, "surface_flag")                                                                  \
  X(SHIFT, "shift")                                                                                \
  X(SUPPORT, "support")                                                                            \
  X(MATRIX, "matrix")                                                                              \
  X(VOLUME_FRACTION, "volume_fraction")                                                            \
  X(SOIL, "soil")                                                                                  \
  X(ID, "id")
enum field {
#define X(symbol, text) FIELD_##symbol,
  FIELD_LIST
#undef X
      FIELD_COUNT
};
#define FIELD_BIT(symbol) (1ull << FIELD_##symbol)

#define EFFECT_WHY 160

struct effect_context; /* scene, lattice and scales; plan.h */

struct effect {
  const char *name;                 /* "viscosity_morris" */
  const char *model;                /* one line for people: what it is */
  const char *citation;             /* author, year, equation */
  unsigned methods;                 /* METHOD_BIT_* */
  unsigned long long reads, writes; /* FIELD_BIT_* */
  /* Whether the scene calls for it; `why` says so in words, for on and for off. Pure. */
  bool (*wanted)(const struct effect_context *context, char why[EFFECT_WHY]);
  /* Largest stable time step, s; NULL: no limit of its own. */
  double (*dt_max)(const struct effect_context *context);
};

#endif
