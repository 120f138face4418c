#include "ct2model/readers/pixels.h"

#include <string.h>

#include "common/variants.h"

static const struct {
  size_t size;
  const char *name;
  double low, high; /* range of the types with few enough levels */
} TYPES[] = {
    [PIXEL_U8] = {1, "8-bit unsigned", 0, 255},
    [PIXEL_I8] = {1, "8-bit signed", -128, 127},
    [PIXEL_U16] = {2, "16-bit unsigned", 0, 65535},
    [PIXEL_I16] = {2, "16-bit signed", -32768, 32767},
    [PIXEL_U32] = {4, "32-bit unsigned", 0, 0},
    [PIXEL_I32] = {4, "32-bit signed", 0, 0},
    [PIXEL_F32] = {4, "32-bit float", 0, 0},
    [PIXEL_F64] = {8, "64-bit float", 0, 0},
};

size_t pixel_size(enum pixel_type type) {
  return TYPES[type].size;
}

const char *pixel_name(enum pixel_type type) {
  return TYPES[type].name;
}

bool pixel_levels(enum pixel_type type, double *low, double *high) {
  *low = TYPES[type].low;
  *high = TYPES[type].high;
  return *low < *high;
}

bool pixel_type_of(int bits, char format, enum pixel_type *type) {
  static const struct {
    int bits;
    char format;
    enum pixel_type type;
  } KNOWN[] = {
      {8, 'u', PIXEL_U8},   {8, 'i', PIXEL_I8},   {16, 'u', PIXEL_U16}, {16, 'i', PIXEL_I16},
      {32, 'u', PIXEL_U32}, {32, 'i', PIXEL_I32}, {32, 'f', PIXEL_F32}, {64, 'f', PIXEL_F64},
  };
  for (size_t i = 0; i < sizeof KNOWN / sizeof *KNOWN; i++) {
    if (KNOWN[i].bits == bits && KNOWN[i].format == format) {
      *type = KNOWN[i].type;
      return true;
    }
  }
  return false;
}

/* Loads a value at any alignment. */
#define LOADER(type)                                                                               \
  static inline type load_##type(const unsigned char *at) {                                        \
    type value;                                                                                    \
    memcpy(&value, at, sizeof value);                                                              \
    return value;                                                                                  \
  }
LOADER(int8_t)
LOADER(uint8_t)
LOADER(int16_t)
LOADER(uint16_t)
LOADER(int32_t)
LOADER(uint32_t)
LOADER(uint64_t)
LOADER(float)
LOADER(double)

#define CONVERT(type)                                                                              \
  for (size_t i = 0; i < n; i++) out[i] = (float)load_##type(bytes + sizeof(type) * i);            \
  break

TARGETS void pixels_to_float(float *restrict out, const void *restrict in, size_t n,
                             enum pixel_type type) {
  const unsigned char *restrict bytes = in;
  switch (type) {
  case PIXEL_U8:
    CONVERT(uint8_t);
  case PIXEL_I8:
    CONVERT(int8_t);
  case PIXEL_U16:
    CONVERT(uint16_t);
  case PIXEL_I16:
    CONVERT(int16_t);
  case PIXEL_U32:
    CONVERT(uint32_t);
  case PIXEL_I32:
    CONVERT(int32_t);
  case PIXEL_F32:
    CONVERT(float);
  case PIXEL_F64:
    CONVERT(double);
  }
}

#define SWAP(bits)                                                                                 \
  for (size_t i = 0; i < n; i++, bytes += sizeof(uint##bits##_t)) {                                \
    const uint##bits##_t value = __builtin_bswap##bits(load_uint##bits##_t(bytes));                \
    memcpy(bytes, &value, sizeof value);                                                           \
  }                                                                                                \
  break

TARGETS void pixels_swap(void *data, size_t n, enum pixel_type type) {
  unsigned char *bytes = data;
  switch (pixel_size(type)) {
  case 2:
    SWAP(16);
  case 4:
    SWAP(32);
  case 8:
    SWAP(64);
  }
}

/* With 256 levels the same one often follows itself; four tables used in turn avoid that increments
 * wait for each other. With 65536 levels a single table stays closer to the processor. */
enum { TABLES = 4 };

void pixels_count(uint32_t *counts, const void *in, size_t n, enum pixel_type type) {
  const uint8_t *bytes = in;
  size_t i = 0;
  if (pixel_size(type) == 1) {
    const unsigned sign = type == PIXEL_I8 ? 0x80 : 0;
    for (; i + TABLES <= n; i += TABLES)
      for (unsigned k = 0; k < TABLES; k++) counts[256 * k + (bytes[i + k] ^ sign)]++;
    for (; i < n; i++) counts[bytes[i] ^ sign]++;
    return;
  }
  const unsigned sign = type == PIXEL_I16 ? 0x8000 : 0;
  for (; i + TABLES <= n; i += TABLES) {
    uint64_t four;
    memcpy(&four, bytes + 2 * i, sizeof four);
    for (unsigned k = 0; k < TABLES; k++) counts[(four >> 16 * k & 0xffffu) ^ sign]++;
  }
  for (; i < n; i++) counts[load_uint16_t(bytes + 2 * i) ^ sign]++;
}

uint64_t pixels_counted(const uint32_t *counts, size_t level, enum pixel_type type) {
  uint64_t sum = counts[level];
  for (size_t k = 1; k < TABLES && pixel_size(type) == 1; k++) sum += counts[256 * k + level];
  return sum;
}

TARGETS static void negate(float *row, size_t n) {
  for (size_t i = 0; i < n; i++) row[i] = -row[i];
}

void pixel_rows_read(const struct pixel_rows *rows, size_t y, size_t n, float *out) {
  pixels_to_float(out, (const char *)rows->first + y * rows->stride, n, rows->type);
  if (rows->scale < 0.0f) negate(out, n);
}

const float *pixel_rows_at(const struct pixel_rows *rows, size_t y, size_t n, float *row) {
  const void *there = (const char *)rows->first + y * rows->stride;
  if (rows->type == PIXEL_F32 && rows->scale > 0.0f) return there;
  pixel_rows_read(rows, y, n, row);
  return row;
}
