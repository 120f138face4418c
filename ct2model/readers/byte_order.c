#include "ct2model/readers/byte_order.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/readers/constants.h"
#include "ct2model/readers/row_ends.h"

/* Ratio of roughness from which the other byte order is suggested. Random numbers have a roughness
 * of 1.3 (uniform) to 1.4 (normal). A scan is smooth except for its noise; only its low bytes are
 * random. */
#define ROUGHNESS_RATIO 2.0
/* Largest roughness of neighbours in a noisy scan; the two bytes of a pixel differ more. */
#define ROUGHNESS_SCAN 0.8

/* Mean difference of neighbours in a row over the mean deviation from the mean, of the pixels that
 * are numbers. */
static double roughness(const float *pixels, size_t width, size_t height) {
  const size_t n = width * height;
  double mean = 0.0, distance = 0.0, step = 0.0, count = 0.0, steps = 0.0;
  for (size_t i = 0; i < n; i++)
    if (isfinite(pixels[i])) mean += ((double)pixels[i] - mean) / ++count;
  for (size_t i = 0; i < n; i++) {
    if (!isfinite(pixels[i])) continue;
    distance += fabs((double)pixels[i] - mean) / count;
    if (i % width == 0 || !isfinite(pixels[i - 1])) continue;
    step += fabs((double)pixels[i] - (double)pixels[i - 1]);
    steps++;
  }
  return distance > 0.0 && steps > 0.0 ? step / steps / distance : 0.0;
}

/* The type of which two make one of `type`; false if there is none. */
static bool half_of(enum pixel_type type, enum pixel_type *half) {
  static const enum pixel_type HALVES[][2] = {{PIXEL_U16, PIXEL_U8},
                                              {PIXEL_I16, PIXEL_U8},
                                              {PIXEL_U32, PIXEL_U16},
                                              {PIXEL_I32, PIXEL_I16},
                                              {PIXEL_F64, PIXEL_F32}};
  for (size_t i = 0; i < sizeof HALVES / sizeof *HALVES; i++)
    if (HALVES[i][0] == type) {
      *half = HALVES[i][1];
      return true;
    }
  return false;
}

/* Whether greys go round: neighbours leap from one end of the range to the other and seldom by
 * less, and both ends are in use without a heap, as greys cut off there and labels have it. */
static bool are_wrapped(const float *pixels, size_t width, size_t n, enum pixel_type type) {
  enum { BINS = 128, NEXT = 2 };
  size_t count[BINS] = {0}, leaps = 0, halves = 0;
  double low, high;
  if (!pixel_levels(type, &low, &high)) return false;
  for (size_t i = 0; i < n; i++) {
    count[(size_t)(((double)pixels[i] - low) * BINS / (high - low + 1.0))]++;
    const double step = i % width > 0 ? fabs((double)pixels[i] - (double)pixels[i - 1]) : 0.0;
    leaps += step > 0.75 * (high - low);
    halves += step > 0.5 * (high - low);
  }
  for (size_t end = 0; end < BINS; end += BINS - 1) {
    double next = 0.0;
    for (size_t k = 1; k <= NEXT; k++) next += (double)count[end == 0 ? k : end - k] / NEXT;
    if (!((double)count[end] > 0.5 * next && (double)count[end] < 2.0 * next)) return false;
  }
  return (double)leaps > LEAPS_SHARE * (double)n && halves < 2 * leaps;
}

/* The width at which a pixel is as similar to the one below as to the one beside it, if that
 * clearly fails at the given width; otherwise 0. A body that repeats along x is accepted, as its
 * pixels are similar at the given width, too; so is a layered body, unless its layers are inclined
 * (row_ends.h), as no lag is better than others. */
static size_t better_width(const float *pixels, size_t width, size_t n) {
  enum { LEAST = 8, ASIDE = 4 };
  const size_t most = 4 * width + ASIDE < n / 2 ? 4 * width + ASIDE : n / 2;
  if (most <= width) return 0;
  const double beside = row_ends_lag(pixels, n, 1);
  const double given = row_ends_lag(pixels, n, width);
  if (!(beside > 0.0 && given > 1.5 * beside)) return 0;
  size_t best = 0;
  double least = fmin(1.25 * beside, 0.75 * given);
  for (size_t lag = LEAST; lag + ASIDE < most; lag++) {
    const double here = row_ends_lag(pixels, n, lag);
    if (!(here < least) || here > 0.75 * row_ends_lag(pixels, n, lag - ASIDE) ||
        here > 0.75 * row_ends_lag(pixels, n, lag + ASIDE))
      continue;
    least = here;
    best = lag;
  }
  return best;
}

/* Whether every step-th pixel has one of few greys, as in labels, whose neighbours tell nothing of
 * their layout. */
static bool has_few_greys(const float *pixels, size_t n, size_t step) {
  enum { FEW = 4 };
  float grey[FEW];
  size_t count = 0;
  for (size_t i = 0; i < n; i += step) {
    size_t k = 0;
    while (k < count && grey[k] != pixels[i]) k++;
    if (k == FEW) return false;
    if (k == count) grey[count++] = pixels[i];
  }
  return true;
}

/* Of pixels that are not whole ones, but bytes or channels of such in turns, the number that makes
 * one; 0 if neighbours are as alike as any. Bytes of one kind come round at that distance, and are
 * more alike than neighbours are; or of some neighbours the difference is less than `ratio` that of
 * others. */
static size_t find_turns(const float *pixels, size_t width, size_t n, double ratio) {
  enum { TURNS_MOST = 4 };
  double step[TURNS_MOST + 1] = {0.0};
  for (size_t k = 1; k <= TURNS_MOST; k++)
    for (size_t i = 0; i + TURNS_MOST < n; i++)
      step[k] += fabs((double)pixels[i + k] - (double)pixels[i]);
  for (size_t k = 2; k <= TURNS_MOST && 4 * k < width; k++) {
    double of_turn[TURNS_MOST] = {0.0}, most = 0.0, rest = 0.0;
    if (step[k] < TURN_RATIO * step[1]) return k;
    for (size_t i = 0; i + TURNS_MOST < n; i++)
      of_turn[i % k] += sqrt(fabs((double)pixels[i + 1] - (double)pixels[i]));
    for (size_t j = 0; j < k; j++) {
      most = fmax(most, of_turn[j]);
      rest += of_turn[j];
    }
    rest = (rest - most) / ((double)k - 1.0);
    if (rest < ratio * most) return k;
  }
  return 0;
}

/* Whether pixels are pairs of pixels of the type `half`: then the two halves of a pixel are
 * neighbours, and as alike as others. Those of greys that are cut off at the ends of their range
 * are more alike than others. With `swap` the halves are exchanged in `bytes`. `pixels` is
 * overwritten. */
static bool are_pairs(const uint8_t *bytes, size_t width, size_t n, enum pixel_type half, bool swap,
                      float *pixels) {
  for (size_t side = 0; side < 2; side++) {
    pixels_to_float(pixels, bytes + side * (n - n % 2) * pixel_size(half), n, half);
    for (size_t i = 0; swap && i + 1 < n; i += 2) {
      const float first = pixels[i];
      pixels[i] = pixels[i + 1];
      pixels[i + 1] = first;
    }
    if (has_few_greys(pixels + 1, n - 1, 2) ||
        row_ends_lag(pixels, n, 2) < row_ends_lag(pixels, n, 1) ||
        find_turns(pixels, 2 * width, n, PAIR_REST) > 0 ||
        roughness(pixels, 2 * width, n / (2 * width)) > ROUGHNESS_SCAN)
      return false;
  }
  return true;
}

/* Whether floats are whole numbers, as labels are; in the other order they would not be. */
static bool are_whole(const float *pixels, size_t n) {
  double most = 0.0;
  for (size_t i = 0; i < n; i++) {
    if (!(rint((double)pixels[i]) == (double)pixels[i])) return false;
    most = fmax(most, fabs((double)pixels[i]));
  }
  return most > 0.0 && most < FLOAT_MOST;
}

/* Whether neighbours are much more alike with their bytes in the other order. `stored` and the
 * pixels are overwritten. */
static bool are_swapped(const struct rows *rows, enum pixel_type type, void *stored) {
  const size_t n = rows->width * rows->count;
  if ((type == PIXEL_F32 || type == PIXEL_F64) && are_whole(rows->pixels, n)) return false;
  const double given = roughness(rows->pixels, rows->width, rows->count);
  pixels_swap(stored, n, type);
  pixels_to_float(rows->pixels, stored, n, type);
  const double other = roughness(rows->pixels, rows->width, rows->count);
  return given > ROUGHNESS_RATIO * other && other > 0.0;
}

static char letter_of(enum pixel_type type) {
  if (type == PIXEL_F32 || type == PIXEL_F64) return 'f';
  return type == PIXEL_U8 || type == PIXEL_U16 || type == PIXEL_U32 ? 'u' : 'i';
}

/* The order of the bytes in the name of a type, "" of one byte. */
static const char *order_of(size_t bytes, bool big) {
  return bytes == 1 ? "" : big ? "be" : "le";
}

/* Whether whole numbers of 32 bits are floats of common sizes, all of them. */
static bool are_floats(const void *stored, size_t n, float *pixels) {
  double least = FLOAT_MOST;
  pixels_to_float(pixels, stored, n, PIXEL_F32);
  for (size_t i = 0; i < n; i++) {
    const double size = fabs((double)pixels[i]);
    if (!(size < FLOAT_MOST) || (size > 0.0 && size < 1.0 / FLOAT_MOST)) return false;
    if (size > 0.0) least = size;
  }
  return least < FLOAT_MOST;
}

/* Whether neighbours are no more alike than pixels far apart. */
static bool is_noise(const float *pixels, size_t width, size_t n) {
  const double far = NOISE_RATIO * fmax(row_ends_lag(pixels, n, n / 2 + width / 3),
                                        row_ends_lag(pixels, n, n / 3 + width / 2));
  return row_ends_lag(pixels, n, 1) > far && row_ends_lag(pixels, n, width) > far;
}

/* Reads slices from the middle of the file on. */
static enum status read_rows(const struct image *image, struct rows *rows, void **stored) {
  enum { ROWS = 4000, PIXELS = 1 << 24 };
  enum status status = STATUS_OK;
  const size_t nx = image->size[0], ny = image->size[1], one = pixel_size(image->type);
  const size_t wanted = (nx > PIXELS / ROWS ? PIXELS / nx : ROWS) / ny + 1;
  const size_t pages = image->pages < wanted ? image->pages : wanted;
  const size_t first = (image->pages - pages + 1) / 2;
  *rows = (struct rows){NULL, NULL, nx, ny, first * ny, pages * ny, image->pages * ny};
  TRY(memory_allocate(stored, nx * ny * pages, one, "slices"));
  TRY(memory_allocate(&rows->pixels, nx * ny * pages, sizeof *rows->pixels, "slices"));
  for (size_t z = 0; z < pages; z++)
    TRY(image->reader->read(image, first + z, (char *)*stored + z * nx * ny * one));
  pixels_to_float(rows->pixels, *stored, nx * ny * pages, image->type);
  TRY(memory_allocate(&rows->step, rows->count, sizeof *rows->step, "rows"));
  for (size_t i = 0; i + nx < nx * rows->count; i++)
    rows->step[i / nx] += fabs((double)rows->pixels[i + nx] - (double)rows->pixels[i]) / (double)nx;
cleanup:
  return status;
}

/* What is wrong with the type of the pixels, or with their layout in rows and slices. */
static bool warn_of_type(const struct image *image, const char *where, const struct rows *rows,
                         const void *stored) {
  const size_t n = rows->width * rows->count, bytes = pixel_size(image->type);
  enum pixel_type half, turned = image->type;
  if (are_wrapped(rows->pixels, rows->width, n, image->type)) {
    (void)pixel_type_of((int)(8 * bytes), letter_of(image->type) == 'i' ? 'u' : 'i', &turned);
    pixels_to_float(rows->pixels, stored, n, turned);
    if (are_wrapped(rows->pixels, rows->width, n, turned))
      log_warning("%s: neighbouring pixels leap from the lowest value to the highest: greys that "
                  "went round when they were written with fewer bits? save them anew",
                  image->path);
    else
      log_warning("%s: neighbouring pixels leap from the lowest value to the highest, and are "
                  "alike %s a sign: is %c%zu%s meant in %s?",
                  image->path, letter_of(turned) == 'u' ? "without" : "with", letter_of(turned),
                  8 * bytes, order_of(bytes, image->swap), where);
    return true;
  }
  if (bytes == sizeof(float) && image->type != PIXEL_F32 && are_floats(stored, n, rows->pixels)) {
    log_warning("%s: its whole numbers of 32 bits make sense as floats: is f32%s meant in %s?",
                image->path, order_of(bytes, image->swap), where);
    return true;
  }
  if (!half_of(image->type, &half) ||
      !are_pairs(stored, rows->width, n, half, image->swap, rows->pixels)) {
    pixels_to_float(rows->pixels, stored, n, image->type);
    return false;
  }
  log_warning("%s: the two halves of a pixel are as alike as neighbours are: is %c%zu%s meant in "
              "%s, with twice the width or twice the slices?",
              image->path, letter_of(half), 4 * bytes, order_of(bytes / 2, image->swap), where);
  return true;
}

static bool warn_of_layout(const struct image *image, const char *where, const struct rows *rows,
                           bool labels) {
  const size_t n = rows->width * rows->count;
  const size_t turns = labels ? 0 : find_turns(rows->pixels, rows->width, n, TURN_REST);
  const size_t width = row_ends_width(rows, better_width(rows->pixels, rows->width, n));
  const size_t height = row_ends_height(rows);
  if (turns > 0)
    log_warning("%s: pixels alternate in turns of %zu: are they the bytes of wider pixels, or "
                "channels or colours, that %s takes for pixels?",
                image->path, turns, where);
  else if (width > 0)
    log_warning("%s: rows of %zu pixels, one below the other, are not alike, rows of %zu are: is "
                "that the width in %s?",
                image->path, rows->width, width, where);
  else if (height > 0)
    log_warning("%s: slices of %zu rows end within the body, those of %zu rows do not: is that the "
                "height in %s?",
                image->path, rows->height, height, where);
  return turns + width + height > 0;
}

enum status byte_order_check(const struct image *image) {
  enum { LEAST = 4096, SIDE_LEAST = 8 }; /* fewer pixels are alike, or not, by chance */
  enum status status = STATUS_OK;
  const size_t bytes = pixel_size(image->type);
  const char *where = image->reader->claims == NULL ? "--raw" : "its header";
  struct rows rows = {0};
  void *stored = NULL;
  if (!image->plain || image->columns || image->palette != NULL) return STATUS_OK;
  TRY(read_rows(image, &rows, &stored));
  const size_t n = rows.width * rows.count;
  const bool labels = has_few_greys(rows.pixels, n, 1);
  if (n < LEAST || rows.width < SIDE_LEAST || rows.height < SIDE_LEAST ||
      warn_of_type(image, where, &rows, stored) || warn_of_layout(image, where, &rows, labels))
    goto cleanup;
  const bool noise = !labels && is_noise(rows.pixels, rows.width, n);
  if (bytes > 1 && are_swapped(&rows, image->type, stored))
    log_warning("%s: with its bytes in the other order neighbouring pixels are much more alike: "
                "is %c%zu%s meant in %s?",
                image->path, letter_of(image->type), 8 * bytes, order_of(bytes, !image->swap),
                where);
  else if (noise)
    log_warning("%s: neighbouring pixels are no more alike than those far apart, as in compressed "
                "data or where greys went round: is it a scan?",
                image->path);
cleanup:
  MEMORY_FREE(&stored, &rows.pixels, &rows.step);
  return status;
}
