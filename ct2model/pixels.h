/* Pixel types of scans and their conversion to float. */
#ifndef TOSUI_CT2MODEL_PIXELS_H
#define TOSUI_CT2MODEL_PIXELS_H

#include <stdbool.h>
#include <stddef.h>

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

size_t pixel_size(enum pixel_type type);
/* "16-bit unsigned" and the like. */
const char *pixel_name(enum pixel_type type);
/* True where a histogram with one bin a grey level is affordable (8 and 16 bits); its levels. */
bool pixel_levels(enum pixel_type type, double *low, double *high);
/* The type of `bits` bits per sample; `format` 'u', 'i' or 'f'. False if there is none. */
bool pixel_type_of(int bits, char format, enum pixel_type *type);
/* n values of `type` at `in` (any alignment; bytes swapped first if `swap`) to float. */
void pixels_to_float(float *out, const void *in, size_t n, enum pixel_type type, bool swap);

#endif
