/* What a method is to the rest of the program: what it can do, when "auto" takes it, what it costs,
 * how good it is, and how it runs. One descriptor a method, in its folder; the table of them is
 * scene/methods.def. Nothing outside a method's folder asks which method it is: it asks the
 * descriptor. */
#ifndef TOSUI_SPHSOLVE_PLAN_METHOD_H
#define TOSUI_SPHSOLVE_PLAN_METHOD_H

#include "common/error.h"
#include "sphsolve/plan/effect.h"

struct lattice;
struct plan;
struct ranks_cost;
struct recorder;
struct run_result;

struct predicted_level;

struct method {
  const char *name;
  const struct effect *const
      *effects; /* in the order in which explain prints them, ended by NULL */

  /* The plan refuses what a method cannot do. One that resolves pores takes voxel models, and
   * domains with every site water or wall; one that does not takes soil, inflow and surfaces. */
  bool resolves_pores;
  bool marches;         /* in time, to any end_time; else it finds the steady flow at once */
  bool takes_soil;      /* sites of a model with pores below the voxel */
  bool solves_creeping; /* the steady flow without inertia; "auto" and advice use it for that */
  bool moves_walls;     /* from their place, not only along themselves */
  bool has_turbulence;  /* a model of it */
  int wall_layers;      /* of sites that it needs outside a closed domain */
  const char *const *fields; /* of snapshots that no other method has, ended by NULL; or NULL */

  /* Whether "auto" takes it for what the context says of the scene; `why` in words. Without a
   * lattice only what the scene itself holds is known. Velocity and Reynolds number are those of
   * the estimate of seepage. */
  bool (*takes)(const struct effect_context *context, char why[EFFECT_WHY]);
  /* Fills smoothing_length, support, sound_speed and velocity_scale of plan->context, before the
   * effects are asked. */
  enum status (*scales)(struct plan *plan);
  /* Fills dt, bytes, steps, seconds and error after them (dt_limit and dt_limited_by are the
   * effects' own by then). */
  enum status (*cost)(struct plan *plan, int threads);
  /* Bytes that a run on the plan's lattice holds at once for sure, where it comes to that only when
   * much is done. NULL: a run takes what it needs before it starts. */
  enum status (*bytes_least)(const struct plan *plan, double *bytes);
  /* The lattices that --error and --time would solve, coarsest first, `most` at most; their number.
   * NULL: the method chooses none. */
  int (*levels)(const struct plan *plan, int most, struct predicted_level *levels);
  /* What several ranks add to it. */
  void (*ranks_cost)(const struct plan *plan, int ranks, int threads, struct ranks_cost *cost);

  const char *(*wall_name)(const struct scene *scene); /* for the record of a run */
  /* Of one that resolves pores: its walls, and what its error has beside theirs (error_forecast.h).
   */
  enum wall_scheme (*wall)(const struct scene *scene);
  /* Of one that resolves pores: whether its water passes edges and corners of sites, too. NULL: no.
   */
  bool (*joins_corners)(const struct effect_context *context);
  double error_flat;          /* of k between parallel flat walls, where all else is exact */
  const char *error_flat_why; /* what is left there, in words */
  /* More flow in pores and past grains of few sites: times (slope of ln k per spacing)^order. */
  double error_narrow, error_narrow_order;
  double error_uneven; /* less flow, times (slope of ln k per spacing)^2 */

  /* Of one that works on a flow which is solved already (scene.flow_path) in place of a lattice;
   * all but its name, `takes` and effects is empty then. With `resume` from the last checkpoint, if
   * there is one. Results go to `prefix` and to stdout, as JSON or for people. NULL for the others.
   */
  enum status (*run_on_flow)(const struct scene *scene, const char *prefix, bool resume,
                             const char *command_line, bool json);
  enum status (*explain_on_flow)(const struct scene *scene, int threads, bool json);

  /* Run to the end (steady, end_time, or a signal). `result` is filled also when interrupted. The
   * lattice is afterwards what it was; meanwhile a method may set parts of it aside. */
  enum status (*run)(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                     struct recorder *recorder, struct run_result *result);
};

/* All methods in the order of the table, ended by NULL. */
extern const struct method *const methods_all[];

#endif
