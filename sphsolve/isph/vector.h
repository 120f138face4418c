/* Vectors of three components. */
#ifndef TOSUI_SPHSOLVE_ISPH_VECTOR_H
#define TOSUI_SPHSOLVE_ISPH_VECTOR_H

/* A vector whose components are processed at once, and a fourth number of no meaning. */
typedef double four __attribute__((vector_size(4 * sizeof(double)), aligned(8), may_alias));
/* That of a field, whose arrays have room for one more number at their end. */
#define FOUR(x) (*(const four *)(x))
#define FOUR_DOT(a, b) ((a)[0] * (b)[0] + (a)[1] * (b)[1] + (a)[2] * (b)[2])

/* Eight numbers that are processed at once: those from array[k] on, and those of eight particles j;
 * their sum is in a fixed order on any machine. */
#define EIGHT_WIDE 8
typedef double eight
    __attribute__((vector_size(EIGHT_WIDE * sizeof(double)), aligned(8), may_alias));
#define EIGHT(array, k) (*(eight *)&(array)[k])
#define EIGHT_OF(array, j, component)                                                              \
  ((eight){(array)[(j)[0]] component, (array)[(j)[1]] component, (array)[(j)[2]] component,        \
           (array)[(j)[3]] component, (array)[(j)[4]] component, (array)[(j)[5]] component,        \
           (array)[(j)[6]] component, (array)[(j)[7]] component})
#define EIGHT_SUM(x)                                                                               \
  ((((x)[0] + (x)[1]) + ((x)[2] + (x)[3])) + (((x)[4] + (x)[5]) + ((x)[6] + (x)[7])))

static inline double dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

#endif
