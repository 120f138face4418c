/* Inner loops of method stokes: one lattice row (x) at a time, in vectors of STOKES_LANES floats,
 * compiled once for every instruction set. */
#ifndef TOSUI_SPHSOLVE_STOKES_ROWS_H
#define TOSUI_SPHSOLVE_STOKES_ROWS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define STOKES_REACH 4 /* farthest neighbour along an axis, sites */
#define STOKES_LANES 16
#define STOKES_CLASS_MAX ((STOKES_REACH + 1) * (STOKES_REACH + 1))

/* Rows at (+-dj, +-dk) have the same coefficients up to the sign: they are added up before the
 * multiplication. */
struct stokes_class {
  int row_count, plus_count; /* the first plus_count rows are added, the others subtracted */
  int dj[4], dk[4];
  float c[STOKES_REACH + 1]; /* by |di| */
  double c_double[STOKES_REACH + 1];
};

struct stokes_convolution {
  int reach;  /* largest |di| */
  bool odd_x; /* coefficients change sign with di */
  int class_count;
  struct stokes_class classes[STOKES_CLASS_MAX];
};

/* Floats of scratch that `convolve` needs. */
size_t stokes_rows_scratch(size_t stride);

struct stokes_rows {
  const char *name;
  /* out[i] = sum over the classes and |di| <= reach, periodic in x with period nx. rows[class][r]
   * start aligned and hold `stride` floats (a multiple of STOKES_LANES, >= nx), zero beyond nx. */
  void (*convolve)(const struct stokes_convolution *convolution, const float *const (*rows)[4],
                   size_t nx, size_t stride, float *scratch, float *out);
  /* The same in double precision; scratch holds as many doubles, cleared by the callee. */
  void (*convolve_double)(const struct stokes_convolution *convolution,
                          const double *const (*rows)[4], size_t nx, size_t stride, double *scratch,
                          double *out);
  /* Conversion between a full row and the packed values of its active sites; bit b of mask[c]
   * stands for site STOKES_LANES * c + b. Returns the number of packed values. `packed` of pack
   * must have room for `chunks` chunks, all of which may be overwritten. */
  size_t (*unpack)(const uint16_t *mask, size_t chunks, const float *packed, float *row);
  size_t (*pack)(const uint16_t *mask, size_t chunks, const float *row, float *packed);
};

/* Tables for eight sites whose active sites are the bits of a byte, filled by stokes_rows_best:
 * index of the packed value of each site (EMPTY: none); and site of each packed value. For n = 0 to
 * 8: mask of the first n values, EMPTY for these. */
#define STOKES_ROWS_EMPTY 0x80
extern uint8_t stokes_rows_expand[256][8], stokes_rows_compress[256][8], stokes_rows_first[9][8];

extern const struct stokes_rows stokes_rows_base, stokes_rows_avx2, stokes_rows_avx512;
/* The fastest table that this processor supports. */
const struct stokes_rows *stokes_rows_best(void);

#endif
