/* Preconditioner of the pressure equation on background cells (the idea of Osaki, Morikawa, Asai
 * 2023): M^-1 r = D^-1 r + P B P^T r, with P the trilinear interpolation from a grid of about two
 * spacings to the particles and B one symmetric V-cycle for the trilinear finite elements of
 * div k grad on that grid. The elements take their k from the particles in them, at edges of
 * soil from those particles' pairs, so nothing of the particles' matrix is multiplied out. M is
 * symmetric and positive for any arrangement of water. */
#ifndef TOSUI_SPHSOLVE_ISPH_MULTIGRID_H
#define TOSUI_SPHSOLVE_ISPH_MULTIGRID_H

#include "common/error.h"
#include "sphsolve/isph/state.h"

/* Collective. For the particles where they are now; memory is kept between calls. */
enum status multigrid_build(struct isph *s);
/* Collective: z of the own particles; every rank has the whole grid. */
void multigrid_apply(struct isph *s, const double *r, double *z);

/* What it takes to have B from PETSc. */
size_t multigrid_nodes(const struct isph *s);
/* The number of a node in the order in which ranks share them out, that of the particles' cells, or
 * back. */
size_t multigrid_number(const struct isph *s, size_t node, bool back);
/* The number of the first node of the row of nodes below x. */
size_t multigrid_row_before(const struct isph *s, const double x[3]);
/* Nodes around own particle i and their weights; returns how many. */
int multigrid_interpolation(const struct isph *s, size_t i, size_t node[8], double weight[8]);
/* A row of the grid's matrix; a node may stand there twice. Returns how many entries. */
int multigrid_row(const struct isph *s, size_t node, size_t column[27], double value[27]);
void multigrid_free(struct isph *s);

#endif
