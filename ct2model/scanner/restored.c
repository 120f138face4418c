#include "ct2model/scanner/restored.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/resample/reduce.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/surface/specks.h"

/* ---- grains and throats that are only a few blurs wide ---- */

/* Voxels, voxels of pores, and voxels whose next one along an axis is of the other phase. */
struct crossings {
  size_t voxels, pores, faces[3];
};

static void count_block(const struct coarse *scan, const struct restore_block *block,
                        double threshold, struct crossings *crossings) {
  const size_t nx = scan->size[0], ny = scan->size[1], *n = block->size, *first = block->first;
  size_t pores = 0, faces[3] = {0};
#pragma omp parallel for schedule(static) reduction(+ : pores, faces[:3])
  for (size_t row = 0; row < n[1] * n[2]; row++) {
    const size_t y = row % n[1], z = row / n[1]; // NOLINT: a block has rows
    const uint8_t *at = scan->levels + ((first[2] + z) * ny + first[1] + y) * nx + first[0];
    const uint8_t *y_next = y + 1 < n[1] ? at + nx : at, *z_next = z + 1 < n[2] ? at + nx * ny : at;
    for (size_t x = 0; x < n[0]; x++) {
      const bool grain = at[x] > threshold;
      pores += !grain;
      faces[0] += grain != (at[x + 1 < n[0] ? x + 1 : x] > threshold);
      faces[1] += grain != (y_next[x] > threshold);
      faces[2] += grain != (z_next[x] > threshold);
    }
  }
  crossings->voxels += n[0] * n[1] * n[2];
  crossings->pores += pores;
  for (int d = 0; d < 3; d++) crossings->faces[d] += faces[d];
}

struct narrow_throats narrow_throats_measure(const struct restore *restore, double threshold) {
  struct crossings all = {0};
  for (size_t i = 0; i < restore_sampled(restore); i++) {
    const struct restore_block block = restore_sample_block(restore, i);
    count_block(&restore->levels, &block, threshold, &all);
  }
  /* By stereology the surface per volume is twice the intersections per length of random lines
   * (Saltykov 1958); here the mean of lines along the three axes. */
  double crossings = 0.0; /* per length, times the voxels */
  for (int d = 0; d < 3; d++) crossings += (double)all.faces[d] / restore->region->voxel[d] / 3.0;
  const double surface = crossings > 0.0 ? 2.0 * crossings : NAN;
  return (struct narrow_throats){.pore_width = 4.0 * (double)all.pores / surface,
                                 .grain_diameter =
                                     6.0 * (double)(all.voxels - all.pores) / surface};
}

double narrow_throats_pore_excess(const struct narrow_throats *throats,
                                  const struct scanner *scanner, double threshold) {
  const double lowered = LEVEL_EXPECTED - threshold;
  if (scanner->assumed) return 0.0; /* the blur is unknown */
  return (1.0 - scanner->smooth_walls) * ramp(lowered, LOWERED_CHANCE, LOWERED_SIGNIFICANT) *
         ramp(-lowered, -LOWERED_IMPLAUSIBLE, -LOWERED_MOST) *
         ramp(-throats->pore_width / scanner->blur, -WIDTH_SHOWS_GREY, -WIDTH_SHOWS_NO_GREY) *
         fmax(lowered, 0.0) / LEVELS_PER_CONTRAST;
}

double narrow_throats_two_phases(const struct narrow_throats *throats,
                                 const struct scanner *scanner) {
  if (scanner->assumed) return 0.0;
  return (1.0 - scanner->smooth_walls) *
         ramp(scanner->contrast_to_noise, CONTRAST_NOISY, CONTRAST_CLEAR) *
         ramp(-throats->grain_diameter / scanner->blur, -DIAMETER_OPEN, -DIAMETER_CLOSED);
}

/* ---- levels ---- */

enum { BATCH = 32 };

/* Islands of few voxels ("specks") are removed from CHUNK_SLICES slices at a time, with
 * OVERLAP_SLICES slices on either side; no speck is longer. The first slice is adjacent to the last
 * one, as are the ends of rows and columns (specks.h): at an end of the slab specks would be kept,
 * but one on a face of the scan obstructs the flow like any other. */
enum { CHUNK_SLICES = 64, OVERLAP_SLICES = 12 };

/* Volume of the largest speck, in voxels of the restored scan: an island smaller than what the
 * scanner resolves is noise, since a grain touches others. */
static size_t speck_limit(const struct region *region, const struct scanner *scanner) {
  double volume = 3.14159265358979323846 / 6.0; /* of a ball as wide as the resolution */
  for (int d = 0; d < 3; d++) volume *= scanner->resolution / region->voxel[d];
  return (size_t)fmin(fmax(volume, SPECK_LEAST), SPECK_MOST);
}

/* Moves the levels of specks to the other side of `threshold`, by the same distance and at least
 * LEVEL_STEP: the threshold changes when the void ratio is matched once more, which must not
 * restore the specks. */
static enum status drop_specks(const struct region *region, const struct scanner *scanner,
                               double threshold, struct coarse *scan) {
  enum status status = STATUS_OK;
  const size_t nx = scan->size[0], ny = scan->size[1], nz = scan->size[2], plane = nx * ny;
  const size_t words = phase_words(nx), limit = speck_limit(region, scanner);
  const size_t most = (nz < CHUNK_SLICES ? nz : CHUNK_SLICES) + 2 * OVERLAP_SLICES,
               kept = nz < OVERLAP_SLICES ? nz : OVERLAP_SLICES;
  int16_t *field = NULL;
  uint64_t *bits = NULL, *scratch = NULL;
  uint8_t *previous = NULL, *first = NULL; /* original levels of the slices before the chunk, and of
                                         the first slices */
  TRY(memory_allocate(&field, most * plane, sizeof *field, "specks"));
  TRY(memory_allocate(&bits, most * ny * words, sizeof *bits, "specks"));
  TRY(memory_allocate(&scratch, 2 * most * ny * words, sizeof *scratch, "specks"));
  TRY(memory_allocate(&previous, OVERLAP_SLICES * plane, 1, "specks"));
  TRY(memory_allocate(&first, kept * plane, 1, "specks"));
  memcpy(first, scan->levels, kept * plane);
  for (size_t i = 0; i < OVERLAP_SLICES; i++)
    memcpy(previous + i * plane,
           scan->levels + (nz * OVERLAP_SLICES + i - OVERLAP_SLICES) % nz * plane, plane);
  for (size_t z = 0; z < nz; z += CHUNK_SLICES) {
    const size_t count = nz - z < CHUNK_SLICES ? nz - z : CHUNK_SLICES;
    const size_t size[3] = {nx, ny, count + 2 * OVERLAP_SLICES};
#pragma omp parallel for schedule(static)
    for (size_t row = 0; row < size[2] * ny; row++) {
      const size_t layer = row / ny, at = z + layer - OVERLAP_SLICES;
      const uint8_t *levels = (layer < OVERLAP_SLICES ? previous + layer * plane
                               : at < nz              ? scan->levels + at * plane
                                                      : first + (at - nz) % nz * plane) +
                              row % ny * nx;
      for (size_t x = 0; x < nx; x++)
        field[row * nx + x] = (int16_t)lrint(64.0 * ((double)levels[x] - threshold));
      phase_row(field + row * nx, nx, bits + row * words);
    }
    specks_remove(field, bits, size, limit, scratch);
    if (count >= OVERLAP_SLICES)
      memcpy(previous, scan->levels + (z + count - OVERLAP_SLICES) * plane, OVERLAP_SLICES * plane);
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < count * plane; i++) {
      uint8_t *level = &scan->levels[z * plane + i];
      if ((field[OVERLAP_SLICES * plane + i] > 0) == ((double)*level > threshold)) continue;
      const double distance = fmax(fabs((double)*level - threshold), LEVEL_STEP);
      const double to = (double)*level > threshold ? threshold - distance : threshold + distance;
      *level = (uint8_t)lrint(fmin(fmax(to, 0.0), 255.0));
    }
  }
  memset(scan->histogram.counts, 0, scan->histogram.bins * sizeof *scan->histogram.counts);
  for (size_t i = 0; i < plane * nz; i++) scan->histogram.counts[scan->levels[i]]++;
cleanup:
  MEMORY_FREE(&field, &bits, &scratch, &previous, &first);
  return status;
}

void restored_end(struct restored *restored) {
  coarse_end(&restored->scan);
}

struct region restored_region(const struct restored *restored, const struct region *region) {
  return coarse_region(&restored->scan, region);
}

static double void_ratio_at(const struct grey_histogram *levels, double level) {
  const double n = grey_histogram_porosity(levels, level);
  return n / (1.0 - n);
}

/* Finds the void ratio at the middle level, and the level that encloses `void_ratio`. */
static void match(const struct restore *restore, double void_ratio, struct restored *restored) {
  const struct grey_histogram *levels = &restore->levels.histogram;
  restored->middle = void_ratio_at(levels, LEVEL_MIDDLE);
  restored->threshold = grey_histogram_quantile(levels, void_ratio / (1.0 + void_ratio));
}

/* Reads the void ratio that the scan shows from a restoration that knows nothing of a measured
 * one. */
static void see_void_ratio(const struct restore *restore, const struct scanner *scanner,
                           struct restored *restored) {
  const struct grey_histogram *levels = &restore->levels.histogram;
  restored->scan_void_ratio = restored->scan_void_ratio_error = NAN;
  /* Greys that no surface shows by itself say nothing: those of a narrow phase were fitted. */
  if (!scanner->known || scanner->by_void_ratio || scanner->narrow) return;
  const double noise = LEVEL_NOISY / pow(scanner->contrast_to_noise, 2.0);
  const double width = narrow_throats_measure(restore, LEVEL_EXPECTED).pore_width;
  const double narrow = LEVEL_NARROW * pow(scanner->blur / width, 2.0);
  const double unsure = fmin(hypot(LEVEL_SURE, hypot(noise, narrow)), LEVEL_UNSURE_MOST);
  restored->scan_void_ratio = void_ratio_at(levels, LEVEL_EXPECTED);
  restored->scan_void_ratio_error = 0.5 * (void_ratio_at(levels, LEVEL_EXPECTED + unsure) -
                                           void_ratio_at(levels, LEVEL_EXPECTED - unsure));
}

static bool allows_void_ratio(const struct restored *restored) {
  return restored->threshold > LEVEL_MIN && restored->threshold < LEVEL_MAX;
}

/* Corrects the scanner by what narrow throats require, and restores the sample again with it. */
static enum status open_throats(struct restore *restore, double void_ratio, struct scanner *scanner,
                                struct restored *restored) {
  enum status status = STATUS_OK;
  const struct narrow_throats throats = narrow_throats_measure(restore, restored->threshold);
  const double excess = narrow_throats_pore_excess(&throats, scanner, restored->threshold);
  restored->two_phases = narrow_throats_two_phases(&throats, scanner);
  scanner->pore -= excess * (scanner->grain - scanner->pore);
  if (excess > EXCESS_SMALL)
    log_warning("pores are too narrow to show their grey: it is taken as darker by %.0f %% of the "
                "contrast, so that the edges of the scan give a void ratio near %.3g; check the "
                "void ratio",
                100.0 * excess, void_ratio);
  if (!(excess > 0.0 || restored->two_phases > 0.0)) return STATUS_OK;
  TRY(restore_sample(restore, scanner, restored->two_phases));
  match(restore, void_ratio, restored);
  if (restored->two_phases > 0.0 && !allows_void_ratio(restored)) {
    restored->two_phases = 0.0;
    TRY(restore_sample(restore, scanner, 0.0));
    match(restore, void_ratio, restored);
  }
cleanup:
  return status;
}

/* Restores a sample, finds what narrow throats require, and restores the rest. */
static enum status restore_all(const struct region *region, const struct scanner *measured,
                               double void_ratio, struct restored *restored) {
  enum status status = STATUS_OK;
  struct scanner scanner = *measured;
  struct restore restore;
  TRY(restore_start(region, scanner.blur, RESTORE_VOXELS, &restore));
  TRY(restore_sample(&restore, &scanner, 0.0));
  match(&restore, void_ratio, restored);
  see_void_ratio(&restore, &scanner, restored);
  if (allows_void_ratio(restored)) TRY(open_throats(&restore, void_ratio, &scanner, restored));
  if (allows_void_ratio(restored)) TRY(restore_others(&restore, &scanner, restored->two_phases));
  match(&restore, void_ratio, restored);
cleanup:
  restored->scan = restore.levels;
  if (status != STATUS_OK) restored_end(restored);
  return status;
}

enum status restored_make(const struct region *region, const struct scanner *scanner,
                          double void_ratio, const struct enclosed_sides *sides,
                          struct restored *restored) {
  enum status status = STATUS_OK;
  struct coarse *scan = &restored->scan;
  TRY(restore_all(region, scanner, void_ratio, restored));
  if (!allows_void_ratio(restored)) {
    log_warning("the edges of the scan give a void ratio of %.3g, not %.3g: the surface is taken "
                "where the threshold says, with the scanner's blur and noise",
                restored->middle, void_ratio);
    restored_end(restored);
    return STATUS_OK;
  }
  const struct region levels = restored_region(restored, region);
  const double porosity = void_ratio / (1.0 + void_ratio);
  double met = porosity;
  TRY(enclosed_match(&levels, sides, LEVEL_MIN, LEVEL_MAX, &restored->threshold, &met));
  TRY(drop_specks(region, scanner, restored->threshold, scan));
  met = porosity;
  TRY(enclosed_match(&levels, sides, LEVEL_MIN, LEVEL_MAX, &restored->threshold, &met));
  restored->void_ratio = met / (1.0 - met);
cleanup:
  return status;
}

/* Reads a row of levels. Many voxels have exactly the level of the threshold; the mean of their six
 * neighbours, with a small weight, decides which of these are grain. */
static void read_row(const struct coarse *scan, size_t y, size_t z, float *row) {
  static const float TIE = 1.0F / 3300.0F;
  const size_t nx = scan->size[0], ny = scan->size[1], plane = nx * ny;
  const uint8_t *at = scan->levels + z * plane + y * nx;
  const uint8_t *y_last = y > 0 ? at - nx : at, *y_next = y + 1 < ny ? at + nx : at;
  const uint8_t *z_last = z > 0 ? at - plane : at,
                *z_next = z + 1 < scan->size[2] ? at + plane : at;
  for (size_t x = 0; x < nx; x++) {
    const int near = at[x > 0 ? x - 1 : x] + at[x + 1 < nx ? x + 1 : x] + y_last[x] + y_next[x] +
                     z_last[x] + z_next[x];
    row[x] = (float)at[x] + TIE * (float)(near - 6 * (int)at[x]);
  }
}

enum status restored_resample(const struct restored *restored, enum filter filter,
                              const size_t size[3], float *volume) {
  enum status status = STATUS_OK;
  const size_t *in = restored->scan.size, nx = in[0];
  struct resampler resampler = {0};
  float *rows = NULL;
  TRY(resampler_start(filter, in, size, BATCH, &resampler));
  TRY(memory_allocate(&rows, BATCH * nx, sizeof *rows, "rows of greys"));
  memset(volume, 0, size[0] * size[1] * size[2] * sizeof *volume);
  for (size_t z = 0; z < in[2]; z += BATCH) {
    const size_t n = in[2] - z < BATCH ? in[2] - z : BATCH;
#pragma omp parallel for schedule(dynamic)
    for (size_t i = 0; i < n; i++) {
      float *row = rows + i * nx;
      struct reduction reduction;
      resampler_begin(&resampler, i, &reduction);
      for (size_t y = 0; y < in[1]; y++) {
        read_row(&restored->scan, y, z + i, row);
        reduction_add(&reduction, row);
      }
    }
    resampler_add(&resampler, z, n, volume);
  }
cleanup:
  memory_free(&rows);
  resampler_end(&resampler);
  return status;
}
