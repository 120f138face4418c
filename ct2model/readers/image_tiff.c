#include "ct2model/readers/image.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <tiffio.h>
#include <unistd.h>

#include "common/memory.h"
#include "ct2model/readers/constants.h"
#include "ct2model/readers/image_shape.h"
#include "ct2model/readers/tiff_description.h"

/* libtiff has one error handler for all threads; the last message is kept per thread. */
static _Thread_local char tiff_message[160];

static void on_error(const char *module, const char *format, va_list arguments) {
  (void)module;
  /* Strips are read as a whole: instead of a row, libtiff names the largest possible number. */
  static const char NO_ROW[] = " at scanline 4294967295";
  vsnprintf(tiff_message, sizeof tiff_message, format, arguments);
  char *at = strstr(tiff_message, NO_ROW);
  if (at != NULL) memmove(at, at + sizeof NO_ROW - 1, strlen(at + sizeof NO_ROW - 1) + 1);
}

/* Set once: libtiff stores the handlers where other threads read them. */
static void handlers_set(void) {
  TIFFSetErrorHandler(on_error);
  TIFFSetWarningHandler(NULL);
}

/* A file whose header may refer to another first directory than the stored one. */
struct source {
  int file;
  uint64_t at;
  unsigned char head[16];
  size_t head_size;
};

static tmsize_t source_read(thandle_t handle, void *to, tmsize_t size) {
  struct source *source = handle;
  ssize_t got;
  do got = pread(source->file, to, (size_t)size, (off_t)source->at);
  while (got < 0 && errno == EINTR);
  if (got > 0 && source->at < source->head_size) {
    const size_t n = source->head_size - source->at;
    memcpy(to, source->head + source->at, n < (size_t)got ? n : (size_t)got);
  }
  if (got > 0) source->at += (uint64_t)got;
  return got;
}

static tmsize_t source_write(thandle_t handle, void *from, tmsize_t size) {
  (void)handle, (void)from, (void)size;
  return -1;
}

static toff_t source_size(thandle_t handle) {
  struct stat info;
  return fstat(((struct source *)handle)->file, &info) == 0 ? (toff_t)info.st_size : 0;
}

static toff_t source_seek(thandle_t handle, toff_t offset, int whence) {
  struct source *source = handle;
  const uint64_t from = whence == SEEK_CUR   ? source->at
                        : whence == SEEK_END ? source_size(handle)
                                             : 0;
  return source->at = from + offset;
}

static int source_close(thandle_t handle) {
  struct source *source = handle;
  const int failed = close(source->file);
  free(source);
  return failed;
}

/* Opens a TIFF with its first directory at `directory`; 0: where the header says. libtiff finds a
 * directory by number by reading all those before it, so that a stack of n pages would be read n
 * times; the first directory it takes directly. Plain reads are used, since a mapped file that
 * shrinks would crash the program. */
static TIFF *tiff_start(const char *path, uint64_t directory) {
  static pthread_once_t handlers = PTHREAD_ONCE_INIT;
  struct source *source =
      calloc(1, sizeof *source); /* not memory_allocate: it belongs to libtiff */
  tiff_message[0] = '\0';
  (void)pthread_once(&handlers, handlers_set);
  if (source == NULL) return NULL;
  source->file = open(path, O_RDONLY | O_CLOEXEC);
  if (source->file < 0) {
    snprintf(tiff_message, sizeof tiff_message, "%s", strerror(errno));
    free(source);
    return NULL;
  }
  unsigned char *head = source->head;
  const size_t got = directory == 0 ? 0 : (size_t)fmax(0, (double)pread(source->file, head, 16, 0));
  if (got >= 8) {
    const bool big = head[2] == 43 || head[3] == 43;
    source->head_size = big ? 16 : 8;
    for (int i = 0; i < (big ? 8 : 4); i++) {
      const int place = head[0] == 'I' ? i : (big ? 7 : 3) - i;
      head[(big ? 8 : 4) + place] = (unsigned char)(directory >> (8 * i));
    }
  }
  TIFF *tiff = TIFFClientOpen(path, "rm", source, source_read, source_write, source_seek,
                              source_close, source_size, NULL, NULL);
  if (tiff == NULL) source_close(source);
  if (tiff != NULL) source->head_size = 0; /* the header itself is read as it is stored */
  return tiff;
}

static bool tiff_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return n >= 8 && ((head[0] == 'I' && head[1] == 'I' && (head[2] == 42 || head[2] == 43)) ||
                    (head[0] == 'M' && head[1] == 'M' && (head[3] == 42 || head[3] == 43)));
}

enum { SAMPLES_MOST = 8 }; /* a pixel */

struct tiff_layout {
  uint32_t width, height;
  uint16_t bits, samples, format, photometric, compression, planar, orientation, unit;
  float resolution[2], place[2]; /* place: of the page in a larger picture; 0: not told */
};

static void layout_read(TIFF *tiff, struct tiff_layout *layout) {
  memset(layout, 0, sizeof *layout);
  TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &layout->width);
  TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &layout->height);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &layout->bits);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &layout->samples);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &layout->format);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_COMPRESSION, &layout->compression);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &layout->planar);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &layout->orientation);
  TIFFGetField(tiff, TIFFTAG_XRESOLUTION, &layout->resolution[0]);
  TIFFGetField(tiff, TIFFTAG_YRESOLUTION, &layout->resolution[1]);
  TIFFGetField(tiff, TIFFTAG_XPOSITION, &layout->place[0]);
  TIFFGetField(tiff, TIFFTAG_YPOSITION, &layout->place[1]);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_RESOLUTIONUNIT, &layout->unit);
  if (!TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &layout->photometric))
    layout->photometric = PHOTOMETRIC_MINISBLACK;
}

static enum status layout_type(const char *path, const struct tiff_layout *layout,
                               enum pixel_type *type) {
  char format = layout->format == SAMPLEFORMAT_IEEEFP ? 'f'
                : layout->format == SAMPLEFORMAT_INT  ? 'i'
                                                      : 'u';
  if (layout->format > SAMPLEFORMAT_VOID)
    return FAIL(STATUS_INPUT, "%s: complex numbers are not read; save greys", path);
  if (layout->samples < 1 || layout->samples > SAMPLES_MOST)
    return FAIL(STATUS_INPUT, "%s: %u samples a pixel are not read; save the scan alone, as grey",
                path, layout->samples);
  bool whole = layout->bits == 1 || layout->bits == 2 || layout->bits == 4; /* samples of less than
                                                                               a byte */
  if (whole && layout->samples == 1 && format == 'u') {
    *type = PIXEL_U8;
    return STATUS_OK;
  }
  if (!pixel_type_of(layout->bits, format, type))
    return FAIL(STATUS_INPUT, "%s: %s of %u bits a sample are not read; save as 8, 16 or 32 bit%s",
                path, format == 'f' ? "floats" : "pixels", layout->bits,
                format == 'f' ? ", floats as 32" : "");
  return STATUS_OK;
}

/* By what the colours of a palette are those of 8 bits: 257 by the definition, 256 as some programs
 * write them, 1 as old ones do; 0: they are none of 8 bits. */
static unsigned palette_step(uint16_t *const channels[3], size_t size) {
  static const unsigned STEPS[] = {257, 256, 1};
  for (size_t s = 0; s < sizeof STEPS / sizeof *STEPS; s++) {
    bool all = true;
    for (size_t i = 0; i < 3 * size && all; i++) {
      const unsigned colour = channels[i % 3][i / 3];
      all = colour % STEPS[s] == 0 && colour / STEPS[s] < 256;
    }
    if (all) return STEPS[s];
  }
  return 0;
}

/* Keeps the palette of a page where it has colours (image_keep_palette); *whole is false where its
 * greys, of 16 bits, do not fit in 8. */
static enum status read_palette(TIFF *tiff, const struct tiff_layout *layout, struct image *image,
                                bool *whole) {
  enum status status = STATUS_OK;
  uint16_t *channels[3], *colours = NULL;
  *whole = true;
  if (layout->photometric != PHOTOMETRIC_PALETTE) return STATUS_OK;
  if (layout->samples != 1 || layout->bits > 16 || layout->format != SAMPLEFORMAT_UINT)
    return FAIL(STATUS_INPUT, "%s: a palette of %s samples is not read; save as grey", image->path,
                pixel_name(image->type));
  const size_t size = (size_t)1 << layout->bits;
  if (!TIFFGetField(tiff, TIFFTAG_COLORMAP, &channels[0], &channels[1], &channels[2]))
    return FAIL(STATUS_INPUT, "%s: a palette image without its palette; save as grey", image->path);
  TRY(memory_allocate(&colours, 3 * size, sizeof *colours, "a palette"));
  for (size_t i = 0; i < 3 * size; i++) colours[i] = channels[i % 3][i / 3];
  TRY(image_keep_palette(image, colours, size));
  if (layout->bits <= 8 && image->palette == NULL) *whole = palette_step(channels, size) > 0;
cleanup:
  memory_free(&colours);
  return status;
}

static void read_resolution(const struct tiff_layout *layout, const char *description,
                            struct image *image) {
  const double metres = layout->unit == RESUNIT_CENTIMETER ? 0.01
                        : layout->unit == RESUNIT_INCH     ? 0.0254
                                                           : NAN;
  tiff_voxel_size(description, layout->resolution, metres, image->voxel, &image->voxel_source);
  double edge[2];
  for (int a = 0; a < 2; a++)
    edge[a] = layout->resolution[a] > 0.0f ? 1.0 / (double)layout->resolution[a] : 1.0;
  if (image->voxel_source == NULL) /* spacing is in the unit of a resolution that has no other */
    image_tell_edges(image, edge[0], edge[1],
                     isnan(metres) || !(layout->resolution[0] > 0.0f) ? tiff_spacing(description)
                                                                      : NAN,
                     "resolution or spacing");
}

/* Whether both pages tell how large pixels are, and not the same. */
static bool other_resolution(const struct tiff_layout *a, const struct tiff_layout *b) {
  bool other = false;
  for (int i = 0; i < 2; i++)
    if (a->resolution[i] > 0.0f && b->resolution[i] > 0.0f)
      other |= a->unit != b->unit ||
               fabs((double)(a->resolution[i] / b->resolution[i]) - 1.0) > RESOLUTIONS_ALIKE;
  return other;
}

/* ImageJ's calibration of greys: value = c0 + c1 * grey (cf=0), or another function of them. */
static void tell_calibration(const char *description, struct image *image) {
  char c0[40], c1[40];
  if (description != NULL && tiff_description_value(description, "cf", c0, sizeof c0) &&
      strcmp(c0, "0") != 0) {
    image_note(image, "greys as stored, before ImageJ's calibration by its function %s", c0);
    return;
  }
  if (description != NULL && tiff_description_value(description, "c0", c0, sizeof c0) &&
      tiff_description_value(description, "c1", c1, sizeof c1)) {
    image_note(image, "greys as stored, before ImageJ's calibration (%s + %s times the grey)", c0,
               c1);
    image->rescale[0] = strtod(c1, NULL);
    image->rescale[1] = strtod(c0, NULL);
  }
}

/* Names of axes, of tifffile: {"shape": [22, 18, 14], "axes": "XYZ"}; or what OME tells of
 * pages that may be no slices. */
static void tell_axes(const char *description, struct image *image) {
  if (description != NULL && strstr(description, "BinaryOnly ") != NULL)
    image_note(image,
               "which slices and channels its pages are stands in another file (BinaryOnly), "
               "which is not read: they are taken as slices");
  if (description != NULL && strstr(description, "ModuloAlongZ ") != NULL)
    image_note(image, "along z it has angles or others, as its text tells (ModuloAlongZ): read as "
                      "slices; if they are projections reconstruct them first");
  const char *at =
      description != NULL && description[0] == '{' ? tiff_json_value(description, "axes") : NULL;
  char of_space[4] = "", order[4];
  if (at == NULL) return;
  for (size_t i = 0, n = 0; i < strcspn(at, "\"") && n < 3; i++)
    if (strchr("XYZ", at[i]) != NULL) of_space[n++] = at[i];
  if (image_names_other_order(of_space, false, order))
    image_note(image, "its axes are %s by its text: read as stored, as z, y, x", order);
}

enum { TEXT_MOST = 8192 }; /* letters that are looked at of a tag's text */

/* The text of a tag that libtiff does not know, at most `size` - 1 letters of it. */
static bool tag_text(TIFF *tiff, uint32_t tag, char *text, size_t size) {
  uint32_t count = 0;
  const char *value = NULL;
  if (!TIFFGetField(tiff, tag, &count, &value) || value == NULL) return false;
  snprintf(text, size, "%.*s", count < size ? (int)count : (int)size - 1, value);
  return true;
}

/* GDAL's tags: the value that is no measurement, and the numbers that the greys stand for. */
static void tell_gdal(TIFF *tiff, struct image *image) {
  enum { METADATA = 42112, NO_DATA = 42113 };
  static const char *const ROLES[] = {"scale", "offset"};
  char text[TEXT_MOST], role[24];
  if (tag_text(tiff, NO_DATA, text, sizeof text)) {
    char *end;
    const double value = strtod(text, &end);
    if (end > text) image_no_data(image, value, value, "GDAL_NODATA");
  }
  if (!tag_text(tiff, METADATA, text, sizeof text)) return;
  for (int i = 0; i < 2; i++) {
    snprintf(role, sizeof role, "role=\"%s\">", ROLES[i]);
    const char *at = strstr(text, role);
    if (at == NULL) continue;
    image->rescale[i] = strtod(at + strlen(role), NULL);
    if (image->rescale[i] != 1.0 - i)
      image_note(image, "greys as stored, before GDAL's %s %g", ROLES[i], image->rescale[i]);
  }
}

/* Number of values of a tag that libtiff does not know. */
static unsigned long long count_values(TIFF *tiff, uint32_t tag) {
  uint32_t count = 0;
  void *values = NULL;
  return TIFFGetField(tiff, tag, &count, &values) ? count : 0;
}

/* Whether the present directory has a tag that libtiff ignores. */
static bool has_ignored_tag(TIFF *tiff, unsigned tag) {
  const struct source *source = TIFFClientdata(tiff);
  const bool big = TIFFIsBigTIFF(tiff), motorola = TIFFIsBigEndian(tiff);
  const size_t head = big ? 8 : 2, entry = big ? 20 : 12;
  unsigned char at[8];
  uint64_t where = TIFFCurrentDirOffset(tiff);
  if (pread(source->file, at, head, (off_t)where) != (ssize_t)head) return false;
  uint64_t entries = image_number(at, head, motorola);
  for (where += head; entries > 0; entries--, where += entry)
    if (pread(source->file, at, 2, (off_t)where) != 2)
      return false;
    else if (image_number(at, 2, motorola) == tag)
      return true;
  return false;
}

/* What greys have gone through, or stand for, beside the numbers that are stored. */
static void tell_greys(TIFF *tiff, const struct tiff_layout *layout, struct image *image) {
  const uint16_t how = layout->compression;
  if (how == COMPRESSION_JPEG || how == COMPRESSION_OJPEG || how == COMPRESSION_WEBP)
    image_note(image, IMAGE_COMPRESSED_WITH_LOSS);
  enum { FEI = 34682, LINEARIZATION = 50712 };
  if (count_values(tiff, LINEARIZATION) > 0)
    image_note(image, "greys as stored, before its LinearizationTable");
  static const char BAR[] = "DatabarHeight=";
  char text[TEXT_MOST];
  if (tag_text(tiff, FEI, text, sizeof text)) {
    const char *at = strstr(text, BAR);
    const long rows = at != NULL ? strtol(at + strlen(BAR), NULL, 10) : 0;
    if (rows > 0)
      image_note(image, "its last %ld rows are a bar of data, no scan: leave them out by --crop",
                 rows);
  }
  if (has_ignored_tag(tiff, TIFFTAG_GRAYRESPONSECURVE))
    image_note(image, "greys as stored, not as its GrayResponseCurve says");
}

/* ImageJ, of stacks of more than 4 GB, tifffile if asked to, and MetaMorph write a single
 * directory, and the other slices after the first. */
static bool slices_follow(TIFF *tiff, unsigned long long slices, const struct tiff_layout *layout,
                          struct image *image) {
  uint64_t bytes, *offsets = NULL;
  uint16_t fill = FILLORDER_MSB2LSB; /* else the bits of each byte are reversed */
  TIFFGetFieldDefaulted(tiff, TIFFTAG_FILLORDER, &fill);
  if (fill != FILLORDER_MSB2LSB || layout->compression != COMPRESSION_NONE ||
      layout->samples != 1 || layout->bits < 8 || layout->photometric == PHOTOMETRIC_PALETTE ||
      !TIFFLastDirectory(tiff) || TIFFIsTiled(tiff) ||
      !TIFFGetField(tiff, TIFFTAG_STRIPOFFSETS, &offsets))
    return false;
  size_t page;
  if (!size_multiply((size_t)layout->width * layout->height, pixel_size(image->type), &page) ||
      slices < 2 || image_file_size(image->path, &bytes) != STATUS_OK)
    return false;
  if (offsets[0] == 0 || offsets[0] > bytes) return false;
  image->pages = (size_t)slices;
  image->data_offset = offsets[0];
  image->swap = TIFFIsByteSwapped(tiff) != 0;
  if ((bytes - image->data_offset) / page < slices) {
    image->pages = (size_t)((bytes - image->data_offset) / page);
    image_note(image, "cut short: %zu of %llu slices are there", image->pages, slices);
  }
  return image->pages > 0;
}

/* A page that is the only one of a file which holds as much again: slices that no directory tells
 * of, as of programs whose texts got lost. */
static void look_for_others(TIFF *tiff, const struct tiff_layout *layout, const char *description,
                            struct image *image) {
  const uint32_t count = TIFFIsTiled(tiff) ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  enum { TAGS = 8192 }; /* bytes that may be of tags */
  const double own = TAGS + (description != NULL ? (double)strlen(description) : 0.0);
  uint64_t bytes;
  uint16_t others = 0;
  void *offsets = NULL;
  double page = 0.0;
  if (layout->compression != COMPRESSION_NONE || !TIFFLastDirectory(tiff) ||
      TIFFGetField(tiff, TIFFTAG_SUBIFD, &others, &offsets) ||
      image_file_size(image->path, &bytes) != STATUS_OK)
    return;
  for (uint32_t i = 0; i < count; i++) page += (double)TIFFGetStrileByteCount(tiff, i);
  if (page > 0.0 && (double)bytes - page - own >= page)
    image_note(image, "%.0f bytes of it are of no page: slices that it does not tell of?",
               (double)bytes - page);
}

/* Whether the present directory is of another kind than a slice: a thumbnail or a mask of
 * transparency, tagged so. */
static bool is_aside(TIFF *tiff) {
  uint32_t kind = 0;
  TIFFGetField(tiff, TIFFTAG_SUBFILETYPE, &kind);
  return (kind & (FILETYPE_REDUCEDIMAGE | FILETYPE_MASK)) != 0;
}

/* Strips or tiles that are not in the file, as sparse files leave them out where all is zero. */
static size_t count_missing(TIFF *tiff) {
  const uint32_t count = TIFFIsTiled(tiff) ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  size_t missing = 0;
  for (uint32_t i = 0; i < count; i++)
    missing += TIFFGetStrileOffset(tiff, i) == 0 && TIFFGetStrileByteCount(tiff, i) == 0;
  return missing;
}

/* Channels and times that follow one another on the pages, as private tags tell: LSM's table of
 * Zeiss, and Micro-Manager's text of each page. */
static enum status check_channels(TIFF *tiff, const char *path) {
  enum { LSM = 34412, LSM_CHANNELS = 20, LSM_LEAST = 28, MICRO_MANAGER = 51123 };
  static const char *const KEYS[] = {"ChannelIndex", "FrameIndex"};
  static const char *const KINDS[] = {"channels", "frames"};
  uint32_t count = 0;
  const unsigned char *table = NULL;
  char text[TEXT_MOST];
  const bool lsm = TIFFGetField(tiff, LSM, &count, &table) && count >= LSM_LEAST && table != NULL;
  const bool told = tag_text(tiff, MICRO_MANAGER, text, sizeof text);
  for (int i = 0; i < 2; i++) {
    const unsigned char *at = lsm ? table + LSM_CHANNELS + 4 * i : NULL;
    const char *number = told ? tiff_json_value(text, KEYS[i]) : NULL;
    unsigned long long several = at != NULL ? image_number(at, 2, false) : 1;
    if (number != NULL) several = 1 + strtoull(number, NULL, 10);
    if (several > 1) return tiff_refuse_hyperstack(path, several, KINDS[i]);
  }
  return STATUS_OK;
}

/* The bytes of a page in the file, from its first strip or tile to the end of its last. */
static void find_bytes(TIFF *tiff, uint64_t range[2]) {
  const uint32_t count = TIFFIsTiled(tiff) ? TIFFNumberOfTiles(tiff) : TIFFNumberOfStrips(tiff);
  range[0] = UINT64_MAX;
  range[1] = 0;
  for (uint32_t i = 0; i < count; i++) {
    const uint64_t from = TIFFGetStrileOffset(tiff, i), n = TIFFGetStrileByteCount(tiff, i);
    if (n > 0 && from < range[0]) range[0] = from;
    if (n > 0 && n <= UINT64_MAX - from && from + n > range[1]) range[1] = from + n;
  }
}

/* The numbers of a further page mean what those of the first do. `other` is for use here alone. */
static enum status check_values(TIFF *tiff, const struct image *first, struct image *other) {
  other->no_data_count = 0;
  other->rescale[0] = 1.0;
  other->rescale[1] = 0.0;
  other->note[0] = '\0';
  tell_gdal(tiff, other);
  const bool scaled = other->rescale[0] != 1.0 || other->rescale[1] != 0.0;
  if ((other->no_data_count > 0 &&
       (first->no_data_count == 0 || other->no_data[0].from != first->no_data[0].from)) ||
      (scaled && memcmp(other->rescale, first->rescale, sizeof first->rescale) != 0))
    return FAIL(STATUS_INPUT,
                "%s: page %zu has another GDAL_NODATA, scale or offset than the first: the same "
                "number means something else; save pages of one kind",
                first->path, first->pages);
  return STATUS_OK;
}

/* Collects the offsets of all directories with slices, from the present one on; thumbnails and
 * masks are left out. */
static enum status collect_pages(TIFF *tiff, const struct tiff_layout *first, struct image *image) {
  size_t room = 0, missing = 0;
  uint16_t number, number_before = 0, count;
  bool in_order = true;
  enum status status = STATUS_OK;
  struct image other = {.path = image->path, .type = image->type};
  bool resized = false, aside = false;
  uint64_t bytes[2], before[2] = {UINT64_MAX, 0};
  const bool all_aside = is_aside(tiff); /* then they are the slices after all */
  do {
    struct tiff_layout layout;
    bool whole;
    if (is_aside(tiff) && !all_aside) continue;
    layout_read(tiff, &layout);
    if (layout.width != first->width || layout.height != first->height)
      TRY_FAIL(STATUS_INPUT,
               "%s: page %zu: %ux%u, but the first page is %ux%u; save pages of one size",
               image->path, image->pages, layout.width, layout.height, first->width, first->height);
    if (layout.bits != first->bits || layout.format != first->format ||
        layout.samples != first->samples)
      TRY_FAIL(
          STATUS_INPUT,
          "%s: page %zu: %u bits, but the first page has %u bits a sample; save pages of one type",
          image->path, image->pages, layout.bits, first->bits);
    if (layout.photometric != first->photometric)
      TRY_FAIL(
          STATUS_INPUT,
          "%s: page %zu: photometric %u, but the first page has %u (0: white is zero, 1: black "
          "is zero); save pages of one kind",
          image->path, image->pages, layout.photometric, first->photometric);
    if (layout.orientation != first->orientation)
      TRY_FAIL(STATUS_INPUT,
               "%s: page %zu: orientation %u, but the first page has %u; save pages of one "
               "orientation",
               image->path, image->pages, layout.orientation, first->orientation);
    if (image->pages == room) {
      room = room == 0 ? 64 : 2 * room;
      TRY(memory_resize(&image->page_offsets, room, sizeof *image->page_offsets,
                        "the pages of a TIFF"));
    }
    TRY(read_palette(tiff, &layout, image->pages == 0 ? image : &other, &whole));
    if (image->pages > 0 && !image_palettes_agree(image, &other))
      TRY_FAIL(STATUS_INPUT,
               "%s: page %zu has another palette than the first: its numbers mean other colours; "
               "save all with one",
               image->path, image->pages);
    if (image->pages > 0) TRY(check_values(tiff, image, &other));
    TRY(check_channels(tiff, image->path));
    resized |= other_resolution(&layout, first);
    aside |= memcmp(layout.place, first->place, sizeof layout.place) != 0;
    find_bytes(tiff, bytes);
    if (bytes[0] < before[1] && before[0] < bytes[1] && memcmp(bytes, before, sizeof bytes) != 0)
      TRY_FAIL(STATUS_INPUT, "%s: page %zu has bytes of the page before" EXPORT_AGAIN, image->path,
               image->pages);
    memcpy(before, bytes, sizeof before);
    image->plain &= whole;
    missing += count_missing(tiff);
    if (TIFFGetField(tiff, TIFFTAG_PAGENUMBER, &number, &count)) {
      in_order &= number >= number_before;
      number_before = number;
    }
    image->page_offsets[image->pages++] = TIFFCurrentDirOffset(tiff);
  } while (TIFFReadDirectory(tiff));
  if (tiff_message[0] == '\0' && !TIFFLastDirectory(tiff))
    snprintf(tiff_message, sizeof tiff_message, "its directories lead in a circle");
  /* A regular end leaves no message; a broken chain of directories does. */
  if (tiff_message[0] != '\0')
    TRY_FAIL(STATUS_INPUT, "%s: broken after page %zu: %s" EXPORT_AGAIN, image->path, image->pages,
             tiff_message);
  if (resized)
    image_note(image, "not all of its pages have the resolution of the first, which is taken");
  if (aside)
    image_note(image, "its pages lie beside each other (XPosition, YPosition), as parts of one "
                      "picture: read as slices");
  if (!in_order)
    image_note(image, "its pages are numbered in another order: read as they stand in the file");
  if (missing > 0)
    image_note(image, "%zu of its blocks are not in the file (sparse): all 0 there", missing);
cleanup:
  memory_free(&other.palette);
  return status;
}

/* Samples that are greys, or colours that may be. */
static enum status check_photometric(const char *path, const struct tiff_layout *layout) {
  static const uint16_t READ[] = {PHOTOMETRIC_MINISWHITE, PHOTOMETRIC_MINISBLACK, PHOTOMETRIC_RGB,
                                  PHOTOMETRIC_PALETTE,    PHOTOMETRIC_MASK,       34892 /* raw */};
  for (size_t i = 0; i < sizeof READ / sizeof *READ; i++)
    if (layout->photometric == READ[i]) return STATUS_OK;
  if (layout->photometric == PHOTOMETRIC_YCBCR && layout->compression == COMPRESSION_JPEG)
    return STATUS_OK;
  return FAIL(STATUS_INPUT, "%s: colours of the kind %u (5: of print, 8: CIE Lab); save as grey",
              path, layout->photometric);
}

/* Goes to the first directory that is a slice: some programs put a thumbnail before. */
static void find_first_slice(TIFF *tiff) {
  while (is_aside(tiff) && TIFFReadDirectory(tiff)) continue;
  if (is_aside(tiff)) (void)TIFFSetDirectory(tiff, 0);
}

static enum status tiff_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  struct tiff_layout layout;
  char *description = NULL;
  TIFF *tiff = tiff_start(path, 0);
  if (tiff == NULL)
    TRY_FAIL(STATUS_INPUT, "%s: not a readable TIFF: %s" EXPORT_AGAIN, path,
             tiff_message[0] != '\0' ? tiff_message : "its first directory is damaged");
  find_first_slice(tiff);
  layout_read(tiff, &layout);
  if (layout.width == 0 || layout.height == 0)
    TRY_FAIL(STATUS_INPUT, "%s: a TIFF without width and height" EXPORT_AGAIN, path);
  if (!TIFFIsCODECConfigured(layout.compression))
    TRY_FAIL(STATUS_INPUT,
             "%s: compression %u is not supported by libtiff here; save it uncompressed", path,
             layout.compression);
  TRY(layout_type(path, &layout, &image->type));
  TRY(check_photometric(path, &layout));
  uint32_t depth = 1;
  if (TIFFGetField(tiff, TIFFTAG_IMAGEDEPTH, &depth) && depth > 1)
    TRY_FAIL(STATUS_INPUT, "%s: pages of %u slices each (ImageDepth) are not read; save one a page",
             path, depth);
  if (layout.bits < 8) image->top = (unsigned char)((1 << layout.bits) - 1);
  image->size[0] = layout.width;
  image->size[1] = layout.height;
  for (int axis = 0; axis < 2; axis++) image->at[axis] = (double)layout.place[axis];
  image->invert = layout.photometric == PHOTOMETRIC_MINISWHITE;
  image->plain = true;
  image->orientation = layout.orientation;
  image_tell_orientation(image);
  if (layout.samples >= 3) image_note(image, IMAGE_STORED_IN_COLOUR);
  if (!TIFFGetField(tiff, TIFFTAG_IMAGEDESCRIPTION, &description)) description = NULL;
  read_resolution(&layout, description, image);
  unsigned long long slices;
  bool follow;
  char *program = NULL;
  if (!TIFFGetField(tiff, TIFFTAG_SOFTWARE, &program)) program = NULL;
  TRY(tiff_told_channels(path, description));
  TRY(tiff_told_channels(path, program));
  TRY(tiff_told_slices(path, description,
                       (const size_t[]){layout.width, layout.height, layout.samples}, &slices,
                       &follow)); /* a text of this directory alone */
  tell_calibration(description, image);
  tell_axes(description, image);
  tell_gdal(tiff, image);
  tell_greys(tiff, &layout, image);
  enum { UIC2 = 33629 }; /* of MetaMorph: one directory, and a value of it for each slice */
  const unsigned long long metamorph = count_values(tiff, UIC2);
  if (slices_follow(tiff, metamorph > 1 ? metamorph : follow ? slices : 0, &layout, image))
    goto cleanup;
  look_for_others(tiff, &layout, description, image);
  image->data_offset = 0;
  image->pages = 0;
  tiff_message[0] = '\0';
  TRY(collect_pages(tiff, &layout, image));
  if (image->palette != NULL)
    image_note(image, IMAGE_NUMBERS_OF_COLOURS);
  else if (layout.photometric == PHOTOMETRIC_PALETTE) {
    image_note(image, IMAGE_STORED_IN_COLOUR);
    image->top = 0; /* greys of the palette, of 8 bits */
  }
  if (slices > 0 && slices != image->pages)
    image_note(image, "its text says %llu images, but %zu are there: %s?", slices, image->pages,
               slices > image->pages ? "slices lost, or in other files"
                                     : "those of several images");
cleanup:
  if (tiff != NULL) TIFFClose(tiff);
  return status;
}

/* Converts one row of decoded samples to values of the image's type: samples of less than a byte,
 * palettes and colours that are grey. */
struct row_decoder {
  const struct image *image;
  struct tiff_layout layout;
  uint16_t *palette[3];
  unsigned step;                                          /* of the palette (palette_step) */
  unsigned char reference[SAMPLES_MOST * sizeof(double)]; /* the first pixel of the page */
};

/* Maps entries of a palette of greys, which stand in `out` where they fit in 8 bits. */
static void map_palette(const struct row_decoder *decoder, const unsigned char *in, size_t n,
                        void *out) {
  const struct image *image = decoder->image;
  const bool bytes = image->type == PIXEL_U8;
  for (size_t x = 0; x < n; x++) {
    uint16_t entry = in[x];
    if (!bytes) memcpy(&entry, in + 2 * x, 2);
    const uint16_t grey = decoder->palette[0][entry];
    if (!image->plain)
      ((float *)out)[x] = (float)(grey / (decoder->step > 0 ? (double)decoder->step : 257.0));
    else if (bytes)
      ((unsigned char *)out)[x] = (unsigned char)(grey / decoder->step);
    else
      ((uint16_t *)out)[x] = grey;
  }
}

/* Decodes n samples from column x0 on of row y into `page`; `small`: space for a row of bytes. */
static enum status decode_row(struct row_decoder *decoder, const unsigned char *in, size_t x0,
                              size_t n, size_t y, unsigned char *small, void *page) {
  const struct tiff_layout *layout = &decoder->layout;
  const struct image *image = decoder->image;
  const size_t bytes = pixel_size(image->type), stride = bytes * layout->samples;
  const bool palette = layout->photometric == PHOTOMETRIC_PALETTE && image->palette == NULL;
  char *out = (char *)page + (y * image->size[0] + x0) * (image->plain ? bytes : sizeof(float));
  if (layout->bits < 8) {
    const unsigned mask = (1u << layout->bits) - 1u;
    for (size_t x = 0; x < n; x++) {
      const size_t bit = x * layout->bits;
      small[x] = (unsigned char)((unsigned)in[bit / 8] >> (8 - layout->bits - bit % 8) & mask);
    }
    in = small;
  }
  if (palette) {
    map_palette(decoder, in, n, out);
    return STATUS_OK;
  }
  if (layout->samples == 1 && !image->plain) { /* among pages with palettes */
    pixels_to_float((float *)(void *)out, in, n, image->type);
    return STATUS_OK;
  }
  if (layout->samples == 1) {
    memcpy(out, in, n * bytes);
    return STATUS_OK;
  }
  if (x0 == 0 && y == 0) memcpy(decoder->reference, in, stride);
  return image_take_greys(image, in, n, layout->samples, y * image->size[0] + x0,
                          decoder->reference, out);
}

/* Whether strips can be decoded in place, since the page is stored in the wanted form. */
static bool stands_as_wanted(const struct row_decoder *decoder, size_t row) {
  const struct image *image = decoder->image;
  return image->plain &&
         (decoder->layout.photometric != PHOTOMETRIC_PALETTE || image->palette != NULL) &&
         decoder->layout.samples == 1 && row == image->size[0] * pixel_size(image->type) &&
         decoder->layout.bits >= 8;
}

/* Whether a strip or tile is in the file. libtiff reads uncompressed ones from their offset on,
 * whatever their length is said to be: the start of the file where both are 0. */
static enum status find_block(TIFF *tiff, const struct row_decoder *decoder, uint32_t number,
                              size_t bytes, bool *missing) {
  const uint64_t offset = TIFFGetStrileOffset(tiff, number);
  const uint64_t count = TIFFGetStrileByteCount(tiff, number);
  *missing = offset == 0 && count == 0;
  if (*missing ||
      (offset > 0 && (decoder->layout.compression != COMPRESSION_NONE || count >= bytes)))
    return STATUS_OK;
  return FAIL(
      STATUS_INPUT, "%s: block %u is said to be %llu bytes from byte %llu on, not %zu" EXPORT_AGAIN,
      decoder->image->path, number, (unsigned long long)count, (unsigned long long)offset, bytes);
}

static enum status read_strips(TIFF *tiff, struct row_decoder *decoder, void *out) {
  enum status status = STATUS_OK;
  const struct image *image = decoder->image;
  size_t width = image->size[0], height = image->size[1];
  uint32_t rows = 0;
  unsigned char *buffer = NULL, *small = NULL;
  size_t row = (size_t)TIFFScanlineSize64(tiff);
  TIFFGetFieldDefaulted(tiff, TIFFTAG_ROWSPERSTRIP, &rows);
  if (rows == 0 || rows > height) rows = (uint32_t)height;
  size_t strip_bytes;
  if (!size_multiply(row, rows, &strip_bytes) || (tmsize_t)strip_bytes != TIFFStripSize(tiff))
    TRY_FAIL(STATUS_INPUT, "%s: strips of an unsupported layout; save it uncompressed",
             image->path);
  if (!stands_as_wanted(decoder, row)) {
    TRY(memory_allocate(&buffer, strip_bytes, 1, "a TIFF strip"));
    TRY(memory_allocate(&small, width, 1, "a TIFF row"));
  }
  for (size_t y0 = 0; y0 < height; y0 += rows) {
    size_t n = height - y0 < rows ? height - y0 : rows;
    unsigned char *to = buffer == NULL ? (unsigned char *)out + y0 * row : buffer;
    const uint32_t strip = (uint32_t)(y0 / rows);
    bool missing;
    TRY(find_block(tiff, decoder, strip, n * row, &missing));
    if (missing) memset(to, 0, n * row);
    const tmsize_t want = (tmsize_t)(n * row);
    if (!missing && TIFFReadEncodedStrip(tiff, strip, to, want) < want)
      TRY_FAIL(STATUS_INPUT, "%s: rows %zu to %zu cannot be decoded: %s" EXPORT_AGAIN, image->path,
               y0, y0 + n - 1, tiff_message[0] != '\0' ? tiff_message : "too few bytes");
    for (size_t y = 0; y < n && buffer != NULL; y++)
      TRY(decode_row(decoder, buffer + y * row, 0, width, y0 + y, small, out));
  }
cleanup:
  memory_free(&buffer);
  memory_free(&small);
  return status;
}

static enum status read_tiles(TIFF *tiff, struct row_decoder *decoder, void *out) {
  enum status status = STATUS_OK;
  const struct image *image = decoder->image;
  size_t width = image->size[0], height = image->size[1];
  uint32_t tile[2] = {0, 0};
  unsigned char *buffer = NULL, *small = NULL;
  TIFFGetField(tiff, TIFFTAG_TILEWIDTH, &tile[0]);
  TIFFGetField(tiff, TIFFTAG_TILELENGTH, &tile[1]);
  size_t bytes = (size_t)TIFFTileSize(tiff), row = (size_t)TIFFTileRowSize(tiff);
  if (tile[0] == 0 || tile[1] == 0 || bytes < row * tile[1])
    TRY_FAIL(STATUS_INPUT, "%s: tiles of an unsupported layout; save it uncompressed", image->path);
  TRY(memory_allocate(&buffer, bytes, 1, "a TIFF tile"));
  TRY(memory_allocate(&small, tile[0], 1, "a TIFF row"));
  for (size_t y0 = 0; y0 < height; y0 += tile[1]) {
    for (size_t x0 = 0; x0 < width; x0 += tile[0]) {
      const uint32_t tile_number = TIFFComputeTile(tiff, (uint32_t)x0, (uint32_t)y0, 0, 0);
      bool missing;
      TRY(find_block(tiff, decoder, tile_number, bytes, &missing));
      if (missing) memset(buffer, 0, bytes);
      if (!missing && TIFFReadTile(tiff, buffer, (uint32_t)x0, (uint32_t)y0, 0, 0) < 0)
        TRY_FAIL(STATUS_INPUT, "%s: the tile at %zu,%zu cannot be decoded: %s" EXPORT_AGAIN,
                 image->path, x0, y0, tiff_message);
      size_t nx = width - x0 < tile[0] ? width - x0 : tile[0];
      size_t ny = height - y0 < tile[1] ? height - y0 : tile[1];
      for (size_t y = 0; y < ny; y++)
        TRY(decode_row(decoder, buffer + y * row, x0, nx, y0 + y, small, out));
    }
  }
cleanup:
  memory_free(&buffer);
  memory_free(&small);
  return status;
}

/* Opens a page and checks those properties of its layout that may differ from the first page. */
static enum status page_open(const struct image *image, size_t page, struct row_decoder *decoder,
                             TIFF **handle) {
  enum status status = STATUS_OK;
  struct tiff_layout *layout = &decoder->layout;
  decoder->image = image;
  TIFF *tiff = *handle = tiff_start(image->path, image->page_offsets[page]);
  if (tiff == NULL)
    TRY_FAIL(STATUS_INPUT, "%s: page %zu cannot be read: %s" EXPORT_AGAIN, image->path, page,
             tiff_message);
  layout_read(tiff, layout);
  if (layout->width != image->size[0] || layout->height != image->size[1] || layout->samples < 1 ||
      layout->samples > SAMPLES_MOST)
    TRY_FAIL(STATUS_INPUT, "%s: changed while it was being read; run again", image->path);
  if (layout->samples > 1 && layout->planar != PLANARCONFIG_CONTIG)
    TRY_FAIL(STATUS_INPUT, "%s: colour planes apart are not read; save as grey", image->path);
  if (layout->compression == COMPRESSION_JPEG)
    TIFFSetField(tiff, TIFFTAG_JPEGCOLORMODE, JPEGCOLORMODE_RGB);
  if (layout->photometric == PHOTOMETRIC_PALETTE &&
      !TIFFGetField(tiff, TIFFTAG_COLORMAP, &decoder->palette[0], &decoder->palette[1],
                    &decoder->palette[2]))
    TRY_FAIL(STATUS_INPUT, "%s: changed while it was being read; run again", image->path);
  if (layout->photometric == PHOTOMETRIC_PALETTE && layout->bits <= 8)
    decoder->step = palette_step(decoder->palette, (size_t)1 << layout->bits);
  if (image->plain && image->palette == NULL && image->type == PIXEL_U8 &&
      layout->photometric == PHOTOMETRIC_PALETTE && decoder->step == 0)
    TRY_FAIL(STATUS_INPUT, "%s: changed while it was being read; run again", image->path);
cleanup:
  return status;
}

static enum status tiff_read(const struct image *image, size_t page, void *out) {
  enum status status = STATUS_OK;
  TIFF *tiff = NULL;
  struct row_decoder decoder = {0};
  if (image->data_offset != 0) return image_read_contiguous(image, page, out);
  TRY(page_open(image, page, &decoder, &tiff));
  TRY(TIFFIsTiled(tiff) ? read_tiles(tiff, &decoder, out) : read_strips(tiff, &decoder, out));
cleanup:
  if (tiff != NULL) TIFFClose(tiff);
  return status;
}

const struct image_reader image_tiff_reader = {.name = "TIFF",
                                               .endings = {".tif", ".tiff", ".btf", ".tf8"},
                                               .claims = tiff_claims,
                                               .open = tiff_open,
                                               .read = tiff_read};
