/* Tracks of selected walkers, for ParaView. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_TRACKS_H
#define TOSUI_SPHSOLVE_SOLUTE_TRACKS_H

#include "sphsolve/solute/volumes.h"
#include "sphsolve/solute/walk.h"

#define TRACKS_TIMES 256 /* most times written: of longer walks every second, third, ... */

/* Writes a VTKHDF UnstructuredGrid with one line per walker, in the unwrapped periodic box (m),
 * with `time` (s) and `id` at each point. `record`: after walk_record_write, its positions in m;
 * `interval`: s between two of them. The other arguments: those of provenance_write. */
enum status tracks_write(const char *path, const struct solute_flow *flow,
                         const struct walk_record *record, double interval,
                         const char *command_line, size_t inputs, const char *const *input,
                         const uint64_t *hashes);

#endif
