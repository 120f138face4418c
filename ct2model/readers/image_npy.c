#include "ct2model/readers/image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/readers/image_shape.h"

/* NumPy's format, versions 1 to 3: magic, version, length, a Python dictionary of the shape, then
 * the pixels (numpy.lib.format). An array of a volume is [z][y][x], of one slice [y][x]. */

#define HEADER_MOST 65536

static bool npy_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n >= 10 && memcmp(head, "\x93NUMPY", 6) == 0;
}

/* The text after 'key': in the dictionary; NULL if there is none. */
static const char *value_of(const char *header, const char *key) {
  char quoted[24];
  snprintf(quoted, sizeof quoted, "'%s':", key);
  const char *at = strstr(header, quoted);
  if (at == NULL) return NULL;
  at += strlen(quoted);
  return at + strspn(at, " ");
}

static bool read_type(const char *value, struct image *image) {
  char order, format;
  int bytes;
  if (value == NULL || sscanf(value, "'%c%c%d'", &order, &format, &bytes) != 3) return false;
  if (strchr("<>|=", order) == NULL || bytes < 1 || bytes > 8) return false;
  image->swap = order == '>';
  if (format == 'b' && bytes == 1) format = 'u'; /* booleans */
  return strchr("uif", format) != NULL && image_take_type(image, 8 * bytes, format);
}

static bool read_shape(const char *value, struct image *image) {
  size_t n[AXES_MOST], turned[AXES_MOST];
  int count = 0, axis[3];
  if (value == NULL || *value++ != '(') return false;
  while (*value != ')' && count < AXES_MOST) {
    char *end;
    if (*value < '0' || *value > '9') return false;
    errno = 0;
    const unsigned long long size = strtoull(value, &end, 10);
    if (errno != 0 || size == 0 || size > (1ull << 32)) return false;
    n[count++] = (size_t)size;
    value = end + strspn(end, ", ");
  }
  if (*value != ')') return false;
  for (int a = 0; a < count; a++) turned[a] = n[count - 1 - a];
  if (!image_choose_axes(turned, count, axis)) return false;
  image->size[0] = turned[axis[0]];
  image->size[1] = turned[axis[1]];
  image->pages = axis[2] < 0 ? 1 : turned[axis[2]];
  return true;
}

static enum status npy_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  unsigned char start[12] = {0};
  char *header = NULL;
  FILE *file = fopen(path, "rb");
  if (file == NULL) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  if (fread(start, 1, 10, file) != 10) TRY_FAIL(STATUS_INPUT, "%s: ends too early", path);
  size_t length = (size_t)(start[8] | start[9] << 8), at = 10;
  if (start[6] > 1) {
    if (fread(start + 10, 1, 2, file) != 2) TRY_FAIL(STATUS_INPUT, "%s: ends too early", path);
    length |= (size_t)start[10] << 16 | (size_t)start[11] << 24;
    at = 12;
  }
  if (start[6] < 1 || start[6] > 3 || length > HEADER_MOST)
    TRY_FAIL(STATUS_INPUT, "%s: version %d of NumPy's format is not read; save with numpy.save",
             path, start[6]);
  TRY(memory_allocate(&header, length + 1, 1, "a header"));
  if (fread(header, 1, length, file) != length)
    TRY_FAIL(STATUS_INPUT, "%s: ends within its header" EXPORT_AGAIN, path);
  const char *order = value_of(header, "fortran_order");
  const char *type = value_of(header, "descr");
  if (!read_type(type, image)) {
    char name[40] = "unknown";
    if (type != NULL) (void)sscanf(type, "%39[^,}]", name);
    TRY_FAIL(STATUS_INPUT,
             "%s: an array of type %s, which is no grey; save integers, truth values or floats of "
             "up to 64 bits, e.g. image.astype('float32')",
             path, name);
  }
  if (!read_shape(value_of(header, "shape"), image))
    TRY_FAIL(STATUS_INPUT,
             "%s: is empty, over 2^32 long on an axis, or no array of 2 or 3 axes (and others of "
             "one); save one volume as [z][y][x]",
             path);
  image->columns = order != NULL && strncmp(order, "True", 4) == 0;
  image->data_offset = at + length;
  image->plain = true;
  TRY(image_claim_pixels(image, false));
cleanup:
  fclose(file);
  memory_free(&header);
  return status;
}

const struct image_reader image_npy_reader = {.name = "NumPy",
                                              .endings = {".npy"},
                                              .claims = npy_claims,
                                              .open = npy_open,
                                              .read = image_read_contiguous};
