/* Random numbers as a function of (seed, stream, index), and what is built from them with + - * /
 * and sqrt alone: the same bits for any thread count, compiler and C library. */
#ifndef TOSUI_DATA_SAMPLES_COUNTER_RANDOM_H
#define TOSUI_DATA_SAMPLES_COUNTER_RANDOM_H

#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

/* What a number is drawn for, so that two uses never share one. */
enum random_stream {
  RANDOM_SIZE = 1,
  RANDOM_SHAPE,
  RANDOM_PLACE,
  RANDOM_GREY,
  RANDOM_ROUGHNESS,
  RANDOM_TEXTURE,
  RANDOM_NOISE,
  RANDOM_RING,
  RANDOM_DRIFT
};

/* 64 mixed bits (SplitMix64's finaliser: Steele, Lea, Flood 2014, fig. 20). */
static inline uint64_t random_mix(uint64_t z) {
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static inline uint64_t random_key(uint64_t seed, enum random_stream stream) {
  return random_mix(seed * UINT64_C(0x9e3779b97f4a7c15) + (uint64_t)stream);
}

static inline uint64_t random_bits(uint64_t key, uint64_t index) {
  return random_mix(key + (index + 1) * UINT64_C(0x9e3779b97f4a7c15));
}

/* Nearly normal, mean 0, variance 1: the sum of four uniforms of 16 bits each. */
static inline float random_normal(uint64_t key, uint64_t index) {
  const uint64_t bits = random_bits(key, index);
  const int64_t sum =
      (int64_t)((bits & 0xffff) + ((bits >> 16) & 0xffff) + ((bits >> 32) & 0xffff) + (bits >> 48));
  return (float)(sum - 131070) * 2.6429e-5F; /* sqrt(12 / 4) / 65536 */
}

/* A sequence drawn one after the other. */
struct random_sequence {
  uint64_t key, next;
};

struct random_sequence random_sequence_start(uint64_t seed, enum random_stream stream,
                                             uint64_t item);
double random_uniform(struct random_sequence *sequence, double low, double high);
void random_direction(struct random_sequence *sequence, double direction[3]);

/* exp(x) for x <= 0 from basic operations, relative error < 1e-13. */
double exponential_negative(double x);

/* A periodic lattice of smooth noise, mean 0, variance about 1, in units of its own spacing. */
#define NOISE_LATTICE_SIZE 64

struct noise_lattice {
  float *value; /* [64][64][64] */
};

enum status noise_lattice_create(struct noise_lattice *lattice, uint64_t seed,
                                 enum random_stream stream);
void noise_lattice_destroy(struct noise_lattice *lattice);

/* Trilinear value at (x, y, z), any real numbers. */
float noise_lattice_value(const struct noise_lattice *lattice, float x, float y, float z);

#endif
