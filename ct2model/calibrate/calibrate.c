#include "ct2model/calibrate/calibrate.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"

enum status grey_histogram_start(double low, double width, size_t bins,
                                 struct grey_histogram *histogram) {
  *histogram = (struct grey_histogram){.low = low, .width = width, .bins = bins};
  return memory_allocate(&histogram->counts, bins, sizeof *histogram->counts, "a histogram");
}

void grey_histogram_end(struct grey_histogram *histogram) {
  memory_free(&histogram->counts);
}

void grey_histogram_add(struct grey_histogram *histogram, const float *values, size_t n) {
  const double scale = 1.0 / histogram->width, top = (double)histogram->bins - 1.0;
  for (size_t i = 0; i < n; i++) {
    double bin = ((double)values[i] - histogram->low) * scale;
    bin = bin > 0.0 ? bin : 0.0;
    histogram->counts[(size_t)(bin < top ? bin : top)]++;
  }
  histogram->total += n;
}

double grey_histogram_porosity(const struct grey_histogram *histogram, double threshold) {
  double position = (threshold - histogram->low) / histogram->width;
  if (position <= 0.0) return 0.0;
  if (position >= (double)histogram->bins) return 1.0;
  size_t bin = (size_t)position;
  uint64_t below = 0;
  for (size_t i = 0; i < bin; i++) below += histogram->counts[i];
  double part = (position - (double)bin) * (double)histogram->counts[bin];
  return ((double)below + part) / (double)histogram->total;
}

double grey_histogram_quantile(const struct grey_histogram *histogram, double porosity) {
  double target = porosity * (double)histogram->total, below = 0.0;
  for (size_t i = 0; i < histogram->bins; i++) {
    double count = (double)histogram->counts[i];
    if (count > 0.0 && below + count >= target)
      return histogram->low + histogram->width * ((double)i + (target - below) / count);
    below += count;
  }
  return histogram->low + histogram->width * (double)histogram->bins;
}

static double bin_centre(const struct grey_histogram *histogram, size_t bin) {
  return histogram->low + histogram->width * ((double)bin + 0.5);
}

/* Like grey_histogram_quantile, but a bin represents all greys half-way to the next bins that are
 * not empty: levels stored as floats leave most of the narrow bins empty. */
static double level_quantile(const struct grey_histogram *histogram, double porosity) {
  double target = porosity * (double)histogram->total, below = 0.0;
  size_t bin = 0, bins = histogram->bins;
  for (; bin + 1 < bins; bin++) {
    const double count = (double)histogram->counts[bin];
    if (count > 0.0 && below + count >= target) break;
    below += count;
  }
  size_t last = bin, next = bin + 1;
  while (last > 0 && histogram->counts[last - 1] == 0) last--;
  while (next < bins && histogram->counts[next] == 0) next++;
  const double centre = bin_centre(histogram, bin), half = 0.5 * histogram->width;
  const double low = last > 0 ? 0.5 * (bin_centre(histogram, last - 1) + centre) : centre - half;
  const double high = next < bins ? 0.5 * (centre + bin_centre(histogram, next)) : centre + half;
  const double count = (double)histogram->counts[bin];
  return low + (count > 0.0 ? (high - low) * (target - below) / count : 0.0);
}

double grey_histogram_slope(const struct grey_histogram *histogram, double porosity) {
  double low = fmax(porosity - 0.005, 0.0), high = fmin(porosity + 0.005, 0.999);
  return (level_quantile(histogram, high) - level_quantile(histogram, low)) /
         (high / (1.0 - high) - low / (1.0 - low));
}

double grey_histogram_otsu(const struct grey_histogram *histogram) {
  double sum = 0.0, below = 0.0, below_sum = 0.0, best = 0.0, threshold = NAN;
  for (size_t i = 0; i < histogram->bins; i++)
    sum += (double)histogram->counts[i] * bin_centre(histogram, i);
  size_t tied = 0;
  for (size_t i = 0; i + 1 < histogram->bins; i++) {
    below += (double)histogram->counts[i];
    below_sum += (double)histogram->counts[i] * bin_centre(histogram, i);
    double above = (double)histogram->total - below;
    if (below == 0.0 || above == 0.0) continue;
    double distance = below_sum / below - (sum - below_sum) / above;
    double between = below * above * distance * distance;
    double edge = histogram->low + histogram->width * (double)(i + 1);
    if (between > best * (1.0 + 1e-12)) {
      best = between;
      threshold = edge;
      tied = 1;
    } else if (between >= best * (1.0 - 1e-12) && best > 0.0) {
      /* Empty bins between the classes have equally good edges: the middle is taken. */
      tied++;
      threshold = edge - 0.5 * histogram->width * (double)(tied - 1);
    }
  }
  return threshold;
}

/* Number of coarse bins. They are smoothed widely enough to bridge noise and empty levels. */
enum { COARSE = 512 };

/* Whether `bin`, the first or the last that is not empty, holds clipped greys: far more than the
 * occupied bins next to it, but less than half of the `share` of its phase. Such a spike is not a
 * peak. */
static bool is_clipped(const struct grey_histogram *histogram, size_t bin, bool first,
                       double share) {
  const int neighbours = 8;
  double sum = 0.0;
  int n = 0;
  for (size_t i = bin; n<neighbours; n += histogram->counts[i]> 0) {
    if (first ? ++i == histogram->bins : i-- == 0) break;
    sum += (double)histogram->counts[i];
  }
  double count = (double)histogram->counts[bin];
  return n == neighbours && count > 4.0 * sum / n && count < 0.5 * share * (double)histogram->total;
}

static void coarse_histogram(const struct grey_histogram *histogram, double low, double high,
                             double threshold, double *coarse) {
  double raw[COARSE] = {0}, pore = grey_histogram_porosity(histogram, threshold);
  size_t first = 0, last = histogram->bins - 1;
  while (first < last && histogram->counts[first] == 0) first++;
  while (last > first && histogram->counts[last] == 0) last--;
  if (is_clipped(histogram, first, true, pore)) first++;
  if (is_clipped(histogram, last, false, 1.0 - pore)) last--;
  for (size_t i = first; i <= last; i++) {
    double position = (bin_centre(histogram, i) - low) / (high - low) * COARSE;
    if (position >= 0.0 && position < COARSE) raw[(size_t)position] += (double)histogram->counts[i];
  }
  const int half = 6;
  for (int i = 0; i < COARSE; i++) {
    double sum = 0.0, weights = 0.0;
    for (int k = -half; k <= half; k++) {
      if (i + k < 0 || i + k >= COARSE) continue;
      double weight = half + 1 - abs(k);
      sum += weight * raw[i + k];
      weights += weight;
    }
    coarse[i] = sum / weights;
  }
}

static int least_between(const double *coarse, int a, int b) {
  int least = a, step = a < b ? 1 : -1;
  for (int i = a; i != b + step; i += step)
    if (coarse[i] < coarse[least]) least = i;
  return least;
}

/* The highest local maximum in first <= i < end; if there is none, as on the flank of one broad
 * peak, the highest value. */
static int highest_peak(const double *coarse, int first, int end) {
  const int reach = 6;
  int peak = -1, top = first;
  for (int i = first; i < end; i++) {
    bool local = true;
    for (int k = -reach; k <= reach; k++)
      if (i + k >= 0 && i + k < COARSE && coarse[i + k] > coarse[i]) local = false;
    if (local && (peak < 0 || coarse[i] > coarse[peak])) peak = i;
    if (coarse[i] > coarse[top]) top = i;
  }
  return peak >= 0 ? peak : top;
}

/* The floor of a valley: greys at most this many times as frequent as the rarest one. */
#define VALLEY_FLOOR 2.0

void grey_histogram_phases(const struct grey_histogram *histogram, double threshold,
                           struct grey_phases *phases) {
  double coarse[COARSE];
  double low = grey_histogram_quantile(histogram, 0.0005);
  double high = grey_histogram_quantile(histogram, 0.9995);
  *phases = (struct grey_phases){.pore_peak = NAN,
                                 .grain_peak = NAN,
                                 .valley = NAN,
                                 .valley_low = NAN,
                                 .valley_high = NAN,
                                 .noise = NAN,
                                 .contrast_to_noise = NAN,
                                 .valley_depth = 1.0};
  for (size_t i = 0; i < histogram->bins; i++) phases->levels += histogram->counts[i] > 0;
  if (!(high > low)) return;
  coarse_histogram(histogram, low, high, threshold, coarse);
  double position = (threshold - low) / (high - low) * COARSE;
  int split = (int)fmin(fmax(position, 1.0), COARSE - 1.0);
  int pore = highest_peak(coarse, 0, split), grain = highest_peak(coarse, split, COARSE);
  int valley = least_between(coarse, pore, grain);
  double step = (high - low) / COARSE;
  phases->pore_peak = low + (pore + 0.5) * step;
  phases->grain_peak = low + (grain + 0.5) * step;
  phases->valley = low + (valley + 0.5) * step;
  int floor_low = valley, floor_high = valley; /* where there is a valley, the peaks lie above its
                                                  floor */
  while (floor_low > pore && coarse[floor_low - 1] <= VALLEY_FLOOR * coarse[valley]) floor_low--;
  while (floor_high < grain && coarse[floor_high + 1] <= VALLEY_FLOOR * coarse[valley])
    floor_high++;
  phases->valley_low = low + (floor_low + 0.5) * step;
  phases->valley_high = low + (floor_high + 0.5) * step;
  phases->valley_depth = coarse[valley] / fmin(coarse[pore], coarse[grain]);
  /* The outer flank of the pore peak is due to noise alone: 0.3173/2 of a normal distribution lies
   * below mean - sd. If this flank is clipped, the outer flank of the grain peak is used. */
  double outer = grey_histogram_porosity(histogram, phases->pore_peak);
  double flank = grey_histogram_quantile(histogram, outer * 0.3173);
  double above = 1.0 - grey_histogram_porosity(histogram, phases->grain_peak);
  phases->noise = phases->pore_peak - flank;
  if (flank < grey_histogram_quantile(histogram, 0.0) + 1.5 * histogram->width)
    phases->noise = grey_histogram_quantile(histogram, 1.0 - above * 0.3173) - phases->grain_peak;
  if (phases->noise > 0.0)
    phases->contrast_to_noise = (phases->grain_peak - phases->pore_peak) / phases->noise;
}

/* Maps floats to integers in the same order, for a selection by digits. */
static uint32_t key_of(float value) {
  uint32_t bits;
  memcpy(&bits, &value, 4);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

static float value_of(uint32_t key) {
  uint32_t bits = (key & 0x80000000u) != 0 ? key & 0x7fffffffu : ~key;
  float value;
  memcpy(&value, &bits, 4);
  return value;
}

enum { DIGITS = 65536 };

/* Counts the greys by their upper digit or, if `key` is not NULL, those with the upper digit of
 * `key` by their lower digit. */
static void count_digits(const float *volume, const struct mirroring *mirroring,
                         const uint32_t *key, uint64_t *work, uint64_t *counts) {
  const size_t nx = mirroring->size[0], ny = mirroring->size[1];
#pragma omp parallel
  {
    uint64_t *thread_counts = work + (size_t)omp_get_thread_num() * DIGITS;
    memset(thread_counts, 0, DIGITS * sizeof *thread_counts);
#pragma omp for schedule(static)
    for (size_t row = 0; row < ny * mirroring->size[2]; row++) {
      const unsigned often = mirroring_count(mirroring, 1, row % ny) * // NOLINT: there is a row
                             mirroring_count(mirroring, 2, row / ny);  // NOLINT: there is a row
      for (size_t x = 0; x < nx; x++) {
        const uint32_t k = key_of(volume[row * nx + x]);
        const unsigned count = often * mirroring_count(mirroring, 0, x);
        if (key == NULL)
          thread_counts[k >> 16] += count;
        else if (k >> 16 == *key >> 16)
          thread_counts[k & 0xffffu] += count;
      }
    }
#pragma omp critical(grey_digits) /* integer sums do not depend on the order */
    for (size_t d = 0; d < DIGITS; d++) counts[d] += thread_counts[d];
  }
}

enum status volume_threshold(const float *volume, const struct mirroring *mirroring,
                             double porosity, double *threshold) {
  enum status status = STATUS_OK;
  const size_t *n = mirroring->size;
  uint64_t *counts = NULL, total = 1, below = 0, digit = 0;
  uint64_t *work = NULL;
  TRY(memory_allocate(&counts, 2 * DIGITS, sizeof *counts, "grey counts"));
  TRY(memory_allocate(&work, (size_t)omp_get_max_threads() * DIGITS, sizeof *work, "grey counts"));
  for (int d = 0; d < 3; d++) total *= mirroring->mirrored[d] ? 2 * n[d] - 1 : n[d];
  double target = porosity * (double)total;
  uint32_t key = 0;
  for (int pass = 0; pass < 2; pass++) {
    uint64_t *count = counts + pass * DIGITS;
    count_digits(volume, mirroring, pass == 0 ? NULL : &key, work, count);
    for (digit = 0; digit + 1 < DIGITS && (double)(below + count[digit]) < target; digit++)
      below += count[digit];
    key |= (uint32_t)digit << (pass == 0 ? 16 : 0);
  }
  /* The grey at the target, the volume that has exactly this grey, and the adjacent greys. */
  float grey = value_of(key), lower = -INFINITY, upper = INFINITY;
  double equal = (double)counts[DIGITS + digit];
#pragma omp parallel for schedule(static) reduction(max : lower) reduction(min : upper)
  for (size_t i = 0; i < n[0] * n[1] * n[2]; i++) {
    if (volume[i] < grey && volume[i] > lower) lower = volume[i];
    if (volume[i] > grey && volume[i] < upper) upper = volume[i];
  }
  double low = isfinite(lower) ? 0.5 * ((double)grey + (double)lower) : (double)grey - 0.5;
  double high = isfinite(upper) ? 0.5 * ((double)grey + (double)upper) : (double)grey + 0.5;
  double share = equal > 0.0 ? (target - (double)below) / equal : 0.5;
  /* Below one half, keeping this grey solid gives the nearer count, so that the threshold stays
   * below it. */
  *threshold = share < 0.5 ? low + 2.0 * share * ((double)grey - low)
                           : (double)grey + (2.0 * share - 1.0) * (high - (double)grey);
  if (share < 0.5 && *threshold >= (double)grey) *threshold = nextafter((double)grey, -INFINITY);
cleanup:
  MEMORY_FREE(&counts, &work);
  return status;
}
