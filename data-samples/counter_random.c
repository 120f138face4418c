#include "data-samples/counter_random.h"

#include <math.h>

#include "common/memory.h"

struct random_sequence random_sequence_start(uint64_t seed, enum random_stream stream,
                                             uint64_t item) {
  return (struct random_sequence){random_bits(random_key(seed, stream), item), 0};
}

double random_uniform(struct random_sequence *sequence, double low, double high) {
  const double unit = (double)(random_bits(sequence->key, sequence->next++) >> 11) * 0x1p-53;
  return low + (high - low) * unit;
}

void random_direction(struct random_sequence *sequence, double direction[3]) {
  double square;
  do {
    square = 0;
    for (int i = 0; i < 3; i++) {
      direction[i] = random_uniform(sequence, -1, 1);
      square += direction[i] * direction[i];
    }
  } while (square > 1 || square < 1e-4);
  for (int i = 0; i < 3; i++) direction[i] /= sqrt(square);
}

double exponential_negative(double x) {
  const double small = x / 1024;
  double term = 1, sum = 1;
  for (int i = 1; i < 8; i++) {
    term *= small / i;
    sum += term;
  }
  for (int i = 0; i < 10; i++) sum *= sum;
  return sum;
}

enum status noise_lattice_create(struct noise_lattice *lattice, uint64_t seed,
                                 enum random_stream stream) {
  const uint64_t count = (uint64_t)NOISE_LATTICE_SIZE * NOISE_LATTICE_SIZE * NOISE_LATTICE_SIZE;
  const uint64_t key = random_key(seed, stream);
  enum status status = memory_allocate(&lattice->value, count, sizeof(float), "noise lattice");
  if (status != STATUS_OK) return status;
  /* Between lattice points a trilinear mean of eight has a third of the variance, at most; 1.7
   * brings the variance over all places to about 1. */
  for (uint64_t i = 0; i < count; i++) lattice->value[i] = 1.7F * random_normal(key, i);
  return STATUS_OK;
}

void noise_lattice_destroy(struct noise_lattice *lattice) {
  memory_free(&lattice->value);
}

float noise_lattice_value(const struct noise_lattice *lattice, float x, float y, float z) {
  const float position[3] = {x, y, z};
  unsigned low[3], high[3];
  float weight[3];
  for (int i = 0; i < 3; i++) {
    const int cell = (int)position[i] - (position[i] < 0);
    weight[i] = position[i] - (float)cell;
    low[i] = (unsigned)cell % NOISE_LATTICE_SIZE;
    high[i] = (low[i] + 1) % NOISE_LATTICE_SIZE;
  }
  float plane[2];
  for (int k = 0; k < 2; k++) {
    const float *layer =
        lattice->value + (size_t)(k ? high[2] : low[2]) * NOISE_LATTICE_SIZE * NOISE_LATTICE_SIZE;
    const float *front = layer + (size_t)low[1] * NOISE_LATTICE_SIZE;
    const float *back = layer + (size_t)high[1] * NOISE_LATTICE_SIZE;
    const float near = front[low[0]] + weight[0] * (front[high[0]] - front[low[0]]);
    const float far = back[low[0]] + weight[0] * (back[high[0]] - back[low[0]]);
    plane[k] = near + weight[1] * (far - near);
  }
  return plane[0] + weight[2] * (plane[1] - plane[0]);
}
