/* The plan of a run, made before anything is allocated: method, effects and the reasons for them,
 * memory, time step and the effect that limits it, steps, predicted time and error. It depends only
 * on scene and lattice; `explain` prints it, and the run follows it. */
#ifndef TOSUI_SPHSOLVE_PLAN_PLAN_H
#define TOSUI_SPHSOLVE_PLAN_PLAN_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/effect.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene.h"

#define EFFECT_MAX 40

/* Input for the decisions of effects. The numbers are those of the chosen method. */
struct effect_context {
  const struct scene *scene;
  const struct lattice *lattice;
  const struct method *method; /* NULL while a method is being chosen */
  enum kernel kernel;
  double smoothing_length;    /* m */
  double support;             /* m */
  double spacing;             /* m, geometric mean */
  double sound_speed;         /* m/s, wcsph */
  double kinematic_viscosity; /* m^2/s */
  double driving;             /* |g + a - grad P / rho|, m/s^2 */
  double velocity_scale;      /* m/s, estimated */
  double reynolds;            /* estimated from Kozeny-Carman and Ergun; 0: unknown */
  double surface_reynolds;    /* of free water, at most; isph */
  double inertia;             /* fraction of the force balanced by inertia, likewise */
  char sound_why[EFFECT_WHY]; /* what decides the sound speed */
  bool has_porous, has_surface, has_wall, has_moving_wall, has_inflow, has_rain, has_absorbing;
};

struct planned_effect {
  const struct effect *effect;
  bool on;
  char why[EFFECT_WHY];
  double dt_max; /* s; INFINITY: none */
};

/* The shape of the pores. Lengths are in spacings; without walls they are infinite and the slope is
 * 0. */
struct pore_shape {
  double width; /* mean pore width, 4 V / S of the pores */
  double open;  /* the same without the pore volume filled by soil */
  double
      throat;  /* critical width along the force (geometry/throat_width.h); infinite without one */
  double ways; /* mean pores side by side in a plane across the force */
  int dimensions;
  double grain;  /* mean thickness, 2 V / S of the grains; infinite between boxes */
  double slope;  /* d ln k if all walls recede by one spacing, after Kozeny and Carman */
  double outer;  /* mean depth of the wall sites next to fluid behind the surface */
  double middle; /* mean depth of the midpoint of these pairs of sites (< 0: in the fluid) */
  bool sharp;    /* walls are boxes or voxel faces */
  bool straight; /* and has hardly any edges: ducts */
  bool flat;     /* and all normal to one axis: slits */
};

/* Expected |k/k_exact - 1|. Where two parts of opposite sign may cancel, `error` is the root of the
 * sum of their squares, and `least` the smallest possible remainder, or 0 if they have similar
 * size: the error then passes through zero, and only the range is meaningful. Otherwise both are
 * equal. */
struct error_forecast {
  double error, least; /* NAN: no walls */
  double pores;        /* error without the part of the narrowest way */
  char why[EFFECT_WHY];
};

/* The accuracy or run time that the user requests; 0: not requested. */
struct accuracy_goal {
  double error;   /* relative */
  double seconds; /* wall time */
};

/* A lattice that --error or --time would solve. */
struct predicted_level {
  double spacing; /* m */
  double sites;
  double error;   /* relative error of k from all lattices up to this one, as a run reports it */
  bool few;       /* too few lattices to finish with --error; enough for --time */
  double seconds; /* processor time of all lattices up to this one */
  /* Additional processor time if the effect of the sides is large (see struct plan). */
  double seconds_sides;
  double bytes; /* largest memory up to its solution, including the program itself */
};
#define PREDICTED_LEVELS_MAX 24

struct plan {
  struct accuracy_goal goal; /* set after the plan is made */
  int threads;
  struct effect_context context;
  size_t effect_count;
  struct planned_effect effects[EFFECT_MAX]; /* all effects of the method, on or off */
  double dt;                                 /* s; NAN: chosen each step; 0: steady method */
  double dt_limit;                           /* s */
  const char *dt_limited_by;
  int dt_power;                   /* power of the spacing in dt_limit; 0: unknown */
  const char *dt_by;              /* what decides a constant dt */
  double bytes_fluid, bytes_wall; /* per fluid and per wall site, everything included */
  double bytes_total;             /* largest total memory, including the program itself */
  /* Memory of the method itself; of a stored state to return to; of the separation of the error of
   * k, after the method has freed its memory; and disk space for temporary files next to the
   * results during a run. */
  double bytes_method, bytes_copy, bytes_split, bytes_disk;
  struct pore_shape shape;
  double steps, seconds; /* predicted */
  /* If the effect of the sides is large, which cannot be predicted: additional seconds at most;
   * total bytes in place of bytes_total, or 0 if that is not exceeded. */
  double seconds_sides, bytes_sides;
  struct error_forecast expected; /* error of the main result */
  bool blocked;                   /* no pore leads through the model (plan_find_path): k is 0 */
  double expected_scan;           /* additional error due to the scanner; NAN: unknown */
  double expected_threshold;      /* that due to the void ratio and the threshold of the model */
  char method_why[EFFECT_WHY];
};

/* Wall layers that the lattice needs outside a closed domain, from the scene alone. */
int plan_wall_layers(const struct scene *scene);
/* Chooses the method ("auto") and rejects a scene that the method cannot solve. */
enum status plan_method(const struct scene *scene, const struct lattice *lattice,
                        const struct method **method, char why[EFFECT_WHY]);
/* Makes the plan; `threads` is used for the predicted time. */
enum status plan_make(const struct scene *scene, const struct lattice *lattice,
                      const struct method *method, const char *method_why, int threads,
                      struct plan *plan);
/* Sets plan->blocked by following the pores as a run does; time and error are then NAN. */
enum status plan_find_path(struct plan *plan);
/* Sets what follows from scene and lattice (NULL if not built yet), without a method. */
void plan_context(const struct scene *scene, const struct lattice *lattice,
                  struct effect_context *context);
/* Sets velocity_scale, inertia and reynolds. */
void plan_estimate_seepage(struct effect_context *context);
/* Terms of the conservation budget of all effects that are on, 1u << term. */
uint32_t plan_budget(const struct plan *plan);
/* Sets the flags of a method's settings that its effects switch on (EFFECT_SWITCH), and clears
 * those of effects that are off. */
void plan_switch(const struct plan *plan, void *settings);

#endif
