/* The interface of a method: its capabilities, when "auto" selects it, its cost and accuracy, and
 * how it runs. Each method has one descriptor, in its folder; scene/methods.def is the table of
 * them. Code outside a method's folder never asks which method it is, but uses the descriptor. */
#ifndef TOSUI_SPHSOLVE_PLAN_METHOD_H
#define TOSUI_SPHSOLVE_PLAN_METHOD_H

#include "common/error.h"
#include "sphsolve/plan/effect.h"

struct constant;
struct lattice;
struct plan;
struct recorder;
struct run_result;

struct predicted_level;

struct method {
  const char *name;
  const struct effect *const *effects; /* in the order of `explain`, ended by NULL */
  const struct constant *constants;    /* its constants.def, for the run file; NULL: none */

  /* Capabilities; the plan rejects scenes that a method cannot solve. A method that resolves pores
   * takes voxel models, and domains whose sites are all water or wall; one that does not takes
   * soil, inflow and free surfaces. */
  bool resolves_pores;
  bool marches;    /* integrates in time to any end_time; otherwise it solves the steady flow */
  bool takes_soil; /* takes models with pores smaller than the voxel */
  /* Solves the steady flow without inertia; "auto" and advice use it for that. */
  bool solves_creeping;
  bool moves_walls;          /* walls may be displaced, not only move along themselves */
  bool has_turbulence;       /* it has a turbulence model */
  int wall_layers;           /* layers of wall sites that it needs outside a closed domain */
  bool walls_need_sites;     /* it knows no walls between sites: thin_wall_fill makes them sites */
  const char *const *fields; /* snapshot fields of this method alone, ended by NULL; or NULL */

  /* Whether "auto" selects it for the scene described by `context`; `why` receives the reason.
   * Without a lattice only the scene itself is known. Velocity and Reynolds number are those of the
   * seepage estimate. */
  bool (*takes)(const struct effect_context *context, char why[EFFECT_WHY]);
  /* Sets smoothing_length, support, sound_speed and velocity_scale of plan->context, before the
   * effects are evaluated. */
  enum status (*scales)(struct plan *plan);
  /* Sets dt, bytes, steps, seconds and error after the effects (which have set dt_limit and
   * dt_limited_by). */
  enum status (*cost)(struct plan *plan, int threads);
  /* Bytes that a run on the plan's lattice is certain to hold at once, if it reaches that only late
   * in the run. NULL: a run allocates its memory before it starts. */
  enum status (*bytes_least)(const struct plan *plan, double *bytes);
  /* Lists the lattices that --error and --time would solve, coarsest first, `most` at most; returns
   * their number. NULL: the method has no such choice. */
  int (*levels)(const struct plan *plan, int most, struct predicted_level *levels);
  const char *(*wall_name)(const struct scene *scene); /* for the run record */
  /* For methods that resolve pores: sets shape and expected_scan of the plan, before the scales. */
  enum status (*expect)(struct plan *plan);
  /* For methods that resolve pores: the wall scheme, and the parts of the error of k that do not
   * depend on it (error/error_forecast.h). */
  enum wall_scheme (*wall)(const struct scene *scene);
  /* For methods that resolve pores: whether water also flows across edges and corners of sites.
   * NULL: no. */
  bool (*joins_corners)(const struct effect_context *context);
  double error_flat;          /* error of k between parallel flat walls, where all else is exact */
  const char *error_flat_why; /* the remaining error in words */
  /* Excess flow in pores and around grains of few sites: factor of (slope of ln k per
   * spacing)^order. */
  double error_narrow, error_narrow_order;
  double error_uneven; /* reduced flow: factor of (slope of ln k per spacing)^2 */

  /* For a method that works on a flow that is already solved (scene.flow_path) instead of a
   * lattice: it sets only its name, `takes` and effects. With `resume` it continues from the last
   * checkpoint, if there is one. Results go to `prefix` and to stdout, as text or as JSON. NULL for
   * other methods. */
  enum status (*run_on_flow)(const struct scene *scene, const char *prefix, bool resume,
                             const char *command_line, bool json);
  enum status (*explain_on_flow)(const struct scene *scene, int threads, bool json);

  /* Runs to the end (steady state, end_time, or a signal). `result` is also filled after an
   * interruption. The lattice is unchanged afterwards; during the run a method may move parts of it
   * to disk. */
  enum status (*run)(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                     struct recorder *recorder, struct run_result *result);
};

/* All methods in the order of the table, ended by NULL. */
extern const struct method *const methods_all[];

#endif
