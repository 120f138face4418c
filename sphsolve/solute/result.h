/* Results of method solute, and their output. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_RESULT_H
#define TOSUI_SPHSOLVE_SOLUTE_RESULT_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/solute/volumes.h"
#include "sphsolve/solute/walk.h"

/* Estimate by one method at one Peclet number: coefficients over the molecular diffusion
 * coefficient. Errors are relative, 95 %, NAN where unknown. */
struct solute_estimate {
  double longitudinal, transverse;
  double longitudinal_error, transverse_error;
};

/* Result of the closure problem at one Peclet number. */
struct solute_closed {
  struct solute_estimate value;
  double tensor[3][3];                         /* D* / D along x, y, z, extrapolated */
  double resolution[2], projection[2], solver; /* parts of the errors, longitudinal, transverse */
  double sample[2], repeats[2]; /* due to the sample's size; not in the errors (sample_size.h) */
  int iterations;
  double seconds; /* processor time */
};

/* Result of the random walk at one Peclet number. */
struct solute_walked {
  struct solute_estimate value;
  double statistics[2], asymptotics[2], resolution[2]; /* parts of the errors, as above */
  bool settled; /* statistics and asymptotics are within the wanted error */
  double seconds, steps, walkers;
};

struct solute_result {
  const char *status; /* "converged"; "steps": a walk reached its step limit before the tolerance */
  double length;      /* m, length in the Peclet number */
  double diffusion;   /* m^2/s; NAN: only ratios are known */
  int count;
  double peclet[SOLUTE_PECLET_MAX];
  bool by_closure;
  struct solute_closed closure[SOLUTE_PECLET_MAX];
  bool by_walk;
  double wanted; /* wanted relative error of a walk */
  struct solute_walked walk[SOLUTE_PECLET_MAX];
  struct walk_record *record;                     /* [count] of the walks; not owned */
  struct solute_estimate best[SOLUTE_PECLET_MAX]; /* the reported values */
  /* Conduction through the pores: the formation factor F = 1 / (porosity D* / D) along the flow,
   * its relative error, and D / D*, often called the diffusive tortuosity. */
  double formation, formation_error, formation_sample, tortuosity;
  double correlation[2]; /* correlation lengths of the velocity, along and across the flow, m */
  double wall_time;
};

/* Writes PREFIX.hdf: /run, /solute, /provenance, and PREFIX-tracks-N.hdf of walks
 * (docs/formats.md). */
enum status solute_result_write(const struct scene *scene, const struct solute_flow *flow,
                                const struct solute_result *result, const char *prefix,
                                const char *command_line);
/* Prints the result to stdout: one JSON object, or a readable table. */
enum status solute_result_print_json(const struct scene *scene, const struct solute_flow *flow,
                                     const struct solute_result *result);
void solute_result_print(const struct scene *scene, const struct solute_flow *flow,
                         const struct solute_result *result, const char *prefix);

#endif
