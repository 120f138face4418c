#include "ct2model/scan/grey_soil.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scan/grey_peaks.h"
#include "ct2model/scan/micro.h"

/* Decides which of the voxels with greys of soil are soil: edges between pore and grain have these
 * greys too, and noise gives them to others. */

/* micro->kind is MICRO_PORE, MICRO_GRAIN or, between them, a level that rises with the grey. First
 * noise is removed: a voxel whose phase at most SETTLE_SPECK of the 3x3x3 voxels around it share
 * takes the phase of the majority, but edges are kept; soil takes the mean level of these voxels.
 * Then edges: a level with more than SETTLE_SHARE of both pore and grain within SETTLE_RIM voxels
 * becomes pore below the level `middle`, else grain. Then noise is removed once more
 * (docs/physics/restoration.md says on what they were set). *noisy: the fraction of voxels that
 * were noise in the first round. */
#define SETTLE_SPECK 0.3 /* 8 of 27 */
#define SETTLE_RIM 2
#define SETTLE_SHARE 0.1

enum { PORE, SOIL, GRAIN };

static int phase_of(uint8_t kind) {
  return kind == MICRO_PORE ? PORE : kind == MICRO_GRAIN ? GRAIN : SOIL;
}

/* Number of voxels of each phase within `rim` voxels, and sum of the levels of soil among them. */
struct phase_counts {
  int count[3], levels;
};

static struct phase_counts count_phases(const struct micro *m, const size_t at[3], size_t rim) {
  struct phase_counts phase_counts = {{0}, 0};
  size_t first[3], end[3];
  for (int d = 0; d < 3; d++) {
    first[d] = at[d] > rim ? at[d] - rim : 0;
    end[d] = at[d] + rim < m->size[d] ? at[d] + rim + 1 : m->size[d];
  }
  for (size_t z = first[2]; z < end[2]; z++)
    for (size_t y = first[1]; y < end[1]; y++) {
      const uint8_t *row = m->kind + (z * m->size[1] + y) * m->size[0];
      for (size_t x = first[0]; x < end[0]; x++) {
        const int phase = phase_of(row[x]);
        phase_counts.count[phase]++;
        phase_counts.levels += phase == SOIL ? row[x] : 0;
      }
    }
  return phase_counts;
}

static uint8_t without_edge(const struct micro *m, const size_t at[3], uint8_t kind,
                            double middle) {
  if (phase_of(kind) != SOIL) return kind;
  const struct phase_counts c = count_phases(m, at, SETTLE_RIM);
  const double least = SETTLE_SHARE * (c.count[PORE] + c.count[SOIL] + c.count[GRAIN]);
  if (c.count[PORE] <= least || c.count[GRAIN] <= least) return kind;
  return kind < middle ? MICRO_PORE : MICRO_GRAIN;
}

/* Whether all six neighbours have the same phase as the voxel. */
static bool is_inside(const struct micro *m, const size_t at[3], const uint8_t *kind) {
  const size_t step[3] = {1, m->size[0], m->size[0] * m->size[1]};
  const int phase = phase_of(*kind);
  for (int d = 0; d < 3; d++) {
    if (at[d] > 0 && phase_of(kind[-(ptrdiff_t)step[d]]) != phase) return false;
    if (at[d] + 1 < m->size[d] && phase_of(kind[step[d]]) != phase) return false;
  }
  return true;
}

/* The phase of a voxel without noise. A level at an edge is not noise: its grey decides, in
 * without_edge. */
static uint8_t without_noise(const struct micro *m, const size_t at[3], uint8_t kind) {
  const struct phase_counts c = count_phases(m, at, 1);
  const int all = c.count[PORE] + c.count[SOIL] + c.count[GRAIN];
  int phase = phase_of(kind);
  const bool edge =
      phase == SOIL && c.count[PORE] > SETTLE_SHARE * all && c.count[GRAIN] > SETTLE_SHARE * all;
  if (c.count[phase] <= SETTLE_SPECK * all && !edge)
    for (int p = 0; p < 3; p++)
      if (c.count[p] > c.count[phase]) phase = p;
  if (phase != SOIL) return phase == PORE ? MICRO_PORE : MICRO_GRAIN;
  return (uint8_t)((c.levels + c.count[SOIL] / 2) / c.count[SOIL]);
}

/* One round over all voxels, which removes edges or noise. Returns the number of voxels whose phase
 * changed. */
static size_t settle_round(const struct micro *m, bool edges, double middle, uint8_t *settled) {
  const size_t nx = m->size[0], ny = m->size[1], nz = m->size[2];
  size_t changed = 0;
#pragma omp parallel for schedule(static) reduction(+ : changed)
  for (size_t row = 0; row < ny * nz; row++)
    for (size_t x = 0; x < nx; x++) {
      const size_t at[3] = {x, row % ny, row / ny}; // NOLINT: has rows
      const uint8_t *kind = m->kind + row * nx + x;
      const bool inside = phase_of(*kind) != SOIL && is_inside(m, at, kind);
      uint8_t *to = settled + row * nx + x;
      *to = edges    ? without_edge(m, at, *kind, middle)
            : inside ? *kind
                     : without_noise(m, at, *kind);
      changed += phase_of(*to) != phase_of(*kind);
    }
  return changed;
}

static enum status settle(struct micro *m, double middle, double *noisy) {
  enum status status = STATUS_OK;
  const size_t count = m->size[0] * m->size[1] * m->size[2];
  uint8_t *settled = NULL;
  TRY(memory_allocate(&settled, count, 1, "the labels"));
  for (int round = 0; round < 3; round++) {
    uint8_t *before = m->kind;
    const size_t changed = settle_round(m, round == 1, middle, settled);
    if (round == 0) *noisy = (double)changed / (double)count;
    m->kind = settled;
    settled = before;
  }
cleanup:
  memory_free(&settled);
  return status;
}

/* Bins of the histogram, over seven times the range of soil. */
#define BINS 512
/* Largest number of trial shifts of the bounds. */
#define SHIFTS_MOST 12
/* Relative tolerance of the void fraction. */
#define VOIDS_TOLERANCE 1e-3
/* Bins on each side that are averaged at a peak. */
#define PEAK_HALF_WIDTH 3
/* Levels of soil between the bounds, from 1 to 254. */
#define LEVELS 253
/* Shift of the bounds from which slopes are measured, over the range of soil. */
#define SLOPE_STEP 0.05

/* Bounds of soil, and peaks, in greys of the region, where grain is bright. Peaks that are not
 * needed because of a table may be NAN. */
struct bounds {
  double low, high, pore, grain;
  struct porosity_table table;
};

/* Porosity of a grey, limited to 1/255 to 254/255, since less or more is grain or pore. */
static double porosity_of(const struct bounds *b, double grey) {
  const struct porosity_table *t = &b->table;
  double porosity = t->porosity[0];
  for (int i = 1; i < t->count && grey > t->grey[i - 1]; i++) {
    const double part = fmin(1.0, (grey - t->grey[i - 1]) / (t->grey[i] - t->grey[i - 1]));
    porosity = t->porosity[i - 1] + part * (t->porosity[i] - t->porosity[i - 1]);
  }
  return fmin(fmax(porosity, 1.0 / 255.0), 254.0 / 255.0);
}

/* Grey at which an edge between pore and grain changes from one to the other. */
static double middle_of(const struct bounds *b) {
  const double pore = isfinite(b->pore) ? b->pore : b->low;
  return 0.5 * (pore + (isfinite(b->grain) ? b->grain : b->high));
}

static double ratio_of(double porosity) {
  return porosity / (1.0 - porosity);
}

/* Shifts the bounds and the middle; the table of porosities is not shifted. */
static void shift_bounds(struct bounds *b, double step) {
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

/* Most frequent grey from bin `first` to `end`; NAN if none occurs. */
static double find_peak(const struct grey_histogram *h, size_t first, size_t end) {
  double most = 0.0, peak = NAN;
  for (size_t i = first + PEAK_HALF_WIDTH; i + PEAK_HALF_WIDTH < end; i++) {
    double count = 0.0, sum = 0.0;
    for (size_t j = i - PEAK_HALF_WIDTH; j <= i + PEAK_HALF_WIDTH; j++) {
      count += (double)h->counts[j];
      sum += (double)h->counts[j] * (h->low + h->width * ((double)j + 0.5));
    }
    if (count > most) most = count, peak = sum / count;
  }
  return peak;
}

/* Finds the peaks below and above the bounds, and makes porosity linear between them if there is no
 * table. */
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

/* Sums up the fractions of voxels, and sets porosity and permeability of each level that occurs. */
static enum status summarize(const struct region *region, const struct micro_rules *rules,
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

/* Propagates the uncertainties of the peaks to the porosity n = (grain - soil) / (grain - pore),
 * and from there to n^3 / (1 - n)^2 of Kozeny and Carman. */
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

/* Classifies the region with the bounds shifted by `shift`. */
static enum status apply_shift(const struct region *region, const struct micro_rules *rules,
                               const struct bounds *b, double shift, struct labels *labels,
                               uint8_t *grain) {
  struct bounds moved = *b;
  shift_bounds(&moved, shift);
  const enum status status = classify(region, &moved, &labels->micro, &labels->noisy);
  return status == STATUS_OK ? summarize(region, rules, &moved, labels, grain) : status;
}

/* Finds the shift with the wanted void fraction, by false position between 0 and the farthest
 * shift, which moves a bound to a peak (Dowell, Jarratt 1971: the value at the end that stays is
 * halved). */
static enum status find_shift(const struct region *region, const struct micro_rules *rules,
                              const struct bounds *b, double wanted, struct labels *labels,
                              uint8_t *grain, double *shift) {
  enum status status = STATUS_OK;
  const double half = 0.5 * (b->high - b->low), e = ratio_of(wanted);
  *shift = 0.0;
  TRY(apply_shift(region, rules, b, 0.0, labels, grain));
  const double unshifted = labels->voids;
  if (fabs(unshifted / wanted - 1.0) < VOIDS_TOLERANCE) return STATUS_OK;
  const bool up = unshifted < wanted;
  const double end = up                  ? isfinite(b->grain) ? b->grain - b->high : half
                     : isfinite(b->pore) ? b->pore - b->low
                                         : -half;
  double near = 0.0, far = end, at_near = unshifted - wanted, at_far;
  TRY(apply_shift(region, rules, b, far, labels, grain));
  at_far = labels->voids - wanted;
  if (up ? at_far < 0.0 : at_far > 0.0)
    TRY_FAIL(
        STATUS_INPUT,
        "%s: --micro: its greys give a void ratio of %.4g, and %.4g when they are moved to the "
        "peak of %s, not the measured %.4g",
        region->stack->files[0].path, ratio_of(unshifted), ratio_of(labels->voids),
        up ? "grain" : "pore", e);
  for (int round = 0; round < SHIFTS_MOST; round++) {
    *shift = near - at_near * (far - near) / (at_far - at_near);
    TRY(apply_shift(region, rules, b, *shift, labels, grain));
    const double excess = labels->voids - wanted;
    if (fabs(excess / wanted) < VOIDS_TOLERANCE) break;
    if ((excess > 0.0) == (at_far > 0.0)) {
      far = *shift, at_far = excess, at_near *= 0.5;
    } else {
      near = far, at_near = at_far, far = *shift, at_far = excess;
    }
  }
cleanup:
  return status;
}

/* Measures how the void ratios depend on the bounds, and the resulting uncertainties. `labels` and
 * `grain` are those of other bounds afterwards. */
static enum status add_thresholds(const struct region *region, const struct micro_rules *rules,
                                  const struct bounds *b, double measured_error,
                                  struct labels *labels, uint8_t *grain, struct grey_soil *greys) {
  enum status status = STATUS_OK;
  const bool measured = measured_error > 0.0;
  const double step = measured ? SLOPE_STEP * (b->high - b->low)
                               : sqrt(0.5) * hypot(greys->low_error, greys->high_error);
  const double voids = labels->voids, open = labels->porosity;
  TRY(apply_shift(region, rules, b, step, labels, grain));
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
    TRY(apply_shift(region, rules, &b, 0.0, labels, grain));
  else
    TRY(find_shift(region, rules, &b, void_ratio / (1.0 + void_ratio), labels, grain, &shift));
  const double pore_peak = b.pore, grain_peak = b.grain;
  shift_bounds(&b, shift);
  if (isnan(void_ratio) ? rules->automatic : void_ratio_error > 0.0) {
    TRY(add_thresholds(region, rules, &b, void_ratio_error, labels, grain, greys));
    TRY(apply_shift(region, rules, &b, 0.0, labels, grain));
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
