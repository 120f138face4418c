/* A run of sphsolve (OUT.hdf), read and checked. See docs/formats.md. */
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

/* k on each lattice of a run that solved several; arrays of `count`. */
struct run_levels {
  size_t count;
  double *spacing, *k, *iterations, *seconds; /* m, m/s, -, s of processor time */
  /* Extrapolated k, m/s; its resolution error, relative; NULL in files of versions before 0.2. */
  double *estimate, *low, *high;
};

struct run {
  char *path;
  char *folder; /* of `path`, "" or ending with '/'; snapshot names are relative to it */
  char *title;  /* name of the scene, else the file's name without its ending */
  /* The title, or the file's name if several runs have the same title (runs_name_apart). */
  char *name;
  char *method, *status, *wall, *kernel;
  char *model_path;  /* "" without a model */
  char *model_file;  /* path of the model that was run; "" if it is not found */
  bool model_other;  /* files of that name exist, but none is the model that was run */
  uint64_t identity; /* equal for runs of the same geometry: hash of the model, else of the sites */

  double driving[3];            /* m/s^2 */
  double direction[3];          /* unit vector along `driving`; zero without a driving force */
  double hydraulic_gradient;    /* along the driving force; NAN without one */
  double density, viscosity;    /* kg/m^3, Pa s */
  double spacing[3], origin[3]; /* m, x y z; origin is the centre of site (0,0,0) */
  size_t size[3];
  bool mirrored[3]; /* the run mirrored its model along x, y, z */
  int dimensions;
  double bulk_count, fluid_count;
  double darcy_velocity[3]; /* as computed by sphsolve; NAN if not stored */
  double k, k_error;        /* m/s; relative, of solver or averaging only; NAN if not stored */
  /* m/s: 95 % interval, k of the finest lattice; NAN if not stored. */
  double k_low, k_high, k_finest;
  double k_low_image,
      k_high_image; /* m/s: of the image itself, not of its material; NAN likewise */
  /* Relative resolution error expected by explain; NAN if not stored. */
  double reynolds, predicted_error;
  double wall_time, steps;        /* s; NAN if not stored */
  struct uncertainty_parts error; /* of k, as computed by sphsolve; NAN if not stored */
  /* What would reduce the resolution error: "lattice", "model", "scan"; "" if not stored. */
  char *resolution_needs;

  struct run_levels levels; /* the lattices that the run solved; count 0 for a single one */
  size_t column_count;
  struct history_column *columns;
  uint64_t flow_hash; /* of the last snapshot; 0: unknown */
  size_t snapshot_count;
  char **snapshot_names;
  double *snapshot_times;
  uint8_t *solid; /* [z][y][x] or NULL */
};

/* Reads everything except the particles of snapshots. On failure the run is empty. */
enum status run_read(const char *path, struct run *run);
/* Names runs by their files if their scenes have the same name, as in a study that varied something
 * else. */
enum status runs_name_apart(struct run *runs, size_t n);
void run_free(struct run *run);
/* Whether one file is a copy of the other: bitwise the same numbers, including the measured
 * time. */
bool run_is_copy(const struct run *a, const struct run *b);

/* Whether `path` is a model, or a snapshot, image or checkpoint of a run, to which a shell's
 * "*.hdf" also expands. */
bool run_is_companion(const char *path);

/* Whether the run can have a k: its flow is driven and, for methods that know soil as such, a k was
 * found (there is none if gravity only holds the water in a tank). */
bool run_has_permeability(const struct run *run);

/* Magnitude of the driving force per mass, m/s^2. */
double run_driving(const struct run *run);

/* The column with that name and number of components, or NULL. */
const struct history_column *run_column(const struct run *run, const char *name, int components);

/* Darcy velocity along the driving force (without one, along the largest component) against time,
 * in new memory (memory_free); `rows` of both. An input error if they are missing. */
enum status run_darcy_series(const struct run *run, size_t *rows, double **times, double **values);

/* The last snapshot: points [count][3] (m), velocity [count][3] (m/s), density [count] (kg/m^3) and
 * pressure [count] (Pa; the last two NULL if not stored), all in new memory. */
struct particles {
  double time;
  size_t count;
  double *points, *velocity, *density, *pressure;
  /* Of soil with pores below the site size, 0 elsewhere; NULL without such soil. */
  double *micro_porosity;
};
enum status run_last_snapshot(const struct run *run, struct particles *particles);
void particles_free(struct particles *particles);

/* Groups comparable runs: same geometry, fluid, method, wall and direction of the driving force.
 * `group` [n] is numbered from 0 in the order of appearance; returns the number of groups. */
size_t runs_group(const struct run *runs, size_t n, size_t *group);
/* Text that describes a group: "dense (wcsph, frozen walls)". */
void run_group_name(const struct run *run, char *text, size_t size);

#endif
