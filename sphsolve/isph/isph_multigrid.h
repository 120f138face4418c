/* Preconditioner of the pressure equation on background cells (the idea of Osaki, Morikawa, Asai
 * 2023): M^-1 r = D^-1 r + P B P^T r, with P the trilinear interpolation from a grid of about two
 * spacings to the particles and B one symmetric V-cycle for the trilinear finite elements of
 * div k grad on that grid. The elements take their k from the particles in them, so nothing of the
 * particles' matrix is multiplied out. M is symmetric and positive for any arrangement of water. */
#ifndef TOSUI_SPHSOLVE_ISPH_MULTIGRID_H
#define TOSUI_SPHSOLVE_ISPH_MULTIGRID_H

#include "common/error.h"
#include "sphsolve/isph/isph_state.h"

/* For the particles where they are now; memory is kept between calls. */
enum status multigrid_build(struct isph *s);
void multigrid_apply(struct isph *s, const double *r, double *z);
void multigrid_free(struct isph *s);

#endif
