/* The parts of the error of k beside the resolution's: each from solves of their own, on lattices
 * that differ from those of the cascade in what the part is about. */
#ifndef TOSUI_SPHSOLVE_STOKES_CASCADE_PARTS_H
#define TOSUI_SPHSOLVE_STOKES_CASCADE_PARTS_H

#include "sphsolve/stokes/cascade/cascade.h"

/* When such a solve is good enough. */
extern const struct stokes_goal cascade_part_goal;

/* Intrinsic permeability along the force, m^2. */
double cascade_permeability(const struct stokes_solver *solver);
/* Intrinsic permeability (m^2) of a lattice of its own; 0 where nothing flows, NAN where the
 * solver fails: a part of the error is then unknown, with a warning, and the run goes on, but after
 * a signal. Of several processes, one that fails in the middle of a solve cannot, as the others
 * wait for it; so they ask first whether memory is there. `from`: where it starts; with `keep` the
 * cascade keeps the solution. */
enum status cascade_solve(struct cascade *cascade, const struct lattice *lattice,
                          const struct stokes_solver *from, const struct stokes_goal *goal,
                          bool keep, double *k);
/* Whether the sides are left to the end, as a time was asked for. */
bool cascade_sides_wait(const struct cascade *cascade);
/* The change of k when pores that end at a side, or at the first or last layer where those do not
 * fit, go on into their own image there, not into whatever lies opposite; and what a tube would do.
 * All on one coarse lattice. */
enum status cascade_add_sides(struct cascade *cascade);
/* What k owes to the void ratio, and to the model's voxels: solved on a lattice of the cascade. */
enum status cascade_add_model_parts(struct cascade *cascade, const struct lattice *lattice,
                                    double spacing, double k, const struct stokes_solver *from);
/* Whether the share of the scan is solved for on the last lattice; and whether it will be on the
 * next, as it still grew from one to the next. */
bool cascade_scan_is_due(const struct cascade *cascade);
bool cascade_scan_grows(const struct cascade *cascade);
/* What k owes to the scanner: the surface is blurred once more. */
enum status cascade_add_scan_part(struct cascade *cascade, const struct lattice *lattice, double k,
                                  const struct stokes_solver *from);

#endif
