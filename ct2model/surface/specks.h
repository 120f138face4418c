/* Islands of a few voxels in a slab of a scan. */
#ifndef TOSUI_CT2MODEL_SURFACE_SPECKS_H
#define TOSUI_CT2MODEL_SURFACE_SPECKS_H

#include <stddef.h>
#include <stdint.h>

/* The largest island that may be asked for. */
enum { SPECK_MOST = 64 };

/* field[z][y][x], grain where it is positive, and bits[z][y][word] as phase_row makes them: islands
 * (voxels joined by faces) of under `limit` voxels, at most SPECK_MOST, change sign; first those of
 * pore, then those of grain. x and y are periodic; what touches the first or last slice is let be.
 * `scratch` is twice as large as `bits`. Returns how many voxels were changed. */
size_t specks_remove(int16_t *field, uint64_t *bits, const size_t size[3], size_t limit,
                     uint64_t *scratch);

#endif
