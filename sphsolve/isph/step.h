/* One step in time. */
#ifndef TOSUI_SPHSOLVE_ISPH_STEP_H
#define TOSUI_SPHSOLVE_ISPH_STEP_H

#include "sphsolve/isph/state.h"

/* One step of length dt, s, from a fresh state. */
enum status isph_advance(struct isph *s, double dt);

#endif
