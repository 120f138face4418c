/* Preconditioner of the pressure equation on background cells (after an idea of Osaki, Morikawa,
 * Asai 2023): M^-1 r = D^-1 r + P B P^T r, where P is the trilinear interpolation from a grid of
 * about two spacings to the particles and B one symmetric V-cycle for the trilinear finite elements
 * of div k grad on that grid. The elements take their k from the particles that fill them (at edges
 * of soil from those particles' pairs), so no Galerkin product of the particles' matrix is formed.
 * M is symmetric and positive for any arrangement of water. */
#ifndef TOSUI_SPHSOLVE_ISPH_MULTIGRID_H
#define TOSUI_SPHSOLVE_ISPH_MULTIGRID_H

#include "common/error.h"
#include "sphsolve/isph/state.h"

/* Collective. Builds the preconditioner for the particles at their present places; memory is kept
 * between calls. */
enum status multigrid_build(struct isph *s);
/* Collective: z = M^-1 r for the own particles; every rank has the whole grid. */
void multigrid_apply(struct isph *s, const double *r, double *z);

/* The functions below are for PETSc's solution of the grid (isph/petsc.c). Number of nodes. */
size_t multigrid_nodes(const struct isph *s);
/* Number of a node in the order in which ranks divide the nodes among them, which is that of the
 * particles' cells; or, with `back`, the reverse. */
size_t multigrid_number(const struct isph *s, size_t node, bool back);
/* Number, in that order, of the first node of the row of nodes below x. */
size_t multigrid_row_before(const struct isph *s, const double x[3]);
/* Nodes around own particle i and their weights; returns their number. */
int multigrid_interpolation(const struct isph *s, size_t i, size_t node[8], double weight[8]);
/* A row of the grid's matrix, in which a node may occur twice. Returns the number of entries. */
int multigrid_row(const struct isph *s, size_t node, size_t column[27], double value[27]);
void multigrid_free(struct isph *s);

#endif
