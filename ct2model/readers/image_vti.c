#include "ct2model/readers/image.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "common/input_file.h"
#include "common/memory.h"
#include "ct2model/readers/image_shape.h"
#include "ct2model/readers/vti_data.h"

/* ImageData of VTK in XML: one piece with one array of numbers, appended or within the text, as
 * bytes, base64 or text, plain or compressed with zlib ("VTK XML Formats"). The XML is scanned for
 * its elements; all else is refused. */

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

/* "UInt8", "Float32" */
static bool read_type(const char *name, struct image *image) {
  const char *digits = name + strcspn(name, "0123456789");
  const size_t letters = (size_t)(digits - name);
  char *end;
  const long bits = strtol(digits, &end, 10);
  const char format = letters == 4 && strncmp(name, "UInt", 4) == 0    ? 'u'
                      : letters == 3 && strncmp(name, "Int", 3) == 0   ? 'i'
                      : letters == 5 && strncmp(name, "Float", 5) == 0 ? 'f'
                                                                       : ' ';
  return format != ' ' && *end == '\0' && bits <= 64 && image_take_type(image, (int)bits, format);
}

/* Reads the text before the pixels, comments blanked out: to the head of the appended data, or as
 * much of it as the head of an array within it may take. *start: the place of the first byte of the
 * appended data; 0: there are none. */
static enum status read_xml(const char *path, FILE *file, char **xml, uint64_t *start) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(xml, XML_MOST + 1, 1, "the head of a VTI file"));
  const size_t got = fread(*xml, 1, XML_MOST, file);
  char *end = NULL;
  *start = 0;
  for (char *c = *xml; c + 13 < *xml + got && end == NULL; c++) {
    if (strncmp(c, "<!--", 4) == 0) {
      char *over = strstr(c, "-->");
      if (over == NULL) break;
      memset(c, ' ', (size_t)(over - c) + 3);
    }
    if (strncmp(c, "<AppendedData", 13) == 0) end = strchr(c, '>');
  }
  if (end != NULL) {
    const size_t room = (size_t)(*xml + got - end);
    const char *mark = memchr(end, '_', room);
    if (mark == NULL || strspn(end + 1, " \t\r\n") != (size_t)(mark - end - 1))
      TRY_FAIL(STATUS_INPUT, "%s: no _ before its appended data" EXPORT_AGAIN, path);
    *start = (uint64_t)(mark + 1 - *xml);
    end[1] = '\0';
  }
  if (strlen(*xml) != (end != NULL ? (size_t)(end + 1 - *xml) : got))
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

/* In which form the numbers stand, and where. */
static enum status place_array(const char *path, const char *xml, const char *array, uint64_t start,
                               struct vti_data *data) {
  const char *vtk = next_element(xml, "VTKFile"), *appended = next_element(xml, "AppendedData");
  char text[120], other[120];
  data->wide = attribute(vtk, "header_type", text, sizeof text) && strcmp(text, "UInt64") == 0;
  data->big = attribute(vtk, "byte_order", text, sizeof text) && strcmp(text, "BigEndian") == 0;
  if (!attribute(array, "format", text, sizeof text)) text[0] = '\0';
  data->packed = attribute(vtk, "compressor", other, sizeof other) && strcmp(text, "ascii") != 0;
  if (data->packed && strcmp(other, "vtkZLibDataCompressor") != 0)
    return FAIL(STATUS_INPUT, "%s: compressed by %.60s, which is not read; save it with zlib", path,
                other);
  if (strcmp(text, "appended") == 0) {
    char *end = NULL;
    if (appended == NULL || start == 0)
      return FAIL(STATUS_INPUT, "%s: has no appended data" EXPORT_AGAIN, path);
    if (!attribute(appended, "encoding", other, sizeof other) ||
        (strcmp(other, "raw") != 0 && strcmp(other, "base64") != 0))
      return FAIL(STATUS_INPUT, "%s: encoding '%.60s' of its data is not read; save as raw", path,
                  other);
    data->form = strcmp(other, "raw") == 0 ? VTI_BYTES : VTI_BASE64;
    errno = 0;
    const long long offset =
        attribute(array, "offset", text, sizeof text) ? strtoll(text, &end, 10) : -1;
    if (offset < 0 || errno != 0 || *end != '\0')
      return FAIL(STATUS_INPUT, "%s: offset %s of its array is no number" EXPORT_AGAIN, path, text);
    data->start = start + (uint64_t)offset;
    return STATUS_OK;
  }
  if (strcmp(text, "ascii") != 0 && strcmp(text, "binary") != 0)
    return FAIL(STATUS_INPUT, "%s: format '%.60s' of its array is not read; save it appended", path,
                text);
  data->form = strcmp(text, "ascii") == 0 ? VTI_TEXT : VTI_BASE64;
  const char *body = strchr(array, '>');
  if (body == NULL || body[-1] == '/')
    return FAIL(STATUS_INPUT, "%s: its array is empty" EXPORT_AGAIN, path);
  data->start = (uint64_t)(body + 1 - xml);
  return STATUS_OK;
}

/* Whether a few bytes more than the array stand before the end of what is appended, as where the
 * header is of 64 bits and its type says 32. */
static bool has_more(FILE *file, off_t end) {
  static const char CLOSED[] = "</AppendedData";
  char rest[64];
  if (fseeko(file, end, SEEK_SET) != 0) return false;
  const size_t n = fread(rest, 1, sizeof rest, file), length = strlen(CLOSED);
  bool more = false;
  for (size_t i = 0; i + length <= n; i++) {
    if (memcmp(rest + i, CLOSED, length) == 0) return more;
    more |= strchr(" \t\r\n", rest[i]) == NULL || rest[i] == '\0';
  }
  return false; /* another array follows */
}

/* Appended bytes are read where they stand. */
static enum status claim_bytes(const char *path, const struct vti_data *data, struct image *image) {
  unsigned char head[8];
  const size_t width = data->wide ? 8 : 4;
  uint64_t bytes;
  if (fseeko(data->file, (off_t)data->start, SEEK_SET) != 0 ||
      fread(head, 1, width, data->file) != width)
    return FAIL(STATUS_INPUT, "%s: ends before its array" EXPORT_AGAIN, path);
  const uint64_t told = image_number(head, width, data->big);
  const double wanted = (double)image->size[0] * (double)image->size[1] * (double)image->pages *
                        (double)image_stored_size(image);
  if ((double)told != wanted)
    return FAIL(STATUS_INPUT,
                "%s: its array has %llu bytes, but its extent promises %.0f" EXPORT_AGAIN, path,
                (unsigned long long)told, wanted);
  image->swap = data->big;
  image->data_offset = data->start + width;
  const enum status status = image_file_size(path, &bytes);
  if (status == STATUS_OK && (double)bytes < (double)image->data_offset + wanted)
    return FAIL(STATUS_INPUT, "%s: ends within its array" EXPORT_AGAIN, path);
  if (status == STATUS_OK && has_more(data->file, (off_t)((double)image->data_offset + wanted)))
    return FAIL(STATUS_INPUT,
                "%s: bytes are left behind its array: is header_type=\"UInt%d\" right?", path,
                data->wide ? 64 : 32);
  return status;
}

/* Behind an array within the text: whether there are others. */
static enum status check_rest(const char *path, FILE *file) {
  static const char OTHER[] = "<DataArray";
  size_t alike = 0;
  for (int c = getc(file); c != EOF; c = getc(file)) {
    alike = c == OTHER[alike] ? alike + 1 : c == '<';
    if (alike + 1 == sizeof OTHER)
      return FAIL(STATUS_INPUT, "%s: has several arrays; save the one that is the scan", path);
  }
  return STATUS_OK;
}

static enum status vti_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  char *xml = NULL, text[120];
  const char *array;
  uint64_t start = 0;
  bool cells;
  struct vti_data data = {0};
  TRY(input_open(path, &data.file));
  TRY(read_xml(path, data.file, &xml, &start));
  const char *vtk = next_element(xml, "VTKFile"), *grid = next_element(xml, "ImageData");
  const char *piece = next_element(xml, "Piece");
  if (vtk == NULL || grid == NULL || piece == NULL || !attribute(vtk, "type", text, sizeof text) ||
      strcmp(text, "ImageData") != 0)
    TRY_FAIL(STATUS_INPUT, "%s: no ImageData of VTK; save it as that", path);
  if (next_element(piece, "Piece") != NULL)
    TRY_FAIL(STATUS_INPUT, "%s: several pieces are not read; save one", path);
  TRY(find_array(path, piece, &array, &cells));
  if (attribute(array, "NumberOfComponents", text, sizeof text) && strcmp(text, "1") != 0)
    TRY_FAIL(STATUS_INPUT, "%s: %s numbers a voxel; one is read: save the grey alone", path, text);
  if (!attribute(array, "type", text, sizeof text) || !read_type(text, image))
    TRY_FAIL(STATUS_INPUT, "%s: an array of type %s is not read; save integers or floats", path,
             text);
  TRY(read_extent(path, grid, piece, cells, image));
  TRY(place_array(path, xml, array, start, &data));
  if (data.form == VTI_BYTES && !data.packed)
    TRY(claim_bytes(path, &data, image));
  else
    TRY(vti_data_unpack(&data, image));
  if (start == 0) TRY(check_rest(path, data.file));
  if (attribute(grid, "Direction", text, sizeof text) && image_is_turn(text, 3))
    image_note(image, "its axes are turned (Direction): read as stored");
  if (attribute(grid, "Spacing", text, sizeof text))
    image_note(image, "Spacing = %.60s has no unit; --voxel-size decides", text);
  image->plain = true;
cleanup:
  if (data.file != NULL) fclose(data.file);
  memory_free(&xml);
  return status;
}

const struct image_reader image_vti_reader = {.name = "VTI",
                                              .endings = {".vti"},
                                              .claims = vti_claims,
                                              .open = vti_open,
                                              .read = image_read_contiguous};
