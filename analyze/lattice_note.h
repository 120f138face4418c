/* Note on the lattice to which velocities belong. If a run solved several lattices k is
 * extrapolated from all of them, but snapshots, distributions and pictures are of the finest
 * lattice. */
#ifndef TOSUI_ANALYZE_LATTICE_NOTE_H
#define TOSUI_ANALYZE_LATTICE_NOTE_H

#include <stdio.h>

#include "analyze/run_file.h"

/* k (m/s) of the finest lattice, to which the velocities belong, or of the only one. */
double lattice_note_k(const struct run *run);
/* What velocities are multiplied by to carry the flow of k: 1 where both are of one lattice. */
double lattice_note_scale(const struct run *run);
/* Writes "Velocities are of the finest lattice (8.7 um), k = 0.0311 cm/s; k from all lattices is
 * 0.0299 cm/s", without a full stop, between `before` and `after`; nothing if the two are equal. */
void lattice_note_write(const struct run *run, const char *before, const char *after, FILE *stream);

#endif
