/* What the error of k is made of, found by solving creeping flow on lattices made from the run's:
 * coarser ones for the resolution, one whose surface is moved for the void ratio. */
#ifndef TOSUI_SPHSOLVE_STOKES_ERROR_BUDGET_H
#define TOSUI_SPHSOLVE_STOKES_ERROR_BUDGET_H

#include <stdbool.h>

#include "common/error.h"
#include "common/hdf5_file.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene.h"

/* Relative parts, 95 % half widths where they are statistical; NAN: unknown. */
struct error_split {
  double resolution; /* grid convergence index of subvoxel walls at spacings h, 1.5 h and 2 h; of
                      * other walls joined by their distance from the extrapolated value */
  double averaging;  /* over time, by batch means; 0 for a steady method */
  double steadiness; /* change still to come, or what the solver left */
  double void_ratio; /* the model's void ratio off the measured one */
  double threshold;  /* the threshold's uncertainty, from that of the measured void ratio */

  double order;            /* observed; NAN: not seen */
  bool order_credible;     /* within half the formal order of it */
  int levels;              /* spacings that gave a flow, 0: not tried */
  double extrapolated;     /* intrinsic permeability at spacing 0, m^2 */
  double slope_void_ratio; /* d ln k / d e, measured; NAN: not tried */
  double
      slope_threshold; /* d ln k / d T per grey level: the same over dT/de of the model's sweep */
};

/* All parts unknown. */
struct error_split error_split_none(void);
/* Root of the sum of squares of the known parts; NAN if none is. */
double error_split_total(const struct error_split *split);

/* Fills resolution, void_ratio, threshold and what stands with them. `permeability` (m^2) is that
 * of the lattice with the run's walls by method stokes; NAN: it is solved for. Nothing is done, and
 * all stays unknown, where nothing drives a flow past resting walls. */
enum status error_split_measure(const struct scene *scene, const struct plan *plan,
                                const struct lattice *lattice, double permeability, double found,
                                struct error_split *split);

/* As attributes of /run/error. */
enum status error_split_write(const struct error_split *split, struct h5_file *file);

/* Processor seconds of the measuring, predicted; 0 where nothing is done. */
double error_split_seconds(const struct scene *scene, const struct plan *plan);

#endif
