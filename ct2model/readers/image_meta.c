#include "ct2model/readers/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "common/input_file.h"
#include "ct2model/readers/image_data.h"
#include "ct2model/readers/image_shape.h"

/* MetaImage: "Key = value" lines; ElementDataFile is the last and names the pixels, LOCAL, a
 * pattern of names or a LIST. Programs add keys of their own, so that unknown ones are passed over.
 */

static bool meta_claims(const char *path, const unsigned char *head, size_t n) {
  const char *dot = strrchr(path, '.');
  (void)head;
  return n > 10 && dot != NULL && (strcasecmp(dot, ".mhd") == 0 || strcasecmp(dot, ".mha") == 0);
}

static bool element_type(const char *name, struct image *image) {
  static const struct {
    const char *name;
    int bits;
    char format;
  } TYPES[] = {{"MET_UCHAR", 8, 'u'},      {"MET_CHAR", 8, 'i'},    {"MET_USHORT", 16, 'u'},
               {"MET_SHORT", 16, 'i'},     {"MET_UINT", 32, 'u'},   {"MET_INT", 32, 'i'},
               {"MET_FLOAT", 32, 'f'},     {"MET_DOUBLE", 64, 'f'}, {"MET_LONG_LONG", 64, 'i'},
               {"MET_ULONG_LONG", 64, 'u'}};
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++)
    if (strcmp(name, TYPES[i].name) == 0)
      return image_take_type(image, TYPES[i].bits, TYPES[i].format);
  return false;
}

struct meta_header {
  int dimensions;
  char sizes[200];
  bool sized, typed, placed, compressed, ordered;
};

static enum status read_sizes(const char *path, const struct meta_header *header,
                              struct image *image) {
  size_t n[AXES_MOST];
  int axis[3], count = 0;
  const char *at = header->sizes;
  while (count < header->dimensions) {
    char *end;
    const unsigned long long size = strtoull(at, &end, 10);
    if (end == at || size == 0 || strchr(header->sizes, '-') != NULL) break;
    n[count++] = (size_t)size;
    at = end;
  }
  if (count < header->dimensions || at[strspn(at, " \t")] != '\0')
    return FAIL(STATUS_INPUT, "%s: DimSize = %s is not %d numbers above zero", path, header->sizes,
                header->dimensions);
  if (!image_choose_axes(n, count, axis))
    return FAIL(STATUS_INPUT,
                "%s: NDims = %d, DimSize = %s; 2 or 3 axes (and others of one) are read: save one "
                "volume",
                path, header->dimensions, header->sizes);
  image->size[0] = n[axis[0]];
  image->size[1] = n[axis[1]];
  image->pages = axis[2] < 0 ? 1 : n[axis[2]];
  return STATUS_OK;
}

/* ElementDataFile. */
static enum status place_pixels(const char *value, FILE *file, int number,
                                const struct meta_header *header, struct image *image) {
  if (strcasecmp(value, "LOCAL") == 0) {
    const uint64_t start = (uint64_t)ftello(file);
    if (image->data_offset == PIXELS_AT_END) return STATUS_OK;
    image->packed_offset = header->compressed ? start : 0;
    image->data_offset = header->compressed ? 0 : start;
    return STATUS_OK;
  }
  if (header->compressed && image->data_offset != PIXELS_AT_END) {
    image->packed_offset = image->data_offset;
    image->data_offset = 0;
  }
  if (strncasecmp(value, "LIST", 4) == 0 && (value[4] == '\0' || value[4] == ' '))
    return image_data_list(image, file, number);
  return strchr(value, '%') != NULL ? image_data_pattern(image, value, number)
                                    : image_data_beside(image, value, number);
}

static enum status read_key(const char *path, const char *key, const char *value, int number,
                            struct meta_header *header, struct image *image) {
  static const char *const TRUTHS[] = {"CompressedData", "BinaryData", "BinaryDataByteOrderMSB",
                                       "ElementByteOrderMSB"};
  const bool truth = strchr("Tt1", value[0]) != NULL && value[0] != '\0'; /* as MetaIO reads it */
  for (size_t i = 0; i < sizeof TRUTHS / sizeof *TRUTHS; i++)
    if (strcasecmp(key, TRUTHS[i]) == 0 && !truth && strchr("Ff0", value[0]) == NULL)
      return FAIL(STATUS_INPUT, "%s:%d: %s = %s is neither True nor False", path, number, key,
                  value);
  if (strcasecmp(key, "NDims") == 0) {
    header->dimensions = atoi(value);
    if (header->dimensions < 2 || header->dimensions > AXES_MOST)
      return FAIL(STATUS_INPUT, "%s:%d: NDims = %s; 2 or 3 are read: save one volume", path, number,
                  value);
  } else if (strcasecmp(key, "DimSize") == 0) {
    if (header->sized)
      return FAIL(STATUS_INPUT, "%s:%d: a second DimSize; one counts, and which is unclear", path,
                  number);
    snprintf(header->sizes, sizeof header->sizes, "%s", value);
    header->sized = true;
  } else if (strcasecmp(key, "ElementSpacing") == 0 || strcasecmp(key, "ElementSize") == 0) {
    /* The format has no unit; ITK users mean millimetres, so it is only shown. */
    image_note(image, "%.40s = %.60s has no unit; --voxel-size decides", key, value);
  } else if (strcasecmp(key, "ElementType") == 0) {
    header->typed = element_type(value, image);
    if (!header->typed)
      return FAIL(STATUS_INPUT, "%s:%d: ElementType = %s is not read; save integers or floats",
                  path, number, value);
  } else if (strcasecmp(key, "CompressedData") == 0) {
    header->compressed = truth;
  } else if (strcasecmp(key, "BinaryData") == 0 && !truth) {
    return FAIL(STATUS_INPUT, "%s:%d: pixels as text (BinaryData = %s) are not read; save binary",
                path, number, value);
  } else if (strcasecmp(key, "ElementNumberOfChannels") == 0 && atoi(value) != 1) {
    return FAIL(STATUS_INPUT, "%s:%d: %s channels; one is read: save as grey", path, number, value);
  } else if (strcasecmp(key, "BinaryDataByteOrderMSB") == 0 ||
             strcasecmp(key, "ElementByteOrderMSB") == 0) {
    if (header->ordered && image->swap != truth)
      return FAIL(STATUS_INPUT,
                  "%s:%d: %s = %s, but another line has the other order; which is it?", path,
                  number, key, value);
    header->ordered = true;
    image->swap = truth;
  } else if (strcasecmp(key, "ElementToIntensityFunctionSlope") == 0 ||
             strcasecmp(key, "ElementToIntensityFunctionOffset") == 0) {
    const bool slope = strstr(key, "Slope") != NULL;
    image->rescale[slope ? 0 : 1] = strtod(value, NULL);
    if (image->rescale[slope ? 0 : 1] != (slope ? 1.0 : 0.0))
      image_note(image, "greys as stored, before its %s %.30s", slope ? "slope" : "offset", value);
  } else if (strcasecmp(key, "TransformMatrix") == 0 || strcasecmp(key, "Orientation") == 0 ||
             strcasecmp(key, "Rotation") == 0) {
    if (image_is_turn(value, header->dimensions))
      image_note(image, "its axes are turned (%s): read as stored", key);
  } else if (strcasecmp(key, "HeaderSizePerSlice") == 0 && atoi(value) != 0) {
    return FAIL(STATUS_INPUT, "%s:%d: a header before every slice is not read; save one volume",
                path, number);
  } else if (strcasecmp(key, "HeaderSize") == 0) {
    const long long bytes = atoll(value);
    if (bytes < -1)
      return FAIL(STATUS_INPUT, "%s:%d: HeaderSize = %s is not read; it counts bytes, or is -1",
                  path, number, value);
    image->placed = true;
    image->data_offset = bytes < 0 ? PIXELS_AT_END : (uint64_t)bytes;
  }
  return STATUS_OK;
}

static enum status meta_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  char line[1 << 15], key[64], value[1024];
  struct meta_header header = {.dimensions = 3};
  bool more = true;
  FILE *file = NULL;
  TRY(input_open(path, &file));
  for (int number = 0; !header.placed;) {
    TRY(image_header_line(path, file, line, sizeof line, &number, &more));
    if (!more) break;
    if (sscanf(line, " %63[^ :=\t] %*[:=] %1023[^\r\n]", key, value) != 2) continue;
    for (char *end = value + strlen(value); end > value && (end[-1] == ' ' || end[-1] == '\t');)
      *--end = '\0';
    header.placed = strcasecmp(key, "ElementDataFile") == 0;
    TRY(header.placed ? place_pixels(value, file, number, &header, image)
                      : read_key(path, key, value, number, &header, image));
  }
  if (!header.sized || !header.typed || !header.placed)
    TRY_FAIL(STATUS_INPUT, "%s: %s is missing" EXPORT_AGAIN, path,
             !header.sized   ? "DimSize"
             : !header.typed ? "ElementType"
                             : "ElementDataFile");
  TRY(read_sizes(path, &header, image));
  image->plain = true;
  TRY(image_claim_pixels(image, header.compressed));
cleanup:
  if (file != NULL) fclose(file);
  return status;
}

const struct image_reader image_meta_reader = {.name = "MetaImage",
                                               .endings = {".mhd", ".mha"},
                                               .claims = meta_claims,
                                               .open = meta_open,
                                               .read = image_read_contiguous};
