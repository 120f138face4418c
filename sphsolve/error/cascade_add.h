/* The lattices of a cascade one after the other: each solved k is added to the estimate, with the
 * other parts of its error; checkpoints between them. */
#ifndef TOSUI_SPHSOLVE_ERROR_CASCADE_ADD_H
#define TOSUI_SPHSOLVE_ERROR_CASCADE_ADD_H

#include "sphsolve/error/cascade.h"

/* Adds the solved k of a lattice to the estimate. `seconds`: processor time of the solve. The
 * solution is not changed. */
enum status cascade_add(struct cascade *cascade, const struct lattice *lattice, double spacing,
                        struct stokes_solver *solver, double seconds);
/* Goes on to the next lattice: on this one no site of a wall is left, and it has no k. */
void cascade_skip(struct cascade *cascade);
/* To be called after the last lattice. Computes the effect of the sides if a time limit was given
 * (it takes as long as several coarse lattices, which are solved first), and the effect of the scan
 * if the third lattice was the last. */
enum status cascade_finish(struct cascade *cascade);
/* Write and read a checkpoint. `solved`: the checkpoint holds the completed solution of the last
 * lattice added, and a run that resumes adds that lattice again; otherwise the solution is of a
 * lattice not yet added. */
enum status cascade_write(const struct cascade *cascade, bool solved, struct h5_file *file);
enum status cascade_read(struct cascade *cascade, struct h5_file *file);

/* Error of resolution of a run whose k was computed differently, by another method or with other
 * walls: lattices up to `base` are solved with subvoxel walls. `found`: intrinsic permeability of
 * the run, m^2. Fills *u. */
enum status cascade_measure(const struct scene *scene, const struct plan *plan,
                            const struct lattice *base, double found, struct uncertainty *u);

#endif
