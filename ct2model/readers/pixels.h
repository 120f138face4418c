/* Pixel types of scans and their conversion to float. */
#ifndef TOSUI_CT2MODEL_READERS_PIXELS_H
#define TOSUI_CT2MODEL_READERS_PIXELS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum pixel_type {
  PIXEL_U8,
  PIXEL_I8,
  PIXEL_U16,
  PIXEL_I16,
  PIXEL_U32,
  PIXEL_I32,
  PIXEL_F32,
  PIXEL_F64
};

/* Bytes. */
size_t pixel_size(enum pixel_type type);
/* "16-bit unsigned" and the like. */
const char *pixel_name(enum pixel_type type);
/* True where a histogram with one bin a grey level is affordable (8 and 16 bits); its levels. */
bool pixel_levels(enum pixel_type type, double *low, double *high);
/* The type of `bits` bits per sample; `format` 'u', 'i' or 'f'. False if there is none. */
bool pixel_type_of(int bits, char format, enum pixel_type *type);
/* n values of `type` at `in` (any alignment) to float. */
void pixels_to_float(float *out, const void *in, size_t n, enum pixel_type type);
/* Turns the bytes of each of n values round, in place. */
void pixels_swap(void *data, size_t n, enum pixel_type type);
/* For types with levels: counts n values of a type with levels in counts[PIXEL_COUNTS]; how often
 * level i, from the lowest, was met. */
enum { PIXEL_COUNTS = 65536 };
void pixels_count(uint32_t *counts, const void *in, size_t n, enum pixel_type type);
uint64_t pixels_counted(const uint32_t *counts, size_t level, enum pixel_type type);

/* Rows of a slice as stored or as float; a grey is `scale` (1 or -1) times the value. */
struct pixel_rows {
  const void *first;
  size_t stride; /* bytes from row to row */
  enum pixel_type type;
  float scale;
};

/* Row y as greys. */
void pixel_rows_read(const struct pixel_rows *rows, size_t y, size_t n, float *out);
/* The same, where it stands if it is of greys already, else in `row`. */
const float *pixel_rows_at(const struct pixel_rows *rows, size_t y, size_t n, float *row);

#endif
