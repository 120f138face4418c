/* Removes islands of a few voxels from a slab of a scan. */
#ifndef TOSUI_CT2MODEL_SURFACE_SPECKS_H
#define TOSUI_CT2MODEL_SURFACE_SPECKS_H

#include <stddef.h>
#include <stdint.h>

/* Largest `limit` that may be given. */
enum { SPECK_MOST = 64 };

/* field[z][y][x] is positive in grain, and bits[z][y][word] are as from phase_row. Islands (voxels
 * joined by faces) of fewer than `limit` voxels, at most SPECK_MOST, change sign: first those of
 * pore, then those of grain. x and y are periodic; islands that touch the first or the last slice
 * are kept. `scratch` is twice as large as `bits`. Returns the number of changed voxels. */
size_t specks_remove(int16_t *field, uint64_t *bits, const size_t size[3], size_t limit,
                     uint64_t *scratch);

#endif
