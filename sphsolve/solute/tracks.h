/* Ways of the tracked walkers, for ParaView. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_TRACKS_H
#define TOSUI_SPHSOLVE_SOLUTE_TRACKS_H

#include "sphsolve/solute/volumes.h"
#include "sphsolve/solute/walk.h"

#define TRACKS_TIMES 256 /* at most: of longer walks every second time, every third ... */

/* A VTKHDF UnstructuredGrid with a line a walker, in the box that repeats without end (m), with
 * `time` (s) and `id` at each point. `record`: after walk_record_write, its places in m;
 * `interval`: s between two of them. The rest: of provenance_write. */
enum status tracks_write(const char *path, const struct solute_flow *flow,
                         const struct walk_record *record, double interval,
                         const char *command_line, size_t inputs, const char *const *input,
                         const uint64_t *hashes);

#endif
