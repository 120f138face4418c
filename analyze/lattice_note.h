/* Which lattice's flow velocities are. Of a run that solved several, k is extrapolated from all of
 * them, but there is no flow of the limit: snapshots, distributions and pictures are the finest's. */
#ifndef TOSUI_ANALYZE_LATTICE_NOTE_H
#define TOSUI_ANALYZE_LATTICE_NOTE_H

#include <stdio.h>

#include "analyze/run_file.h"

/* k (m/s) of the lattice whose velocities a run left: its own where it solved but one. */
double lattice_note_k(const struct run *run);
/* "Velocities are of the finest lattice (8.7 um), k = 0.0311 cm/s; k from all lattices is 0.0299
 * cm/s", an end of a sentence without its full stop, between `before` and `after`; nothing where the
 * two are the same. */
void lattice_note_write(const struct run *run, const char *before, const char *after, FILE *stream);

#endif
