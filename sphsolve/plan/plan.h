/* What a scene calls for, decided before anything is allocated: method, effects on and why, memory,
 * time step and the effect that limits it, steps, predicted time and error. A pure function of
 * scene and lattice; `explain` prints it and run obeys it. */
#ifndef TOSUI_SPHSOLVE_PLAN_PLAN_H
#define TOSUI_SPHSOLVE_PLAN_PLAN_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/plan/effect.h"
#include "sphsolve/plan/error_forecast.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

#define EFFECT_MAX 40

/* The program with its libraries: peak memory and time of a scene of a few sites. */
#define PROGRAM_BYTES 16e6
/* What files hold while they are written, and the allocator between its blocks: of runs of 64 to
 * 240 MB the machine's count was 3 to 6 % of theirs above it. */
#define HELD_BESIDE 0.065
/* What reading a model takes a voxel: its solid, wall distance and grain fraction; then the first
 * two twice, in the file's form and the lattice's; then the lattice and the labels of its pores. */
#define MODEL_BYTES 10.0
#define PROGRAM_SECONDS 0.02

/* What an effect may look at to decide. The numbers are those of the chosen method. */
struct effect_context {
  const struct scene *scene;
  const struct lattice *lattice;
  const struct method *method; /* NULL while one is looked for */
  enum kernel kernel;
  double smoothing_length;    /* m */
  double support;             /* m */
  double spacing;             /* m, geometric mean */
  double sound_speed;         /* m/s, wcsph */
  double kinematic_viscosity; /* m^2/s */
  double driving;             /* |g + a - grad P / rho|, m/s^2 */
  double velocity_scale;      /* m/s, estimated */
  double reynolds;            /* estimated from Kozeny-Carman and Ergun; 0 unknown */
  double inertia;             /* fraction of the force that inertia takes up, by the same */
  char sound_why[EFFECT_WHY]; /* what decides the sound speed */
  bool has_porous, has_surface, has_wall, has_moving_wall, has_inflow, has_rain, has_absorbing;
};

struct planned_effect {
  const struct effect *effect;
  bool on;
  char why[EFFECT_WHY];
  double dt_max; /* s; INFINITY: none */
};

/* What the user asks k to be or to cost; 0: not asked. */
struct accuracy_goal {
  double error;   /* relative */
  double seconds; /* wall time */
};

/* A lattice that --error or --time would solve. */
struct predicted_level {
  double spacing; /* m */
  double sites;
  double error;   /* relative, of k from all lattices up to this, as a run will state it */
  bool few;       /* too few lattices for --error to end with; --time may */
  double seconds; /* processor time of all up to this, and more where plan.seconds_sides has it */
  double seconds_sides;
  double bytes;   /* at most until it is solved, with what the program itself takes */
};
#define PREDICTED_LEVELS_MAX 24

struct plan {
  struct accuracy_goal goal; /* set after the plan is made */
  int threads;
  struct effect_context context;
  size_t effect_count;
  struct planned_effect effects[EFFECT_MAX]; /* those of the method, on and off */
  double dt;                                 /* s; NAN: chosen each step; 0: steady method */
  double dt_limit;                           /* s */
  const char *dt_limited_by;
  int dt_power;                   /* of the spacing, that dt_limit falls with; 0: not known */
  const char *dt_by;              /* what decides a constant dt */
  double bytes_fluid, bytes_wall; /* per fluid and per wall site, everything included */
  double bytes_total;             /* at most, at any time, with what the program itself takes */
  /* The method's own; what a state to go back to takes beside it while one is kept; and, when the
   * method has given back all it held, what splits the error of k. On disk: what a run may keep
   * beside its results while it lasts. */
  double bytes_method, bytes_copy, bytes_split, bytes_disk;
  struct pore_shape shape;
  double steps, seconds;          /* predicted */
  /* Where the effect of the sides is large, as no forecast knows: seconds more, at most; bytes in
   * all, in place of bytes_total, or 0: no more than that. */
  double seconds_sides, bytes_sides;
  struct error_forecast expected; /* error of the headline number */
  bool blocked;                   /* no pore leads through (plan_look_for_path): k is 0 */
  double expected_scan;           /* what the scanner adds to it; NAN: not known */
  char method_why[EFFECT_WHY];
};

/* Wall layers the lattice needs outside a closed domain, as far as the scene alone tells. */
int plan_wall_layers(const struct scene *scene);
/* Chooses the method ("auto") and refuses what a method cannot do. */
enum status plan_method(const struct scene *scene, const struct lattice *lattice,
                        const struct method **method, char why[EFFECT_WHY]);
/* `threads` for the predicted time. */
enum status plan_make(const struct scene *scene, const struct lattice *lattice,
                      const struct method *method, const char *method_why, int threads,
                      struct plan *plan);
/* Sets plan->blocked, as a run will find it, by following the pores; no time or error is expected
 * then. */
enum status plan_look_for_path(struct plan *plan);
/* What scene and lattice (may be NULL: not built yet) hold, and nothing of a method. */
void plan_context(const struct scene *scene, const struct lattice *lattice,
                  struct effect_context *context);
/* Fills velocity_scale, inertia and reynolds. */
void plan_estimate_seepage(struct effect_context *context);
/* The terms of the conservation budget that the effects on have, 1u << term. */
uint32_t plan_budget(const struct plan *plan);
/* Sets in a method's settings the flags that its effects switch on (EFFECT_SWITCH), and clears
 * those of effects that are off. */
void plan_switch(const struct plan *plan, void *settings);

#endif
