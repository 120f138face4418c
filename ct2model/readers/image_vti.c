#include "ct2model/readers/image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "common/input_file.h"
#include "common/memory.h"

/* ImageData of VTK in XML: one piece with one array of numbers, appended raw and uncompressed
 * ("VTK XML Formats"). The XML is scanned for its elements; all else is refused. */

enum { XML_MOST = 1 << 20 };

static bool vti_claims(const char *path, const unsigned char *head, size_t n) {
  const char *dot = strrchr(path, '.');
  return n > 20 && dot != NULL && strcasecmp(dot, ".vti") == 0 &&
         (head[0] == '<' || head[0] == 0xef);
}

/* The next element `<name` from `at` on; NULL if there is none. */
static const char *next_element(const char *at, const char *name) {
  const size_t length = strlen(name);
  while ((at = strchr(at, '<')) != NULL) {
    at++;
    if (strncmp(at, name, length) == 0 && strchr(" \t\r\n>/", at[length]) != NULL &&
        at[length] != '\0')
      return at;
  }
  return NULL;
}

/* The value of an attribute of the element at `at`; false if it has none. */
static bool attribute(const char *at, const char *name, char *value, size_t size) {
  const size_t length = strlen(name);
  char quote = '\0';
  value[0] = '\0';
  for (const char *c = at; *c != '\0' && (quote != '\0' || *c != '>'); c++) {
    if (quote != '\0') {
      if (*c == quote) quote = '\0';
      continue;
    }
    if (*c == '"' || *c == '\'') quote = *c;
    if (c == at || strchr(" \t\r\n", c[-1]) == NULL || strncmp(c, name, length) != 0) continue;
    const char *from = c + length;
    from += strspn(from, " \t\r\n");
    if (*from != '=') continue;
    from += 1 + strspn(from + 1, " \t\r\n");
    if (*from != '"' && *from != '\'') return false;
    const char *to = strchr(from + 1, *from);
    if (to == NULL || (size_t)(to - from) > size) return false;
    snprintf(value, size, "%.*s", (int)(to - from - 1), from + 1);
    return true;
  }
  return false;
}

static bool read_type(const char *name, struct image *image) {
  static const struct {
    const char *name;
    enum pixel_type type;
    int widened;
  } TYPES[] = {{"UInt8", PIXEL_U8, WIDENED_NOT},    {"Int8", PIXEL_I8, WIDENED_NOT},
               {"UInt16", PIXEL_U16, WIDENED_NOT},  {"Int16", PIXEL_I16, WIDENED_NOT},
               {"UInt32", PIXEL_U32, WIDENED_NOT},  {"Int32", PIXEL_I32, WIDENED_NOT},
               {"Float32", PIXEL_F32, WIDENED_NOT}, {"Float64", PIXEL_F64, WIDENED_NOT},
               {"Int64", PIXEL_F64, WIDENED_I64},   {"UInt64", PIXEL_F64, WIDENED_U64}};
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++) {
    if (strcmp(name, TYPES[i].name) != 0) continue;
    image->type = TYPES[i].type;
    image->widened = TYPES[i].widened;
    return true;
  }
  return false;
}

/* Reads the text before the pixels, comments blanked out. *start is the place of the first byte of
 * the appended data. */
static enum status read_xml(const char *path, FILE *file, char **xml, uint64_t *start) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(xml, XML_MOST + 1, 1, "the head of a VTI file"));
  const size_t got = fread(*xml, 1, XML_MOST, file);
  char *end = NULL;
  for (char *c = *xml; c + 13 < *xml + got && end == NULL; c++) {
    if (strncmp(c, "<!--", 4) == 0) {
      char *over = strstr(c, "-->");
      if (over == NULL) break;
      memset(c, ' ', (size_t)(over - c) + 3);
    }
    if (strncmp(c, "<AppendedData", 13) == 0) end = strchr(c, '>');
  }
  if (end == NULL)
    TRY_FAIL(STATUS_INPUT,
             "%s: has no appended data; save it with the data mode Appended, not encoded, not "
             "compressed",
             path);
  const size_t room = (size_t)(*xml + got - end);
  const char *mark = memchr(end, '_', room);
  if (mark == NULL || strspn(end + 1, " \t\r\n") != (size_t)(mark - end - 1))
    TRY_FAIL(STATUS_INPUT, "%s: no _ before its appended data" EXPORT_AGAIN, path);
  *start = (uint64_t)(mark + 1 - *xml);
  end[1] = '\0';
  if (strlen(*xml) != (size_t)(end + 1 - *xml))
    TRY_FAIL(STATUS_INPUT, "%s: its head is no text" EXPORT_AGAIN, path);
cleanup:
  return status;
}

static enum status read_extent(const char *path, const char *grid, const char *piece, bool cells,
                               struct image *image) {
  char whole[120], part[120];
  long long e[6];
  if (!attribute(grid, "WholeExtent", whole, sizeof whole) ||
      sscanf(whole, "%lld %lld %lld %lld %lld %lld", &e[0], &e[1], &e[2], &e[3], &e[4], &e[5]) != 6)
    return FAIL(STATUS_INPUT, "%s: WholeExtent is not six whole numbers" EXPORT_AGAIN, path);
  if (attribute(piece, "Extent", part, sizeof part) && strcmp(part, whole) != 0)
    return FAIL(STATUS_INPUT, "%s: a piece of extent %s of %s; save the whole image", path, part,
                whole);
  size_t n[3];
  for (int a = 0; a < 3; a++) {
    const long long count = e[2 * a + 1] - e[2 * a] + (cells ? 0 : 1);
    if (count < 1 || count > INT32_MAX || llabs(e[2 * a]) > INT32_MAX)
      return FAIL(STATUS_INPUT, "%s: WholeExtent %s is of no image" EXPORT_AGAIN, path, whole);
    n[a] = (size_t)count;
  }
  image->size[0] = n[0];
  image->size[1] = n[1];
  image->pages = n[2];
  return STATUS_OK;
}

/* The one array of the piece. */
static enum status find_array(const char *path, const char *piece, const char **array,
                              bool *cells) {
  const char *point_data = next_element(piece, "PointData");
  const char *cell_data = next_element(piece, "CellData");
  *array = next_element(piece, "DataArray");
  if (*array == NULL || next_element(*array, "DataArray") != NULL)
    return FAIL(STATUS_INPUT, "%s: %s; save the one that is the scan", path,
                *array == NULL ? "has no array" : "has several arrays");
  *cells = cell_data != NULL && cell_data < *array &&
           (point_data == NULL || point_data < cell_data || point_data > *array);
  return STATUS_OK;
}

static enum status vti_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  char *xml = NULL, text[120];
  const char *array;
  unsigned char head[8];
  uint64_t start = 0;
  bool cells;
  FILE *file = NULL;
  TRY(input_open(path, &file));
  TRY(read_xml(path, file, &xml, &start));
  const char *vtk = next_element(xml, "VTKFile"), *grid = next_element(xml, "ImageData");
  const char *piece = next_element(xml, "Piece"), *data = next_element(xml, "AppendedData");
  if (vtk == NULL || grid == NULL || piece == NULL || data == NULL ||
      !attribute(vtk, "type", text, sizeof text) || strcmp(text, "ImageData") != 0)
    TRY_FAIL(STATUS_INPUT, "%s: no ImageData of VTK; save it as that", path);
  if (next_element(piece, "Piece") != NULL)
    TRY_FAIL(STATUS_INPUT, "%s: several pieces are not read; save one", path);
  if (attribute(vtk, "compressor", text, sizeof text) ||
      !attribute(data, "encoding", text, sizeof text) || strcmp(text, "raw") != 0)
    TRY_FAIL(STATUS_INPUT,
             "%s: compressed or encoded data are not read; save with the data mode Appended, not "
             "encoded, not compressed",
             path);
  TRY(find_array(path, piece, &array, &cells));
  if (!attribute(array, "format", text, sizeof text) || strcmp(text, "appended") != 0)
    TRY_FAIL(STATUS_INPUT, "%s: its array is not appended; save with the data mode Appended", path);
  if (attribute(array, "NumberOfComponents", text, sizeof text) && strcmp(text, "1") != 0)
    TRY_FAIL(STATUS_INPUT, "%s: %s numbers a voxel; one is read: save the grey alone", path, text);
  if (!attribute(array, "type", text, sizeof text) || !read_type(text, image))
    TRY_FAIL(STATUS_INPUT, "%s: an array of type %s is not read; save integers or floats", path,
             text);
  TRY(read_extent(path, grid, piece, cells, image));
  const bool wide = attribute(vtk, "header_type", text, sizeof text) && strcmp(text, "UInt64") == 0;
  image->swap = attribute(vtk, "byte_order", text, sizeof text) && strcmp(text, "BigEndian") == 0;
  char *end = NULL;
  errno = 0;
  const long long offset =
      attribute(array, "offset", text, sizeof text) ? strtoll(text, &end, 10) : -1;
  if (offset < 0 || errno != 0 || *end != '\0')
    TRY_FAIL(STATUS_INPUT, "%s: offset %s of its array is no number" EXPORT_AGAIN, path, text);
  const size_t width = wide ? 8 : 4;
  uint64_t told = 0;
  if (fseeko(file, (off_t)(start + (uint64_t)offset), SEEK_SET) != 0 ||
      fread(head, 1, width, file) != width)
    TRY_FAIL(STATUS_INPUT, "%s: ends before its array" EXPORT_AGAIN, path);
  for (size_t i = 0; i < width; i++)
    told |= (uint64_t)head[i] << 8 * (image->swap ? width - 1 - i : i);
  const double wanted = (double)image->size[0] * (double)image->size[1] * (double)image->pages *
                        (double)image_stored_size(image);
  if ((double)told != wanted)
    TRY_FAIL(STATUS_INPUT,
             "%s: its array has %llu bytes, but its extent promises %.0f" EXPORT_AGAIN, path,
             (unsigned long long)told, wanted);
  if (attribute(grid, "Direction", text, sizeof text) && strcmp(text, "1 0 0 0 1 0 0 0 1") != 0)
    image_note(image, "its axes are turned (Direction): read as stored");
  if (attribute(grid, "Spacing", text, sizeof text))
    image_note(image, "Spacing = %.60s has no unit; --voxel-size decides", text);
  image->data_offset = start + (uint64_t)offset + width;
  image->plain = true;
  uint64_t bytes;
  TRY(image_file_size(path, &bytes));
  if ((double)bytes < (double)image->data_offset + wanted)
    TRY_FAIL(STATUS_INPUT, "%s: ends within its array" EXPORT_AGAIN, path);
cleanup:
  if (file != NULL) fclose(file);
  memory_free(&xml);
  return status;
}

const struct image_reader image_vti_reader = {
    "VTI", {".vti"}, vti_claims, vti_open, image_read_contiguous};
