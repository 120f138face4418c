/* The parts of the error of k. Methods and the cascade of lattices set them; the record, stdout and
 * the report show them. */
#ifndef TOSUI_SPHSOLVE_ERROR_UNCERTAINTY_H
#define TOSUI_SPHSOLVE_ERROR_UNCERTAINTY_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"
#include "common/uncertainty_parts.h"
#include "common/hdf5_file.h"

#define ERROR_LEVELS_MAX 24

/* What reduces the resolution error; a finer lattice does not help beyond the resolution of the
 * model's voxels. */
enum resolution_needs { NEEDS_LATTICE, NEEDS_MODEL, NEEDS_SCAN };
extern const char *const resolution_needs_names[]; /* "lattice", "model", "scan" */

/* One lattice of a cascade. */
struct error_level {
  double spacing;      /* m, geometric mean of the axes */
  double permeability; /* m^2, along the force */
  double estimate;     /* m^2, from this level and all coarser ones */
  /* Relative resolution error of the estimate: k (1 - low) .. k (1 + high). */
  double low, high;
  double slope_blur;     /* slope_blur (below) on this lattice; NAN: not computed */
  double critical;       /* critical_width (below) on this lattice */
  double sites, seconds; /* number of sites; processor seconds including set-up */
  double iterations;     /* of the solver, a whole number */
};

/* The parts (common/uncertainty_parts.h), and details of the resolution error; NAN: unknown. */
struct uncertainty {
  union {
    struct {
      UNCERTAINTY_PARTS_MEMBERS
    };
    struct uncertainty_parts parts;
  };

  double resolution_low, resolution_high; /* the true value lies in k (1 - low) .. k (1 + high) */
  double model; /* part of the resolution error due to the model's voxels */
  /* Part of it due to the width, in spacings, of the narrowest way that the flow has to take. */
  double critical_width;
  enum resolution_needs needs;
  double order;        /* observed order of convergence; NAN: unknown */
  double extrapolated; /* intrinsic permeability, best estimate, m^2 */
  double finest;       /* that of the finest lattice */
  double slope_blur;   /* change of ln k by additional blur of the surface; NAN: not computed */
  int level_count;     /* lattices that were solved; 0: none */
  struct error_level levels[ERROR_LEVELS_MAX]; /* coarsest first */
};

/* All parts unknown. */
struct uncertainty uncertainty_none(void);
/* Lower and upper total error: root of the sum of squares of the known parts; NAN if none is
 * known. */
void uncertainty_total(const struct uncertainty *u, double *low, double *high);
/* The same without the part of the sides: the error of k of this very image, to be compared with
 * another program's on it, and not of the material of which it is a sample. */
void uncertainty_of_image(const struct uncertainty *u, double *low, double *high);
/* The larger of both total errors. */
double uncertainty_largest(const struct uncertainty *u);

/* Writes the parts as attributes of /run/error, and /run/levels with k in m/s; `to_speed`: factor
 * from m^2 to m/s. */
enum status uncertainty_write(const struct uncertainty *u, double to_speed, struct h5_file *file);

/* For a terminal, during a cascade: draws the estimate of the last lattice and its error bar,
 * relative to k of the first lattice: "0.97 s | --o-- | 0.0299 cm/s"; the seconds are those of all
 * lattices so far. `to_speed`: factor from m^2 to m/s; `columns`: width of the bar, 56 at most. */
void level_bar_draw(const struct uncertainty *uncertainty, double to_speed, int columns, char *text,
                    size_t size);
/* The same on stderr, if that is a terminal, with the width of the terminal. */
void level_bar_show(const struct uncertainty *uncertainty, double to_speed);

#endif
