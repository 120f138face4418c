/* Particles that leave the domain. */
#ifndef TOSUI_SPHSOLVE_ISPH_OUTSIDE_H
#define TOSUI_SPHSOLVE_ISPH_OUTSIDE_H

#include "sphsolve/isph/state.h"

/* After a step of dt and before isph_open_move: removes particles outside the
 * domain: those that left through a window and, with a warning, those that went through a wall. */
enum status isph_remove_outside(struct isph *s, double dt);

#endif
