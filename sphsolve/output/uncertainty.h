/* What the error of k is made of. Methods and the cascade of lattices fill it; the record, stdout
 * and the report show it. */
#ifndef TOSUI_SPHSOLVE_OUTPUT_UNCERTAINTY_H
#define TOSUI_SPHSOLVE_OUTPUT_UNCERTAINTY_H

#include <stdbool.h>

#include "common/error.h"
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
  double sites, seconds; /* lattice sites; processor seconds with set-up */
  long iterations;
};

/* Relative parts, 95 % half widths where they are statistical; NAN: unknown or of no concern. */
struct uncertainty {
  double resolution; /* of the estimate from all lattices; the larger of low and high */
  double scan;       /* what the scanner's blur and noise did */
  double sides;      /* how the sample's sides are closed */
  double void_ratio; /* the model's void ratio off the measured one */
  double threshold;  /* the threshold's uncertainty, from that of the measured void ratio */
  double averaging;  /* over time, by batch means; 0 for a steady method */
  double steadiness; /* change still to come, or what the solver left */

  double resolution_low, resolution_high; /* the truth lies in k (1 - low) .. k (1 + high) */
  double model; /* the part of resolution that the model's own voxels have */
  enum resolution_needs needs;
  double sides_closed;     /* ln k in a tube that the sample fills, less ln k; NAN: not tried */
  double order;            /* observed; NAN: not seen */
  double extrapolated;     /* intrinsic permeability, best estimate, m^2 */
  double finest;           /* and that of the finest lattice */
  double slope_void_ratio; /* d ln k / d e, solved; NAN: not tried */
  double slope_blur;       /* ln k of the surface blurred once more, less ln k; NAN: not tried */
  double slope_threshold;  /* d ln k / d T per grey level: the same over dT/de of the sweep */
  int level_count;         /* lattices that gave a flow; 0: not tried */
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
