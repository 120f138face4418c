/* The pressure equation. */
#ifndef TOSUI_SPHSOLVE_ISPH_PRESSURE_H
#define TOSUI_SPHSOLVE_ISPH_PRESSURE_H

#include "sphsolve/isph/state.h"

/* Assembles the rows. */
void isph_assemble(struct isph *s);
enum status isph_solve_pressure(struct isph *s);
/* Collective, instead of a first solve: the last step's pressure without its alternating part. */
void isph_carry_pressure(struct isph *s);
/* Collective: reports a solve that has stopped at this relative error, with the particle whose row
 * has the largest residual. */
enum status isph_solve_failed(struct isph *s, double error, int iterations);
/* Collective: y = matrix x for the own rows; ghosts of x are exchanged meanwhile. */
void isph_multiply(struct isph *s, double *x, double *y);
/* Collective: a.b */
double isph_dot(struct isph *s, const double *a, const double *b);

#endif
