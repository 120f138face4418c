#include "ct2model/scan/grey_soil.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"

#define BINS 512               /* over seven times the range of soil */
#define ROUNDS 8               /* of moving the bounds */
#define PEAK 3                 /* bins on each side that a peak is the mean of */
#define ROWS (MICRO_GRAIN - 1) /* of porosities, 1/255 apart */

enum status micro_rules_parse(const char *text, struct micro_rules *rules) {
  const char *dots = strstr(text, "..");
  char low[40], *end;
  rules->given = true;
  if (dots != NULL && (size_t)(dots - text) < sizeof low) {
    snprintf(low, sizeof low, "%.*s", (int)(dots - text), text);
    rules->low = strtod(low, &end);
    const bool first = end != low && *end == '\0' && isfinite(rules->low);
    rules->high = strtod(dots + 2, &end);
    if (first && end != dots + 2 && *end == '\0' && isfinite(rules->high) &&
        rules->low < rules->high)
      return STATUS_OK;
  }
  return FAIL(
      STATUS_USAGE,
      "--micro %s: the greys of soil are wanted, the lower first, as 80..170: below is pore, "
      "above is grain (turned round with --grain dark)",
      text);
}

/* Bounds in the region's own greys, where grain is bright. */
struct bounds {
  double low, high, pore, grain; /* the last two: peaks */
};

static double porosity_of(const struct bounds *b, double grey) {
  return fmin(fmax((b->grain - grey) / (b->grain - b->pore), 1.0 / 255.0), 254.0 / 255.0);
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

/* Void share of all greys with the bounds moved by `shift`. */
static double voids_of(const struct grey_histogram *histogram, const struct bounds *b,
                       double shift) {
  double sum = 0.0;
  for (size_t i = 0; i < histogram->bins; i++) {
    const double grey = histogram->low + histogram->width * ((double)i + 0.5);
    const double share = grey < b->low + shift    ? 1.0
                         : grey > b->high + shift ? 0.0
                                                  : porosity_of(b, grey);
    sum += share * (double)histogram->counts[i];
  }
  return sum / (double)histogram->total;
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

static enum status find_peaks(const struct region *region, const struct grey_histogram *histogram,
                              struct bounds *b) {
  const double bins_low = (b->low - histogram->low) / histogram->width;
  const double bins_high = (b->high - histogram->low) / histogram->width;
  b->pore = find_peak(histogram, 0, (size_t)bins_low);
  b->grain = find_peak(histogram, (size_t)bins_high, BINS);
  if (isfinite(b->pore) && isfinite(b->grain)) return STATUS_OK;
  return FAIL(
      STATUS_INPUT, "%s: --micro: no grey near it is %s, from which porosity would be measured",
      region->stack->files[0].path, isfinite(b->pore) ? "above, as grain" : "below, as pore");
}

/* The shift at which the voids are those of the void ratio. */
static enum status find_shift(const struct region *region, const struct grey_histogram *histogram,
                              const struct bounds *b, double wanted, double *shift) {
  double low = b->pore - b->low, high = b->grain - b->high; /* no farther than to the peaks */
  *shift = 0.0;
  const double least = voids_of(histogram, b, low), most = voids_of(histogram, b, high);
  if (!(least < wanted && most > wanted))
    return FAIL(
        STATUS_INPUT,
        "%s: --micro: its greys give void ratios from %.4g to %.4g when they are moved from "
        "peak to peak (%.4g as they stand), not the measured %.4g",
        region->stack->files[0].path, least / (1.0 - least), most / (1.0 - most),
        1.0 / (1.0 / voids_of(histogram, b, 0.0) - 1.0), wanted / (1.0 - wanted));
  for (int i = 0; i < 60; i++) {
    *shift = 0.5 * (low + high);
    if (voids_of(histogram, b, *shift) < wanted)
      low = *shift;
    else
      high = *shift;
  }
  return STATUS_OK;
}

static enum status classify(const struct region *region, const struct bounds *b,
                            struct micro *micro) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1];
  float *slice = NULL;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t z = 0; z < region->size[2]; z++) {
    TRY(region_read(region, &z, 1, slice));
    for (size_t p = 0; p < plane; p++) {
      const double grey = (double)slice[p];
      micro->kind[z * plane + p] = grey < b->low    ? MICRO_PORE
                                   : grey > b->high ? MICRO_GRAIN
                                                    : (uint8_t)lround(255.0 * porosity_of(b, grey));
    }
  }
cleanup:
  memory_free(&slice);
  return status;
}

/* What a voxel between the bounds is: an edge of pore and grain goes to one of them. */
static uint8_t settle(const struct micro *m, size_t x, size_t y, size_t z) {
  const size_t at[3] = {x, y, z};
  const uint8_t own = m->kind[(z * m->size[1] + y) * m->size[0] + x];
  size_t first[3], end[3];
  bool pore = false, grain = false;
  if (own == MICRO_PORE || own == MICRO_GRAIN) return own;
  for (int d = 0; d < 3; d++) {
    first[d] = at[d] > MICRO_RIM ? at[d] - MICRO_RIM : 0;
    end[d] = at[d] + MICRO_RIM < m->size[d] ? at[d] + MICRO_RIM + 1 : m->size[d];
  }
  for (size_t k = first[2]; k < end[2] && !(pore && grain); k++)
    for (size_t j = first[1]; j < end[1]; j++)
      for (size_t i = first[0]; i < end[0]; i++) {
        const uint8_t kind = m->kind[(k * m->size[1] + j) * m->size[0] + i];
        pore = pore || kind == MICRO_PORE;
        grain = grain || kind == MICRO_GRAIN;
      }
  if (!(pore && grain)) return own;
  return own > 127 ? MICRO_PORE : MICRO_GRAIN;
}

static enum status settle_edges(struct micro *micro) {
  enum status status = STATUS_OK;
  const size_t nx = micro->size[0], ny = micro->size[1], nz = micro->size[2];
  uint8_t *settled = NULL;
  TRY(memory_allocate(&settled, nx * ny * nz, 1, "the labels"));
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < ny * nz; row++)
    for (size_t x = 0; x < nx; x++)
      settled[row * nx + x] = settle(micro, x, row % ny, row / ny); // NOLINT: has rows
  memory_free(&micro->kind);
  micro->kind = settled;
cleanup:
  return status;
}

/* The shares of the voxels, and the permeability of each porosity that occurs. */
static enum status sum_up(const struct region *region, const struct micro_rules *rules,
                          struct labels *labels, uint8_t *grain) {
  struct micro *micro = &labels->micro;
  const size_t count = micro->size[0] * micro->size[1] * micro->size[2];
  size_t seen[MICRO_KINDS] = {0}, soils = 0;
  for (size_t i = 0; i < count; i++) {
    seen[micro->kind[i]]++;
    grain[i] = micro->kind[i] == MICRO_GRAIN;
  }
  labels->voids = (double)seen[MICRO_PORE];
  for (int r = 1; r <= ROWS; r++) {
    const double porosity = r / 255.0;
    if (seen[r] == 0) continue;
    soils += seen[r];
    labels->voids += porosity * (double)seen[r];
    micro->soil[r].porosity = porosity;
    micro->soil[r].permeability = rules->grain_size > 0.0
                                      ? soil_kozeny_carman(porosity, rules->grain_size)
                                      : rules->permeability;
  }
  labels->voids /= (double)count;
  labels->porosity = 1.0 - (double)seen[MICRO_GRAIN] / (double)count;
  if (soils > 0) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: --micro: no voxel has a grey of soil, but at edges between pore and grain; "
              "leave it out, or look at the histogram (ct2model sweep)",
              region->stack->files[0].path);
}

enum status micro_take(struct region *region, const struct micro_rules *rules, double void_ratio,
                       const bool reflect[3], struct labels *labels, struct grey_soil *greys) {
  enum status status = STATUS_OK;
  const double sign = region->scale < 0.0 ? -1.0 : 1.0, range = rules->high - rules->low;
  const size_t count = region->size[0] * region->size[1] * region->size[2];
  struct bounds b = {.low = sign < 0.0 ? -rules->high : rules->low,
                     .high = sign < 0.0 ? -rules->low : rules->high};
  struct grey_histogram histogram = {0};
  double shift = 0.0;
  uint8_t *grain = NULL;
  *labels = (struct labels){.on = true};
  memcpy(labels->micro.size, region->size, sizeof region->size);
  TRY(grey_histogram_start(b.low - 3.0 * range, 7.0 * range / BINS, BINS, &histogram));
  TRY(count_greys(region, &histogram));
  TRY(find_peaks(region, &histogram, &b));
  TRY(memory_allocate(&labels->micro.kind, count, 1, "the labels"));
  TRY(memory_allocate(&grain, count, 1, "the labels"));
  const double wanted = void_ratio / (1.0 + void_ratio);
  double beside = 0.0; /* voids that the histogram counts too many, at edges */
  for (int round = 0; round < ROUNDS; round++) {
    struct bounds moved = b;
    if (!isnan(void_ratio)) TRY(find_shift(region, &histogram, &b, wanted + beside, &shift));
    moved.low += shift;
    moved.high += shift;
    TRY(classify(region, &moved, &labels->micro));
    TRY(settle_edges(&labels->micro));
    TRY(sum_up(region, rules, labels, grain));
    beside += wanted - labels->voids;
    if (isnan(void_ratio) || fabs(labels->voids / wanted - 1.0) < 1e-3) break;
  }
  b.low += shift;
  b.high += shift;
  TRY(labels_smooth(region, grain, reflect, labels));
  *greys = (struct grey_soil){.low = sign < 0.0 ? -b.high : b.low,
                              .high = sign < 0.0 ? -b.low : b.high,
                              .shift = sign * shift,
                              .pore_peak = sign * b.pore,
                              .grain_peak = sign * b.grain};
cleanup:
  grey_histogram_end(&histogram);
  memory_free(&grain);
  if (status != STATUS_OK) labels_end(labels);
  return status;
}
