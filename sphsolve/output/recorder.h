/* All output of a run: history, snapshots, run record, checkpoints, progress line. Methods call it;
 * it does not depend on any method. Output files are PREFIX.hdf, PREFIX-NNNN.hdf,
 * PREFIX.hdf.series, PREFIX.ckpt.hdf, and PREFIX.history.csv until PREFIX.hdf is written. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_RECORDER_H
#define TOSUI_SPHSOLVE_OUTPUT_RECORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/snapshot_file.h"
#include "sphsolve/error/uncertainty.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/output/conservation.h"
#include "sphsolve/output/micropores.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/output/step_log.h"

struct recorder;
struct tensor;

struct history_row {
  double time;
  int64_t step;
  double dt;
  double darcy_velocity[3]; /* m/s: sum over fluid / bulk sites, or volume integral / bulk volume */
  double density_max, density_mean; /* kg/m^3 */
  double kinetic_energy;            /* J */
  double momentum[3];               /* kg m/s */
  double mass;                      /* kg */
  double reynolds;
};

/* Result of a run, for the JSON on stdout and /run. */
struct run_result {
  const char *status; /* "steady", "end_time", "converged", "budget", "blocked", "crystal",
                         "interrupted", "failed" */
  const char *ended;  /* why the requested error was not reached, in words; NULL */
  double k;           /* m/s, v/i along the force; NAN if undefined */
  double gradient;    /* hydraulic gradient of the run; 0: not said */
  double inertia_from_gradient; /* gradient from which inertia lowers k; NAN: unknown */
  double k_finest;              /* m/s, of the finest lattice alone; NAN: same as k */
  double k_error;               /* relative, from averaging, steadiness or residual; NAN: unknown */
  struct uncertainty error;     /* parts of the error of k */
  const char *finer_by;         /* option or key that makes the lattice of this run finer */
  double intrinsic_permeability; /* m^2 */
  double darcy_velocity[3];
  double hydraulic_gradient[3]; /* between two heads, divided by the length of soil; else 0 */
  double reynolds;
  int64_t steps;
  bool iterates; /* steps are iterations of a solver, not time steps */
  double wall_time;
  double pair_interactions;            /* directed pairs, counted for each equation they enter */
  double pair_interactions_per_second; /* per time spent in pair loops */
  struct conservation conservation;
  struct micropores micropores; /* sites 0: the model has no soil */
  const struct tensor *tensor;  /* set in the run that completes it; else NULL */
};

/* Opens the record of a run to PREFIX; `scene`, `plan` and `lattice` must outlive it. `resume`
 * continues an earlier run (recorder_resume). Returns a usage error if an output would replace an
 * input. Free with recorder_close. */
enum status recorder_open(const char *prefix, const struct scene *scene, const struct plan *plan,
                          const struct lattice *lattice, const char *command_line, bool resume,
                          struct recorder **recorder);
void recorder_close(struct recorder *recorder);

/* Adds a column to the history, before the first row. */
enum status recorder_add_column(struct recorder *recorder, const char *name, const char *unit,
                                int components);
/* Values per row of the added columns. */
size_t recorder_extra_width(const struct recorder *recorder);
/* Appends a row, in memory and in PREFIX.history.csv; `extra` contains the values of the added
 * columns in the order of registration. */
enum status recorder_row(struct recorder *recorder, const struct history_row *row,
                         const double *extra);
/* Removes the last row. */
enum status recorder_drop_row(struct recorder *recorder);
/* Interval of history rows requested by the scene, s; NAN: the method chooses. */
double recorder_row_interval(const struct recorder *recorder);
/* Time of the next snapshot by output.interval (INFINITY: none; the final one is always
 * written). */
double recorder_next_snapshot(const struct recorder *recorder);

/* Writes PREFIX-NNNN.hdf and the series. Fields not in output.fields are omitted. */
enum status recorder_snapshot(struct recorder *recorder, double time, int64_t step, size_t count,
                              const struct snapshot_field *points, size_t field_count,
                              const struct snapshot_field *fields);

/* Writes PREFIX-image.hdf: the fields of the fluid sites on the whole lattice (image.h). Does
 * nothing on several ranks, or with output.image = false. */
enum status recorder_image(struct recorder *recorder, const struct lattice *lattice, double time,
                           int64_t step, size_t count, const uint64_t *site, const float *velocity,
                           const float *pressure);

/* Removes rows and snapshots after `time`, to which the time integration returns. */
enum status recorder_go_back(struct recorder *recorder, double time);
struct step_log *recorder_step_log(struct recorder *recorder);
/* Name of PREFIX.ckpt.hdf, for messages. */
const char *recorder_checkpoint_name(struct recorder *recorder);

/* Updates the progress line; `done` from 0 to 1. */
void recorder_progress(struct recorder *recorder, double done, const char *note);

/* True after SIGINT or SIGTERM: the method writes a checkpoint and returns STATUS_INTERRUPTED. */
bool recorder_interrupted(const struct recorder *recorder);

/* Checkpoints are due by wall time or after a signal. The method writes its state under /state of
 * *file and then commits; the recorder adds its own state. On resume, recorder_resume returns the
 * newest valid checkpoint (NULL: none, start from the beginning) and has restored the recorder's
 * state. */
bool recorder_checkpoint_due(const struct recorder *recorder);
enum status recorder_checkpoint_begin(struct recorder *recorder, struct h5_file **file);
enum status recorder_checkpoint_commit(struct recorder *recorder, struct h5_file *file);
enum status recorder_resume(struct recorder *recorder, struct h5_file **file);

/* Adds seconds spent in an effect or pass `name`, for /run/timing. */
void recorder_add_time(struct recorder *recorder, const char *name, double seconds);
/* Sets an attribute of /run ("residual", "iterations", ...); replaces an earlier value. */
void recorder_set_fact(struct recorder *recorder, const char *name, double value);

/* Sets an attribute of /run/timing, s or bytes, that varies from run to run; replaces an earlier
 * value. */
void recorder_set_measured(struct recorder *recorder, const char *name, double value);

/* Records the communication between ranks so far; does nothing in a build without MPI. */
void recorder_count_traffic(struct recorder *recorder);

/* Completes the conservation budget from the history and writes PREFIX.hdf (atomically). If this
 * fails, a single snapshot without its run record is removed, too, unless --resume needs it. */
enum status recorder_finish(struct recorder *recorder, struct run_result *result);

/* k = v/i along the driving force and intrinsic permeability v nu / driving, from the Darcy
 * velocity. */
void result_from_darcy(const struct scene *scene, const double darcy_velocity[3],
                       struct run_result *result);

#endif
