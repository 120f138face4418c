#include "ct2model/pixels.h"

#include <stdint.h>
#include <string.h>

static const struct {
  size_t size;
  const char *name;
  double low, high; /* of the types with few enough levels */
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

static uint16_t load16(const unsigned char *at, bool swap) {
  uint16_t value;
  memcpy(&value, at, 2);
  return swap ? __builtin_bswap16(value) : value;
}

static uint32_t load32(const unsigned char *at, bool swap) {
  uint32_t value;
  memcpy(&value, at, 4);
  return swap ? __builtin_bswap32(value) : value;
}

static float load_f32(const unsigned char *at, bool swap) {
  uint32_t bits = load32(at, swap);
  float value;
  memcpy(&value, &bits, 4);
  return value;
}

static float load_f64(const unsigned char *at, bool swap) {
  uint64_t bits;
  double value;
  memcpy(&bits, at, 8);
  if (swap) bits = __builtin_bswap64(bits);
  memcpy(&value, &bits, 8);
  return (float)value;
}

void pixels_to_float(float *out, const void *in, size_t n, enum pixel_type type, bool swap) {
  const unsigned char *bytes = in;
  switch (type) {
  case PIXEL_U8:
    for (size_t i = 0; i < n; i++) out[i] = (float)bytes[i];
    break;
  case PIXEL_I8:
    for (size_t i = 0; i < n; i++) out[i] = (float)(int8_t)bytes[i];
    break;
  case PIXEL_U16:
    for (size_t i = 0; i < n; i++) out[i] = (float)load16(bytes + 2 * i, swap);
    break;
  case PIXEL_I16:
    for (size_t i = 0; i < n; i++) out[i] = (float)(int16_t)load16(bytes + 2 * i, swap);
    break;
  case PIXEL_U32:
    for (size_t i = 0; i < n; i++) out[i] = (float)load32(bytes + 4 * i, swap);
    break;
  case PIXEL_I32:
    for (size_t i = 0; i < n; i++) out[i] = (float)(int32_t)load32(bytes + 4 * i, swap);
    break;
  case PIXEL_F32:
    for (size_t i = 0; i < n; i++) out[i] = load_f32(bytes + 4 * i, swap);
    break;
  case PIXEL_F64:
    for (size_t i = 0; i < n; i++) out[i] = load_f64(bytes + 8 * i, swap);
    break;
  }
}
