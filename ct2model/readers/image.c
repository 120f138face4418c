#include "ct2model/readers/image.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "common/memory.h"
#include "ct2model/readers/constants.h"
#include "ct2model/readers/dataset_name.h"
#include "ct2model/readers/inflate.h"

static const struct image_reader RAW = {.name = "raw", .read = image_read_contiguous};
#define READER(name) &image_##name##_reader,
static const struct image_reader *const READERS[] = {
#include "ct2model/readers/readers.def"
};
#undef READER
#define READER_COUNT (sizeof READERS / sizeof *READERS)

bool image_name_known(const char *name) {
  const char *dot = strrchr(name, '.');
  for (size_t i = 0; dot != NULL && i < READER_COUNT; i++)
    for (const char *const *ending = READERS[i]->endings; *ending != NULL; ending++)
      if (strcasecmp(dot, *ending) == 0) return true;
  return false;
}

/* "TIFF, PNG, ... or HDF5" */
static void list_readers(char *text, size_t size) {
  text[0] = '\0';
  for (size_t i = 0, used = 0; i < READER_COUNT && used < size; i++)
    used += (size_t)snprintf(text + used, size - used, "%s%s",
                             i == 0                 ? ""
                             : i + 1 < READER_COUNT ? ", "
                                                    : " or ",
                             READERS[i]->name);
}

uint64_t image_number(const unsigned char *at, size_t bytes, bool big) {
  uint64_t number = 0;
  for (size_t i = 0; i < bytes; i++) number = number << 8 | at[big ? i : bytes - 1 - i];
  return number;
}

enum status image_file_size(const char *path, uint64_t *size) {
  struct stat info;
  if (stat(path, &info) != 0) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  if (!S_ISREG(info.st_mode)) /* reading a pipe might never end */
    return FAIL(STATUS_INPUT, "%s: a %s, not an image file", path,
                S_ISDIR(info.st_mode) ? "folder" : "pipe or device");
  *size = (uint64_t)info.st_size;
  return STATUS_OK;
}

enum status raw_layout_parse(const char *text, struct raw_layout *layout) {
  static const struct {
    const char *name;
    int bits;
    char format;
    bool big_endian;
  } TYPES[] = {
      {"u8", 8, 'u', false},     {"i8", 8, 'i', false},     {"u16le", 16, 'u', false},
      {"u16be", 16, 'u', true},  {"i16le", 16, 'i', false}, {"i16be", 16, 'i', true},
      {"u32le", 32, 'u', false}, {"u32be", 32, 'u', true},  {"i32le", 32, 'i', false},
      {"i32be", 32, 'i', true},  {"f32le", 32, 'f', false}, {"f32be", 32, 'f', true},
      {"f64le", 64, 'f', false}, {"f64be", 64, 'f', true},
  };
  char name[8] = "";
  int used = 0;
  memset(layout, 0, sizeof *layout);
  if (strchr(text, '-') == NULL &&
      sscanf(text, "%zux%zux%zu:%7[a-z0-9]%n", &layout->size[0], &layout->size[1], &layout->size[2],
             name, &used) == 4 &&
      layout->size[0] > 0 && layout->size[1] > 0 && layout->size[2] > 0) {
    const char *rest = text + used, *digits = rest + (rest[0] == ':');
    const size_t length = strspn(digits, "0123456789");
    const bool placed = digits > rest && length > 0 && length < 19 && digits[length] == '\0';
    for (size_t i = 0; i < sizeof TYPES / sizeof *TYPES && (rest[0] == '\0' || placed); i++) {
      if (strcmp(name, TYPES[i].name) != 0) continue;
      layout->given = true;
      layout->big_endian = TYPES[i].big_endian;
      layout->offset = placed ? strtoull(digits, NULL, 10) : 0;
      (void)pixel_type_of(TYPES[i].bits, TYPES[i].format, &layout->type);
      return STATUS_OK;
    }
  }
  return FAIL(STATUS_USAGE,
              "--raw %s: write NXxNYxNZ:TYPE with TYPE one of u8 i8 u16le u16be i16le i16be u32le "
              "u32be i32le i32be f32le f32be f64le f64be, e.g. 480x480x256:u16le, and :BYTES after "
              "it where each file begins with so many bytes of another kind",
              text);
}

static enum status raw_open(const struct raw_layout *raw, struct image *image) {
  uint64_t bytes = 0;
  size_t page_bytes;
  enum status status = image_file_size(image->path, &bytes);
  if (status != STATUS_OK) return status;
  if (!size_multiply(raw->size[0], raw->size[1], &page_bytes) ||
      !size_multiply(page_bytes, pixel_size(raw->type), &page_bytes))
    return FAIL(STATUS_USAGE, "--raw: slices of %zux%zu are too large", raw->size[0], raw->size[1]);
  image->reader = &RAW;
  image->size[0] = raw->size[0];
  image->size[1] = raw->size[1];
  image->type = raw->type;
  image->data_offset = raw->offset;
  image->swap = raw->big_endian;
  image->plain = true;
  const uint64_t there = bytes > raw->offset ? bytes - raw->offset : 0;
  image->pages = (size_t)(there / page_bytes);
  if (image->pages == 0 || there % page_bytes != 0)
    return FAIL(STATUS_INPUT,
                "%s: %llu bytes are not whole slices of %zux%zu %s (%zu bytes each); check --raw, "
                "to which NXxNYxNZ:TYPE:BYTES adds the length of a header",
                image->path, (unsigned long long)there, raw->size[0], raw->size[1],
                pixel_name(raw->type), page_bytes);
  return STATUS_OK;
}

static enum status read_head(const char *path, unsigned char *head, size_t size, size_t *got) {
  FILE *file = fopen(path, "rb");
  if (file == NULL) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  *got = fread(head, 1, size, file);
  int failed = ferror(file);
  fclose(file);
  if (failed) return FAIL(STATUS_INPUT, "%s: cannot be read", path);
  if (*got == 0) return FAIL(STATUS_INPUT, "%s: empty file; leave it out or export it again", path);
  return STATUS_OK;
}

enum status image_open(const char *path, const struct raw_layout *raw, struct image *image) {
  enum status status = STATUS_OK;
  unsigned char head[520]; /* the signature of an HDF5 file may follow 512 bytes */
  size_t got = 0;
  uint64_t bytes = 0;
  memset(image, 0, sizeof *image);
  for (int axis = 0; axis < 3; axis++) image->voxel[axis] = NAN;
  for (int i = 0; i < 6; i++) image->axes[i] = NAN;
  for (int axis = 0; axis < 3; axis++) image->at[axis] = NAN;
  image->number = NAN;
  image->rescale[0] = 1.0;
  TRY(memory_copy_text(path, strlen(path), &image->path));
  if (raw != NULL && raw->given) {
    TRY(raw_open(raw, image));
    goto cleanup;
  }
  const char *dataset = dataset_name(path);
  if (dataset != NULL) {
    TRY(memory_allocate(&image->data_files, 1, sizeof *image->data_files, "file names"));
    TRY(memory_copy_text(path, (size_t)(dataset - path) - 1, &image->data_files[0]));
    image->data_file_count = 1;
  }
  const char *file = dataset != NULL ? image->data_files[0] : path;
  TRY(image_file_size(file, &bytes));
  TRY(read_head(file, head, sizeof head, &got));
  for (size_t i = 0; i < READER_COUNT && image->reader == NULL; i++) {
    if (READERS[i]->claims(path, head, got)) image->reader = READERS[i];
  }
  if (image->reader == NULL) {
    char formats[128];
    list_readers(formats, sizeof formats);
    TRY_FAIL(STATUS_INPUT,
             "%s: not a %s file; convert it to one of them, or for headerless pixels give --raw "
             "NXxNYxNZ:u8|u16le|...",
             path, formats);
  }
  if (dataset != NULL && image->reader != &image_hdf5_reader)
    TRY_FAIL(STATUS_INPUT, "%s: %s is no HDF5 file, which alone has datasets", path, file);
  TRY(image->reader->open(path, image));
  size_t pixels;
  if (image->size[0] == 0 || image->size[1] == 0 || image->pages == 0)
    TRY_FAIL(STATUS_INPUT, "%s: an image without pixels" EXPORT_AGAIN, path);
  if (!size_multiply(image->size[0], image->size[1], &pixels) || pixels > ((size_t)1 << 32))
    TRY_FAIL(STATUS_INPUT, "%s: slices of %zux%zu are too large", path, image->size[0],
             image->size[1]);
cleanup:
  if (status != STATUS_OK) image_close(image);
  return status;
}

void image_close(struct image *image) {
  memory_free(&image->path);
  for (size_t i = 0; i < image->data_file_count; i++) memory_free(&image->data_files[i]);
  memory_free(&image->data_files);
  image->data_file_count = 0;
  memory_free(&image->page_offsets);
  memory_free(&image->palette);
  inflate_end(image->inflated);
  image->inflated = NULL;
  if (image->reader != NULL && image->reader->close != NULL) image->reader->close(image);
}

bool image_is_screen_resolution(double pixels_per_metre) {
  static const double DPI[] = {72, 96, 100, 150, 300, 600};
  for (size_t i = 0; i < sizeof DPI / sizeof *DPI; i++) {
    if (fabs(pixels_per_metre - DPI[i] / 0.0254) < 1.0) return true;
  }
  return 1e-3 * pixels_per_metre < 1.0; /* no scan has voxels of over a millimetre */
}

enum status image_keep_palette(struct image *image, const uint16_t *colours, size_t size) {
  enum status status = STATUS_OK;
  bool grey = true;
  for (size_t i = 0; i < size; i++)
    grey &= colours[3 * i] == colours[3 * i + 1] && colours[3 * i] == colours[3 * i + 2];
  memory_free(&image->palette);
  image->palette_size = 0;
  if (grey) return STATUS_OK;
  TRY(memory_allocate(&image->palette, 3 * size, sizeof *colours, "a palette"));
  memcpy(image->palette, colours, 3 * size * sizeof *colours);
  image->palette_size = size;
cleanup:
  return status;
}

enum status image_take_greys(const struct image *image, const unsigned char *in, size_t n,
                             size_t samples, size_t first, const unsigned char *reference,
                             void *out) {
  const size_t bytes = pixel_size(image->type), used = samples > 2 ? 3 : 1, width = image->size[0];
  for (size_t i = 0; i < n; i++, in += bytes * samples) {
    if (used == 3 && (memcmp(in, in + bytes, bytes) != 0 || memcmp(in, in + 2 * bytes, bytes) != 0))
      return FAIL(STATUS_INPUT,
                  "%s: a true colour image (pixel %zu,%zu), not grey; export the scan as grey "
                  "levels",
                  image->path, (first + i) % width, (first + i) / width);
    if (memcmp(in + used * bytes, reference + used * bytes, (samples - used) * bytes) != 0)
      return FAIL(STATUS_INPUT,
                  "%s: %zu samples a pixel, of which those beyond the %s are not the same "
                  "everywhere (pixel %zu,%zu), as of a mask or transparency; save the scan alone, "
                  "as grey",
                  image->path, samples, used == 3 ? "colours" : "grey", (first + i) % width,
                  (first + i) / width);
    memcpy((char *)out + i * bytes, in, bytes);
  }
  return STATUS_OK;
}

bool image_palettes_agree(const struct image *a, const struct image *b) {
  const size_t n = a->palette_size < b->palette_size ? a->palette_size : b->palette_size;
  if (a->palette == NULL || b->palette == NULL) return a->palette == b->palette;
  return memcmp(a->palette, b->palette, 3 * n * sizeof *a->palette) == 0;
}

void image_note(struct image *image, const char *format, ...) {
  const size_t used = strlen(image->note), size = sizeof image->note;
  va_list arguments;
  if (used > 0) snprintf(image->note + used, size - used, "; ");
  const size_t start = strlen(image->note);
  va_start(arguments, format);
  vsnprintf(image->note + start, size - start, format, arguments);
  va_end(arguments);
}

void image_tell_orientation(struct image *image) {
  enum { UPRIGHT = 1, LAST_MIRRORED = 4 };
  /* Boxes refer to pixels as in ImageJ and in arrays, which ignore the orientation, too. */
  if (image->orientation > UPRIGHT)
    image_note(
        image,
        "its orientation %u says to %s it: read as stored, as ImageJ does; x and y are the file's",
        image->orientation, image->orientation <= LAST_MIRRORED ? "mirror" : "turn");
}

void image_tell_edges(struct image *image, double x, double y, double z, const char *field) {
  char along_z[32] = "";
  if (!(fabs(y / x - 1.0) > RESOLUTIONS_ALIKE) && !(fabs(z / x - 1.0) > RESOLUTIONS_ALIKE)) return;
  if (z > 0.0) snprintf(along_z, sizeof along_z, " x %.4g", z / x);
  image_note(image, "voxels of 1 x %.4g%s by its %s, without a unit; --voxel-size decides", y / x,
             along_z, field);
}

void image_no_data(struct image *image, double from, double to, const char *name) {
  if (!(from <= to) || image->no_data_count == NO_DATA_MOST) return;
  image->no_data[image->no_data_count].from = (float)from;
  image->no_data[image->no_data_count].to = (float)to;
  image->no_data[image->no_data_count++].name = name;
}

bool image_has_levels(const struct image *image) {
  double low, high;
  return image->plain && image->no_data_count == 0 && pixel_levels(image->type, &low, &high);
}

enum status image_read_stored(const struct image *image, size_t page, void *out) {
  const size_t bytes = image->size[0] * image->size[1] * pixel_size(image->type);
  enum status status = image->reader->read(image, page, out);
  unsigned char *pixels = out;
  /* Exchanging white and black, signed or not, inverts every bit. */
  const unsigned char top = image->top > 0 ? image->top : UINT8_MAX;
  for (size_t i = 0; i < bytes && image->invert && status == STATUS_OK; i++) pixels[i] ^= top;
  return status;
}

enum status image_read(const struct image *image, size_t page, float *out) {
  enum status status = STATUS_OK;
  const size_t pixels = image->size[0] * image->size[1];
  double low, high;
  void *stored = NULL;
  if (!image->plain) return image->reader->read(image, page, out);
  TRY(memory_allocate(&stored, pixels, pixel_size(image->type), "a slice"));
  TRY(image->reader->read(image, page, stored));
  pixels_to_float(out, stored, pixels, image->type);
  for (size_t k = 0; k < image->no_data_count; k++)
    for (size_t i = 0; i < pixels; i++)
      if (out[i] >= image->no_data[k].from && out[i] <= image->no_data[k].to) out[i] = NAN;
  /* White and black exchanged, as image_read_stored does it. */
  const bool levels = pixel_levels(image->type, &low, &high);
  const float ends = image->top > 0 ? image->top : levels ? (float)(low + high) : 0.0f;
  for (size_t i = 0; i < pixels && image->invert; i++) out[i] = ends - out[i];
cleanup:
  memory_free(&stored);
  return status;
}

/* Reads one page at `offset` of an uncompressed file. */
static enum status read_bytes(const char *path, uint64_t offset, size_t size, size_t page,
                              void *out) {
  int file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0) return FAIL(STATUS_INPUT, "%s: %s", path, strerror(errno));
  size_t done = 0;
  while (done < size) {
    ssize_t got = pread(file, (char *)out + done, size - done, (off_t)(offset + done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    done += (size_t)got;
  }
  close(file);
  if (done == size) return STATUS_OK;
  return FAIL(STATUS_INPUT, "%s: ends within slice %zu; the file is cut short", path, page);
}

/* Reads a page of pixels in column order, z first, whose pixels are spread through the whole file.
 * Planes of one x are read one after the other, and all that is not of the page is dropped. */
static enum status read_columns(const struct image *image, size_t page, char *out) {
  enum status status = STATUS_OK;
  const size_t nx = image->size[0], ny = image->size[1], one = image_stored_size(image);
  const size_t bytes = image->pages * ny * one;
  unsigned char *plane = NULL;
  TRY(memory_allocate(&plane, bytes, 1, "columns of an array"));
  for (size_t x = 0; x < nx; x++) {
    TRY(read_bytes(image->path, image->data_offset + (uint64_t)x * bytes, bytes, page, plane));
    for (size_t y = 0; y < ny; y++)
      memcpy(out + (y * nx + x) * one, plane + (y * image->pages + page) * one, one);
  }
cleanup:
  memory_free(&plane);
  return status;
}

/* IEEE 754 (2008), binary16: a sign, 5 bits of exponent, 10 of the fraction. */
static float half_value(uint16_t half) {
  const int exponent = half >> 10 & 31, fraction = half & 1023;
  const float size = exponent == 0    ? ldexpf((float)fraction, -24)
                     : exponent == 31 ? (fraction ? NAN : INFINITY)
                                      : ldexpf((float)(1024 + fraction), exponent - 25);
  return half >> 15 ? -size : size;
}

bool image_take_type(struct image *image, int bits, char format) {
  if (bits == 16 && format == 'f') {
    image->widened = WIDENED_HALF;
    bits = 32;
  } else if (bits == 64 && format != 'f') {
    image->widened = format == 'i' ? WIDENED_I64 : WIDENED_U64;
    format = 'f';
  }
  return pixel_type_of(bits, format, &image->type);
}

size_t image_stored_size(const struct image *image) {
  return image->widened == WIDENED_HALF ? sizeof(uint16_t) : pixel_size(image->type);
}

/* Types that are no pixel types are widened: floats of 16 bits to 32, integers of 64 bits to
 * floats, exact up to 2^53. `from` may lie at the end of `out`, so that writing does not overtake
 * it. */
static void widen(const struct image *image, const char *from, size_t n, char *out) {
  for (size_t i = 0; i < n; i++) {
    if (image->widened == WIDENED_HALF) {
      uint16_t half;
      memcpy(&half, from + i * sizeof half, sizeof half);
      const float value = half_value(half);
      memcpy(out + i * sizeof value, &value, sizeof value);
      continue;
    }
    uint64_t bits;
    memcpy(&bits, from + i * sizeof bits, sizeof bits);
    const double value = image->widened == WIDENED_I64 ? (double)(int64_t)bits : (double)bits;
    memcpy(out + i * sizeof value, &value, sizeof value);
  }
}

enum status image_read_contiguous(const struct image *image, size_t page, void *out) {
  const size_t pixels = image->size[0] * image->size[1], one = image_stored_size(image);
  const size_t bytes = pixels * one, files = image->data_file_count;
  const size_t each = files > 0 ? image->pages / files : image->pages; /* pages of a file */
  const char *path = files > 0 ? image->data_files[page / each] : image->path;
  const uint64_t offset = image->data_offset + (uint64_t)(page % each) * bytes;
  char *to = (char *)out + pixels * (pixel_size(image->type) - one);
  enum status status = image->columns            ? read_columns(image, page, to)
                       : image->inflated != NULL ? inflate_read(image->inflated, offset, bytes, to)
                                                 : read_bytes(path, offset, bytes, page, to);
  if (status == STATUS_OK && image->swap)
    pixels_swap(to, pixels, image->widened == WIDENED_HALF ? PIXEL_U16 : image->type);
  if (status == STATUS_OK && image->widened != WIDENED_NOT) widen(image, to, pixels, out);
  return status;
}
