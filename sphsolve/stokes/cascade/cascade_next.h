/* What the lattices of a cascade say of k, and which one is solved next. */
#ifndef TOSUI_SPHSOLVE_STOKES_CASCADE_NEXT_H
#define TOSUI_SPHSOLVE_STOKES_CASCADE_NEXT_H

#include "sphsolve/stokes/cascade/cascade.h"

/* k and the error of its resolution from all lattices so far, one at least. */
void cascade_estimate(struct cascade *cascade);
/* The next lattice's spacing, m; false when the cascade is at its end: *why is the run's status. */
bool cascade_next(struct cascade *cascade, double *spacing, const char **why);
/* What the next lattice will take, s of processor time. */
double cascade_next_seconds(const struct cascade *cascade);

#endif
