#include "ct2model/scan/slice_check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/provenance.h"
#include "ct2model/scan/constants.h"

/* Fraction of pixels that differ from their left neighbour above which a slice is noisy: nearly all
 * differ where there is noise of a grey level or more, but only those at edges in labels and in
 * images without noise. */
#define DIFFERENT_FRACTION 0.5
/* A slice is sampled at SAMPLES x SAMPLES pixels of each of PARTS x PARTS parts. */
enum { PARTS = 3, SAMPLES = 8, OF_PART = SAMPLES * SAMPLES, OF_SLICE = PARTS * PARTS * OF_PART };
enum { SLICES_JUDGED = 8 }; /* fewer do not tell how alike slices are */

enum status slice_check_start(size_t count, struct slice_check *check) {
  enum status status = STATUS_OK;
  *check = (struct slice_check){.count = count};
  TRY(memory_allocate(&check->hash, count, sizeof *check->hash, "hashes of slices"));
  TRY(memory_allocate(&check->constant, count, sizeof *check->constant, "hashes of slices"));
  TRY(memory_allocate(&check->greys, count * OF_SLICE, sizeof *check->greys, "samples of slices"));
cleanup:
  return status;
}

void slice_check_end(struct slice_check *check) {
  MEMORY_FREE(&check->hash, &check->constant, &check->greys);
}

/* Pixel number `sample` of part `part` along an axis of n pixels. */
static size_t place_of(size_t part, size_t sample, size_t n) {
  return (2 * (part * SAMPLES + sample) + 1) * n / (2 * PARTS * SAMPLES);
}

void slice_check_add(struct slice_check *check, size_t z, const struct pixel_rows *rows,
                     const size_t size[2]) {
  const size_t pixel = pixel_size(rows->type), row = size[0] * pixel;
  const char *first = rows->first;
  uint64_t hash = 0;
  bool constant = true;
  for (size_t y = 0; y < size[1]; y++) {
    const char *at = first + y * rows->stride;
    const uint64_t pair[2] = {hash, hash_bytes(at, row)};
    hash = hash_bytes(pair, sizeof pair);
    constant =
        constant && memcmp(at, first, pixel) == 0 && memcmp(at, at + pixel, row - pixel) == 0;
  }
  float *grey = check->greys + z * OF_SLICE;
  for (size_t part = 0; part < PARTS * PARTS; part++)
    for (size_t i = 0; i < OF_PART; i++, grey++) {
      const size_t y = place_of(part / PARTS, i / SAMPLES, size[1]);
      const size_t x = place_of(part % PARTS, i % SAMPLES, size[0]);
      pixels_to_float(grey, first + y * rows->stride + x * pixel, 1, rows->type);
    }
  check->hash[z] = hash;
  check->constant[z] = constant;
}

/* The nearest slice before z of which z is a copy; z if there is none. */
static size_t copied_from(const struct slice_check *check, size_t z) {
  for (size_t d = 1; d <= z; d++)
    if (check->hash[z] == check->hash[z - d]) return z - d;
  return z;
}

static enum status is_noisy(const struct region *region, size_t z, float *slice, bool *noisy) {
  enum status status = STATUS_OK;
  const size_t nx = region->size[0], n = nx * region->size[1];
  size_t unlike = 0;
  TRY(region_read(region, &z, 1, slice));
  for (size_t i = 0; i < n; i++) unlike += i % nx > 0 && slice[i] != slice[i - 1]; // NOLINT: nx > 0
  *noisy = (double)unlike > DIFFERENT_FRACTION * (double)n;
cleanup:
  return status;
}

/* The nearest slice to z with more than one grey; `count` if there is none. */
static size_t varied_neighbour(const struct slice_check *check, size_t z) {
  for (size_t d = 1; d < check->count; d++) {
    if (z >= d && !check->constant[z - d]) return z - d;
    if (z + d < check->count && !check->constant[z + d]) return z + d;
  }
  return check->count;
}

static int by_value(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return x < y ? -1 : x > y;
}

/* By how much the greys of all parts of slice z are higher than those of the slice before, or
 * lower: the least of the medians of their differences, 0 if these have not all the same sign.
 * Pores and grains that begin or end do not move the medians of all parts at once. */
static double jump_at(const struct slice_check *check, size_t z) {
  const float *here = check->greys + z * OF_SLICE, *before = here - OF_SLICE;
  float least = INFINITY, sign = 0.0f;
  for (size_t part = 0; part < PARTS * PARTS; part++) {
    float change[OF_PART];
    size_t n = 0;
    for (size_t i = part * OF_PART; i < (part + 1) * OF_PART; i++)
      if (isfinite(here[i] - before[i])) change[n++] = here[i] - before[i];
    if (n == 0) return 0.0;
    qsort(change, n, sizeof *change, by_value);
    const float median = 0.5f * (change[(n - 1) / 2] + change[n / 2]);
    if (part == 0) sign = median;
    if (!(median * sign > 0.0f)) return 0.0;
    least = fminf(least, fabsf(median));
  }
  return (double)least;
}

/* Correlation of the greys of slice z with those of the slice before. */
static double likeness(const struct slice_check *check, size_t z) {
  const float *a = check->greys + z * OF_SLICE, *b = a - OF_SLICE;
  double n = 0.0, sum[2] = {0.0}, square[2] = {0.0}, product = 0.0;
  for (size_t i = 0; i < OF_SLICE; i++) {
    const double x = (double)a[i], y = (double)b[i];
    if (!isfinite(x) || !isfinite(y)) continue;
    n++;
    sum[0] += x;
    sum[1] += y;
    square[0] += x * x;
    square[1] += y * y;
    product += x * y;
  }
  const double spread = (square[0] - sum[0] * sum[0] / n) * (square[1] - sum[1] * sum[1] / n);
  return spread > 0.0 ? (product - sum[0] * sum[1] / n) / sqrt(spread) : NAN;
}

/* Warns of slices that are much less like the one before than slices are: others were left out
 * between them, or they were mirrored, turned, shifted or inverted. */
static enum status warn_of_breaks(const struct slice_check *check, const struct region *region) {
  enum status status = STATUS_OK;
  float *like = NULL;
  size_t n = 0, breaks = 0, first = 0;
  char name[2][80];
  TRY(memory_allocate(&like, check->count, sizeof *like, "likeness of slices"));
  for (size_t z = 1; z < check->count; z++) {
    const double here = likeness(check, z);
    if (isfinite(here)) like[n++] = (float)here;
  }
  if (n < SLICES_JUDGED) goto cleanup;
  qsort(like, n, sizeof *like, by_value);
  const double usual = (double)like[n / 2];
  for (size_t i = 0; i < n; i++) like[i] = fabsf(like[i] - (float)usual);
  qsort(like, n, sizeof *like, by_value);
  const double least = fmin(0.5 * usual, usual - BREAK_LEAST * (double)like[n / 2]);
  for (size_t z = check->count; z-- > 1 && usual > LIKENESS_LEAST;)
    if (likeness(check, z) < least) {
      breaks++;
      first = z;
    }
  if (breaks == 0) goto cleanup;
  for (size_t i = 0; i < 2; i++)
    stack_slice_name(region->stack, region->origin[2] + first - i, name[i], sizeof name[i]);
  log_warning("%zu of %zu slices do not go on where the one before ends (first: %s after %s, "
              "correlation %.2f, of others %.2f): are slices missing between, or was one mirrored, "
              "turned, shifted or inverted? pores end there",
              breaks, check->count, name[0], name[1], likeness(check, first), usual);
cleanup:
  memory_free(&like);
  return status;
}

/* How far slice z is from the mean of those beside it, in the mean. */
static double bend_at(const struct slice_check *check, size_t z) {
  const float *here = check->greys + z * OF_SLICE;
  double sum = 0.0, n = 0.0;
  for (size_t i = 0; i < OF_SLICE; i++) {
    const double bend =
        0.5 * ((double)here[i - OF_SLICE] + (double)here[i + OF_SLICE]) - (double)here[i];
    if (!isfinite(bend)) continue;
    sum += fabs(bend);
    n++;
  }
  return n > 0.0 ? sum / n : 0.0;
}

/* Warns of slices that a program put between those of the scanner: no noise of their own bends the
 * greys there. */
static void warn_of_interpolation(const struct slice_check *check) {
  size_t between = 0;
  double bend[3] = {0.0}; /* of three slices that follow one another */
  if (check->count < SLICES_JUDGED) return;
  for (size_t z = 1; z < check->count; z++) {
    bend[0] = bend[1];
    bend[1] = bend[2];
    bend[2] = z + 1 < check->count ? bend_at(check, z) : 0.0;
    between += z > 1 && bend[1] < BETWEEN_MOST * fmax(bend[0], bend[2]);
  }
  if (4 * between > check->count)
    log_warning(
        "%zu of %zu slices are the means of those beside them, as where a program put slices "
        "between those of the scanner: walls along z are no sharper than those are apart",
        between, check->count);
}

/* Warns of slices that are more alike to a later one than to the next: of several channels, times
 * or scans in turns. */
static void warn_of_turns(const struct slice_check *check) {
  enum { TURNS_MOST = 4 };
  double step[TURNS_MOST + 1] = {0.0};
  if (check->count < SLICES_JUDGED) return;
  for (size_t k = 1; k <= TURNS_MOST; k++) {
    for (size_t i = 0; i < (check->count - TURNS_MOST) * OF_SLICE; i++) {
      const double change = (double)check->greys[i + k * OF_SLICE] - (double)check->greys[i];
      if (isfinite(change)) step[k] += fabs(change);
    }
    if (!(step[k] < SLICE_TURN_RATIO * step[1])) continue;
    log_warning(
        "slices alternate in turns of %zu: are they of several channels, times or scans, one "
        "in turn after the other? save one of them alone",
        k);
    return;
  }
}

/* Warns of slices whose greys were stretched each in its own way, as where a program took the range
 * of each slice for that of the greys it wrote. */
static void warn_of_jumps(const struct slice_check *check) {
  double n = 0.0, sum = 0.0, squares = 0.0, most = 0.0;
  size_t jumps = 0;
  for (size_t i = 0; i < check->count * OF_SLICE; i++) {
    const double grey = (double)check->greys[i];
    if (!isfinite(grey)) continue;
    n++;
    sum += grey;
    squares += grey * grey;
  }
  const double deviation = sqrt(fmax(0.0, squares / n - sum / n * (sum / n)));
  for (size_t z = 1; z < check->count; z++) {
    const double jump = check->constant[z] || check->constant[z - 1] ? 0.0 : jump_at(check, z);
    jumps += jump > JUMP_LEAST * deviation;
    most = fmax(most, jump);
  }
  if (jumps > JUMPS_SHARE * (double)(check->count - 1) && jumps > 1)
    log_warning("the greys of %zu of %zu slices jump everywhere at once against those of the slice "
                "before, by up to %.0f %% of their spread: were the slices stretched each to its "
                "own range (auto contrast)? one threshold means another wall in each: save them "
                "again with one range for all",
                jumps, check->count, 100.0 * most / deviation);
}

/* Warns of greys far from all others, at one end of them: voxels without a measurement, which no
 * field of the file tells of. */
static enum status warn_of_fill(const struct slice_check *check) {
  enum status status = STATUS_OK;
  float *greys = NULL;
  size_t n = 0;
  TRY(memory_allocate(&greys, check->count * OF_SLICE, sizeof *greys, "samples of slices"));
  for (size_t i = 0; i < check->count * OF_SLICE; i++)
    if (isfinite(check->greys[i])) greys[n++] = check->greys[i];
  qsort(greys, n, sizeof *greys, by_value);
  for (int end = 0; end < 2 && n > 0; end++) {
    const double fill = (double)greys[end == 0 ? 0 : n - 1];
    size_t others = 0; /* from one end to the other */
    while (others < n && (double)greys[end == 0 ? others : n - 1 - others] == fill) others++;
    if (others == n || (double)others < FILL_SHARE * (double)n) continue;
    const double next = (double)greys[end == 0 ? others : n - 1 - others];
    const double last = (double)greys[end == 0 ? n - 1 : 0];
    if (fabs(next - fill) > FILL_GAP * fabs(last - next))
      log_warning("%.1f %% of the voxels have the grey %g, far from all others (%g to %g): no "
                  "measurement? it counts as %s: leave it out by --crop or --roi",
                  100.0 * (double)others / (double)n, fill, fmin(next, last), fmax(next, last),
                  end == 0 ? "dark" : "bright");
  }
cleanup:
  memory_free(&greys);
  return status;
}

enum status slice_check_warn(const struct slice_check *check, const struct region *region) {
  enum status status = STATUS_OK;
  const size_t n = check->count;
  size_t copies = 0, copy = 0, constants = 0, constant = 0;
  char name[2][80];
  float *slice = NULL;
  bool noisy = false;
  for (size_t z = n; z-- > 0;) {
    if (check->constant[z]) {
      constants++;
      constant = z;
    } else if (copied_from(check, z) < z) {
      copies++;
      copy = z;
    }
  }
  if (constants == n) goto cleanup;
  TRY(memory_allocate(&slice, region->size[0] * region->size[1], sizeof *slice, "a slice"));
  if (copies > 0) TRY(is_noisy(region, copy, slice, &noisy));
  if (copies > 0 && noisy) {
    stack_slice_name(region->stack, region->origin[2] + copy, name[0], sizeof name[0]);
    stack_slice_name(region->stack, region->origin[2] + copied_from(check, copy), name[1],
                     sizeof name[1]);
    log_warning("%zu of %zu slices are copies, noise and all, of another (first: %s of %s): "
                "pores do not run through them as in the specimen, and k is false; mend the stack, "
                "or leave them "
                "out with --crop",
                copies, n, name[0], name[1]);
  }
  TRY(is_noisy(region, constants > 0 ? varied_neighbour(check, constant) : n / 2, slice, &noisy));
  if (noisy) warn_of_jumps(check);
  if (noisy) warn_of_interpolation(check);
  if (noisy) warn_of_turns(check);
  if (noisy) TRY(warn_of_breaks(check, region));
  if (noisy) TRY(warn_of_fill(check));
  if (noisy && constants > 0) {
    stack_slice_name(region->stack, region->origin[2] + constant, name[0], sizeof name[0]);
    log_warning("%zu of %zu slices are of one grey (first: %s): no scan, but a gap or a plate in "
                "the model; mend the stack, or leave them out with --crop",
                constants, n, name[0]);
  }
cleanup:
  memory_free(&slice);
  return status;
}
