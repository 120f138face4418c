/* Everything a run leaves behind: history, snapshots, run record, checkpoints, progress line. A
 * method calls it; it knows no method. Output files are PREFIX.hdf, PREFIX-NNNN.hdf,
 * PREFIX.hdf.series, PREFIX.ckpt.hdf, and PREFIX.history.csv until PREFIX.hdf is there. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_RECORDER_H
#define TOSUI_SPHSOLVE_OUTPUT_RECORDER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "common/snapshot_file.h"
#include "sphsolve/output/uncertainty.h"
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

/* How a run ended; fills stdout's JSON and /run. */
struct run_result {
  const char *status;       /* "steady", "end_time", "converged", "budget", "blocked", "crystal",
                               "interrupted", "failed" */
  const char *ended;        /* why short of the error asked for, in words; NULL */
  double k;                 /* m/s, v/i along the force; NAN where there is none */
  double k_finest;          /* m/s, of the finest lattice alone; NAN: k itself */
  double k_error;           /* relative, of averaging, steadiness or residual; NAN unknown */
  struct uncertainty error; /* what k_error and the rest is made of */
  const char *finer_by;     /* what makes the lattice of this run finer: an option or a key */
  double intrinsic_permeability; /* m^2 */
  double darcy_velocity[3];
  double hydraulic_gradient[3]; /* between two heads, over the length of soil; 0 without */
  double reynolds;
  int64_t steps;
  bool iterates; /* steps are iterations of a solver, not steps in time */
  double wall_time;
  double pair_interactions;            /* directed pairs, once for each equation they enter */
  double pair_interactions_per_second; /* over the time in pair loops */
  struct conservation conservation;
  struct micropores micropores; /* sites 0: the model has no soil */
  const struct tensor *tensor;  /* of the run that completes it; NULL */
};

/* Opens the record of a run to PREFIX; `scene`, `plan` and `lattice` must outlive it. With `resume`
 * an earlier run is gone on with (recorder_resume). A usage error where an output would replace an
 * input. Free with recorder_close. */
enum status recorder_open(const char *prefix, const struct scene *scene, const struct plan *plan,
                          const struct lattice *lattice, const char *command_line, bool resume,
                          struct recorder **recorder);
void recorder_close(struct recorder *recorder);

/* Registers a further column of the history before the first row. */
enum status recorder_add_column(struct recorder *recorder, const char *name, const char *unit,
                                int components);
/* Appends a row, in memory and in PREFIX.history.csv; `extra` holds the values of the added
 * columns, in the order of registration. */
enum status recorder_row(struct recorder *recorder, const struct history_row *row,
                         const double *extra);
/* Takes the last row back. */
enum status recorder_drop_row(struct recorder *recorder);
/* Mean of the rows' Darcy velocity over times from .. to, s; NAN where there is no row. */
void recorder_mean_velocity(const struct recorder *recorder, double from, double to,
                            double velocity[3]);
/* The same of a column of one component, registered under that name. */
double recorder_mean(const struct recorder *recorder, const char *name, double from, double to);
/* The 95 % error of such a mean of a column along `direction` (of one component: its factor first),
 * by batch means, in its unit; NAN of fewer rows than four. */
enum status recorder_sampling(const struct recorder *recorder, const char *name,
                              const double direction[3], double from, double to, double *error95);
/* Interval of history rows the scene asks for, s; NAN: the method chooses. */
double recorder_row_interval(const struct recorder *recorder);
/* Time of the next snapshot due by output.interval (INFINITY: none; the last is always written). */
double recorder_next_snapshot(const struct recorder *recorder);

/* Writes PREFIX-NNNN.hdf and the series. Fields that output.fields does not name are left out. */
enum status recorder_snapshot(struct recorder *recorder, double time, int64_t step, size_t count,
                              const struct snapshot_field *points, size_t field_count,
                              const struct snapshot_field *fields);

/* PREFIX-image.hdf: the fluid sites' fields on the whole lattice (image.h); nothing on several
 * ranks, or with output.image = false. */
enum status recorder_image(struct recorder *recorder, const struct lattice *lattice, double time,
                           int64_t step, size_t count, const uint64_t *site, const float *velocity,
                           const float *pressure);

/* Forgets rows and snapshots after `time`: the march goes back to it. */
enum status recorder_go_back(struct recorder *recorder, double time);
struct step_log *recorder_step_log(struct recorder *recorder);
/* PREFIX.ckpt.hdf, for messages. */
const char *recorder_checkpoint_name(struct recorder *recorder);

/* The live line: done in 0..1. */
void recorder_progress(struct recorder *recorder, double done, const char *note);

/* True after SIGINT or SIGTERM: the method writes a checkpoint and returns STATUS_INTERRUPTED. */
bool recorder_interrupted(const struct recorder *recorder);

/* Checkpoints, due by wall time or after a signal. The method writes its state under /state of
 * *file, then commits; the recorder adds its own. On resume recorder_resume gives the newest valid
 * checkpoint (NULL: none, start anew) and has taken its own part of it. */
bool recorder_checkpoint_due(const struct recorder *recorder);
enum status recorder_checkpoint_begin(struct recorder *recorder, struct h5_file **file);
enum status recorder_checkpoint_commit(struct recorder *recorder, struct h5_file *file);
enum status recorder_resume(struct recorder *recorder, struct h5_file **file);

/* Seconds spent per effect or pass, for /run/timing and /run/effects; names may be effects. */
void recorder_add_time(struct recorder *recorder, const char *name, double seconds);
/* A fact for /run as an attribute ("residual", "iterations", ...). Overwrites. */
void recorder_set_fact(struct recorder *recorder, const char *name, double value);

/* What was measured and differs from run to run, s or bytes, as an attribute of /run/timing.
 * Overwrites. */
void recorder_set_measured(struct recorder *recorder, const char *name, double value);

/* What the ranks have sent each other so far, as facts; nothing in a build without MPI. */
void recorder_count_traffic(struct recorder *recorder);

/* Completes the conservation budget from the history and writes the whole PREFIX.hdf (atomically).
 * Where it does not fit, the snapshot that stands alone beside it goes too, unless --resume needs
 * it. */
enum status recorder_finish(struct recorder *recorder, struct run_result *result);

/* Darcy velocity along the driving force -> k = v/i and intrinsic permeability v nu / driving. */
void result_from_darcy(const struct scene *scene, const double darcy_velocity[3],
                       struct run_result *result);

#endif
