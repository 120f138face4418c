/* What the error of k is made of. Methods and the cascade of lattices fill it; the record, stdout
 * and the report show it. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_UNCERTAINTY_H
#define TOSUI_SPHSOLVE_OUTPUT_UNCERTAINTY_H

#include <stdbool.h>

#include "common/error.h"
#include "common/uncertainty_parts.h"
#include "common/hdf5_file.h"

#define ERROR_LEVELS_MAX 24

/* What lessens the error of resolution: past a model's own voxels no lattice does. */
enum resolution_needs { NEEDS_LATTICE, NEEDS_MODEL, NEEDS_SCAN };
extern const char *const resolution_needs_names[]; /* "lattice", "model", "scan" */

/* One lattice of a cascade. */
struct error_level {
  double spacing;        /* m, geometric mean of the axes */
  double permeability;   /* m^2, along the force */
  double estimate;       /* m^2, from this level and all before it */
  double low, high;      /* relative, of the estimate's resolution: k (1 - low) .. k (1 + high) */
  double slope_blur;     /* slope_blur below, as this lattice has it; NAN: not tried */
  double sites, seconds; /* lattice sites; processor seconds with set-up */
  long iterations;
};

/* The parts (common/uncertainty_parts.h), and what the resolution's is made of; NAN: unknown. */
struct uncertainty {
  union {
    struct {
      UNCERTAINTY_PARTS_MEMBERS
    };
    struct uncertainty_parts parts;
  };

  double resolution_low, resolution_high; /* the truth lies in k (1 - low) .. k (1 + high) */
  double model; /* the part of resolution that the model's own voxels have */
  enum resolution_needs needs;
  double order;        /* observed; NAN: not seen */
  double extrapolated; /* intrinsic permeability, best estimate, m^2 */
  double finest;       /* and that of the finest lattice */
  double slope_blur;   /* ln k of the surface blurred once more, less ln k; NAN: not tried */
  int level_count;     /* lattices that gave a flow; 0: not tried */
  struct error_level levels[ERROR_LEVELS_MAX]; /* coarsest first */
};

/* All parts unknown. */
struct uncertainty uncertainty_none(void);
/* Roots of the sums of squares of the known parts, down and up; NAN if none is known. */
void uncertainty_total(const struct uncertainty *u, double *low, double *high);
/* The larger of the two. */
double uncertainty_largest(const struct uncertainty *u);

/* As attributes of /run/error, and /run/levels with k in m/s, by that factor from m^2. */
enum status uncertainty_write(const struct uncertainty *u, double to_speed, struct h5_file *file);

#endif
