/* Vectors of three components. */
#ifndef TOSUI_SPHSOLVE_ISPH_VECTOR_H
#define TOSUI_SPHSOLVE_ISPH_VECTOR_H

/* A vector whose components are processed at once, and a fourth number of no meaning. */
typedef double four __attribute__((vector_size(4 * sizeof(double)), aligned(8), may_alias));
/* That of a field, whose arrays have room for one more number at their end. */
#define FOUR(x) (*(const four *)(x))
#define FOUR_DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

static inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
