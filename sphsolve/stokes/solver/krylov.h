/* GMRES (Saad, Schultz 1986), preconditioned from the right, on long float vectors. Sums run over
 * fixed blocks in double precision and in a fixed order: the bits do not depend on the threads. */
#ifndef TOSUI_SPHSOLVE_STOKES_KRYLOV_H
#define TOSUI_SPHSOLVE_STOKES_KRYLOV_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

struct stokes_krylov {
  size_t length;
  int basis_max;   /* vectors kept */
  bool alone;      /* all of the vectors are this rank's; else it has its part of them */
  float *basis;    /* [basis_max + 1][length]; the first is the residual between corrections */
  float *work;     /* [length] */
  double *partial; /* of the sums */
  double *columns; /* of Hessenberg's matrix */
  void *system;
  void (*apply)(void *system, const float *x, float *y);                     /* y = K x */
  void (*precondition)(void *system, const float *x, float *work, float *y); /* y = M^-1 x */
};

/* Room for vectors of `length` floats; apply and precondition are the caller's to set. Free
 * with stokes_krylov_free. */
enum status stokes_krylov_build(size_t length, int basis_max, struct stokes_krylov *krylov);
void stokes_krylov_free(struct stokes_krylov *krylov);

/* x += correction with K correction ~ residual, until the residual has shrunk by `reduction` or
 * the basis is full. The residual is the first vector of the basis, and becomes what is left of it.
 * Returns the iterations; *reached the shrinkage. 0 iterations: given up as a signal has come
 * (common/interrupt), x and the residual are what they were. */
int stokes_krylov_correct(struct stokes_krylov *krylov, double reduction, double *x,
                          double *reached);

/* Euclidean norm of x, over all ranks: collective. */
double stokes_krylov_norm(struct stokes_krylov *krylov, const float *x);

#endif
