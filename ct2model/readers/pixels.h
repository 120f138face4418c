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

/* Bytes per pixel. */
size_t pixel_size(enum pixel_type type);
/* Name of the type, such as "16-bit unsigned". */
const char *pixel_name(enum pixel_type type);
/* Whether a histogram with one bin per grey level is affordable (8 and 16 bits); the range of its
 * levels. */
bool pixel_levels(enum pixel_type type, double *low, double *high);
/* The type with `bits` bits per sample and `format` 'u', 'i' or 'f'; false if there is none. */
bool pixel_type_of(int bits, char format, enum pixel_type *type);
/* Converts n values of `type` at `in` (any alignment) to float. */
void pixels_to_float(float *out, const void *in, size_t n, enum pixel_type type);
/* Reverses the bytes of each of n values, in place. */
void pixels_swap(void *data, size_t n, enum pixel_type type);
/* For types with levels. pixels_count counts n values in counts[PIXEL_COUNTS]; pixels_counted
 * returns the count of a level, numbered from the lowest one. */
enum { PIXEL_COUNTS = 65536 };
void pixels_count(uint32_t *counts, const void *in, size_t n, enum pixel_type type);
uint64_t pixels_counted(const uint32_t *counts, size_t level, enum pixel_type type);

/* Rows of a slice, as stored or as float; grey = `scale` (1 or -1) times the value. */
struct pixel_rows {
  const void *first;
  size_t stride; /* bytes from row to row */
  enum pixel_type type;
  float scale;
};

/* Reads row y as greys. */
void pixel_rows_read(const struct pixel_rows *rows, size_t y, size_t n, float *out);
/* Row y as greys: a pointer to the stored row if it holds greys already, otherwise `row`, which is
 * filled. */
const float *pixel_rows_at(const struct pixel_rows *rows, size_t y, size_t n, float *row);

#endif
