/* What numbers of runs belong together: runs of different models are not combined unless the user
 * says so, and velocities belong to one lattice of a run. */
#ifndef TOSUI_ANALYZE_COMPATIBLE_RUNS_H
#define TOSUI_ANALYZE_COMPATIBLE_RUNS_H

#include <stdbool.h>
#include <stdio.h>

#include "analyze/run_file.h"

/* An input error that names the models and their runs if there is more than one model; with
 * `allowed` an information instead. With `levels` the same body at different spacings counts as one
 * model. */
enum status compatible_runs_check(const struct run *runs, size_t n, bool levels, bool allowed);

/* Whether a and b have the same body: equal size but for rounding to sites. If not, *axis is an
 * axis on which they differ. */
bool compatible_runs_same_body(const struct run *a, const struct run *b, int *axis);

/* Whether a and b have the same model; `levels` as above. */
bool compatible_runs_same_model(const struct run *a, const struct run *b, bool levels);

/* Note on the lattice to which velocities belong. If a run solved several lattices k is
 * extrapolated from all of them, but snapshots, distributions and pictures are of the finest
 * lattice. */

/* k (m/s) of the finest lattice, to which the velocities belong, or of the only one. */
double lattice_note_k(const struct run *run);
/* What velocities are multiplied by to carry the flow of k: 1 where both are of one lattice. */
double lattice_note_scale(const struct run *run);
/* Writes "Velocities are of the finest lattice (8.7 um), k = 0.0311 cm/s; k from all lattices is
 * 0.0299 cm/s", without a full stop, between `before` and `after`; nothing if the two are equal. */
void lattice_note_write(const struct run *run, const char *before, const char *after, FILE *stream);

#endif
