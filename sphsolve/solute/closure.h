/* The closure problem of dispersion in a periodic flow (Brenner 1980, eq. 4.12; volume averaging:
 * Whitaker 1999, 3.2). Under a mean concentration gradient along x_a the concentration is
 * x_a + b_a(x) with a periodic b_a:
 *   div(u b - D grad b) = -(u_a - <u_a>),   n . grad b = -n_a at the walls,
 * which for phi = x_a + b_a is div(u phi - D grad phi) = <u_a> with no flux through the walls. Then
 *   D*_ij / D = < grad phi_i . grad phi_j >   over the pores (Brenner 1980, eq. 5.8):
 * never less than the value by conduction alone, and with an error of second order in that of phi.
 * Without flow it describes conduction around grains: the formation factor
 * F = 1 / (porosity D* / D). */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CLOSURE_H
#define TOSUI_SPHSOLVE_SOLUTE_CLOSURE_H

#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/multigrid.h"

struct solute_closure {
  int axis[3]; /* order of the axes in the solver: the last is the main direction of the flow */
  double unit; /* m: unit of length of the solver */
  double speed;
  double mean[3];      /* mean velocity along the solver's axes, over its magnitude */
  double direction[3]; /* of the flow along x, y, z; without flow z */
  int dimensions;
  double spacing; /* of the cells, in units */
  struct solute_solver solver;
  double *source;
  double *b[3]; /* by the solver's axes, in its units; start values for the next Peclet number */
};

struct solute_dispersion {
  double tensor[3][3]; /* D* / D along x, y, z */
  double longitudinal; /* along the mean flow, over D */
  double transverse;   /* mean of the directions across the flow, over D */
  double residual;     /* the largest relative residual of the three problems */
  int iterations;      /* of the three problems together */
};

/* Prepares the closure problem on the cells of the flow, coarsened `coarsenings` times by two in
 * each direction. Free with solute_closure_free. */
enum status solute_closure_build(const struct solute_flow *flow, int coarsenings,
                                 struct solute_closure *closure);
void solute_closure_free(struct solute_closure *closure);

/* Solves it for the diffusion coefficient D (m^2/s; INFINITY: no flow), to the relative residual
 * `tolerance`. */
enum status solute_closure_solve(struct solute_closure *closure, double diffusion, double tolerance,
                                 struct solute_dispersion *dispersion);

/* Sets the longitudinal and transverse coefficients from the tensor and the unit vector of the
 * flow. */
void solute_dispersion_parts(const double direction[3], int dimensions,
                             struct solute_dispersion *dispersion);

#endif
