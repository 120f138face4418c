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

/* The phases of a row of voxels as bits: 1 grain, 0 pore; 0 also after the end of the row. */

enum { PHASE_WORD = 64 };

/* Number of words for a row of n voxels. */
size_t phase_words(size_t n);
/* Bits of n values, which are grain where they are positive. */
void phase_row(const int16_t *values, size_t n, uint64_t *bits);
/* Bits of the neighbours at x + 1 (`next`) and x - 1 (`last`), periodic. */
void phase_next(const uint64_t *bits, size_t n, uint64_t *next);
void phase_last(const uint64_t *bits, size_t n, uint64_t *last);

#endif
