/* The pressure equation of method isph on several ranks, by PETSc. */
#ifndef TOSUI_SPHSOLVE_ISPH_PETSC_H
#define TOSUI_SPHSOLVE_ISPH_PETSC_H

#include "sphsolve/isph/state.h"

/* Collective: solves the equations of the own rows for the own pressures, as isph_solve_pressure
 * does on one rank: the same equation, starting from the same pressures, to the same tolerance in
 * the same norm. */
enum status isph_petsc_solve(struct isph *s);
void isph_petsc_free(struct isph *s);

#endif
