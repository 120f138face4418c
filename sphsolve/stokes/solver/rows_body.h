/* Body of the row loops, compiled once per instruction set by the files that include it; they name
 * the table with STOKES_ROWS_TABLE and STOKES_ROWS_NAME. */
#include <string.h>
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "sphsolve/stokes/solver/rows.h"

/* Vectors as wide as the registers (the compiler splits wider ones up in memory), and the number of
 * vectors whose sums fit into the registers at once. */
#ifdef __AVX512F__
#define VECTOR 16
#define WIDTH 4
#elif defined __AVX2__
#define VECTOR 8
#define WIDTH 4
#else
#define VECTOR 4
#define WIDTH 4
#endif
typedef float vec __attribute__((vector_size(4 * VECTOR), may_alias));
#define LOAD(p) (*(const vec *)(p))

/* Sums over y and z for every |di| at once, for `width` vectors of a row: partial[m][i] = sum over
 * the classes of c[m] times the signed sum of their rows. width and reach are constants where it is
 * called, so that the sums stay in registers. */
static inline __attribute__((always_inline)) void
sum_block(const struct stokes_convolution *convolution, const float *const (*rows)[4], size_t start,
          size_t pitch, float *partial, const int width, const int reach) {
  vec sum[WIDTH][STOKES_REACH + 1] = {{{0}}};
  for (int c = 0; c < convolution->class_count; c++) {
    const struct stokes_class *class = &convolution->classes[c];
    const float *const *row = rows[c];
    vec s[WIDTH];
    for (int w = 0; w < width; w++) s[w] = LOAD(row[0] + start + w * VECTOR);
    if (class->row_count == 2) {
      if (class->plus_count == 2)
        for (int w = 0; w < width; w++) s[w] += LOAD(row[1] + start + w * VECTOR);
      else
        for (int w = 0; w < width; w++) s[w] -= LOAD(row[1] + start + w * VECTOR);
    } else if (class->row_count == 4) {
      for (int w = 0; w < width; w++) {
        const size_t i = start + (size_t)w * VECTOR;
        const vec t = LOAD(row[2] + i) + LOAD(row[3] + i);
        s[w] += LOAD(row[1] + i);
        s[w] = class->plus_count == 4 ? s[w] + t : s[w] - t;
      }
    }
    for (int m = 0; m <= reach; m++)
      for (int w = 0; w < width; w++) sum[w][m] += class->c[m] * s[w];
  }
  for (int m = 0; m <= reach; m++)
    for (int w = 0; w < width; w++)
      *(vec *)(partial + (size_t)m * pitch + start + w * VECTOR) = sum[w][m];
}

static inline __attribute__((always_inline)) void
sum_rows(const struct stokes_convolution *convolution, const float *const (*rows)[4], size_t stride,
         size_t pitch, float *partial, const int width, const int reach) {
  size_t i = 0;
  for (; i + (size_t)(width * VECTOR) <= stride; i += (size_t)(width * VECTOR))
    sum_block(convolution, rows, i, pitch, partial, width, reach);
  for (; i < stride; i += VECTOR) sum_block(convolution, rows, i, pitch, partial, 1, reach);
}

/* Fills the values beyond the ends of a row periodically; a row may be shorter than the reach. */
static void wrap(float *partial, size_t nx, size_t pitch, int reach) {
  for (int m = 1; m <= reach; m++) {
    float *p = partial + (size_t)m * pitch;
    for (int i = 0; i < m; i++) {
      p[nx + (size_t)i] = p[(size_t)i % nx];
      p[-1 - i] = p[nx - 1 - (size_t)i % nx];
    }
  }
}

static void convolve(const struct stokes_convolution *convolution, const float *const (*rows)[4],
                     size_t nx, size_t stride, float *scratch, float *out) {
  const size_t pitch = stride + 2 * STOKES_LANES;
  float *partial = scratch + STOKES_LANES;
  const int reach = convolution->reach;
  const float sign = convolution->odd_x ? -1.0f : 1.0f;
  if (reach == 1) { /* the usual support */
    sum_rows(convolution, rows, stride, pitch, partial, WIDTH, 1);
    wrap(partial, nx, pitch, 1);
    const float own = convolution->odd_x ? 0.0f : 1.0f, *one = partial + pitch;
    for (size_t i = 0; i < nx; i++) out[i] = own * partial[i] + (one[i + 1] + sign * one[i - 1]);
    return;
  }
  if (reach == 2) { /* support 2.9 */
    sum_rows(convolution, rows, stride, pitch, partial, WIDTH / 2, 2);
    wrap(partial, nx, pitch, 2);
    const float own = convolution->odd_x ? 0.0f : 1.0f;
    const float *one = partial + pitch, *two = partial + 2 * pitch;
    for (size_t i = 0; i < nx; i++)
      out[i] = own * partial[i] + one[i + 1] + sign * one[i - 1] + two[i + 2] + sign * two[i - 2];
    return;
  }
  sum_rows(convolution, rows, stride, pitch, partial, 1, reach);
  wrap(partial, nx, pitch, reach);
  for (size_t i = 0; i < nx; i++) out[i] = convolution->odd_x ? 0.0f : partial[i];
  for (int m = 1; m <= reach; m++) {
    const float *right = partial + (size_t)m * pitch + m, *left = right - 2 * m;
    for (size_t i = 0; i < nx; i++) out[i] += right[i] + sign * left[i];
  }
}

static void convolve_double(const struct stokes_convolution *convolution,
                            const double *const (*rows)[4], size_t nx, size_t stride,
                            double *scratch, double *out) {
  const size_t pitch = stride + 2 * STOKES_LANES;
  double *sum = scratch + STOKES_REACH;
  const double sign = convolution->odd_x ? -1.0 : 1.0;
  for (int m = 0; m <= convolution->reach; m++)
    memset(sum + (size_t)m * pitch, 0, nx * sizeof *sum);
  for (int c = 0; c < convolution->class_count; c++) {
    const struct stokes_class *class = &convolution->classes[c];
    for (int r = 0; r < class->row_count; r++)
      for (int m = 0; m <= convolution->reach; m++) {
        const double f = r < class->plus_count ? class->c_double[m] : -class->c_double[m];
        const double *u = rows[c][r];
        double *s = sum + (size_t)m * pitch;
        for (size_t i = 0; i < nx; i++) s[i] += f * u[i];
      }
  }
  for (size_t i = 0; i < nx; i++) out[i] = convolution->odd_x ? 0.0 : sum[i];
  for (int m = 1; m <= convolution->reach; m++) {
    double *s = sum + (size_t)m * pitch;
    for (int i = 0; i < m; i++) {
      s[nx + (size_t)i] = s[(size_t)i % nx];
      s[-1 - i] = s[nx - 1 - (size_t)i % nx];
    }
    for (size_t i = 0; i < nx; i++) out[i] += s[i + (size_t)m] + sign * s[(long)i - m];
  }
}

#if defined __AVX2__ && !defined __AVX512F__
/* Converts bytes of a table to the indices of a permutation; the highest bit of a byte becomes the
 * highest bit of the index. */
static inline __m256i indices(const uint8_t bytes[8]) {
  return _mm256_cvtepi8_epi32(_mm_loadl_epi64((const __m128i *)(const void *)bytes));
}
#endif

static size_t unpack(const uint16_t *mask, size_t chunks, const float *packed, float *row) {
  const float *p = packed;
  for (size_t c = 0; c < chunks; c++) {
    float *r = row + c * STOKES_LANES;
    unsigned bits = mask[c];
#ifdef __AVX512F__
    _mm512_store_ps(r, _mm512_maskz_expandloadu_ps((__mmask16)bits, p));
    p += __builtin_popcount(bits);
#elif defined __AVX2__
    /* Only existing values are read, as the vector may end with them. */
    for (int half = 0; half < 2; half++, bits >>= 8) {
      const __m256i from = indices(stokes_rows_expand[bits & 255]);
      const int count = __builtin_popcount(bits & 255);
      const __m256 some = _mm256_maskload_ps(p, indices(stokes_rows_first[count]));
      _mm256_store_ps(r + 8 * half,
                      _mm256_blendv_ps(_mm256_permutevar8x32_ps(some, from), _mm256_setzero_ps(),
                                       _mm256_castsi256_ps(from)));
      p += count;
    }
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
    /* Compressed in a register and stored as a whole: the next chunk overwrites what lies beyond
     * the values. */
#ifdef __AVX512F__
    /* A compress-store to memory is microcoded on AMD's Zen 4. */
    _mm512_storeu_ps(p, _mm512_maskz_compress_ps((__mmask16)bits, _mm512_loadu_ps(r)));
    p += __builtin_popcount(bits);
#elif defined __AVX2__
    for (int half = 0; half < 2; half++, bits >>= 8) {
      const __m256i from = indices(stokes_rows_compress[bits & 255]);
      _mm256_storeu_ps(p, _mm256_permutevar8x32_ps(_mm256_loadu_ps(r + 8 * half), from));
      p += __builtin_popcount(bits & 255);
    }
#else
    for (; bits; bits &= bits - 1) *p++ = r[__builtin_ctz(bits)];
#endif
  }
  return (size_t)(p - packed);
}

const struct stokes_rows STOKES_ROWS_TABLE = {STOKES_ROWS_NAME, convolve, convolve_double, unpack,
                                              pack};
