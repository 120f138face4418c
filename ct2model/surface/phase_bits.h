/* The phases of a row of voxels as bits: 1 grain, 0 pore; 0 also after the end of the row. */
#ifndef TOSUI_CT2MODEL_SURFACE_PHASE_BITS_H
#define TOSUI_CT2MODEL_SURFACE_PHASE_BITS_H

#include <stddef.h>
#include <stdint.h>

enum { PHASE_WORD = 64 };

/* Number of words for a row of n voxels. */
size_t phase_words(size_t n);
/* Bits of n values, which are grain where they are positive. */
void phase_row(const int16_t *values, size_t n, uint64_t *bits);
/* Bits of the neighbours at x + 1 (`next`) and x - 1 (`last`), periodic. */
void phase_next(const uint64_t *bits, size_t n, uint64_t *next);
void phase_last(const uint64_t *bits, size_t n, uint64_t *last);

#endif
