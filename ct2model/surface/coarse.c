#include "ct2model/surface/coarse.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
#include "ct2model/scan/survey.h"

enum { LEVELS = 256, STEP_MOST = 4 };
/* Largest memory for the levels, in bytes. */
static const double BYTES_MOST = 160e6;

/* Chooses the range of greys of the levels: both phases and half the contrast beyond them; for a
 * segmented image all greys of the survey. */
static void choose_range(const struct region *region, const struct survey *survey,
                         struct coarse *coarse) {
  const struct grey_phases *phases = &survey->phases;
  const size_t n = survey->count * region->size[0] * region->size[1];
  double low = INFINITY, high = -INFINITY;
  if (phases->contrast_to_noise > 0.0) {
    const double contrast = phases->grain_peak - phases->pore_peak;
    low = phases->pore_peak - 0.5 * contrast;
    high = phases->grain_peak + 0.5 * contrast;
  } else {
    for (size_t i = 0; i < n; i++) {
      low = fmin(low, (double)survey->sample[i]);
      high = fmax(high, (double)survey->sample[i]);
    }
  }
  coarse->low = low;
  coarse->unit = (high - low) / (LEVELS - 1);
}

/* The largest step of which a voxel of the model spans at least four. */
static size_t choose_step(const size_t in[3], const size_t out[3]) {
  double least = INFINITY, voxels = 1.0;
  for (int d = 0; d < 3; d++) {
    least = fmin(least, (double)in[d] / (double)out[d]);
    voxels *= (double)in[d];
  }
  for (size_t step = STEP_MOST; step > 1; step /= 2) {
    bool fits = least >= 4.0 * (double)step && voxels / pow((double)step, 3.0) <= BYTES_MOST;
    for (int d = 0; d < 3; d++) fits &= in[d] % step == 0;
    if (fits) return step;
  }
  return 1;
}

enum status coarse_start(const struct region *region, const size_t size[3],
                         const struct survey *survey, struct coarse *coarse) {
  enum status status = STATUS_OK;
  *coarse = (struct coarse){.step = choose_step(region->size, size)};
  if (coarse->step == 1) return STATUS_OK;
  choose_range(region, survey, coarse);
  if (!(coarse->unit > 0.0)) { /* of one grey */
    coarse->step = 1;
    return STATUS_OK;
  }
  for (int d = 0; d < 3; d++) coarse->size[d] = region->size[d] / coarse->step;
  TRY(memory_allocate(&coarse->levels, coarse->size[0] * coarse->size[1] * coarse->size[2],
                      sizeof *coarse->levels, "the averaged scan"));
  TRY(grey_histogram_start(-0.5, 1.0, LEVELS, &coarse->histogram));
cleanup:
  if (status != STATUS_OK) coarse_end(coarse);
  return status;
}

void coarse_end(struct coarse *coarse) {
  memory_free(&coarse->levels);
  grey_histogram_end(&coarse->histogram);
  coarse->step = 1;
}

size_t coarse_sums(const struct coarse *coarse) {
  return coarse->size[0] * coarse->size[1];
}

TARGETS static void start_pairs(const float *restrict row, size_t n, float *restrict sums) {
  for (size_t i = 0; i < n; i++) sums[i] = row[2 * i] + row[2 * i + 1];
}

TARGETS static void add_pairs(const float *restrict row, size_t n, float *restrict sums) {
  for (size_t i = 0; i < n; i++) sums[i] += row[2 * i] + row[2 * i + 1];
}

TARGETS static void add_fours(const float *restrict row, size_t n, float *restrict sums) {
  for (size_t i = 0; i < n; i++)
    sums[i] += (row[4 * i] + row[4 * i + 1]) + (row[4 * i + 2] + row[4 * i + 3]);
}

void coarse_add(const struct coarse *coarse, size_t y, size_t z, const float *row, float *sums) {
  const size_t n = coarse->size[0], step = coarse->step;
  const bool first = y % step == 0 && z % step == 0; // NOLINT: a step is one voxel at least
  float *at = sums + y / step * n;
  if (step == 2) {
    (first ? start_pairs : add_pairs)(row, n, at);
  } else {
    if (first) memset(at, 0, n * sizeof *at);
    add_fours(row, n, at);
  }
}

TARGETS static void to_levels(const float *restrict sums, size_t n, float scale, float shift,
                              uint8_t *restrict levels) {
  for (size_t i = 0; i < n; i++) {
    const float level = sums[i] * scale + shift;
    levels[i] = (uint8_t)(int)(level < 0.0f ? 0.0f : level > LEVELS - 1 ? LEVELS - 1 : level);
  }
}

void coarse_store(struct coarse *coarse, size_t z, const float *sums) {
  const size_t plane = coarse_sums(coarse);
  uint8_t *levels = coarse->levels + z * plane;
  uint32_t counts[LEVELS * 4] = {0}; /* layout of pixels_count */
  to_levels(sums, plane, (float)(1.0 / (pow((double)coarse->step, 3.0) * coarse->unit)),
            (float)(0.5 - coarse->low / coarse->unit), levels);
  pixels_count(counts, levels, plane, PIXEL_U8);
#pragma omp critical(coarse_counts)
  for (size_t b = 0; b < LEVELS; b++)
    coarse->histogram.counts[b] += pixels_counted(counts, b, PIXEL_U8);
#pragma omp atomic
  coarse->histogram.total += plane;
}

struct region coarse_region(const struct coarse *coarse, const struct region *region) {
  struct region larger = {
      .stack = region->stack, .scale = 1.0, .held = coarse->levels, .held_type = PIXEL_U8};
  memcpy(larger.size, coarse->size, sizeof larger.size);
  for (int d = 0; d < 3; d++) larger.voxel[d] = region->voxel[d] * (double)coarse->step;
  return larger;
}
