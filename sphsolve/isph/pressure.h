/* The pressure equation. */
#ifndef TOSUI_SPHSOLVE_ISPH_PRESSURE_H
#define TOSUI_SPHSOLVE_ISPH_PRESSURE_H

#include "sphsolve/isph/state.h"

/* Assembles the rows. */
void isph_assemble(struct isph *s);
enum status isph_solve_pressure(struct isph *s);
/* Collective, instead of a first solve: the last step's pressure without its alternating part. */
void isph_carry_pressure(struct isph *s);
#endif
