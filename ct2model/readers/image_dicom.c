#include "ct2model/readers/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/input_file.h"
#include "common/memory.h"

/* DICOM (PS3.5, PS3.10): files with a preamble, little-endian and uncompressed, of one grey a
 * pixel; one slice, or frames one behind the other. stack.c puts the slices of a series in order by
 * their positions. */

enum { PREAMBLE = 128, NESTED_MOST = 16 };
#define UNDEFINED 0xffffffffu

struct dicom {
  const char *path;
  FILE *file;
  bool implicit;
  unsigned rows, columns, allocated, stored, high, is_signed, samples, frames;
  bool white_is_zero;
  double spacing[2], position[3], orientation[6], slope, intercept;
  bool placed, oriented;
  uint64_t pixels;
  uint32_t length;
};

static bool dicom_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n >= PREAMBLE + 4 && memcmp(head + PREAMBLE, "DICM", 4) == 0;
}

static enum status damaged(const struct dicom *dicom) {
  return FAIL(STATUS_INPUT, "%s: ends within its header" EXPORT_AGAIN, dicom->path);
}

static bool read_number(FILE *file, int bytes, uint32_t *value) {
  unsigned char at[4] = {0};
  if (fread(at, 1, (size_t)bytes, file) != (size_t)bytes) return false;
  *value = (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
  return true;
}

struct element {
  uint32_t group, number, length;
};

/* Reads the tag and the length of an element. */
static bool read_element(struct dicom *dicom, struct element *element) {
  char kind[2];
  if (!read_number(dicom->file, 2, &element->group) ||
      !read_number(dicom->file, 2, &element->number))
    return false;
  if (element->group == 0xfffe || (dicom->implicit && element->group != 2))
    return read_number(dicom->file, 4, &element->length);
  if (fread(kind, 1, 2, dicom->file) != 2) return false;
  static const char LONG[][3] = {"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                 "UC", "UN", "UR", "UT", "SV", "UV"};
  for (size_t i = 0; i < sizeof LONG / sizeof *LONG; i++)
    if (memcmp(kind, LONG[i], 2) == 0)
      return fseeko(dicom->file, 2, SEEK_CUR) == 0 && read_number(dicom->file, 4, &element->length);
  return read_number(dicom->file, 2, &element->length);
}

/* Skips a sequence or an item of undefined length. */
static bool skip_undefined(struct dicom *dicom, int depth) {
  struct element element;
  while (depth < NESTED_MOST && read_element(dicom, &element)) {
    if (element.group == 0xfffe && (element.number == 0xe0dd || element.number == 0xe00d))
      return true;
    if (element.length == UNDEFINED) {
      if (!skip_undefined(dicom, depth + 1)) return false;
    } else if (fseeko(dicom->file, (off_t)element.length, SEEK_CUR) != 0) {
      return false;
    }
  }
  return false;
}

/* Reads up to `count` numbers parted by '\'. */
static bool read_decimals(const char *text, int count, double *values) {
  for (int i = 0; i < count; i++) {
    char *end;
    values[i] = strtod(text, &end);
    if (end == text || !isfinite(values[i])) return false;
    text = end + strspn(end, " ");
    if (i + 1 < count && *text++ != '\\') return false;
  }
  return true;
}

static enum status take_element(struct dicom *dicom, const struct element *element) {
  const uint32_t tag = element->group << 16 | element->number;
  unsigned *whole = tag == 0x00280010   ? &dicom->rows
                    : tag == 0x00280011 ? &dicom->columns
                    : tag == 0x00280100 ? &dicom->allocated
                    : tag == 0x00280101 ? &dicom->stored
                    : tag == 0x00280102 ? &dicom->high
                    : tag == 0x00280103 ? &dicom->is_signed
                    : tag == 0x00280002 ? &dicom->samples
                                        : NULL;
  char text[200] = "";
  if (whole != NULL) {
    uint32_t value;
    if (element->length != 2 || !read_number(dicom->file, 2, &value)) return damaged(dicom);
    *whole = value;
    return STATUS_OK;
  }
  const bool is_text = tag == 0x00020010 || tag == 0x00280004 || tag == 0x00280008 ||
                       tag == 0x00280030 || tag == 0x00200032 || tag == 0x00200037 ||
                       tag == 0x00281052 || tag == 0x00281053;
  if (!is_text || element->length >= sizeof text)
    return fseeko(dicom->file, (off_t)element->length, SEEK_CUR) == 0 ? STATUS_OK : damaged(dicom);
  if (fread(text, 1, element->length, dicom->file) != element->length) return damaged(dicom);
  for (size_t n = strlen(text); n > 0 && text[n - 1] == ' ';) text[--n] = '\0';
  if (tag == 0x00020010) {
    dicom->implicit = strcmp(text, "1.2.840.10008.1.2") == 0;
    if (!dicom->implicit && strcmp(text, "1.2.840.10008.1.2.1") != 0)
      return FAIL(STATUS_INPUT,
                  "%s: transfer syntax %s (compressed or big-endian) is not read; save it "
                  "uncompressed, little-endian",
                  dicom->path, text);
  } else if (tag == 0x00280004) {
    dicom->white_is_zero = strcmp(text, "MONOCHROME1") == 0;
    if (!dicom->white_is_zero && strcmp(text, "MONOCHROME2") != 0)
      return FAIL(STATUS_INPUT, "%s: pixels of the kind %s are not read; save as grey", dicom->path,
                  text);
  } else if (tag == 0x00280008) {
    dicom->frames = (unsigned)atoi(text);
  } else if (tag == 0x00280030) {
    if (!read_decimals(text, 2, dicom->spacing)) dicom->spacing[0] = NAN;
  } else if (tag == 0x00200032) {
    dicom->placed = read_decimals(text, 3, dicom->position);
  } else if (tag == 0x00200037) {
    dicom->oriented = read_decimals(text, 6, dicom->orientation);
  } else if (!read_decimals(text, 1, tag == 0x00281052 ? &dicom->intercept : &dicom->slope)) {
    return damaged(dicom);
  }
  return STATUS_OK;
}

static enum status read_header(const char *path, struct dicom *dicom) {
  enum status status = STATUS_OK;
  struct element element;
  *dicom =
      (struct dicom){.path = path, .frames = 1, .samples = 1, .slope = 1.0, .spacing = {NAN, NAN}};
  TRY(input_open(path, &dicom->file));
  if (fseeko(dicom->file, PREAMBLE + 4, SEEK_SET) != 0) TRY(damaged(dicom));
  for (;;) {
    if (!read_element(dicom, &element)) TRY(damaged(dicom));
    if (element.group == 0x7fe0 && element.number == 0x0010) break;
    if (element.length == UNDEFINED) {
      if (!skip_undefined(dicom, 0)) TRY(damaged(dicom));
    } else {
      TRY(take_element(dicom, &element));
    }
  }
  dicom->pixels = (uint64_t)ftello(dicom->file);
  dicom->length = element.length;
cleanup:
  return status;
}

/* The place along the normal of the slice, m; NAN if it is not told. */
static double place_along_normal(const struct dicom *d) {
  const double *r = d->orientation, *c = d->orientation + 3, *p = d->position;
  if (!d->placed || !d->oriented) return NAN;
  return 1e-3 * (p[0] * (r[1] * c[2] - r[2] * c[1]) + p[1] * (r[2] * c[0] - r[0] * c[2]) +
                 p[2] * (r[0] * c[1] - r[1] * c[0]));
}

static enum status dicom_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  struct dicom d;
  uint64_t bytes;
  TRY(read_header(path, &d));
  TRY(image_file_size(path, &bytes));
  if (d.rows == 0 || d.columns == 0 || d.frames == 0 || d.frames > INT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%s: %u x %u pixels, %u frames" EXPORT_AGAIN, path, d.columns, d.rows,
             d.frames);
  if (d.samples != 1)
    TRY_FAIL(STATUS_INPUT, "%s: %u samples a pixel; one is read: save as grey", path, d.samples);
  if (!pixel_type_of((int)d.allocated, d.is_signed ? 'i' : 'u', &image->type) || d.stored < 1 ||
      d.stored > d.allocated || d.high + 1 != d.stored)
    TRY_FAIL(STATUS_INPUT, "%s: %u bits up to bit %u of %u a pixel are not read; save as 8 or 16",
             path, d.stored, d.high, d.allocated);
  const double wanted = (double)d.rows * d.columns * d.frames * (double)pixel_size(image->type);
  if (d.length == UNDEFINED || ((double)d.length != wanted && (double)d.length != wanted + 1))
    TRY_FAIL(STATUS_INPUT,
             "%s: %.0f bytes of pixels (or compressed ones), but its header promises "
             "%.0f" EXPORT_AGAIN,
             path, (double)d.length, wanted);
  if ((double)bytes < (double)d.pixels + wanted)
    TRY_FAIL(STATUS_INPUT, "%s: ends within its pixels" EXPORT_AGAIN, path);
  image->size[0] = d.columns;
  image->size[1] = d.rows;
  image->pages = d.frames;
  image->data_offset = d.pixels;
  image->invert = d.white_is_zero;
  image->used_bits = d.stored < d.allocated ? d.stored : 0;
  image->plain = true;
  image->place = place_along_normal(&d);
  image->rescale[0] = d.slope;
  image->rescale[1] = d.intercept;
  if (d.spacing[0] > 0.0 && d.spacing[1] > 0.0) {
    image->voxel[0] = 1e-3 * d.spacing[1];
    image->voxel[1] = 1e-3 * d.spacing[0];
    image->voxel_source = "DICOM pixel spacing";
  }
  if (d.slope != 1.0 || d.intercept != 0.0)
    image_note(image, "greys as stored, before its slope %g and intercept %g", d.slope,
               d.intercept);
cleanup:
  if (d.file != NULL) fclose(d.file);
  return status;
}

/* Bits above those that are used may hold anything; those of a sign go on to the top. */
static enum status dicom_read(const struct image *image, size_t page, void *out) {
  const enum status status = image_read_contiguous(image, page, out);
  const size_t n = image->size[0] * image->size[1], bytes = pixel_size(image->type);
  const bool is_signed =
      image->type == PIXEL_I8 || image->type == PIXEL_I16 || image->type == PIXEL_I32;
  if (status != STATUS_OK || image->used_bits == 0) return status;
  const uint32_t mask = (1u << image->used_bits) - 1u, sign = 1u << (image->used_bits - 1);
  for (size_t i = 0; i < n; i++) {
    uint32_t value = 0;
    memcpy(&value, (char *)out + i * bytes, bytes);
    value &= mask;
    if (is_signed && (value & sign) != 0) value |= ~mask;
    memcpy((char *)out + i * bytes, &value, bytes);
  }
  return status;
}

const struct image_reader image_dicom_reader = {
    "DICOM", {".dcm", ".dicom", ".ima"}, dicom_claims, dicom_open, dicom_read};
