/* The matrix of the pressure equation, whose rows isph_assemble (pressure.h) makes. */
#ifndef TOSUI_SPHSOLVE_ISPH_MATRIX_H
#define TOSUI_SPHSOLVE_ISPH_MATRIX_H

#include "sphsolve/isph/state.h"

/* Collective: y = matrix x for the own rows; ghosts of x are exchanged meanwhile. */
void isph_multiply(struct isph *s, double *x, double *y);
/* Collective: a.b */
double isph_dot(struct isph *s, const double *a, const double *b);
/* Collective: reports a solve that has stopped at this relative error, with the particle whose row
 * has the largest residual. */
enum status isph_solve_failed(struct isph *s, double error, int iterations);

#endif
