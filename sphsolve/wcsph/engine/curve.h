/* Position along the Hilbert curve (Skilling 2004, "Programming the Hilbert curve"). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_CURVE_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_CURVE_H

#include <stdint.h>

/* `bits` per coordinate, 2 or 3 coordinates; dimensions * bits <= 32. */
uint32_t curve_key(int dimensions, int bits, const uint32_t coordinate[3]);

#endif
