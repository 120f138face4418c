#include "ct2model/scanner/restore.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/gaussian.h"

enum { LEVELS = 255 };
/* Number of voxels beyond the faces of the scan at either end of each axis. */
static void voxels_beyond(const size_t size[3], const double blur[3], size_t beyond[3]) {
  for (int d = 0; d < 3; d++) {
    const double far = fmin(ceil(BEYOND_BLURS * blur[d]), (double)size[d]);
    beyond[d] = size[d] > 1 ? (size_t)far : 0;
  }
}

/* Index of the voxel of the slab that position `at` shows if the scan is reflected at its faces. */
static size_t reflect(size_t at, size_t n, const size_t beyond[2]) {
  return beyond[0] + gaussian_reflect((long)at - (long)beyond[0], n - beyond[0] - beyond[1]);
}

/* Fills the voxels beyond the faces by reflection, as a first guess. */
static void slab_reflect(struct deblur *slab) {
  const size_t nx = slab->size[0], ny = slab->size[1], nz = slab->size[2];
  const size_t first = slab->beyond[0][0], end = nx - slab->beyond[0][1];
#pragma omp parallel for schedule(static)
  for (size_t row = 0; row < ny * nz; row++) {
    const size_t y = reflect(row % ny, ny, slab->beyond[1]); // NOLINT: a volume has a row
    const size_t z = reflect(row / ny, nz, slab->beyond[2]); // NOLINT
    const float *from = slab->grey + (z * ny + y) * nx;
    float *to = slab->grey + row * nx;
    if (from != to) memcpy(to + first, from + first, (end - first) * sizeof *to);
    for (size_t x = 0; x < nx; x++)
      if (x < first || x >= end) to[x] = to[reflect(x, nx, slab->beyond[0])];
  }
}

/* Voxel of the scan at which block `number` of an axis begins. */
static size_t block_start(const struct restore *restore, int d, size_t number) {
  return number * restore->region->size[d] / restore->count[d];
}

/* Largest number of voxels along an axis of a block, with its neighbours' parts. */
static size_t block_extent(const struct restore *restore, int d) {
  const size_t n = restore->region->size[d], count = restore->count[d];
  return count == 1 ? n + 2 * restore->beyond[d]
                    : (n + count - 1) / count + 2 * restore->overlap[d];
}

static size_t block_count(const struct restore *restore) {
  return restore->count[0] * restore->count[1] * restore->count[2];
}

static struct restore_block block_at(const struct restore *restore, size_t number) {
  const size_t *count = restore->count;
  const size_t at[3] = {number % count[0], number / count[0] % count[1],
                        number / count[0] / count[1]};
  struct restore_block block;
  for (int d = 0; d < 3; d++) {
    block.first[d] = block_start(restore, d, at[d]);
    block.size[d] = block_start(restore, d, at[d] + 1) - block.first[d];
  }
  return block;
}

/* Halves, thirds, ... the longest axis of the blocks until they have at most `voxels` voxels, or
 * would be less than their overlap. */
static void choose_blocks(double voxels, struct restore *restore) {
  for (;;) {
    double all = 1.0;
    int longest = 0;
    for (int d = 0; d < 3; d++) {
      all *= (double)block_extent(restore, d);
      if (block_extent(restore, d) > block_extent(restore, longest)) longest = d;
    }
    if (all <= voxels || block_extent(restore, longest) <= 3 * restore->overlap[longest]) return;
    restore->count[longest]++;
  }
}

enum status restore_start(const struct region *region, double blur, double voxels,
                          struct restore *restore) {
  enum status status = STATUS_OK;
  double blurs[3];
  *restore = (struct restore){.region = region, .count = {1, 1, 1}};
  restore->levels = (struct coarse){.step = 1, .unit = 1.0 / LEVELS};
  memcpy(restore->levels.size, region->size, sizeof region->size);
  for (int d = 0; d < 3; d++) {
    blurs[d] = blur / region->voxel[d];
    restore->overlap[d] = (size_t)ceil(OVERLAP_BLURS * fmax(blurs[d], 1.0));
  }
  voxels_beyond(region->size, blurs, restore->beyond);
  choose_blocks(voxels, restore);
  TRY(memory_allocate(&restore->levels.levels, region->size[0] * region->size[1] * region->size[2],
                      1, "the scan without its blur (--crop or --blur keep need less)"));
  TRY(grey_histogram_start(-0.5, 1.0, LEVELS + 1, &restore->levels.histogram));
cleanup:
  return status;
}

size_t restore_sampled(const struct restore *restore) {
  return block_count(restore) < SAMPLE_BLOCKS ? block_count(restore) : SAMPLE_BLOCKS;
}

/* Number of a block of the sample: one in each third of each axis, in another third for each axis
 * (a Latin hypercube: McKay, Beckman, Conover 1979, Technometrics 21: 239). */
static size_t sample_number(const struct restore *restore, size_t i) {
  const size_t *count = restore->count;
  size_t number = 0;
  if (block_count(restore) <= SAMPLE_BLOCKS) return i;
  for (size_t d = 3; d-- > 0;)
    number =
        number * count[d] + count[d] * (2 * ((i + d) % SAMPLE_BLOCKS) + 1) / (2 * SAMPLE_BLOCKS);
  return number;
}

static bool in_sample(const struct restore *restore, size_t number) {
  for (size_t i = 0; i < restore_sampled(restore); i++)
    if (sample_number(restore, i) == number) return true;
  return false;
}

struct restore_block restore_sample_block(const struct restore *restore, size_t i) {
  return block_at(restore, sample_number(restore, i));
}

/* Reads a block and its neighbours' parts, scaled to 0 in pores and 1 in grains, into the slab, and
 * fills the voxels beyond the faces. skip[]: voxels of the slab before those of the block. */
static enum status block_read(const struct restore *restore, const struct scanner *scanner,
                              const struct restore_block *block, struct deblur *slab,
                              size_t skip[3]) {
  enum status status = STATUS_OK;
  const size_t *all = restore->region->size;
  size_t from[3], size[3];
  for (int d = 0; d < 3; d++) {
    const size_t overlap = restore->overlap[d], end = block->first[d] + block->size[d];
    const size_t to = end + overlap < all[d] ? end + overlap : all[d];
    from[d] = block->first[d] > overlap ? block->first[d] - overlap : 0;
    size[d] = to - from[d];
    slab->beyond[d][0] = from[d] == 0 ? restore->beyond[d] : 0;
    slab->beyond[d][1] = to == all[d] ? restore->beyond[d] : 0;
    slab->size[d] = slab->beyond[d][0] + size[d] + slab->beyond[d][1];
    skip[d] = slab->beyond[d][0] + block->first[d] - from[d];
  }
  const size_t pitch[2] = {slab->size[0], slab->size[0] * slab->size[1]};
  const float pore = (float)scanner->pore, scale = (float)(1.0 / (scanner->grain - scanner->pore));
  TRY(region_read_box(restore->region, from, size, pitch,
                      slab->grey + slab->beyond[2][0] * pitch[1] + slab->beyond[1][0] * pitch[0] +
                          slab->beyond[0][0]));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < pitch[1] * slab->size[2]; i++)
    slab->grey[i] = scale * (slab->grey[i] - pore);
  slab_reflect(slab);
cleanup:
  return status;
}

/* Stores the restored block as levels. */
static void block_keep(const struct deblur *slab, const struct restore_block *block,
                       const size_t skip[3], struct coarse *restored) {
  const size_t *n = restored->size, rows = block->size[1] * block->size[2];
  for (size_t row = 0; row < rows; row++) {
    const size_t y = row % block->size[1], z = row / block->size[1]; // NOLINT: a block has rows
    const float *share =
        slab->share + ((z + skip[2]) * slab->size[1] + y + skip[1]) * slab->size[0] + skip[0];
    uint8_t *levels = restored->levels +
                      ((block->first[2] + z) * n[1] + block->first[1] + y) * n[0] + block->first[0];
    for (size_t x = 0; x < block->size[0]; x++) {
      levels[x] = (uint8_t)(share[x] * (float)LEVELS + 0.5f);
      restored->histogram.counts[levels[x]]++;
    }
  }
  restored->histogram.total += block->size[0] * rows;
}

/* Correlation volume of the noise (m^3): its power at low frequencies over its variance. White
 * noise filtered by a Gaussian of the given length has (2 sqrt(pi) length)^3; at least a voxel. */
static double noise_volume(double length, const double voxel[3]) {
  double noise = 1.0;
  for (int d = 0; d < 3; d++) noise *= fmax(voxel[d], 2.0 * sqrt(M_PI) * length);
  return noise;
}

void restore_scanner(const struct region *region, const struct scanner *scanner, double blur,
                     struct deblur_scanner *work) {
  const double contrast = scanner->grain - scanner->pore;
  double volume = 1.0, least = INFINITY;
  *work = (struct deblur_scanner){.fringe = scanner->fringe};
  for (int d = 0; d < 3; d++) {
    const double voxel = region->voxel[d];
    volume *= voxel;
    least = fmin(least, voxel);
    work->blur[d] = blur / voxel;
  }
  for (int d = 0; d < 3; d++) work->stretch[d] = region->voxel[d] / least;
  /* The correlation length is limited to the blur: anything longer is texture of the grains. */
  const double length =
      fmin(fmax(scanner->noise_correlation, CORRELATION_LEAST * least), fmax(blur, least));
  const double correlation_volume = noise_volume(length, region->voxel);
  work->correlation = length / least;
  work->power = pow(scanner->noise / contrast, 2.0) * correlation_volume / volume;
  /* Noise finer than CORRELATION_LEAST is already overestimated, so that smooth walls need
   * less additional cost. */
  const double actual_volume =
      noise_volume(fmin(scanner->noise_correlation, length), region->voxel);
  const double smoother = fmax(1.0, COST_SMOOTH * actual_volume / correlation_volume);
  work->surface = scanner->smooth_walls > 0.0  ? pow(smoother, scanner->smooth_walls)
                  : scanner->fine_relief > 0.0 ? pow(COST_FINE, scanner->fine_relief)
                                               : 1.0;
}

/* Restores the blocks of the sample, or the others. */
static enum status restore_blocks(struct restore *restore, const struct scanner *scanner,
                                  double two_phases, bool sample) {
  enum status status = STATUS_OK;
  struct deblur slab = {0};
  struct deblur_scanner work;
  struct progress progress;
  const size_t count = block_count(restore), sampled = restore_sampled(restore);
  const size_t blocks = sample ? sampled : count - sampled;
  if (blocks == 0) return STATUS_OK;
  restore_scanner(restore->region, scanner, scanner->blur, &work);
  work.two_phases = two_phases;
  TRY(deblur_start(block_extent(restore, 0) * block_extent(restore, 1) * block_extent(restore, 2),
                   &work, &slab));
  progress_start(&progress, sample && blocks < count ? "restoring a sample" : "restoring", NULL,
                 (double)blocks);
  slab.progress = &progress;
  for (size_t i = 0; i < count; i++) {
    const struct restore_block block = block_at(restore, i);
    size_t skip[3];
    if (in_sample(restore, i) != sample) continue;
    TRY(block_read(restore, scanner, &block, &slab, skip));
    TRY(deblur_run(&slab));
    block_keep(&slab, &block, skip, &restore->levels);
    slab.done += 1.0;
  }
  progress_end(&progress);
cleanup:
  deblur_end(&slab);
  return status;
}

enum status restore_sample(struct restore *restore, const struct scanner *scanner,
                           double two_phases) {
  struct grey_histogram *histogram = &restore->levels.histogram;
  memset(histogram->counts, 0, histogram->bins * sizeof *histogram->counts);
  histogram->total = 0;
  return restore_blocks(restore, scanner, two_phases, true);
}

enum status restore_others(struct restore *restore, const struct scanner *scanner,
                           double two_phases) {
  return restore_blocks(restore, scanner, two_phases, false);
}
