#include "ct2model/readers/image.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/input_file.h"
#include "common/memory.h"
#include "ct2model/readers/constants.h"

/* DICOM (PS3.5, PS3.10): little-endian and uncompressed, of one grey a pixel; one slice, or frames
 * one behind the other; with a preamble or, as older programs write, without, and with or without
 * the group that names the transfer syntax. stack.c puts the slices of a series in order by their
 * positions or numbers. */

enum { PREAMBLE = 128, NESTED_MOST = 16 };
#define UNDEFINED 0xffffffffu

struct dicom {
  const char *path;
  FILE *file;
  bool implicit;
  unsigned rows, columns, allocated, stored, high, is_signed, samples, frames;
  bool white_is_zero, by_table; /* by_table: greys are to be looked up in one */
  double spacing[2], orientation[6], slope, intercept;
  double padding[2], tilt, aspect[2]; /* padding: stored values; tilt: of the gantry, degrees */
  double number, thickness, distance, location; /* of the series; of slices, mm; NAN: not told */
  bool placed, oriented, varied; /* varied: frames are turned or scaled each in its own way */
  bool in_time, in_several;      /* frames follow one another in time, or along several axes */
  bool projected;                /* frames are of other directions */
  bool of_many;                  /* each pixel is of a whole line through the body */
  bool lossy, written, logarithms, scout;
  unsigned part;           /* of a concatenation; 0: none */
  char series[65], of[80]; /* of: which echo, time, energy and filter of the series */
  struct places {
    double (*at)[3];
    size_t count, room;
  } places, numbers, indices; /* of frames: positions, mm; numbers in the stack; last indices */
  double step;                /* from frame to frame, mm */
  double mapping[2];          /* slope and intercept of real world values; NAN: not told */
  bool mapped_each;           /* frames have several */
  uint64_t pixels;
  uint32_t length;
};

/* Whether two letters are a kind of value. */
static bool is_kind(const unsigned char *at) {
  return at[0] >= 'A' && at[0] <= 'Z' && at[1] >= 'A' && at[1] <= 'Z';
}

/* Whether the bytes begin a set of elements: groups 2 or 8, which all of them begin with, and a
 * length as short as those of its first elements are. */
static bool begins_elements(const unsigned char *head, size_t n) {
  static const unsigned char FIRST[] = {0x00, 0x01, 0x05, 0x06, 0x08, 0x12,
                                        0x13, 0x14, 0x16, 0x18, 0x20, 0x60};
  if (n < 16 || head[1] != 0 || head[3] != 0) return false;
  const unsigned length = head[4] + 256u * head[5];
  if (head[0] == 2) return is_kind(head + 4);
  return head[0] == 8 && memchr(FIRST, head[2], sizeof FIRST) != NULL &&
         (is_kind(head + 4) || (head[6] == 0 && head[7] == 0 && length <= 128));
}

static bool dicom_claims(const char *path, const unsigned char *head, size_t n) {
  (void)path;
  return (n >= PREAMBLE + 4 && memcmp(head + PREAMBLE, "DICM", 4) == 0) || begins_elements(head, n);
}

static enum status damaged(const struct dicom *dicom) {
  return FAIL(STATUS_INPUT, "%s: its header cannot be read" EXPORT_AGAIN, dicom->path);
}

static bool read_number(FILE *file, size_t bytes, uint32_t *value) {
  unsigned char at[4];
  if (fread(at, 1, bytes, file) != bytes) return false;
  *value = (uint32_t)image_number(at, bytes, false);
  return true;
}

struct element {
  uint32_t group, number, length;
  bool unknown; /* of kind UN: what it holds is implicit (PS3.5, 6.2.2) */
};

/* Reads the tag and the length of an element. */
static bool read_element(struct dicom *dicom, struct element *element) {
  unsigned char kind[2];
  element->unknown = false;
  if (!read_number(dicom->file, 2, &element->group) ||
      !read_number(dicom->file, 2, &element->number))
    return false;
  if (element->group == 0xfffe || (dicom->implicit && element->group != 2))
    return read_number(dicom->file, 4, &element->length);
  if (fread(kind, 1, 2, dicom->file) != 2 || !is_kind(kind)) return false;
  static const char LONG[][3] = {"OB", "OW", "OF", "OD", "OL", "OV", "SQ",
                                 "UC", "UN", "UR", "UT", "SV", "UV"};
  element->unknown = memcmp(kind, "UN", 2) == 0;
  for (size_t i = 0; i < sizeof LONG / sizeof *LONG; i++)
    if (memcmp(kind, LONG[i], 2) == 0)
      return fseeko(dicom->file, 2, SEEK_CUR) == 0 && read_number(dicom->file, 4, &element->length);
  return read_number(dicom->file, 2, &element->length);
}

/* Skips a sequence or an item of undefined length. */
static bool skip_items(struct dicom *dicom, int depth);

static bool skip_undefined(struct dicom *dicom, const struct element *element, int depth) {
  const bool implicit = dicom->implicit;
  dicom->implicit |= element->unknown;
  const bool whole = skip_items(dicom, depth);
  dicom->implicit = implicit;
  return whole;
}

static bool skip_items(struct dicom *dicom, int depth) {
  struct element element;
  while (depth < NESTED_MOST && read_element(dicom, &element)) {
    if (element.group == 0xfffe && (element.number == 0xe0dd || element.number == 0xe00d))
      return true;
    if (element.length == UNDEFINED) {
      if (!skip_undefined(dicom, &element, depth + 1)) return false;
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
    if (i + 1 < count ? *text++ != '\\' : *text != '\0' && *text != '\\') return false;
  }
  return true;
}

/* The components of p along the row, the column and the normal of the slice. */
static void along_axes(const struct dicom *d, const double p[3], double along[3]) {
  const double *r = d->orientation, *c = d->orientation + 3;
  along[0] = p[0] * r[0] + p[1] * r[1] + p[2] * r[2];
  along[1] = p[0] * c[0] + p[1] * c[1] + p[2] * c[2];
  along[2] = p[0] * (r[1] * c[2] - r[2] * c[1]) + p[1] * (r[2] * c[0] - r[0] * c[2]) +
             p[2] * (r[0] * c[1] - r[1] * c[0]);
}

/* Takes where a slice is, or one frame after the other. */
static enum status take_place(struct places *places, const double p[3]) {
  enum status status = STATUS_OK;
  if (places->count == places->room) {
    places->room = places->room == 0 ? 1 : 2 * places->room;
    TRY(memory_resize(&places->at, places->room, sizeof *places->at, "positions of frames"));
  }
  memcpy(places->at[places->count++], p, sizeof *places->at);
cleanup:
  return status;
}

/* Takes the last of `count` whole numbers of 4 bytes as the place of a frame. */
static enum status take_number(struct dicom *d, struct places *places, size_t count) {
  uint32_t value = 0;
  for (size_t i = 0; i < count; i++)
    if (!read_number(d->file, 4, &value)) return damaged(d);
  return take_place(places, (const double[]){0.0, 0.0, value});
}

/* Takes a number of real world value mapping, of 8 bytes (PS3.3, C.7.6.16.2.11). */
static enum status take_mapping(struct dicom *d, double *told) {
  double value;
  if (fread(&value, sizeof value, 1, d->file) != 1) return damaged(d);
  d->mapped_each |= isfinite(*told) && value != *told;
  if (isnan(*told)) *told = value;
  return STATUS_OK;
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
                    : tag == 0x00209162 ? &dicom->part
                                        : NULL;
  char text[200] = "";
  if (whole != NULL) {
    uint32_t value;
    if (element->length != 2 || !read_number(dicom->file, 2, &value)) return damaged(dicom);
    *whole = value;
    return STATUS_OK;
  }
  if ((tag == 0x00280120 || tag == 0x00280121) && element->length == 2) {
    uint32_t value;
    if (!read_number(dicom->file, 2, &value)) return damaged(dicom);
    dicom->padding[tag & 1] = dicom->is_signed ? (int16_t)value : (double)value;
    return STATUS_OK;
  }
  if ((tag == 0x00409224 || tag == 0x00409225) && element->length == 8)
    return take_mapping(dicom, &dicom->mapping[tag == 0x00409224]);
  if ((tag == 0x00209057 || tag == 0x00209157) && element->length > 0 && element->length % 4 == 0)
    return take_number(dicom, tag == 0x00209057 ? &dicom->numbers : &dicom->indices,
                       element->length / 4);
  if ((tag == 0x00181520 || tag == 0x00181521) && element->length > 0) dicom->projected = true;
  if (tag == 0x00280009 && element->length > 4) dicom->in_several = true;
  if (tag == 0x00280009 && element->length == 4) {
    uint32_t group, number;
    if (!read_number(dicom->file, 2, &group) || !read_number(dicom->file, 2, &number))
      return damaged(dicom);
    dicom->in_time = group == 0x0018 && (number == 0x1063 || number == 0x1065);
    return STATUS_OK;
  }
  static const uint32_t TEXTS[] = {0x00080008, 0x00180060, 0x00181210, 0x00180086, 0x00181063,
                                   0x00200100, 0x00280301, 0x00281040, 0x00282110, 0x20500020,
                                   0x00020010, 0x00180050, 0x00180088, 0x00181120, 0x0020000e,
                                   0x00200013, 0x00200032, 0x00200037, 0x00201041, 0x00280004,
                                   0x00280008, 0x00280030, 0x00280034, 0x00281052, 0x00281053};
  bool is_text = false;
  for (size_t i = 0; i < sizeof TEXTS / sizeof *TEXTS; i++) is_text |= tag == TEXTS[i];
  if (!is_text || element->length >= sizeof text)
    return fseeko(dicom->file, (off_t)element->length, SEEK_CUR) == 0 ? STATUS_OK : damaged(dicom);
  if (fread(text, 1, element->length, dicom->file) != element->length) return damaged(dicom);
  for (size_t n = strlen(text); n > 0 && text[n - 1] == ' ';) text[--n] = '\0';
  if (tag == 0x00020010) {
    if (strcmp(text, "1.2.840.10008.1.2") != 0 && strcmp(text, "1.2.840.10008.1.2.1") != 0)
      return FAIL(STATUS_INPUT,
                  "%s: transfer syntax %s (compressed or big-endian) is not read; save it "
                  "uncompressed, little-endian",
                  dicom->path, text);
  } else if (tag == 0x00080008) {
    dicom->scout = strstr(text, "LOCALIZER") != NULL;
    dicom->of_many = strstr(text, "MIP") != NULL || strstr(text, "PROJECTION") != NULL;
  } else if (tag == 0x00180060 || tag == 0x00180086 || tag == 0x00181210 || tag == 0x00200100) {
    const size_t used = strlen(dicom->of);
    snprintf(dicom->of + used, sizeof dicom->of - used, " %x %.11s", tag, text);
  } else if (tag == 0x00181063) {
    dicom->in_time |= text[0] != '\0';
  } else if (tag == 0x00280301) {
    dicom->written = strcmp(text, "YES") == 0;
  } else if (tag == 0x00281040) {
    dicom->logarithms = strcmp(text, "LOG") == 0;
  } else if (tag == 0x00282110) {
    dicom->lossy = strcmp(text, "01") == 0;
  } else if (tag == 0x20500020) {
    dicom->white_is_zero |= strcmp(text, "INVERSE") == 0;
  } else if (tag == 0x00280004) {
    dicom->white_is_zero |= strcmp(text, "MONOCHROME1") == 0;
    if (strncmp(text, "MONOCHROME", strlen("MONOCHROME")) != 0)
      return FAIL(STATUS_INPUT, "%s: pixels of the kind %s are not read; save as grey", dicom->path,
                  text);
  } else if (tag == 0x00280008) {
    dicom->frames = (unsigned)atoi(text);
  } else if (tag == 0x0020000e) {
    snprintf(dicom->series, sizeof dicom->series, "%.64s", text);
  } else if (tag == 0x00280030) {
    if (!read_decimals(text, 2, dicom->spacing)) dicom->spacing[0] = NAN;
  } else if (tag == 0x00280034) {
    if (!read_decimals(text, 2, dicom->aspect)) dicom->aspect[0] = NAN;
  } else if (tag == 0x00200032) {
    double position[3];
    dicom->placed = read_decimals(text, 3, position);
    if (dicom->placed) return take_place(&dicom->places, position);
  } else if (tag == 0x00200037) {
    double turned[6] = {0.0};
    const bool told = read_decimals(text, 6, turned);
    for (int i = 0; i < 6 && told; i++) {
      dicom->varied |= dicom->oriented && turned[i] != dicom->orientation[i];
      dicom->orientation[i] = turned[i];
    }
    dicom->oriented |= told;
  } else if (tag == 0x00281052 || tag == 0x00281053) {
    double *factor = tag == 0x00281052 ? &dicom->intercept : &dicom->slope, value;
    if (!read_decimals(text, 1, &value)) return damaged(dicom);
    dicom->varied |= isfinite(*factor) && value != *factor;
    *factor = value;
  } else {
    double *told = tag == 0x00200013   ? &dicom->number
                   : tag == 0x00180050 ? &dicom->thickness
                   : tag == 0x00181120 ? &dicom->tilt
                   : tag == 0x00201041 ? &dicom->location
                                       : &dicom->distance;
    if (!read_decimals(text, 1, told)) *told = NAN;
  }
  return STATUS_OK;
}

/* Whether what an element of frames holds is read on, one element after the other: the positions,
 * orientations, measures and scales of frames, of each or shared by all (PS3.3, C.7.6.16), and the
 * real world values that greys stand for. */
static bool holds_frames(const struct element *element) {
  static const uint32_t TAGS[] = {0x52009229, 0x52009230, 0x00209111, 0x00209113,
                                  0x00209116, 0x00289110, 0x00289145, 0x00409096};
  for (size_t i = 0; i < sizeof TAGS / sizeof *TAGS; i++)
    if ((element->group << 16 | element->number) == TAGS[i]) return true;
  return element->group == 0xfffe; /* their items, and the ends of these */
}

/* Whether the elements behind group 2 name the kinds of their values, whatever the transfer syntax,
 * if there is one, says: some programs write another than they name. */
static bool find_kinds(struct dicom *dicom) {
  unsigned char head[6];
  const off_t at = ftello(dicom->file);
  while (fread(head, 1, 6, dicom->file) == 6 && head[0] == 2 && head[1] == 0) {
    struct element element;
    if (fseeko(dicom->file, -6, SEEK_CUR) != 0 || !read_element(dicom, &element) ||
        fseeko(dicom->file, (off_t)element.length, SEEK_CUR) != 0)
      return false;
  }
  dicom->implicit = !is_kind(head + 4);
  return fseeko(dicom->file, at, SEEK_SET) == 0;
}

static enum status read_header(const char *path, struct dicom *dicom) {
  enum status status = STATUS_OK;
  unsigned char head[PREAMBLE + 4];
  struct element element;
  *dicom = (struct dicom){.path = path,
                          .frames = 1,
                          .samples = 1,
                          .slope = NAN,
                          .intercept = NAN,
                          .spacing = {NAN, NAN},
                          .padding = {NAN, NAN},
                          .tilt = NAN,
                          .aspect = {NAN, NAN},
                          .number = NAN,
                          .thickness = NAN,
                          .distance = NAN,
                          .location = NAN,
                          .step = NAN,
                          .mapping = {NAN, NAN},
                          .orientation = {1, 0, 0, 0, 1, 0}}; /* where it is not told */
  TRY(input_open(path, &dicom->file));
  const bool marked = fread(head, 1, sizeof head, dicom->file) == sizeof head &&
                      memcmp(head + PREAMBLE, "DICM", 4) == 0;
  if (fseeko(dicom->file, marked ? PREAMBLE + 4 : 0, SEEK_SET) != 0 || !find_kinds(dicom))
    TRY(damaged(dicom));
  for (;;) {
    if (!read_element(dicom, &element)) {
      if (!feof(dicom->file)) TRY(damaged(dicom));
      TRY_FAIL(STATUS_INPUT,
               "%s: ends before any pixels: cut short, or a list of slices (DICOMDIR): give the "
               "slices themselves",
               path);
    }
    if (element.group == 0x7fe0 && element.number == 0x0010) break;
    if (element.group == 0x7fe0)
      TRY_FAIL(STATUS_INPUT, "%s: pixels that are floats are not read; save as 8 or 16 bit", path);
    const uint32_t tag = element.group << 16 | element.number;
    dicom->by_table |= (tag == 0x00283000 || tag == 0x00409212) && element.length > 0;
    if (holds_frames(&element)) continue;
    if (element.length == UNDEFINED) {
      if (!skip_undefined(dicom, &element, 0)) TRY(damaged(dicom));
    } else {
      TRY(take_element(dicom, &element));
    }
  }
  dicom->pixels = (uint64_t)ftello(dicom->file);
  dicom->length = element.length;
cleanup:
  return status;
}

static int by_distance(const void *a, const void *b) {
  const double x = ((const double *)a)[2], y = ((const double *)b)[2];
  return x < y ? -1 : x > y;
}

/* Puts frames that tell where they are, or at least their numbers, in that order, as stack.c does
 * with slices; frames lie one behind the other at even distances. */
static enum status order_frames(struct dicom *d, struct image *image) {
  enum status status = STATUS_OK;
  const size_t n = d->frames;
  double(*along)[4] = NULL; /* across twice, along the normal, and the number of the frame */
  const bool placed = d->places.count > 1;
  const struct places *places = placed                 ? &d->places
                                : d->numbers.count > 1 ? &d->numbers
                                                       : &d->indices;
  bool even = places->count == n, turned = false;
  double step = 0.0;
  if (n < 2 || places->count < 2) goto cleanup;
  if (even) TRY(memory_allocate(&along, n, sizeof *along, "positions of frames"));
  for (size_t i = 0; i < n && even; i++) {
    memcpy(along[i], places->at[i], sizeof *places->at);
    if (placed) along_axes(d, places->at[i], along[i]);
    along[i][3] = (double)i;
  }
  if (even) {
    qsort(along, n, sizeof *along, by_distance);
    step = (along[n - 1][2] - along[0][2]) / (double)(n - 1);
    if (placed) d->step = step;
  }
  if (places == &d->indices && step == 0.0) goto cleanup; /* of one place along another axis */
  for (size_t i = 1; i < n && even; i++) {
    const double aside = hypot(along[i][0] - along[0][0], along[i][1] - along[0][1]);
    even = step > 0.0 && fabs(along[i][2] - along[i - 1][2] - step) <= STEPS_ALIKE * step;
    turned |= along[i][3] < along[i - 1][3];
    if (placed && d->oriented && aside > 0.5 * d->spacing[0])
      TRY_FAIL(STATUS_INPUT, "%s: its frames are shifted sideways, one by %g mm" SHEARED, d->path,
               aside);
  }
  if (!even)
    TRY_FAIL(STATUS_INPUT,
             "%s: its %u frames are not slices one behind the other at even distances, as their "
             "%zu positions or numbers tell; save them as single slices",
             d->path, d->frames, places->count);
  if (!turned) goto cleanup;
  image_note(image,
             "its frames are taken in the order of their positions or numbers, not as stored");
  TRY(memory_allocate(&image->page_offsets, n, sizeof *image->page_offsets, "order of frames"));
  for (size_t i = 0; i < n; i++) image->page_offsets[i] = (uint64_t)along[i][3];
cleanup:
  memory_free(&along);
  return status;
}

/* Slices lie one behind the other, and frames are of one kind. */
static enum status check_frames(const struct dicom *d) {
  if (d->tilt != 0.0 && isfinite(d->tilt) && !(d->placed && d->oriented))
    return FAIL(
        STATUS_INPUT,
        "%s: its gantry is tilted by %g degrees, and no positions say how its slices lie" SHEARED,
        d->path, d->tilt);
  if (d->frames > 1 && d->projected)
    return FAIL(STATUS_INPUT,
                "%s: its frames are projections at different angles, no slices; reconstruct them "
                "first",
                d->path);
  if (d->varied || (d->frames > 1 && d->mapped_each))
    return FAIL(STATUS_INPUT,
                "%s: its frames are turned or scaled each in its own way; save them as single "
                "slices of one kind",
                d->path);
  return STATUS_OK;
}

/* The distance of slices, m: from frame to frame by their positions, or as told. */
static double slice_distance(const struct dicom *d) {
  const double mm = d->step > 0.0 ? d->step : d->distance > 0.0 ? d->distance : d->thickness;
  return mm > 0.0 ? 1e-3 * mm : NAN;
}

/* Values that fill up a slice beyond what was measured: one, or from one to the other (PS3.3,
 * C.7.5.1.1.2). Bits that are not stored are not looked at in pixels, nor here. */
static void take_padding(const struct dicom *d, struct image *image) {
  const double span = ldexp(1.0, (int)d->stored);
  double ends[2] = {d->padding[0], isnan(d->padding[1]) ? d->padding[0] : d->padding[1]};
  for (int i = 0; i < 2 && isfinite(ends[0]); i++) {
    ends[i] -= span * floor(ends[i] / span);
    if (d->is_signed && ends[i] >= 0.5 * span) ends[i] -= span;
  }
  image_no_data(image, fmin(ends[0], ends[1]), fmax(ends[0], ends[1]), "PixelPaddingValue");
}

static enum status dicom_open(const char *path, struct image *image) {
  enum status status = STATUS_OK;
  struct dicom d = {0};
  uint64_t bytes;
  TRY(read_header(path, &d));
  TRY(image_file_size(path, &bytes));
  if (d.rows == 0 || d.columns == 0 || d.frames == 0 || d.frames > INT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%s: %u x %u pixels, %u frames" EXPORT_AGAIN, path, d.columns, d.rows,
             d.frames);
  TRY(check_frames(&d));
  TRY(order_frames(&d, image));
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
  take_padding(&d, image);
  if (d.oriented) memcpy(image->axes, d.orientation, sizeof image->axes);
  /* Where nothing but a position or a location puts slices in order, it is taken to be along z. */
  if (d.placed && (d.oriented || isnan(d.number))) along_axes(&d, d.places.at[0], image->at);
  if (!d.placed && isnan(d.number)) image->at[2] = d.location;
  for (int a = 0; a < 3; a++) image->at[a] *= 1e-3;
  image->number = d.number;
  snprintf(image->series, sizeof image->series, "%s%s%s", d.series, d.of,
           d.scout ? " localizer" : "");
  if (d.lossy) image_note(image, IMAGE_COMPRESSED_WITH_LOSS);
  if (d.of_many) image_note(image, "projections, as it says (ImageType): read as slices");
  if (d.written)
    image_note(image, "text is written into its pixels (BurnedInAnnotation): leave that out by "
                      "--crop");
  if (d.logarithms)
    image_note(image, "its greys are logarithms (PixelIntensityRelationship), as of projections");
  if (d.part > 0)
    image_note(image, "part %u of a scan that was cut into several files: give all", d.part);
  const bool mapped = isnan(d.slope) && isfinite(d.mapping[0]) && isfinite(d.mapping[1]);
  if (isnan(d.slope)) d.slope = 1.0;
  if (isnan(d.intercept)) d.intercept = 0.0;
  image->rescale[0] = mapped ? d.mapping[0] : d.slope;
  image->rescale[1] = mapped ? d.mapping[1] : d.intercept;
  if (d.spacing[0] > 0.0 && d.spacing[1] > 0.0) {
    image->voxel[0] = 1e-3 * d.spacing[1];
    image->voxel[1] = 1e-3 * d.spacing[0];
    image->voxel[2] = slice_distance(&d);
    image->voxel_source = "DICOM pixel spacing";
  } else if (isfinite(d.aspect[0]) && d.aspect[0] != d.aspect[1])
    image_note(image, "its pixels are not square (aspect %g:%g): give --voxel-size as X,Y,Z",
               d.aspect[0], d.aspect[1]);
  if (d.frames > 1 && d.in_time)
    image_note(image, "its frames follow one another in time, as it says: read as slices");
  if (d.frames > 1 && d.in_several)
    image_note(image, "its frames follow one another along several axes, as of windows, detectors "
                      "or times (FrameIncrementPointer): read as slices");
  if (d.by_table) image_note(image, "greys as stored, before its table (Modality LUT Sequence)");
  if (d.slope != 1.0 || d.intercept != 0.0)
    image_note(image, "greys as stored, before its slope %g and intercept %g", d.slope,
               d.intercept);
  if (isfinite(d.mapping[0]) && (d.mapping[0] != 1.0 || d.mapping[1] != 0.0))
    image_note(image,
               "greys as stored, before the slope %g and intercept %g of its Real World Value "
               "Mapping",
               d.mapping[0], d.mapping[1]);
cleanup:
  MEMORY_FREE(&d.places.at, &d.numbers.at, &d.indices.at);
  if (d.file != NULL) fclose(d.file);
  return status;
}

/* Bits above those that are used may hold anything; those of a sign go on to the top. */
static enum status dicom_read(const struct image *image, size_t page, void *out) {
  const size_t frame = image->page_offsets != NULL ? (size_t)image->page_offsets[page] : page;
  const enum status status = image_read_contiguous(image, frame, out);
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

const struct image_reader image_dicom_reader = {.name = "DICOM",
                                                .endings = {".dcm", ".dicom", ".ima"},
                                                .claims = dicom_claims,
                                                .open = dicom_open,
                                                .read = dicom_read};
