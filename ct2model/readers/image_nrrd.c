#include "ct2model/readers/image.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "common/input_file.h"
#include "common/memory.h"
#include "ct2model/readers/image_data.h"
#include "ct2model/readers/image_shape.h"
#include "ct2model/readers/length_unit.h"

/* NRRD, versions 1 to 5 (teem.sourceforge.net/nrrd/format.html): "field: value" lines after the
 * magic, an empty line, then the pixels (or detached files). Fields are known in all their
 * spellings, in capitals or not; others are refused, as by the definition. */

static bool nrrd_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n > 8 && memcmp(head, "NRRD000", 7) == 0;
}

enum field {
  TYPE,
  DIMENSION,
  SIZES,
  ENCODING,
  ENDIAN,
  LINE_SKIP,
  BYTE_SKIP,
  SPACINGS,
  DIRECTIONS,
  UNITS,
  SPACE_UNITS,
  KINDS,
  LABELS,
  DATA_FILE,
  OLD_MIN,
  OLD_MAX,
  FIELDS, /* those that are used; the others tell nothing about greys and voxels */
  OTHER = FIELDS
};

/* The definition's fields. */
static const struct {
  const char *name;
  enum field field;
} NAMES[] = {
    {"type", TYPE},
    {"dimension", DIMENSION},
    {"sizes", SIZES},
    {"encoding", ENCODING},
    {"endian", ENDIAN},
    {"line skip", LINE_SKIP},
    {"lineskip", LINE_SKIP},
    {"byte skip", BYTE_SKIP},
    {"byteskip", BYTE_SKIP},
    {"spacings", SPACINGS},
    {"space directions", DIRECTIONS},
    {"spacedirections", DIRECTIONS},
    {"units", UNITS},
    {"space units", SPACE_UNITS},
    {"spaceunits", SPACE_UNITS},
    {"kinds", KINDS},
    {"data file", DATA_FILE},
    {"datafile", DATA_FILE},
    {"content", OTHER},
    {"number", OTHER},
    {"block size", OTHER},
    {"blocksize", OTHER},
    {"space", OTHER},
    {"space dimension", OTHER},
    {"spacedimension", OTHER},
    {"space origin", OTHER},
    {"spaceorigin", OTHER},
    {"measurement frame", OTHER},
    {"measurementframe", OTHER},
    {"thicknesses", OTHER},
    {"axis mins", OTHER},
    {"axismins", OTHER},
    {"axis maxs", OTHER},
    {"axismaxs", OTHER},
    {"centers", OTHER},
    {"centerings", OTHER},
    {"labels", LABELS},
    {"min", OTHER},
    {"max", OTHER},
    {"old min", OLD_MIN},
    {"oldmin", OLD_MIN},
    {"old max", OLD_MAX},
    {"oldmax", OLD_MAX},
    {"sample units", OTHER},
    {"sampleunits", OTHER},
};

struct nrrd_header {
  char *value[FIELDS]; /* NULL: not there */
  int line[FIELDS];
  int dimension;
  size_t sizes[AXES_MOST];
  int axis[3];
};

static bool read_type(const char *name, struct image *image) {
  static const struct {
    const char *names[7];
    int bits;
    char format;
  } TYPES[] = {
      {{"signed char", "int8", "int8_t"}, 8, 'i'},
      {{"uchar", "unsigned char", "uint8", "uint8_t"}, 8, 'u'},
      {{"short", "short int", "signed short", "signed short int", "int16", "int16_t"}, 16, 'i'},
      {{"ushort", "unsigned short", "unsigned short int", "uint16", "uint16_t"}, 16, 'u'},
      {{"int", "signed int", "int32", "int32_t"}, 32, 'i'},
      {{"uint", "unsigned int", "uint32", "uint32_t"}, 32, 'u'},
      {{"float"}, 32, 'f'},
      {{"double"}, 64, 'f'},
      {{"longlong", "long long", "long long int", "signed long long", "signed long long int",
        "int64", "int64_t"},
       64,
       'i'},
      {{"ulonglong", "unsigned long long", "unsigned long long int", "uint64", "uint64_t"},
       64,
       'u'},
  };
  for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES; i++)
    for (size_t k = 0; k < 7 && TYPES[i].names[k] != NULL; k++)
      if (strcasecmp(name, TYPES[i].names[k]) == 0)
        return image_take_type(image, TYPES[i].bits, TYPES[i].format);
  return false;
}

/* A line of the header: a comment, a key of the user ("key:=value") or a field. */
static enum status read_line(const char *path, char *line, int number, struct nrrd_header *header) {
  char *value = strstr(line, ": ");
  const char *key = strstr(line, ":=");
  if (line[0] == '#' || (key != NULL && (value == NULL || key < value))) return STATUS_OK;
  if (value == NULL) {
    if (number == 1) return STATUS_OK; /* the magic */
    return FAIL(STATUS_INPUT, "%s:%d: neither \"field: value\" nor a comment" EXPORT_AGAIN, path,
                number);
  }
  *value = '\0';
  for (value += 2; *value == ' ' || *value == '\t';) value++;
  for (char *end = value + strlen(value); end > value && (end[-1] == ' ' || end[-1] == '\t');)
    *--end = '\0';
  for (size_t i = 0; i < sizeof NAMES / sizeof *NAMES; i++) {
    if (strcasecmp(line, NAMES[i].name) != 0) continue;
    if (NAMES[i].field == OTHER) return STATUS_OK;
    if (header->value[NAMES[i].field] != NULL)
      return FAIL(STATUS_INPUT, "%s:%d: a second %s; one counts, and which is unclear", path,
                  number, line);
    header->line[NAMES[i].field] = number;
    return memory_copy_text(value, strlen(value), &header->value[NAMES[i].field]);
  }
  return FAIL(STATUS_INPUT,
              "%s:%d: '%.60s' is no field of NRRD; correct it, or make it a comment (#)", path,
              number, line);
}

static enum status read_header(const char *path, FILE *file, struct image *image,
                               struct nrrd_header *header) {
  enum status status = STATUS_OK;
  char line[1 << 15];
  int number = 0;
  for (bool more = true;;) {
    TRY(image_header_line(path, file, line, sizeof line, &number, &more));
    if (!more || line[0] == '\0') break;
    TRY(read_line(path, line, number, header));
    const char *names = header->value[DATA_FILE];
    if (names == NULL || image->data_file_count > 0) continue;
    if (strncmp(names, "LIST", 4) == 0 && (names[4] == '\0' || names[4] == ' ')) {
      TRY(image_data_list(image, file, number)); /* to the end of the header */
      break;
    }
    TRY(strchr(names, '%') != NULL ? image_data_pattern(image, names, number)
                                   : image_data_beside(image, names, number));
  }
cleanup:
  return status;
}

/* The whole numbers of a field, at most `most`; the number of them, or -1 if there is another word.
 */
static int whole_numbers(const char *text, long long *values, int most) {
  int count = 0;
  while (*text != '\0') {
    char *end;
    errno = 0;
    const long long value = strtoll(text, &end, 10);
    if (end == text || errno != 0 || (*end != '\0' && *end != ' ' && *end != '\t') || count == most)
      return -1;
    values[count++] = value;
    text = end + strspn(end, " \t");
  }
  return count;
}

static enum status read_shape(const char *path, struct nrrd_header *header, struct image *image) {
  long long n[AXES_MOST], dimension;
  const int sizes = whole_numbers(header->value[SIZES], n, AXES_MOST);
  if (whole_numbers(header->value[DIMENSION], &dimension, 1) != 1 || sizes != dimension)
    return FAIL(STATUS_INPUT, "%s:%d: sizes %s are not %s whole numbers, one for each dimension",
                path, header->line[SIZES], header->value[SIZES], header->value[DIMENSION]);
  for (int a = 0; a < sizes; a++) {
    if (n[a] < 1)
      return FAIL(STATUS_INPUT, "%s:%d: sizes %s: each is 1 or more", path, header->line[SIZES],
                  header->value[SIZES]);
    header->sizes[a] = (size_t)n[a];
  }
  header->dimension = sizes;
  if (!image_choose_axes(header->sizes, sizes, header->axis))
    return FAIL(STATUS_INPUT,
                "%s:%d: dimension %d, sizes %s; 2 or 3 axes (and others of one) are read: save one "
                "volume",
                path, header->line[DIMENSION], sizes, header->value[SIZES]);
  image->size[0] = header->sizes[header->axis[0]];
  image->size[1] = header->sizes[header->axis[1]];
  image->pages = header->axis[2] < 0 ? 1 : header->sizes[header->axis[2]];
  return STATUS_OK;
}

/* Axes of colours, vectors or times are not those of a volume. */
static enum status check_kinds(const char *path, const struct nrrd_header *header) {
  static const char *const OF_SPACE[] = {"domain", "space", "none", "???", "scalar", "stub"};
  const char *at = header->value[KINDS];
  for (int a = 0; at != NULL && a < header->dimension; a++) {
    char kind[40] = "";
    at += strspn(at, " \t");
    (void)sscanf(at, "%39s", kind);
    at += strlen(kind);
    /* The slowest may be a list: of slices, by programs that have no word for them. */
    bool known = kind[0] == '\0' || header->sizes[a] == 1 ||
                 (a + 1 == header->dimension && strcasecmp(kind, "list") == 0);
    for (size_t i = 0; i < sizeof OF_SPACE / sizeof *OF_SPACE; i++)
      known |= strcasecmp(kind, OF_SPACE[i]) == 0;
    if (!known)
      return FAIL(STATUS_INPUT,
                  "%s:%d: axis %d holds %zu values of kind %s, no places in space; save one volume "
                  "of greys",
                  path, header->line[KINDS], a, header->sizes[a], kind);
  }
  return STATUS_OK;
}

/* The next quoted text; false if there is none. */
static bool next_quoted(const char **at, char text[24]) {
  const char *from = *at != NULL ? strchr(*at, '"') : NULL;
  const char *to = from != NULL ? strchr(from + 1, '"') : NULL;
  if (to == NULL) return false;
  snprintf(text, 24, "%.*s", (int)(to - from - 1 < 23 ? to - from - 1 : 23), from + 1);
  *at = to + 1;
  return true;
}

/* The voxel size: `spacings` with `units`, a value an axis, or lengths of `space directions` with
 * `space units`, an entry a coordinate of space. In files of others `units` stand with directions
 * and the other way round, so that either is taken. */
static void read_spacing(const struct nrrd_header *header, struct image *image) {
  double length[AXES_MOST];
  const bool directions = header->value[DIRECTIONS] != NULL;
  const char *at = header->value[directions ? DIRECTIONS : SPACINGS];
  const char *units = header->value[directions ? SPACE_UNITS : UNITS];
  if (units == NULL) units = header->value[directions ? UNITS : SPACE_UNITS];
  const bool by_axis = units != NULL && units == header->value[UNITS];
  char unit[24];
  double metres[AXES_MOST];
  int spatial = 0, count = 0;
  while (count < AXES_MOST && next_quoted(&units, unit)) metres[count++] = length_unit(unit);
  if (at == NULL) return;
  const bool bare = count == 0;
  while (bare && count < AXES_MOST) metres[count++] = 1.0;
  for (int a = 0; a < header->dimension; a++) {
    char *end;
    double square = 0.0;
    at += strspn(at, " \t");
    if (strncasecmp(at, "none", 4) == 0) {
      length[a] = NAN;
      at += 4;
      continue;
    }
    const bool vector = *at == '(';
    const double own =
        by_axis ? (a < count ? metres[a] : NAN) : (spatial < count ? metres[spatial] : NAN);
    spatial++;
    for (int c = 0;; c++) {
      const double value = strtod(at + (vector ? 1 : 0), &end);
      if (end == at + (vector ? 1 : 0)) return;
      const double scale = vector && !by_axis ? (c < count ? metres[c] : NAN) : own;
      if (value != 0.0) square += value * scale * value * scale;
      at = end + strspn(end, " \t");
      if (!vector && at == end && *at != '\0') return; /* "1,5" */
      if (!vector || *at != ',') break;
    }
    if (vector && *at++ != ')') return;
    length[a] = sqrt(square);
  }
  for (int d = 0; d < 3; d++) {
    const double edge = header->axis[d] < 0 ? NAN : length[header->axis[d]];
    image->voxel[d] = edge > 0.0 && isfinite(edge) ? edge : NAN;
  }
  if (bare) {
    image_tell_edges(image, image->voxel[0], image->voxel[1], image->voxel[2],
                     directions ? "space directions" : "spacings");
    for (int d = 0; d < 3; d++) image->voxel[d] = NAN;
  }
  if (isfinite(image->voxel[0])) image->voxel_source = "NRRD spacings";
}

/* Whether the axes of the array run not along those of space, in their order. */
static bool is_turned(const char *directions) {
  double along[AXES_MOST];
  int axis = 0;
  for (const char *at = directions; at != NULL && *at != '\0' && axis < AXES_MOST; at++) {
    int count = 0;
    while ((*at == '(' || *at == ',') && count < AXES_MOST) {
      char *end;
      along[count++] = strtod(at + 1, &end);
      if (end == at + 1) return false;
      at = end + strspn(end, " \t");
    }
    if (count == 0) continue; /* "none" */
    for (int c = 0; c < count && axis < count; c++)
      if (c == axis ? along[c] < 0.0 : fabs(along[c]) > 1e-6 * fabs(along[axis])) return true;
    if (*at == '\0') break;
    axis++;
  }
  return false;
}

/* Where the pixels begin: after the header and `line skip` lines, then `byte skip` bytes, of the
 * unpacked ones where they are compressed. */
static enum status place_pixels(const char *path, FILE *header_file, bool compressed,
                                const struct nrrd_header *header, struct image *image) {
  enum status status = STATUS_OK;
  long long lines = 0, bytes = 0;
  const char *skips = header->value[LINE_SKIP], *byte_skip = header->value[BYTE_SKIP];
  FILE *own = NULL, *file = header_file;
  if (skips != NULL && (whole_numbers(skips, &lines, 1) != 1 || lines < 0))
    TRY_FAIL(STATUS_INPUT, "%s:%d: line skip %s is not read; it counts lines", path,
             header->line[LINE_SKIP], skips);
  if (byte_skip != NULL && (whole_numbers(byte_skip, &bytes, 1) != 1 || bytes < -1))
    TRY_FAIL(STATUS_INPUT, "%s:%d: byte skip %s is not read; it counts bytes, or is -1", path,
             header->line[BYTE_SKIP], byte_skip);
  image->placed = lines > 0 || byte_skip != NULL;
  if (bytes < 0) {
    image->data_offset = PIXELS_AT_END;
    goto cleanup;
  }
  if (lines > 0 && image->data_file_count > 1)
    TRY_FAIL(STATUS_INPUT, "%s:%d: lines are skipped in one file, not in several; say byte skip",
             path, header->line[LINE_SKIP]);
  if (image->data_file_count > 0) {
    file = NULL;
    if (lines > 0 && (own = fopen(image->data_files[0], "rb")) == NULL)
      TRY_FAIL(STATUS_INPUT, "%s: %s", image->data_files[0], strerror(errno));
    file = own;
  }
  while (lines > 0) {
    const int c = getc(file);
    if (c == EOF)
      TRY_FAIL(STATUS_INPUT, "%s:%d: line skip %s: there are not so many lines", path,
               header->line[LINE_SKIP], skips);
    lines -= c == '\n';
  }
  const uint64_t start = file != NULL ? (uint64_t)ftello(file) : 0;
  image->packed_offset = compressed ? start : 0;
  image->data_offset = (uint64_t)bytes + (compressed ? 0 : start);
cleanup:
  if (own != NULL) fclose(own);
  return status;
}

/* `endian` and `encoding`. */
static enum status read_storage(const char *path, const struct nrrd_header *header,
                                struct image *image, bool *compressed) {
  const char *encoding = header->value[ENCODING], *endian = header->value[ENDIAN];
  *compressed = strcasecmp(encoding, "gzip") == 0 || strcasecmp(encoding, "gz") == 0;
  if (!*compressed && strcasecmp(encoding, "raw") != 0)
    return FAIL(STATUS_INPUT, "%s:%d: encoding %s is not read; save as raw or gzip", path,
                header->line[ENCODING], encoding);
  const bool big = endian != NULL && strcasecmp(endian, "big") == 0;
  if (endian == NULL && image_stored_size(image) > 1)
    return FAIL(STATUS_INPUT, "%s: endian is missing, the order of a pixel's bytes" EXPORT_AGAIN,
                path);
  if (endian != NULL && !big && strcasecmp(endian, "little") != 0)
    return FAIL(STATUS_INPUT, "%s:%d: endian %s is neither little nor big", path,
                header->line[ENDIAN], endian);
  image->swap = big;
  return STATUS_OK;
}

static enum status nrrd_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  static const char *const NEEDED[] = {"type", "dimension", "sizes", "encoding"};
  struct nrrd_header header = {{NULL}, {0}, 0, {0}, {0}};
  bool compressed;
  FILE *file = NULL;
  TRY(input_open(path, &file));
  TRY(read_header(path, file, image, &header));
  for (int f = 0; f < 4; f++)
    if (header.value[f] == NULL)
      TRY_FAIL(STATUS_INPUT, "%s: %s is missing" EXPORT_AGAIN, path, NEEDED[f]);
  if (!read_type(header.value[TYPE], image))
    TRY_FAIL(STATUS_INPUT, "%s:%d: type %s is not read; save integers or floats", path,
             header.line[TYPE], header.value[TYPE]);
  TRY(read_shape(path, &header, image));
  TRY(check_kinds(path, &header));
  TRY(read_storage(path, &header, image, &compressed));
  TRY(place_pixels(path, file, compressed, &header, image));
  read_spacing(&header, image);
  char order[4];
  if (header.value[LABELS] != NULL && image_names_other_order(header.value[LABELS], true, order))
    image_note(image, "its axes are %s by its labels: read as stored, as x, y, z", order);
  if (is_turned(header.value[DIRECTIONS]))
    image_note(image, "its axes are turned (space directions): read as stored");
  for (int f = OLD_MIN; f <= OLD_MAX; f++)
    if (header.value[f] != NULL && isfinite(strtod(header.value[f], NULL)))
      image_note(image, "greys as stored, before its old %s %.30s", f == OLD_MIN ? "min" : "max",
                 header.value[f]);
  image->plain = true;
  TRY(image_claim_pixels(image, compressed));
cleanup:
  if (file != NULL) fclose(file);
  for (int f = 0; f < FIELDS; f++) memory_free(&header.value[f]);
  return status;
}

const struct image_reader image_nrrd_reader = {.name = "NRRD",
                                               .endings = {".nrrd", ".nhdr"},
                                               .claims = nrrd_claims,
                                               .open = nrrd_open,
                                               .read = image_read_contiguous};
