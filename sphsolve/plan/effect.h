/* An effect is one term of one equation, switched on by what a scene contains.
 *
 * One file per effect, METHOD/effects/NAME.h: the equation and its source above, then its pair or
 * per-particle function (static inline, so that a loop specialised for a set of effects compiles it
 * in), when a scene calls for it and why, its limit of the time step; and, behind the include
 * guard, its descriptor, EFFECT(name, .model = ..., ...). One line in METHOD/effects/registry.def
 * registers it. A loop that uses its function includes the file. An effect with a `force` needs no
 * loop of the method: the method calls it for all particles at once, in each step. Files that pair
 * loops include keep what is for the plan behind #ifdef EFFECTS (effects.c defines it), so that a
 * change of the plan does not compile the pair loops again. */
#ifndef TOSUI_SPHSOLVE_PLAN_EFFECT_H
#define TOSUI_SPHSOLVE_PLAN_EFFECT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "sphsolve/scene/scene.h"

#define EFFECT_WHY 160

struct effect_context; /* scene, lattice and scales; plan.h */

struct effect {
  const char *name;     /* "viscosity_morris" */
  const char *model;    /* one line for people: what it is */
  const char *citation; /* author, year, equation */
  /* Whether the scene calls for it; `why` says so in words, for on and for off. Pure. */
  bool (*wanted)(const struct effect_context *context, char why[EFFECT_WHY]);
  /* Largest stable time step, s; NULL: no limit of its own. */
  double (*dt_max)(const struct effect_context *context);
  const char *limit;  /* what that limit is called; NULL: as the effect */
  int dt_power;       /* of the spacing, that it falls with */
  bool dt_accuracy;   /* it is one of accuracy: a dt that the scene gives may pass it */
  size_t switches_on; /* EFFECT_SWITCH(struct, member): a flag of its method's state; 0: none */
  uint32_t budget;    /* its terms of the conservation budget, 1u << term (output/conservation.h) */
  double operations;  /* vector operations a pair in its method's force loop */
  bool at_walls;      /* of pairs with walls alone */
  /* The accelerations that it gives, m/s^2, from the method's state at the start of a step (isph:
   * struct isph, wcsph: struct engine); NULL: a loop of the method computes it. Such an effect has
   * a term of its own in the budget, of its name. */
  void (*force)(const void *state, double (*acceleration)[3]);
  /* Likewise the pressure that it adds outside a free surface, Pa, at the particles on it. */
  void (*surface_pressure)(void *state, double *pressure);
  bool drives; /* it moves fluid that nothing else drives */
};

#define EFFECT_SWITCH(type, member) (offsetof(type, member) + 1)

/* Defined by plan/effect_list.h where a method lists its effects; elsewhere nothing. */
#ifndef EFFECT
#define EFFECT(name, ...)
#endif

#endif
