#include "ct2model/scanner/restore.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/gaussian.h"

enum { LEVELS = 255 };
/* Numbers of voxels: in a slab that is worked on at a time, at most; held in memory as levels, at
 * most; and above which voxels are averaged as far as the blur allows. */
static const double VOXELS_WORKED = 24e6, VOXELS_HELD = 1.5e9, VOXELS_UNAVERAGED = 150e6;
/* Cost of surface on smooth walls, relative to the usual one: they have no relief that a low cost
 * would keep, and show all the relief that noise makes (docs/physics/restoration.md). */
static const double COST_SMOOTH = 8.0;
/* Cost of surface, relative to the usual one, where relief is much finer than in uniform sand: the
 * usual one would remove grains there (docs/physics/restoration.md). */
static const double COST_FINE = 0.25;
/* Overlap of the slabs, in blurs: what is farther away does not matter. */
static const double MARGIN_BLURS = 7.0;
/* Distance beyond the faces of the scan, in blurs, over which grains are restored together with the
 * others, as far as the scan shows them. If the scan were reflected at its faces instead, as no
 * grain cut by a face is, walls within two blurs of a face would be twice as far off
 * (docs/physics/restoration.md). */
static const double BEYOND_BLURS = 2.0;

size_t restore_step(const size_t size[3], const double voxel[3], double blur) {
  double voxels = 1.0, largest = 0.0;
  for (int d = 0; d < 3; d++) {
    voxels *= (double)size[d];
    largest = fmax(largest, voxel[d]);
  }
  size_t step = 1;
  for (size_t s = 2; s <= 4 && voxels / pow((double)step, 3.0) > VOXELS_UNAVERAGED; s++) {
    bool fits = blur >= 0.9 * (double)s * largest;
    for (int d = 0; d < 3; d++) fits &= size[d] % s == 0;
    if (fits) step = s;
  }
  return step;
}

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

/* Reads slices of the region, averaged over `step` voxels, from slice `first` (of the averages) on,
 * and scales them to 0 in pores and 1 in grains. The voxels beyond the faces are filled, too. */
static enum status slab_read(const struct region *region, const struct scanner *scanner,
                             size_t step, size_t first, struct deblur *slab) {
  enum status status = STATUS_OK;
  const size_t *all = slab->size, plane = region->size[0] * region->size[1];
  const size_t at[3] = {slab->beyond[0][0], slab->beyond[1][0], slab->beyond[2][0]};
  size_t n[3];
  for (int d = 0; d < 3; d++) n[d] = all[d] - slab->beyond[d][0] - slab->beyond[d][1];
  const size_t batch = region_batch(region);
  const float pore = (float)scanner->pore;
  const float scale = (float)(1.0 / (scanner->grain - scanner->pore) / pow((double)step, 3.0));
  float *slices = NULL;
  size_t numbers[64];
  TRY(memory_allocate(&slices, batch * plane, sizeof *slices, "slices"));
  memset(slab->grey, 0, all[0] * all[1] * all[2] * sizeof *slab->grey);
  for (size_t z = 0; z < n[2] * step; z += batch) {
    const size_t count = n[2] * step - z < batch ? n[2] * step - z : batch;
    for (size_t i = 0; i < count; i++) numbers[i] = first * step + z + i;
    TRY(region_read(region, numbers, count, slices));
#pragma omp parallel for schedule(static)
    for (size_t y = 0; y < n[1]; y++)
      for (size_t i = 0; i < count * step; i++) {
        const float *in = slices + (i / step * region->size[1] + y * step + i % step) * // NOLINT
                                       region->size[0];
        const size_t to = (z + i / step) / step + at[2]; // NOLINT: step > 0
        float *out = slab->grey + (to * all[1] + y + at[1]) * all[0] + at[0];
        for (size_t x = 0; x < n[0] * step; x++) out[x / step] += scale * (in[x] - pore); // NOLINT
      }
  }
  slab_reflect(slab);
cleanup:
  memory_free(&slices);
  return status;
}

/* Stores `count` slices of the restored slab as levels, from slice `first` of the result on; the
 * first `skipped` slices of the slab are overlap. */
static void slab_keep(const struct deblur *slab, size_t skipped, size_t count, size_t first,
                      struct coarse *restored) {
  const size_t nx = restored->size[0], ny = restored->size[1];
  uint8_t *levels = restored->levels + first * nx * ny;
  for (size_t row = 0; row < count * ny; row++, levels += nx) {
    const size_t y = row % ny + slab->beyond[1][0];           // NOLINT: a volume has a row
    const size_t z = row / ny + skipped + slab->beyond[2][0]; // NOLINT
    const float *share = slab->share + (z * slab->size[1] + y) * slab->size[0] + slab->beyond[0][0];
    for (size_t x = 0; x < nx; x++) {
      levels[x] = (uint8_t)(share[x] * (float)LEVELS + 0.5f);
      restored->histogram.counts[levels[x]]++;
    }
  }
  restored->histogram.total += count * nx * ny;
}

/* Correlation volume of the noise (m^3): its power at low frequencies over its variance. White
 * noise filtered by a Gaussian of the given length has (2 sqrt(pi) length)^3; at least a voxel. */
static double noise_volume(double length, const double voxel[3]) {
  double noise = 1.0;
  for (int d = 0; d < 3; d++) noise *= fmax(voxel[d], 2.0 * sqrt(M_PI) * length);
  return noise;
}

void restore_scanner(const struct region *region, const struct scanner *scanner, double blur,
                     size_t step, struct deblur_scanner *work) {
  const double contrast = scanner->grain - scanner->pore;
  double volume = 1.0, least = INFINITY;
  *work = (struct deblur_scanner){.fringe = scanner->fringe};
  for (int d = 0; d < 3; d++) {
    const double voxel = region->voxel[d] * (double)step;
    volume *= voxel;
    least = fmin(least, voxel);
    work->blur[d] = blur / voxel;
  }
  for (int d = 0; d < 3; d++) work->stretch[d] = region->voxel[d] * (double)step / least;
  /* The correlation length is limited to the blur: anything longer is texture of the grains. */
  const double length =
      fmin(fmax(scanner->noise_correlation, DEBLUR_CORRELATION_LEAST * least), fmax(blur, least));
  const double correlation_volume = noise_volume(length, region->voxel);
  work->correlation = length / least;
  work->power = pow(scanner->noise / contrast, 2.0) * correlation_volume / volume;
  /* Noise finer than DEBLUR_CORRELATION_LEAST is already overestimated, so that smooth walls need
   * less additional cost. */
  const double actual_volume =
      noise_volume(fmin(scanner->noise_correlation, length), region->voxel);
  const double smoother = fmax(1.0, COST_SMOOTH * actual_volume / correlation_volume);
  work->surface = scanner->smooth_walls > 0.0  ? pow(smoother, scanner->smooth_walls)
                  : scanner->fine_relief > 0.0 ? pow(COST_FINE, scanner->fine_relief)
                                               : 1.0;
}

enum status restore_run(const struct region *region, const struct scanner *scanner,
                        double two_phases, struct coarse *restored) {
  enum status status = STATUS_OK;
  struct deblur slab = {0};
  struct deblur_scanner work;
  struct progress progress;
  const size_t step = restore_step(region->size, region->voxel, scanner->blur);
  double voxels = 1.0;
  *restored = (struct coarse){.step = step, .unit = 1.0 / LEVELS};
  for (int d = 0; d < 3; d++) {
    restored->size[d] = region->size[d] / step;
    voxels *= (double)restored->size[d];
  }
  if (voxels > VOXELS_HELD) return STATUS_OK;
  restore_scanner(region, scanner, scanner->blur, step, &work);
  work.two_phases = two_phases;
  size_t beyond[3];
  voxels_beyond(restored->size, work.blur, beyond);
  const size_t plane = restored->size[0] * restored->size[1], nz = restored->size[2];
  const size_t worked = (restored->size[0] + 2 * beyond[0]) * (restored->size[1] + 2 * beyond[1]);
  const size_t margin = (size_t)ceil(MARGIN_BLURS * fmax(work.blur[2], 1.0));
  size_t depth = (size_t)(VOXELS_WORKED / (double)worked);
  depth = depth > 3 * margin ? depth - 2 * margin : margin;
  if (nz <= depth + margin) depth = nz;
  const size_t most = depth + 2 * margin < nz ? depth + 2 * margin : nz;
  TRY(memory_allocate(&restored->levels, plane * nz, 1, "the scan without its blur"));
  TRY(grey_histogram_start(-0.5, 1.0, LEVELS + 1, &restored->histogram));
  TRY(deblur_start(worked * (most + 2 * beyond[2]), &work, &slab));
  for (int d = 0; d < 2; d++) {
    slab.size[d] = restored->size[d] + 2 * beyond[d];
    slab.beyond[d][0] = slab.beyond[d][1] = beyond[d];
  }
  progress_start(&progress, "restoring", "slices", (double)nz);
  for (size_t z = 0; z < nz; z += depth) {
    const size_t count = nz - z < depth ? nz - z : depth, first = z > margin ? z - margin : 0;
    const size_t end = z + count + margin < nz ? z + count + margin : nz;
    slab.beyond[2][0] = first == 0 ? beyond[2] : 0;
    slab.beyond[2][1] = end == nz ? beyond[2] : 0;
    slab.size[2] = end - first + slab.beyond[2][0] + slab.beyond[2][1];
    TRY(slab_read(region, scanner, step, first, &slab));
    TRY(deblur_run(&slab));
    slab_keep(&slab, z - first, count, z, restored);
    progress_update(&progress, (double)(z + count), NULL);
  }
  progress_end(&progress);
cleanup:
  deblur_end(&slab);
  if (status != STATUS_OK) coarse_end(restored);
  return status;
}
