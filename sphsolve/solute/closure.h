/* The closure problem of dispersion in a periodic flow (Brenner 1980, eq. 4.12; volume averaging:
 * Whitaker 1999, 3.2). A mean gradient of the concentration along x_a makes it x_a + b_a(x) with a
 * periodic b_a:
 *   div(u b - D grad b) = -(u_a - <u_a>),   n . grad b = -n_a at the walls,
 * which for phi = x_a + b_a is div(u phi - D grad phi) = <u_a> with no flux through the walls. Then
 *   D*_ij / D = < grad phi_i . grad phi_j >   over the pores (Brenner 1980, eq. 5.8):
 * never less than what conduction alone gives, and wrong by the square of an error of phi. Without
 * flow it is conduction past grains: the formation factor F = 1 / (porosity D* / D). */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CLOSURE_H
#define TOSUI_SPHSOLVE_SOLUTE_CLOSURE_H

#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/multigrid.h"

struct solute_closure {
  int axis[3]; /* the solver's axes: the last is the one the flow goes along most */
  double unit; /* m: lengths of the solver */
  double speed;
  double mean[3];      /* of the flow, along the solver's axes, over its speed */
  double direction[3]; /* of the flow along x, y, z; at rest z */
  int dimensions;
  double spacing; /* of the cells, over the unit */
  struct solute_solver solver;
  double *source;
  double *b[3]; /* along the solver's axes, in its units; kept from one Peclet number to the next */
};

struct solute_dispersion {
  double tensor[3][3]; /* D* / D along x, y, z */
  double longitudinal; /* along the mean flow, over D */
  double transverse;   /* the mean of the directions across it, over D */
  double residual;     /* of the three problems, the largest */
  int iterations;      /* of them together */
};

/* On the cells of the flow, taken two by two by two `coarsenings` times. Free with
 * solute_closure_free. */
enum status solute_closure_build(const struct solute_flow *flow, int coarsenings,
                                 struct solute_closure *closure);
void solute_closure_free(struct solute_closure *closure);

/* At the diffusion coefficient D (m^2/s; INFINITY: no flow), to `tolerance` of the residual. */
enum status solute_closure_solve(struct solute_closure *closure, double diffusion, double tolerance,
                                 struct solute_dispersion *dispersion);

/* Longitudinal and transverse parts of a tensor. */
void solute_dispersion_parts(const double direction[3], int dimensions,
                             struct solute_dispersion *dispersion);

#endif
