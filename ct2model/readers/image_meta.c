#include "ct2model/readers/image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* MetaImage: "Key = value" lines; ElementDataFile is the last and names the pixels or LOCAL. */

static bool meta_claims(const char *path, const unsigned char *head, size_t n) {
  const char *dot = strrchr(path, '.');
  (void)head;
  return n > 10 && dot != NULL && (strcasecmp(dot, ".mhd") == 0 || strcasecmp(dot, ".mha") == 0);
}

static bool element_type(const char *name, enum pixel_type *type) {
  static const struct {
    const char *name;
    enum pixel_type type;
  } TYPES[] = {{"MET_UCHAR", PIXEL_U8},  {"MET_CHAR", PIXEL_I8},   {"MET_USHORT", PIXEL_U16},
               {"MET_SHORT", PIXEL_I16}, {"MET_UINT", PIXEL_U32},  {"MET_INT", PIXEL_I32},
               {"MET_FLOAT", PIXEL_F32}, {"MET_DOUBLE", PIXEL_F64}};
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++) {
    if (strcmp(name, TYPES[i].name) == 0) {
      *type = TYPES[i].type;
      return true;
    }
  }
  return false;
}

static enum status meta_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  char line[512], key[64], value[400];
  bool sized = false, typed = false, placed = false, compressed = false;
  int dimensions = 3;
  FILE *file = fopen(path, "rb");
  if (file == NULL) TRY_FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  for (int number = 1; !placed && fgets(line, sizeof line, file) != NULL; number++) {
    if (sscanf(line, " %63[^ =\t] = %399[^\r\n]", key, value) != 2) continue;
    if (strcmp(key, "NDims") == 0) {
      dimensions = atoi(value);
      if (dimensions != 2 && dimensions != 3)
        TRY_FAIL(STATUS_INPUT, "%s:%d: NDims = %s; 2 or 3 are read: save one volume", path, number,
                 value);
    } else if (strcmp(key, "DimSize") == 0) {
      image->pages = 1;
      if (value[0] == '-' || sscanf(value, "%zu %zu %zu", &image->size[0], &image->size[1],
                                    &image->pages) < dimensions)
        TRY_FAIL(STATUS_INPUT, "%s:%d: DimSize = %s is not %d numbers", path, number, value,
                 dimensions);
      sized = true;
    } else if (strcmp(key, "ElementSpacing") == 0 || strcmp(key, "ElementSize") == 0) {
      /* The format has no unit; ITK users mean millimetres, so it is only shown. */
      snprintf(image->note, sizeof image->note, "%.40s = %.60s has no unit; --voxel-size decides",
               key, value);
    } else if (strcmp(key, "ElementType") == 0) {
      typed = element_type(value, &image->type);
      if (!typed)
        TRY_FAIL(STATUS_INPUT,
                 "%s:%d: ElementType = %s is not read; save integers of 8 to 32 bits or floats",
                 path, number, value);
    } else if (strcmp(key, "CompressedData") == 0) {
      compressed = strcasecmp(value, "True") == 0;
    } else if (strcmp(key, "ElementNumberOfChannels") == 0 && atoi(value) != 1) {
      TRY_FAIL(STATUS_INPUT, "%s:%d: %s channels; one is read: save as grey", path, number, value);
    } else if (strcmp(key, "BinaryDataByteOrderMSB") == 0 ||
               strcmp(key, "ElementByteOrderMSB") == 0) {
      image->swap = strcasecmp(value, "True") == 0;
    } else if (strcmp(key, "HeaderSize") == 0) {
      long long header = atoll(value);
      if (header < -1)
        TRY_FAIL(STATUS_INPUT, "%s:%d: HeaderSize = %s is not read; it counts bytes, or is -1",
                 path, number, value);
      image->data_offset = header < 0 ? PIXELS_AT_END : (uint64_t)header;
    } else if (strcmp(key, "ElementDataFile") == 0) {
      placed = true;
      if (strcasecmp(value, "LOCAL") == 0)
        image->data_offset = (uint64_t)ftell(file);
      else if (strcasecmp(value, "LIST") == 0 || strchr(value, '%') != NULL)
        TRY_FAIL(STATUS_INPUT, "%s:%d: give the listed slices themselves instead", path, number);
      else
        TRY(image_data_beside(image, value, number));
    }
  }
  if (!sized || !typed || !placed)
    TRY_FAIL(STATUS_INPUT, "%s: %s is missing" EXPORT_AGAIN, path,
             !sized   ? "DimSize"
             : !typed ? "ElementType"
                      : "ElementDataFile");
  image->plain = true;
  TRY(image_claim_pixels(image, compressed));
cleanup:
  if (file != NULL) fclose(file);
  return status;
}

const struct image_reader image_meta_reader = {
    "MetaImage", {".mhd", ".mha"}, meta_claims, meta_open, image_read_contiguous};
