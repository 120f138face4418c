#include "ct2model/readers/image.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* NRRD: "key: value" lines after the magic, an empty line, then the pixels (or a detached file). */

static bool nrrd_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n > 8 && memcmp(head, "NRRD000", 7) == 0;
}

static bool nrrd_type(const char *name, enum pixel_type *type) {
  static const struct {
    const char *name;
    enum pixel_type type;
  } TYPES[] = {
      {"uchar", PIXEL_U8},         {"unsigned char", PIXEL_U8}, {"uint8", PIXEL_U8},
      {"uint8_t", PIXEL_U8},       {"signed char", PIXEL_I8},   {"int8", PIXEL_I8},
      {"int8_t", PIXEL_I8},        {"ushort", PIXEL_U16},       {"unsigned short", PIXEL_U16},
      {"uint16", PIXEL_U16},       {"uint16_t", PIXEL_U16},     {"short", PIXEL_I16},
      {"int16", PIXEL_I16},        {"int16_t", PIXEL_I16},      {"uint", PIXEL_U32},
      {"unsigned int", PIXEL_U32}, {"uint32", PIXEL_U32},       {"uint32_t", PIXEL_U32},
      {"int", PIXEL_I32},          {"int32", PIXEL_I32},        {"int32_t", PIXEL_I32},
      {"float", PIXEL_F32},        {"double", PIXEL_F64},
  };
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++) {
    if (strcmp(name, TYPES[i].name) == 0) {
      *type = TYPES[i].type;
      return true;
    }
  }
  return false;
}

/* Reads the lengths of "(a,b,c)" vectors, or plain spacings, in the units `units`. */
static void read_spacing(struct image *image, const char *value, const char *units) {
  double metres[3];
  const char *at = units;
  for (int axis = 0; axis < 3; axis++) {
    char unit[24] = "";
    at = at != NULL ? strchr(at, '"') : NULL;
    if (at == NULL || sscanf(at, "\"%23[^\"]\"", unit) != 1) return;
    at = strchr(at + 1, '"');
    if (at != NULL) at++;
    metres[axis] = strcmp(unit, "mm") == 0 || strcmp(unit, "millimeter") == 0 ? 1e-3
                   : strcmp(unit, "um") == 0 || strcmp(unit, "micrometer") == 0 ||
                           strcmp(unit, "micron") == 0 || strcmp(unit, "\xC2\xB5m") == 0
                       ? 1e-6
                   : strcmp(unit, "m") == 0 || strcmp(unit, "meter") == 0 ? 1.0
                                                                          : NAN;
  }
  const char *cursor = value;
  for (int axis = 0; axis < 3; axis++) {
    double v[3] = {0, 0, 0};
    char *end = NULL;
    while (*cursor == ' ') cursor++;
    if (*cursor == '(') {
      if (sscanf(cursor, "(%lf,%lf,%lf)", &v[0], &v[1], &v[2]) != 3) return;
      cursor = strchr(cursor, ')');
      if (cursor == NULL) return;
      cursor++;
    } else {
      v[0] = strtod(cursor, &end);
      if (end == cursor) return;
      cursor = end;
    }
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) * metres[axis];
    image->voxel[axis] = length > 0.0 ? length : NAN;
  }
  if (isfinite(image->voxel[0])) image->voxel_source = "NRRD spacings";
}

static enum status nrrd_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  char line[1024], spacing[256] = "", units[128] = "";
  bool typed = false, sized = false, compressed = false;
  FILE *file = fopen(path, "rb");
  if (file == NULL) TRY_FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  for (int number = 1; fgets(line, sizeof line, file) != NULL; number++) {
    line[strcspn(line, "\r\n")] = '\0';
    if (line[0] == '\0') break;
    char *value = strstr(line, ": ");
    if (line[0] == '#' || value == NULL) continue;
    *value = '\0';
    value += 2;
    if (strcmp(line, "type") == 0) {
      typed = nrrd_type(value, &image->type);
      if (!typed)
        TRY_FAIL(STATUS_INPUT,
                 "%s:%d: type %s is not read; save integers of 8 to 32 bits or floats", path,
                 number, value);
    } else if (strcmp(line, "dimension") == 0) {
      if (strcmp(value, "3") != 0 && strcmp(value, "2") != 0)
        TRY_FAIL(STATUS_INPUT, "%s:%d: dimension %s; 2 or 3 are read: save one volume", path,
                 number, value);
    } else if (strcmp(line, "sizes") == 0) {
      image->pages = 1;
      sized = value[0] != '-' &&
              sscanf(value, "%zu %zu %zu", &image->size[0], &image->size[1], &image->pages) >= 2;
    } else if (strcmp(line, "endian") == 0) {
      image->swap = strcmp(value, "big") == 0;
    } else if (strcmp(line, "encoding") == 0) {
      compressed = strcmp(value, "gzip") == 0 || strcmp(value, "gz") == 0;
      if (!compressed && strcmp(value, "raw") != 0)
        TRY_FAIL(STATUS_INPUT, "%s:%d: encoding %s is not read; save as raw or gzip", path, number,
                 value);
    } else if (strcmp(line, "spacings") == 0 || strcmp(line, "space directions") == 0) {
      snprintf(spacing, sizeof spacing, "%s", value);
    } else if (strcmp(line, "space units") == 0 || strcmp(line, "units") == 0) {
      snprintf(units, sizeof units, "%s", value);
    } else if (strcmp(line, "byte skip") == 0) {
      long long skip = atoll(value);
      if (skip < -1)
        TRY_FAIL(STATUS_INPUT, "%s:%d: byte skip %s is not read; it counts bytes, or is -1", path,
                 number, value);
      image->data_offset = skip < 0 ? PIXELS_AT_END : (uint64_t)skip;
    } else if (strcmp(line, "data file") == 0 || strcmp(line, "datafile") == 0) {
      if (strncmp(value, "LIST", 4) == 0 || strchr(value, '%') != NULL)
        TRY_FAIL(STATUS_INPUT, "%s:%d: give the listed slices themselves instead", path, number);
      TRY(image_data_beside(image, value, number));
    }
  }
  if (!typed || !sized)
    TRY_FAIL(STATUS_INPUT, "%s: %s is missing" EXPORT_AGAIN, path, !typed ? "type" : "sizes");
  if (image->data_path == NULL && image->data_offset != PIXELS_AT_END)
    image->data_offset += (uint64_t)ftell(file);
  read_spacing(image, spacing, units);
  image->plain = true;
  TRY(image_claim_pixels(image, compressed));
cleanup:
  if (file != NULL) fclose(file);
  return status;
}

const struct image_reader image_nrrd_reader = {
    "NRRD", {".nrrd", ".nhdr"}, nrrd_claims, nrrd_open, image_read_contiguous};
