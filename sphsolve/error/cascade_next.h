/* Estimate of k from the lattices of a cascade, and the choice of the next one. */
#ifndef TOSUI_SPHSOLVE_ERROR_CASCADE_NEXT_H
#define TOSUI_SPHSOLVE_ERROR_CASCADE_NEXT_H

#include "sphsolve/error/cascade.h"

/* Updates k and its error of resolution from all lattices so far, at least one. */
void cascade_estimate(struct cascade *cascade);
/* Spacing of the next lattice, m. False if the cascade has ended; *why is then the status of the
 * run. */
bool cascade_next(struct cascade *cascade, double *spacing, const char **why);
/* Predicted processor seconds of the next lattice. */
double cascade_next_seconds(const struct cascade *cascade);

#endif
