/* Free water outside of soil that need not be full: reservoirs, rivers, ditches. */
#ifndef TOSUI_SPHSOLVE_DARCY_OPEN_WATER_H
#define TOSUI_SPHSOLVE_DARCY_OPEN_WATER_H

#include "sphsolve/darcy/state.h"

/* The empty places that water of a window's head stands in: those from which a way through empty
 * places below its highest head leads to the window. Water less than half a spacing deep flows over
 * no crest. An error of input where it flows over one at some of the window's heads only; where at
 * all of them, a warning if `tell` is set. *region [lattice->count]: 1 + the index of the
 * window's region; 0 where there is none. The water there is at rest, at the head of the window at
 * each time; above that head there is air. An error of input where two windows fill one place.
 * Free with memory_free. */
enum status open_water_find(const struct scene *scene, const struct lattice *lattice, bool tell,
                            uint16_t **region);

#endif
