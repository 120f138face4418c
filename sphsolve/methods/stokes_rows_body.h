/* Body of the row loops, compiled once per instruction set by the files that include it and name
 * the table with STOKES_ROWS_TABLE and STOKES_ROWS_NAME. */
#include <string.h>
#ifdef __AVX512F__
#include <immintrin.h>
#endif

#include "sphsolve/methods/stokes_rows.h"

typedef float vec __attribute__((vector_size(4 * STOKES_LANES), may_alias));

#define LOAD(p) (*(const vec *)(p))

/* Sums over y and z for every |di| at once: partial[m][i] = sum over the classes of c[m] times the
 * signed sum of their rows. `reach` is a constant where it matters. */
static inline __attribute__((always_inline)) void
sum_rows(const struct stokes_convolution *convolution, const float *const (*rows)[4], size_t stride,
         size_t pitch, float *partial, int reach) {
  for (size_t i = 0; i < stride; i += STOKES_LANES) {
    vec sum[STOKES_REACH + 1] = {0};
    for (int c = 0; c < convolution->class_count; c++) {
      const struct stokes_class *class = &convolution->classes[c];
      vec s = LOAD(rows[c][0] + i);
      if (class->row_count == 2) {
        if (class->plus_count == 2)
          s += LOAD(rows[c][1] + i);
        else
          s -= LOAD(rows[c][1] + i);
      } else if (class->row_count == 4) {
        s += LOAD(rows[c][1] + i);
        const vec t = LOAD(rows[c][2] + i) + LOAD(rows[c][3] + i);
        if (class->plus_count == 4)
          s += t;
        else
          s -= t;
      }
      for (int m = 0; m <= reach; m++) sum[m] += class->c[m] * s;
    }
    for (int m = 0; m <= reach; m++) *(vec *)(partial + (size_t)m * pitch + i) = sum[m];
  }
}

static void convolve(const struct stokes_convolution *convolution, const float *const (*rows)[4],
                     size_t nx, size_t stride, float *scratch, float *out) {
  const size_t pitch = stride + 2 * STOKES_LANES;
  float *partial = scratch + STOKES_LANES;
  const int reach = convolution->reach;
  if (reach == 2)
    sum_rows(convolution, rows, stride, pitch, partial, 2);
  else
    sum_rows(convolution, rows, stride, pitch, partial, reach);
  for (int m = 1; m <= reach; m++) {
    float *p = partial + (size_t)m * pitch;
    for (int i = 0; i < m; i++) { /* a row may be shorter than the reach */
      p[nx + (size_t)i] = p[(size_t)i % nx];
      p[-1 - i] = p[nx - 1 - (size_t)i % nx];
    }
  }
  if (convolution->odd_x)
    memset(out, 0, stride * sizeof *out);
  else
    memcpy(out, partial, stride * sizeof *out);
  const float sign = convolution->odd_x ? -1.0f : 1.0f;
  for (int m = 1; m <= reach; m++) {
    const float *right = partial + (size_t)m * pitch + m, *left = right - 2 * m;
    for (size_t i = 0; i < nx; i++) out[i] += right[i] + sign * left[i];
  }
}

static size_t unpack(const uint16_t *mask, size_t chunks, const float *packed, float *row) {
  const float *p = packed;
  for (size_t c = 0; c < chunks; c++) {
    float *r = row + c * STOKES_LANES;
    unsigned bits = mask[c];
#ifdef __AVX512F__
    _mm512_store_ps(r, _mm512_maskz_expandloadu_ps((__mmask16)bits, p));
    p += __builtin_popcount(bits);
#else
    memset(r, 0, STOKES_LANES * sizeof *r);
    for (; bits; bits &= bits - 1) r[__builtin_ctz(bits)] = *p++;
#endif
  }
  return (size_t)(p - packed);
}

static size_t pack(const uint16_t *mask, size_t chunks, const float *row, float *packed) {
  float *p = packed;
  for (size_t c = 0; c < chunks; c++) {
    const float *r = row + c * STOKES_LANES;
    unsigned bits = mask[c];
#ifdef __AVX512F__
    _mm512_mask_compressstoreu_ps(p, (__mmask16)bits, _mm512_loadu_ps(r));
    p += __builtin_popcount(bits);
#else
    for (; bits; bits &= bits - 1) *p++ = r[__builtin_ctz(bits)];
#endif
  }
  return (size_t)(p - packed);
}

const struct stokes_rows STOKES_ROWS_TABLE = {STOKES_ROWS_NAME, convolve, unpack, pack};
