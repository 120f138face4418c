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
/* Fraction of pixels with two equal bytes above which pixels of 8 bits were converted to 16. */
#define EQUAL_BYTES 0.9

/* Mean difference of neighbours in a row over the mean deviation from the mean; infinite if a pixel
 * is not a number. */
static double roughness(const float *pixels, size_t width, size_t height) {
  const size_t n = width * height;
  double mean = 0.0, distance = 0.0, step = 0.0;
  for (size_t i = 0; i < n; i++) mean += (double)pixels[i] / (double)n;
  if (!isfinite(mean)) return INFINITY;
  for (size_t i = 0; i < n; i++) {
    distance += fabs((double)pixels[i] - mean);
    if (i % width > 0) step += fabs((double)pixels[i] - (double)pixels[i - 1]);
  }
  return distance > 0.0 ? step / distance : 0.0;
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

/* Whether pixels are pairs of pixels of the type `half`: then the two halves of a pixel are
 * neighbours, and as alike as others. `pixels` is overwritten. */
static bool are_pairs(const uint8_t *bytes, size_t width, size_t height, enum pixel_type half,
                      float *pixels) {
  const size_t one = pixel_size(half);
  size_t equal = 0;
  for (size_t i = 0; i < width * height; i++)
    equal += memcmp(bytes + 2 * i * one, bytes + (2 * i + 1) * one, one) == 0;
  if (one == 1 && (double)equal > EQUAL_BYTES * (double)(width * height)) return false;
  for (size_t side = 0; side < 2; side++) {
    for (size_t y = 0; y < height; y++)
      pixels_to_float(pixels + y * (width / 2 * 2),
                      bytes + (2 * width * y + side * (width / 2 * 2)) * one, width / 2 * 2, half);
    if (roughness(pixels, width / 2 * 2, height) > ROUGHNESS_SCAN) return false;
  }
  return true;
}

/* Fraction of neighbours in a row that differ by more than 3/4 of the range of the type. */
static double jump_fraction(const float *pixels, size_t width, size_t n, enum pixel_type type) {
  double low, high;
  size_t count = 0;
  if (!pixel_levels(type, &low, &high)) return 0.0;
  for (size_t i = 1; i < n; i++)
    count += i % width > 0 && fabs((double)pixels[i] - (double)pixels[i - 1]) > 0.75 * (high - low);
  return (double)count / (double)n;
}

/* Whether signed pixels are in fact unsigned: those above half of the range are wrapped to below
 * zero, so that neighbours jump from one end of the range to the other. Labels of both ends may be
 * intended, so an image with few values is not judged. `pixels` is overwritten. */
static bool are_unsigned(const void *stored, size_t width, size_t n, enum pixel_type type,
                         float *pixels) {
  const enum pixel_type turned = type == PIXEL_I8 ? PIXEL_U8 : PIXEL_U16;
  float seen[16];
  size_t values = 0;
  if (type != PIXEL_I8 && type != PIXEL_I16) return false;
  pixels_to_float(pixels, stored, n, type);
  for (size_t i = 0; i < n && values < 16; i++) {
    size_t v = 0;
    while (v < values && seen[v] != pixels[i]) v++;
    if (v == values) seen[values++] = pixels[i];
  }
  const double given = jump_fraction(pixels, width, n, type);
  pixels_to_float(pixels, stored, n, turned);
  return values == 16 && given > 0.001 && jump_fraction(pixels, width, n, turned) < 0.1 * given;
}

/* Mean difference of pixels `lag` apart, for some thousand spread over the first n - most. */
static double lag_difference(const float *pixels, size_t n, size_t most, size_t lag) {
  enum { SAMPLES = 4096 };
  double sum = 0.0;
  for (size_t k = 0; k < SAMPLES; k++) {
    const size_t i = (size_t)(k * UINT64_C(2654435761) % (n - most));
    sum += fabs((double)pixels[i + lag] - (double)pixels[i]);
  }
  return sum / SAMPLES;
}

/* The width at which a pixel is as similar to the one below as to the one beside it, if that
 * clearly fails at the given width; otherwise 0. A body that repeats along x is accepted, as its
 * pixels are similar at the given width, too; so is a layered body, unless its layers are inclined
 * (row_ends.h), as no lag is better than others. */
static size_t better_width(const float *pixels, size_t width, size_t n) {
  enum { LEAST = 8, ASIDE = 4 };
  const size_t most = 4 * width + ASIDE < n / 2 ? 4 * width + ASIDE : n / 2;
  if (most <= width) return 0;
  const double beside = lag_difference(pixels, n, most, 1);
  const double given = lag_difference(pixels, n, most, width);
  if (!(beside > 0.0 && given > 1.5 * beside)) return 0;
  size_t best = 0;
  double least = fmin(1.25 * beside, 0.75 * given);
  for (size_t lag = LEAST; lag + ASIDE < most; lag++) {
    const double here = lag_difference(pixels, n, most, lag);
    if (!(here < least) || here > 0.75 * lag_difference(pixels, n, most, lag - ASIDE) ||
        here > 0.75 * lag_difference(pixels, n, most, lag + ASIDE))
      continue;
    least = here;
    best = lag;
  }
  return best;
}

/* Whether a slice has the few greys of labels, whose neighbours tell nothing of its layout. */
static bool has_few_greys(const float *pixels, size_t n) {
  enum { FEW = 4 };
  float grey[FEW];
  size_t count = 0;
  for (size_t i = 0; i < n; i++) {
    size_t k = 0;
    while (k < count && grey[k] != pixels[i]) k++;
    if (k == FEW) return false;
    if (k == count) grey[count++] = pixels[i];
  }
  return true;
}

/* Of pixels that are not whole ones, but bytes or channels of such in turns, the number that makes
 * one; 0 if neighbours are as alike as any. Bytes of one kind come round at that distance, and are
 * more alike than neighbours are; or some neighbours, of one pixel, are alike and others not. */
static size_t find_turns(const float *pixels, size_t n) {
  enum { TURNS_MOST = 4 };
  double step[TURNS_MOST + 1] = {0.0};
  for (size_t k = 1; k <= TURNS_MOST; k++)
    for (size_t i = 0; i + TURNS_MOST < n; i++)
      step[k] += fabs((double)pixels[i + k] - (double)pixels[i]);
  for (size_t k = 2; k <= TURNS_MOST; k++) {
    double of_turn[TURNS_MOST] = {0.0}, most = 0.0, rest = 0.0;
    if (step[k] < TURN_RATIO * step[1]) return k;
    for (size_t i = 0; i + TURNS_MOST < n; i++)
      of_turn[i % k] += sqrt(fabs((double)pixels[i + 1] - (double)pixels[i]));
    for (size_t j = 0; j < k; j++) {
      most = fmax(most, of_turn[j]);
      rest += of_turn[j];
    }
    rest = (rest - most) / ((double)k - 1.0);
    if (rest < TURN_RATIO * TURN_RATIO * most) return k;
  }
  return 0;
}

/* Whether neighbours are much more alike with their bytes in the other order. Both arrays are
 * overwritten. */
static bool are_swapped(const struct image *image, void *stored, float *pixels) {
  const size_t n = image->size[0] * image->size[1];
  pixels_to_float(pixels, stored, n, image->type);
  const double given = roughness(pixels, image->size[0], image->size[1]);
  pixels_swap(stored, n, image->type);
  pixels_to_float(pixels, stored, n, image->type);
  const double other = roughness(pixels, image->size[0], image->size[1]);
  return given > ROUGHNESS_RATIO * other && other > 0.0;
}

static char letter_of(enum pixel_type type) {
  if (type == PIXEL_F32 || type == PIXEL_F64) return 'f';
  return type == PIXEL_U8 || type == PIXEL_U16 || type == PIXEL_U32 ? 'u' : 'i';
}

enum status byte_order_check(const struct image *image) {
  enum status status = STATUS_OK;
  const size_t n = image->size[0] * image->size[1], bytes = pixel_size(image->type);
  void *stored = NULL;
  float *pixels = NULL;
  TRY(memory_allocate(&stored, n, bytes, "a slice"));
  TRY(memory_allocate(&pixels, n, sizeof *pixels, "a slice"));
  TRY(image->reader->read(image, image->pages / 2, stored));
  enum pixel_type half;
  if (half_of(image->type, &half) &&
      are_pairs(stored, image->size[0], image->size[1], half, pixels)) {
    log_warning("%s: the two halves of a pixel are as alike as neighbours are: is %c%zu%s meant in "
                "--raw, with twice the width or twice the slices?",
                image->path, letter_of(half), 4 * bytes,
                bytes == 2    ? ""
                : image->swap ? "be"
                              : "le");
    goto cleanup;
  }
  if (are_unsigned(stored, image->size[0], n, image->type, pixels)) {
    log_warning("%s: neighbouring pixels leap from the lowest value to the highest, and are alike "
                "without a sign: is u%zu%s meant in --raw?",
                image->path, 8 * bytes,
                bytes == 1    ? ""
                : image->swap ? "be"
                              : "le");
    goto cleanup;
  }
  pixels_to_float(pixels, stored, n, image->type);
  const size_t turns = has_few_greys(pixels, n) ? 0 : find_turns(pixels, n);
  if (turns > 0) {
    log_warning("%s: pixels alternate in turns of %zu: are they the bytes of wider pixels, or "
                "channels or colours, that --raw takes for pixels?",
                image->path, turns);
    goto cleanup;
  }
  size_t better = better_width(pixels, image->size[0], n);
  TRY(row_ends_judge(image, &better));
  if (better > 0) {
    log_warning("%s: rows of %zu pixels, one below the other, are not alike, rows of %zu are: is "
                "that the width in --raw?",
                image->path, image->size[0], better);
    goto cleanup;
  }
  TRY(row_ends_height(image, &better));
  if (better > 0) {
    log_warning("%s: slices of %zu rows end within the body, those of %zu rows do not: is that the "
                "height in --raw?",
                image->path, image->size[1], better);
    goto cleanup;
  }
  if (bytes == 1) goto cleanup;
  if (are_swapped(image, stored, pixels))
    log_warning("%s: with its bytes in the other order neighbouring pixels are much more alike: "
                "is %c%zu%s meant in --raw?",
                image->path, letter_of(image->type), 8 * bytes, image->swap ? "le" : "be");
cleanup:
  memory_free(&stored);
  memory_free(&pixels);
  return status;
}

enum status byte_order_check_sign(const struct image *image) {
  enum status status = STATUS_OK;
  const size_t n = image->size[0] * image->size[1];
  void *stored = NULL;
  float *pixels = NULL;
  if (!image->plain) return STATUS_OK;
  TRY(memory_allocate(&stored, n, pixel_size(image->type), "a slice"));
  TRY(memory_allocate(&pixels, n, sizeof *pixels, "a slice"));
  TRY(image->reader->read(image, image->pages / 2, stored));
  if (are_unsigned(stored, image->size[0], n, image->type, pixels))
    log_warning("%s: neighbouring pixels leap from the lowest value to the highest, and are alike "
                "without a sign: unsigned greys that were stored as signed ones (BigDataViewer "
                "does)? save them as unsigned",
                image->path);
  else if (pixel_size(image->type) == 2 && are_swapped(image, stored, pixels))
    log_warning("%s: with its bytes in the other order neighbouring pixels are much more alike: "
                "was it written on another kind of machine? save it again",
                image->path);
cleanup:
  memory_free(&stored);
  memory_free(&pixels);
  return status;
}
