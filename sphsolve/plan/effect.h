/* An effect is one term of one equation, switched on by the contents of a scene.
 *
 * Each effect has one file, METHOD/effects/NAME.h. It contains the equation and its source; the
 * pair or per-particle function (static inline, so that loops specialised for a set of effects can
 * inline it); when a scene needs the effect and why; its limit of the time step; and, after the
 * include guard, its descriptor, EFFECT(name, .model = ..., ...). One line in
 * METHOD/effects/registry.def registers it. A loop that uses its function includes the file. An
 * effect with a `force` needs no loop of the method: the method calls it once per step for all
 * particles, as it does the hooks below. Files included by pair loops keep the parts needed only by
 * the plan behind #ifdef EFFECTS (defined in effects.c), so that a change of the plan does not
 * recompile the pair loops. */
#ifndef TOSUI_SPHSOLVE_PLAN_EFFECT_H
#define TOSUI_SPHSOLVE_PLAN_EFFECT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

#define EFFECT_WHY 160

struct effect_context; /* scene, lattice and scales; plan.h */
struct history_columns;

/* A number of its own that each particle has: it is sorted, goes to other ranks with the particle,
 * and stands in checkpoints and snapshots. 0 at first. */
struct effect_field {
  const char *name, *unit, *text;
};

/* The row of a particle in the pressure equation: sums so far, to which an effect adds. `tied`: the
 * part of the diagonal that fixes the pressure. `passed`: a source that an effect takes itself. */
struct effect_row {
  double diagonal, source, tied, passed;
};

struct effect {
  const char *name;     /* "viscosity_morris" */
  const char *model;    /* description in one line */
  const char *citation; /* author, year, equation */
  /* Whether the scene needs it; `why` receives the reason, whether on or off. No side effects. */
  bool (*wanted)(const struct effect_context *context, char why[EFFECT_WHY]);
  /* Largest stable time step, s; NULL: no limit. */
  double (*dt_max)(const struct effect_context *context);
  const char *limit;  /* name of that limit; NULL: the effect's name */
  int dt_power;       /* power of the spacing in this limit */
  bool dt_accuracy;   /* a limit of accuracy, which a dt given by the scene may exceed */
  size_t switches_on; /* EFFECT_SWITCH(struct, member): a flag of its method's state; 0: none */
  uint32_t budget;    /* its terms in the conservation budget, 1u << term (output/conservation.h) */
  /* Its accelerations, m/s^2, from the method's state at the start of a step (isph: struct isph,
   * wcsph: struct engine); NULL: a loop of the method computes them. Such an effect has its own
   * term in the budget, with its name. */
  void (*force)(const void *state, double (*acceleration)[3]);
  /* Likewise its additional pressure outside a free surface, Pa, at the particles on the
   * surface. */
  void (*surface_pressure)(void *state, double *pressure);
  bool drives; /* it can drive a flow by itself */

  /* Of methods that move particles (isph), all NULL where nothing is to be done. Returns an error
   * for scenes that the effect cannot solve correctly; asked whether it is on or not. */
  enum status (*refuse)(const struct effect_context *context);
  const struct effect_field *fields; /* ends with a field without a name */
  /* Numbers that it keeps from step to step, so many for each of the `things(scene)` that it is
   * about, in checkpoints as /state/NUMBERS_0, ... */
  const char *numbers;
  int numbers_each;
  size_t (*things)(const struct scene *scene);
  /* In the order of a step of length dt (s), with the state of the method; collective. */
  enum status (*start)(void *state, double dt);     /* once, with the water at rest in its place */
  enum status (*begin)(void *state, double dt);     /* before the forces */
  enum status (*predicted)(void *state, double dt); /* v* is known */
  enum status (*mobile)(void *state, double dt);    /* and mobilities, those of other ranks too */
  void (*row)(void *state, size_t i, struct effect_row *row); /* of particle i; not collective */
  enum status (*solved)(void *state, double dt);              /* after each solve that counts */
  bool (*changes)(void *state); /* whether the pressure changes its rows: a solve is repeated */
  enum status (*corrected)(void *state, double dt); /* velocities are final */
  enum status (*arrive)(void *state, double dt);    /* the water has moved; adds particles */
  enum status (*moved)(void *state, double dt);     /* what else moves */
  enum status (*settled)(void *state, double dt);   /* sorted, with porosities of the new places */
  double (*stable_dt)(const void *state);           /* limit by the present state, s */
  void (*columns)(struct history_columns *columns, const void *state);
};

#define EFFECT_SWITCH(type, member) (offsetof(type, member) + 1)

/* plan/effect_list.h defines it where a method lists its effects; elsewhere it is empty. */
#ifndef EFFECT
#define EFFECT(name, ...)
#endif

#endif
