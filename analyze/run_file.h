/* A run that sphsolve left behind (OUT.hdf), read and checked. See docs/formats.md. */
#ifndef TOSUI_ANALYZE_RUN_FILE_H
#define TOSUI_ANALYZE_RUN_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"
#include "common/uncertainty_parts.h"
#include "common/hdf5_file.h"

/* One column of /history: values [rows][components]. */
struct history_column {
  char *name, *unit;
  size_t rows;
  int components; /* 1 or 3 */
  double *values;
};

/* k on each lattice of a run that solved several: arrays of `count`. */
struct run_levels {
  size_t count;
  double *spacing, *k, *iterations, *seconds; /* m, m/s, -, s of processor */
  double *estimate, *low, *high; /* m/s; relative, of resolution; NULL in files before 0.2 */
};

struct run {
  char *path;
  char *folder; /* of `path`, "" or ending in '/'; snapshot names are relative to it */
  char *title;  /* scene name, else the file's name without its ending */
  char *name;   /* the title, or the file's where several runs share it (runs_name_apart) */
  char *method, *status, *wall, *kernel;
  char *model_path;  /* "" without a model */
  char *model_file;  /* where the model that was run is found; "" if it is not */
  bool model_other;  /* files of that name are there, but none is the one that was run */
  uint64_t identity; /* equal for runs of the same geometry: model hash, else the sites' own hash */

  double driving[3];            /* m/s^2 */
  double direction[3];          /* unit vector along `driving`; zero where nothing drives */
  double hydraulic_gradient;    /* along the driving force; NAN where there is none */
  double density, viscosity;    /* kg/m^3, Pa s */
  double spacing[3], origin[3]; /* m, x y z; origin is the centre of site (0,0,0) */
  size_t size[3];
  bool mirrored[3]; /* the run mirrored its model along x, y, z */
  int dimensions;
  double bulk_count, fluid_count;
  double darcy_velocity[3]; /* as sphsolve found it; NAN if not stored */
  double k, k_error;        /* m/s; relative, of solver or averaging alone; NAN if not stored */
  double k_low, k_high, k_finest;   /* m/s: 95 % interval, finest lattice; NAN if not stored */
  double reynolds, predicted_error; /* relative, of resolution, as explain expects it; NAN */
  double wall_time, steps;          /* s; NAN if not stored */
  struct uncertainty_parts error;   /* of k, as sphsolve found them; NAN if not stored */
  char *resolution_needs;           /* "lattice", "model", "scan"; "" if not stored */

  struct run_levels levels; /* the lattices that the run solved; count 0: one */
  size_t column_count;
  struct history_column *columns;
  uint64_t flow_hash; /* of the last snapshot; 0: not known */
  size_t snapshot_count;
  char **snapshot_names;
  double *snapshot_times;
  uint8_t *solid; /* [z][y][x] or NULL */
};

/* Reads everything but the snapshots' particles. On failure the run is empty. */
enum status run_read(const char *path, struct run *run);
/* Runs of one scene name (a study that varied something else) are called by their files instead. */
enum status runs_name_apart(struct run *runs, size_t n);
void run_free(struct run *run);
/* Whether one is a copy of the other's file: the same numbers to the last bit, the measured time
 * included. */
bool run_is_copy(const struct run *a, const struct run *b);

/* Whether `path` is a model, or a snapshot, image or checkpoint beside a run, which a shell's
 * "*.hdf" names too. */
bool run_is_companion(const char *path);

/* Whether the run can have a k: something drives its flow, and `isph` found one (it has none where
 * a force only holds the water in a tank). */
bool run_has_permeability(const struct run *run);

/* Magnitude of the driving force by mass, m/s^2. */
double run_driving(const struct run *run);

/* The column of that name with that many components, or NULL. */
const struct history_column *run_column(const struct run *run, const char *name, int components);

/* Darcy velocity along the driving force (along the strongest component where nothing drives)
 * against time, in new memory (memory_free): rows of both. An input error without them. */
enum status run_darcy_series(const struct run *run, size_t *rows, double **times, double **values);

/* The last snapshot: points [count][3] (m), velocity [count][3] (m/s), density [count] (kg/m^3) and
 * pressure [count] (Pa; both NULL if not stored), all in new memory. */
struct particles {
  double time;
  size_t count;
  double *points, *velocity, *density, *pressure;
  double *micro_porosity; /* of soil with pores below the sites, 0 elsewhere; NULL: there is none */
};
enum status run_last_snapshot(const struct run *run, struct particles *particles);
void particles_free(struct particles *particles);

/* Runs in groups that may be compared: same geometry, fluid, method, wall and direction of the
 * driving force. `group` [n] gets 0.. in the order of appearance; returns how many. */
size_t runs_group(const struct run *runs, size_t n, size_t *group);
/* What the runs of a group share, for people: "dense (wcsph, frozen walls)". */
void run_group_name(const struct run *run, char *text, size_t size);

#endif
