/* The phase of a row's voxels as bits: 1 grain, 0 pore and whatever lies behind the row's end. */
#ifndef TOSUI_CT2MODEL_SURFACE_PHASE_BITS_H
#define TOSUI_CT2MODEL_SURFACE_PHASE_BITS_H

#include <stddef.h>
#include <stdint.h>

enum { PHASE_WORD = 64 };

/* Words a row of n voxels takes. */
size_t phase_words(size_t n);
/* Of n values, grain where they are positive. */
void phase_row(const int16_t *values, size_t n, uint64_t *bits);
/* Bits of the neighbours at x + 1 (`next`) and x - 1 (`last`), periodic. */
void phase_next(const uint64_t *bits, size_t n, uint64_t *next);
void phase_last(const uint64_t *bits, size_t n, uint64_t *last);

#endif
