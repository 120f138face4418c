#include "ct2model/scan/grey_soil.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/grey_peaks.h"
#include "ct2model/scan/settle.h"

#define BINS 512   /* over seven times the range of soil */
#define ROUNDS 12  /* of moving the bounds */
#define CLOSE 1e-3 /* of the voids: near enough */
#define PEAK 3     /* bins on each side that a peak is the mean of */
#define LEVELS 253 /* of soil between the bounds, from 1 to 254 */
#define STEP 0.05  /* of the range of soil: by which the bounds move to see what it does */

/* What greys are, in the region's own, where grain is bright. Peaks that a table does without are
 * NAN. */
struct bounds {
  double low, high, pore, grain;
  struct porosity_table table;
};

/* Porosities from 1/255 to 254/255: what is less or more is grain or pore. */
static double porosity_of(const struct bounds *b, double grey) {
  const struct porosity_table *t = &b->table;
  double porosity = t->porosity[0];
  for (int i = 1; i < t->count && grey > t->grey[i - 1]; i++) {
    const double part = fmin(1.0, (grey - t->grey[i - 1]) / (t->grey[i] - t->grey[i - 1]));
    porosity = t->porosity[i - 1] + part * (t->porosity[i] - t->porosity[i - 1]);
  }
  return fmin(fmax(porosity, 1.0 / 255.0), 254.0 / 255.0);
}

/* Where an edge between pore and grain is one or the other. */
static double middle_of(const struct bounds *b) {
  const double pore = isfinite(b->pore) ? b->pore : b->low;
  return 0.5 * (pore + (isfinite(b->grain) ? b->grain : b->high));
}

static double ratio_of(double porosity) {
  return porosity / (1.0 - porosity);
}

/* Bounds and middle move; porosities of greys stay. */
static void move(struct bounds *b, double step) {
  b->low += step, b->high += step;
  b->pore += step, b->grain += step;
}

static enum status count_greys(const struct region *region, struct grey_histogram *histogram) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1];
  float *slice = NULL;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t z = 0; z < region->size[2]; z++) {
    TRY(region_read(region, &z, 1, slice));
    grey_histogram_add(histogram, slice, plane);
  }
cleanup:
  memory_free(&slice);
  return status;
}

/* The most frequent grey from bin `first` to `end`; NAN: none occurs. */
static double find_peak(const struct grey_histogram *h, size_t first, size_t end) {
  double most = 0.0, peak = NAN;
  for (size_t i = first + PEAK; i + PEAK < end; i++) {
    double count = 0.0, sum = 0.0;
    for (size_t j = i - PEAK; j <= i + PEAK; j++) {
      count += (double)h->counts[j];
      sum += (double)h->counts[j] * (h->low + h->width * ((double)j + 0.5));
    }
    if (count > most) most = count, peak = sum / count;
  }
  return peak;
}

/* The peaks below and above, and porosity between them where no table says it. */
static enum status find_peaks(const struct region *region, const struct grey_histogram *histogram,
                              struct bounds *b) {
  const double bins_low = (b->low - histogram->low) / histogram->width;
  const double bins_high = (b->high - histogram->low) / histogram->width;
  b->pore = find_peak(histogram, 0, (size_t)bins_low);
  b->grain = find_peak(histogram, (size_t)bins_high, BINS);
  if (b->table.count > 0) return STATUS_OK;
  b->table = (struct porosity_table){2, {b->pore, b->grain}, {1.0, 0.0}};
  if (isfinite(b->pore) && isfinite(b->grain)) return STATUS_OK;
  return FAIL(
      STATUS_INPUT, "%s: --micro: no grey near it is %s, from which porosity would be measured",
      region->stack->files[0].path, isfinite(b->pore) ? "above, as grain" : "below, as pore");
}

static double grey_of_level(const struct bounds *b, int level) {
  return b->low + (b->high - b->low) * (double)(level - 1) / LEVELS;
}

static enum status classify(const struct region *region, const struct bounds *b,
                            struct micro *micro, double *noisy) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1];
  const double levels = LEVELS / (b->high - b->low);
  float *slice = NULL;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t z = 0; z < region->size[2]; z++) {
    TRY(region_read(region, &z, 1, slice));
    for (size_t p = 0; p < plane; p++) {
      const double grey = (double)slice[p];
      micro->kind[z * plane + p] = grey < b->low ? MICRO_PORE
                                   : grey > b->high
                                       ? MICRO_GRAIN
                                       : (uint8_t)(1 + lround((grey - b->low) * levels));
    }
  }
  TRY(settle(micro, 1.0 + (middle_of(b) - b->low) * levels, noisy));
cleanup:
  memory_free(&slice);
  return status;
}

/* The shares of the voxels, and porosity and permeability of each level that occurs. */
static enum status sum_up(const struct region *region, const struct micro_rules *rules,
                          const struct bounds *b, struct labels *labels, uint8_t *grain) {
  struct micro *micro = &labels->micro;
  const size_t count = micro->size[0] * micro->size[1] * micro->size[2];
  size_t seen[MICRO_KINDS] = {0}, soils = 0;
  for (size_t i = 0; i < count; i++) {
    seen[micro->kind[i]]++;
    grain[i] = micro->kind[i] == MICRO_GRAIN;
  }
  labels->voids = (double)seen[MICRO_PORE];
  for (int level = 1; level < MICRO_GRAIN; level++) {
    struct soil *soil = &micro->soil[level];
    *soil = (struct soil){0};
    if (seen[level] == 0) continue;
    soil->porosity = porosity_of(b, grey_of_level(b, level));
    soil->permeability = rules->grain_size > 0.0
                             ? soil_kozeny_carman(soil->porosity, rules->grain_size)
                             : rules->permeability;
    soils += seen[level];
    labels->voids += soil->porosity * (double)seen[level];
  }
  labels->voids /= (double)count;
  labels->porosity = 1.0 - (double)seen[MICRO_GRAIN] / (double)count;
  if (soils > 0) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: --micro: no voxel has a grey of soil, but at edges between pore and grain; "
              "leave it out, or look at the histogram (ct2model sweep)",
              region->stack->files[0].path);
}

/* What the peaks' errors do to porosity n = (grain - soil) / (grain - pore), and that to Kozeny and
 * Carman's n^3 / (1 - n)^2. */
static void add_peaks(const struct grey_peaks *p, const struct micro_rules *rules, double sign,
                      struct grey_soil *greys) {
  const double *u = p->error, contrast = p->grey[PEAK_GRAIN] - p->grey[PEAK_PORE];
  const double n = (p->grey[PEAK_GRAIN] - p->grey[PEAK_SOIL]) / contrast;
  const double above = 0.5 * hypot(u[PEAK_SOIL], u[PEAK_GRAIN]);
  const double below = 0.5 * hypot(u[PEAK_PORE], u[PEAK_SOIL]);
  greys->soil_peak = sign * p->grey[PEAK_SOIL];
  greys->pore_error = u[PEAK_PORE], greys->soil_error = u[PEAK_SOIL];
  greys->grain_error = u[PEAK_GRAIN];
  greys->low_error = sign < 0.0 ? above : below;
  greys->high_error = sign < 0.0 ? below : above;
  greys->porosity_error =
      hypot(u[PEAK_SOIL], hypot((1.0 - n) * u[PEAK_GRAIN], n * u[PEAK_PORE])) / contrast;
  if (rules->grain_size > 0.0)
    greys->permeability_error = (3.0 / n + 2.0 / (1.0 - n)) * greys->porosity_error;
}

/* Labels by the bounds moved by `shift`. */
static enum status take_moved(const struct region *region, const struct micro_rules *rules,
                              const struct bounds *b, double shift, struct labels *labels,
                              uint8_t *grain) {
  struct bounds moved = *b;
  move(&moved, shift);
  const enum status status = classify(region, &moved, &labels->micro, &labels->noisy);
  return status == STATUS_OK ? sum_up(region, rules, &moved, labels, grain) : status;
}

/* The shift with the wanted voids, by false position between none and the farthest, a peak
 * (Dowell, Jarratt 1971: the end that stays counts half). */
static enum status find_shift(const struct region *region, const struct micro_rules *rules,
                              const struct bounds *b, double wanted, struct labels *labels,
                              uint8_t *grain, double *shift) {
  enum status status = STATUS_OK;
  const double half = 0.5 * (b->high - b->low), e = ratio_of(wanted);
  *shift = 0.0;
  TRY(take_moved(region, rules, b, 0.0, labels, grain));
  const double own = labels->voids;
  if (fabs(own / wanted - 1.0) < CLOSE) return STATUS_OK;
  const bool up = own < wanted;
  const double end = up                  ? isfinite(b->grain) ? b->grain - b->high : half
                     : isfinite(b->pore) ? b->pore - b->low
                                         : -half;
  double near = 0.0, far = end, at_near = own - wanted, at_far;
  TRY(take_moved(region, rules, b, far, labels, grain));
  at_far = labels->voids - wanted;
  if (up ? at_far < 0.0 : at_far > 0.0)
    TRY_FAIL(
        STATUS_INPUT,
        "%s: --micro: its greys give a void ratio of %.4g, and %.4g when they are moved to the "
        "peak of %s, not the measured %.4g",
        region->stack->files[0].path, ratio_of(own), ratio_of(labels->voids), up ? "grain" : "pore",
        e);
  for (int round = 0; round < ROUNDS; round++) {
    *shift = near - at_near * (far - near) / (at_far - at_near);
    TRY(take_moved(region, rules, b, *shift, labels, grain));
    const double now = labels->voids - wanted;
    if (fabs(now / wanted) < CLOSE) break;
    if ((now > 0.0) == (at_far > 0.0)) {
      far = *shift, at_far = now, at_near *= 0.5;
    } else {
      near = far, at_near = at_far, far = *shift, at_far = now;
    }
  }
cleanup:
  return status;
}

/* How void ratios answer to the bounds, and what that leaves unsure; `labels` and `grain` are of
 * other bounds afterwards. */
static enum status add_thresholds(const struct region *region, const struct micro_rules *rules,
                                  const struct bounds *b, double measured_error,
                                  struct labels *labels, uint8_t *grain, struct grey_soil *greys) {
  enum status status = STATUS_OK;
  const bool measured = measured_error > 0.0;
  const double step =
      measured ? STEP * (b->high - b->low) : sqrt(0.5) * hypot(greys->low_error, greys->high_error);
  const double voids = labels->voids, open = labels->porosity;
  TRY(take_moved(region, rules, b, step, labels, grain));
  const double slope = (ratio_of(labels->voids) - ratio_of(voids)) / step;
  greys->threshold_slope = step / (ratio_of(labels->porosity) - ratio_of(open));
  greys->threshold_error = measured ? measured_error / slope : step;
  if (!measured)
    greys->void_ratio_error =
        hypot(slope * step, greys->porosity_error * (open - voids) / pow(1.0 - voids, 2));
cleanup:
  return status;
}

static enum status choose_bounds(const struct region *region, const struct micro_rules *rules,
                                 double sign, struct bounds *b, struct grey_soil *greys) {
  enum status status = STATUS_OK;
  struct grey_peaks peaks;
  if (rules->automatic) {
    TRY(grey_peaks_find(region, &peaks));
    b->pore = peaks.grey[PEAK_PORE], b->grain = peaks.grey[PEAK_GRAIN];
    b->low = 0.5 * (b->pore + peaks.grey[PEAK_SOIL]);
    b->high = 0.5 * (peaks.grey[PEAK_SOIL] + b->grain);
    b->table = (struct porosity_table){2, {b->pore, b->grain}, {1.0, 0.0}};
    add_peaks(&peaks, rules, sign, greys);
    return STATUS_OK;
  }
  b->low = sign < 0.0 ? -rules->high : rules->low;
  b->high = sign < 0.0 ? -rules->low : rules->high;
  const int count = b->table.count = rules->table.count;
  for (int i = 0; i < count; i++) {
    const int from = sign < 0.0 ? count - 1 - i : i;
    b->table.grey[i] = sign * rules->table.grey[from];
    b->table.porosity[i] = rules->table.porosity[from];
  }
cleanup:
  return status;
}

enum status micro_take(struct region *region, const struct micro_rules *rules, double void_ratio,
                       double void_ratio_error, const bool reflect[3], struct labels *labels,
                       struct grey_soil *greys) {
  enum status status = STATUS_OK;
  const double sign = region->scale < 0.0 ? -1.0 : 1.0;
  const size_t count = region->size[0] * region->size[1] * region->size[2];
  struct bounds b = {0};
  struct grey_histogram histogram = {0};
  double shift = 0.0;
  uint8_t *grain = NULL;
  *labels = (struct labels){.on = true};
  *greys = (struct grey_soil){.soil_peak = NAN,
                              .low_error = NAN,
                              .high_error = NAN,
                              .pore_error = NAN,
                              .soil_error = NAN,
                              .grain_error = NAN,
                              .porosity_error = NAN,
                              .permeability_error = NAN,
                              .threshold_error = NAN,
                              .threshold_slope = NAN,
                              .void_ratio_error = NAN};
  memcpy(labels->micro.size, region->size, sizeof region->size);
  TRY(choose_bounds(region, rules, sign, &b, greys));
  const double range = b.high - b.low;
  TRY(grey_histogram_start(b.low - 3.0 * range, 7.0 * range / BINS, BINS, &histogram));
  TRY(count_greys(region, &histogram));
  if (!rules->automatic) TRY(find_peaks(region, &histogram, &b));
  TRY(memory_allocate(&labels->micro.kind, count, 1, "the labels"));
  TRY(memory_allocate(&grain, count, 1, "the labels"));
  if (isnan(void_ratio))
    TRY(take_moved(region, rules, &b, 0.0, labels, grain));
  else
    TRY(find_shift(region, rules, &b, void_ratio / (1.0 + void_ratio), labels, grain, &shift));
  const double pore_peak = b.pore, grain_peak = b.grain;
  move(&b, shift);
  if (isnan(void_ratio) ? rules->automatic : void_ratio_error > 0.0) {
    TRY(add_thresholds(region, rules, &b, void_ratio_error, labels, grain, greys));
    TRY(take_moved(region, rules, &b, 0.0, labels, grain));
  }
  TRY(labels_smooth(region, grain, reflect, labels));
  greys->low = sign < 0.0 ? -b.high : b.low;
  greys->high = sign < 0.0 ? -b.low : b.high;
  greys->shift = sign * shift;
  greys->pore_peak = sign * pore_peak, greys->grain_peak = sign * grain_peak;
  greys->threshold_slope *= sign;
cleanup:
  grey_histogram_end(&histogram);
  memory_free(&grain);
  if (status != STATUS_OK) labels_end(labels);
  return status;
}
