/* Right-preconditioned GMRES (Saad, Schultz 1986) on long float vectors. Sums run over fixed blocks
 * in double precision and in a fixed order: the results do not depend on the number of threads. */
#ifndef TOSUI_SPHSOLVE_STOKES_KRYLOV_H
#define TOSUI_SPHSOLVE_STOKES_KRYLOV_H

#include <stdbool.h>
#include <stddef.h>

#include "common/error.h"

struct stokes_krylov {
  size_t length;
  int basis_max;   /* vectors kept */
  bool alone;      /* this rank has the whole vectors; otherwise its part of them */
  float *basis;    /* [basis_max + 1][length]; the first is the residual between corrections */
  float *work;     /* [length] */
  double *partial; /* partial sums of the dot products */
  double *columns; /* of the Hessenberg matrix */
  void *system;
  void (*apply)(void *system, const float *x, float *y);                     /* y = K x */
  void (*precondition)(void *system, const float *x, float *work, float *y); /* y = M^-1 x */
};

/* Allocates vectors of `length` floats; the caller sets system, apply and precondition. Free with
 * stokes_krylov_free. */
enum status stokes_krylov_build(size_t length, int basis_max, struct stokes_krylov *krylov);
void stokes_krylov_free(struct stokes_krylov *krylov);

/* x += correction with K correction ~ residual, until the residual has been reduced by the factor
 * `reduction` or the basis is full. The residual is the first vector of the basis, and is replaced
 * by the remaining one. Returns the iterations; *reached: the reduction. 0 iterations: abandoned
 * after an interrupt (common/interrupt) or because the residual is 0; x and the residual are
 * unchanged. */
int stokes_krylov_correct(struct stokes_krylov *krylov, double reduction, double *x,
                          double *reached);

/* Euclidean norm of x, over all ranks: collective. */
double stokes_krylov_norm(struct stokes_krylov *krylov, const float *x);

#endif
