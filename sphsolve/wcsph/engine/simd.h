/* Vectors of the instruction set for which a file is compiled. Loops see SIMD_LANES logical lanes
 * whatever the width: a narrower machine processes them in SIMD_GROUPS groups, so that the order of
 * every sum is the same. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_SIMD_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_SIMD_H

#include <immintrin.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define SIMD_LANES 16
#define SIMD_INLINE static inline __attribute__((always_inline))

#if defined(__AVX512F__)
#define SIMD_ISA avx512
#define SIMD_WIDTH 16
#elif defined(__AVX2__)
#define SIMD_ISA avx2
#define SIMD_WIDTH 8
#else
#define SIMD_ISA baseline
#define SIMD_WIDTH 4
#endif
#define SIMD_GROUPS (SIMD_LANES / SIMD_WIDTH)

typedef float vec __attribute__((vector_size(SIMD_WIDTH * 4)));
typedef int32_t ivec __attribute__((vector_size(SIMD_WIDTH * 4)));
typedef uint32_t uvec __attribute__((vector_size(SIMD_WIDTH * 4)));

SIMD_INLINE vec vec_set(float value) {
  return value - (vec){0};
}
SIMD_INLINE uvec uvec_set(uint32_t value) {
  return value - (uvec){0};
}
SIMD_INLINE vec vec_load(const float *from) {
  vec v;
  memcpy(&v, from, sizeof v);
  return v;
}
SIMD_INLINE void vec_store(float *to, vec v) {
  memcpy(to, &v, sizeof v);
}
SIMD_INLINE uvec uvec_load(const uint32_t *from) {
  uvec v;
  memcpy(&v, from, sizeof v);
  return v;
}
SIMD_INLINE void uvec_store(uint32_t *to, uvec v) {
  memcpy(to, &v, sizeof v);
}
/* Signed integers to floats. */
SIMD_INLINE vec vec_from(uvec v) {
  return __builtin_convertvector((ivec)v, vec);
}

#if SIMD_WIDTH == 16
SIMD_INLINE vec vec_max(vec a, vec b) {
  return (vec)_mm512_max_ps((__m512)a, (__m512)b);
}
SIMD_INLINE vec vec_min(vec a, vec b) {
  return (vec)_mm512_min_ps((__m512)a, (__m512)b);
}
/* Distance of a from the interval [-half, half], with sign. */
SIMD_INLINE vec vec_beyond(vec a, vec half) {
  /* The smaller of both magnitudes, with the sign of a. */
  return a - (vec)_mm512_range_ps((__m512)a, (__m512)half, 2);
}
/* The estimate of AVX2, so that both give the same bits (AVX-512 has a more accurate one). */
SIMD_INLINE vec vec_rsqrt_estimate(vec a) {
  __m256 low = _mm256_rsqrt_ps(_mm512_castps512_ps256((__m512)a)),
         high = _mm256_rsqrt_ps(_mm512_extractf32x8_ps((__m512)a, 1));
  return (vec)_mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
}
SIMD_INLINE uint32_t vec_below(vec a, vec b) {
  return _mm512_cmp_ps_mask((__m512)a, (__m512)b, _CMP_LT_OQ);
}
SIMD_INLINE uint32_t uvec_differ(uvec a, uvec b) {
  return _mm512_cmpneq_epu32_mask((__m512i)a, (__m512i)b);
}
SIMD_INLINE uvec uvec_load16(const uint16_t *from) {
  return (uvec)_mm512_cvtepu16_epi32(_mm256_loadu_si256((const __m256i *)from));
}
/* a in the first 8 lanes, b in the others, if any. */
SIMD_INLINE vec vec_halves(float a, float b) {
  return (vec)_mm512_insertf32x8(_mm512_set1_ps(a), _mm256_set1_ps(b), 1);
}
/* Stores the lanes of `mask` contiguously at `to`; writes up to SIMD_WIDTH floats. */
SIMD_INLINE void vec_compress(float *to, uint32_t mask, vec a) {
  _mm512_storeu_ps(to, _mm512_maskz_compress_ps((__mmask16)mask, (__m512)a));
}
/* The inverse: contiguous floats into the lanes of `mask`, 0 into the others. */
SIMD_INLINE vec vec_expand(const float *from, uint32_t mask) {
  return (vec)_mm512_maskz_expandloadu_ps((__mmask16)mask, from);
}
#else
#if SIMD_WIDTH == 8
SIMD_INLINE vec vec_max(vec a, vec b) {
  return (vec)_mm256_max_ps((__m256)a, (__m256)b);
}
SIMD_INLINE vec vec_min(vec a, vec b) {
  return (vec)_mm256_min_ps((__m256)a, (__m256)b);
}
SIMD_INLINE vec vec_rsqrt_estimate(vec a) {
  return (vec)_mm256_rsqrt_ps((__m256)a);
}
SIMD_INLINE uint32_t vec_below(vec a, vec b) {
  return (uint32_t)_mm256_movemask_ps(_mm256_cmp_ps((__m256)a, (__m256)b, _CMP_LT_OQ));
}
SIMD_INLINE uint32_t uvec_differ(uvec a, uvec b) {
  __m256i equal = _mm256_cmpeq_epi32((__m256i)a, (__m256i)b);
  return (uint32_t)_mm256_movemask_ps(_mm256_castsi256_ps(equal)) ^ 0xffu;
}
SIMD_INLINE uvec uvec_load16(const uint16_t *from) {
  return (uvec)_mm256_cvtepu16_epi32(_mm_loadu_si128((const __m128i *)from));
}
#else
SIMD_INLINE vec vec_max(vec a, vec b) {
  return (vec)_mm_max_ps((__m128)a, (__m128)b);
}
SIMD_INLINE vec vec_min(vec a, vec b) {
  return (vec)_mm_min_ps((__m128)a, (__m128)b);
}
SIMD_INLINE vec vec_rsqrt_estimate(vec a) {
  return (vec)_mm_rsqrt_ps((__m128)a);
}
SIMD_INLINE uint32_t vec_below(vec a, vec b) {
  return (uint32_t)_mm_movemask_ps(_mm_cmplt_ps((__m128)a, (__m128)b));
}
SIMD_INLINE uint32_t uvec_differ(uvec a, uvec b) {
  __m128i equal = _mm_cmpeq_epi32((__m128i)a, (__m128i)b);
  return (uint32_t)_mm_movemask_ps(_mm_castsi128_ps(equal)) ^ 0xfu;
}
SIMD_INLINE uvec uvec_load16(const uint16_t *from) {
  return (uvec){from[0], from[1], from[2], from[3]};
}
#endif
SIMD_INLINE vec vec_halves(float a, float b) {
  (void)b;
  return vec_set(a);
}
SIMD_INLINE vec vec_beyond(vec a, vec half) {
  return a - vec_max(vec_min(a, half), -half);
}
SIMD_INLINE void vec_compress(float *to, uint32_t mask, vec a) {
  if (mask == (1u << SIMD_WIDTH) - 1) {
    vec_store(to, a);
    return;
  }
  float lanes[SIMD_WIDTH];
  vec_store(lanes, a);
  for (; mask != 0; mask &= mask - 1) *to++ = lanes[__builtin_ctz(mask)];
}
SIMD_INLINE vec vec_expand(const float *from, uint32_t mask) {
  float lanes[SIMD_WIDTH] = {0};
  for (; mask != 0; mask &= mask - 1) lanes[__builtin_ctz(mask)] = *from++;
  return vec_load(lanes);
}
#endif

/* 2 sqrt(a), and 2/sqrt(a) in *inverse: the machine's estimate (12 to 14 bits) and one Newton step,
 * relative error < 3e-7. The factor 2 is free if the units of length account for it. */
SIMD_INLINE vec vec_twice_sqrt(vec a, vec *inverse) {
  vec y = vec_rsqrt_estimate(a), ay = a * y, step = 3.0f - ay * y;
  *inverse = y * step;
  return ay * step;
}

/* Sum of the SIMD_LANES logical lanes in a fixed order: pairwise by halves. */
SIMD_INLINE float lanes_sum(const float *lanes) {
  __m128 low = _mm_add_ps(_mm_loadu_ps(lanes), _mm_loadu_ps(lanes + 8));
  __m128 high = _mm_add_ps(_mm_loadu_ps(lanes + 4), _mm_loadu_ps(lanes + 12));
  __m128 four = _mm_add_ps(low, high);
  __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_shuffle_ps(two, two, 1)));
}

/* The same for n lines. */
SIMD_INLINE void lanes_sums(float (*line)[SIMD_LANES], int n, double *sum) {
  int i = 0;
#if SIMD_WIDTH == 16
  /* Four at a time, in exactly the same order. */
  for (; i < n; i += 4) {
    __m512 a = _mm512_loadu_ps(line[i]), b = _mm512_loadu_ps(line[i + 1 < n ? i + 1 : i]),
           c = _mm512_loadu_ps(line[i + 2 < n ? i + 2 : i]),
           d = _mm512_loadu_ps(line[i + 3 < n ? i + 3 : i]);
    __m512 ab = _mm512_add_ps(_mm512_shuffle_f32x4(a, b, 0x44), _mm512_shuffle_f32x4(a, b, 0xee));
    __m512 cd = _mm512_add_ps(_mm512_shuffle_f32x4(c, d, 0x44), _mm512_shuffle_f32x4(c, d, 0xee));
    __m512 all =
        _mm512_add_ps(_mm512_shuffle_f32x4(ab, cd, 0x88), _mm512_shuffle_f32x4(ab, cd, 0xdd));
    all = _mm512_add_ps(all, _mm512_permute_ps(all, 0x4e));
    all = _mm512_add_ps(all, _mm512_permute_ps(all, 0xb1));
    float four[SIMD_LANES];
    _mm512_storeu_ps(four, all);
    for (int k = 0; k < 4 && i + k < n; k++) sum[i + k] = (double)four[4 * k];
  }
#else
  for (; i < n; i++) sum[i] = (double)lanes_sum(line[i]);
#endif
}

#endif
