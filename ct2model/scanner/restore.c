#include "ct2model/scanner/restore.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/scanner/deblur.h"

enum { LEVELS = 255 };
/* In voxels: worked on at a time, at most; held in memory as levels, at most; and from where on
 * voxels are averaged as far as the blur allows. */
static const double WORKED = 24e6, HELD = 1.5e9, FULL = 150e6;
/* Smooth walls have no relief for cheap surface to keep, and show all that noise makes: surface
 * costs so many times as much there (docs/notes/2026-11-25-smooth-walls.md). */
static const double SMOOTHER = 8.0;
/* Where relief is much finer than in sand of one size it would take grains away: so many times at
 * the least (docs/notes/2026-11-26-scanner-bias.md). */
static const double FINER = 0.25;
/* In blurs: beyond this a slab's surroundings do not matter. */
static const double MARGIN = 7.0;

size_t restore_step(const size_t size[3], const double voxel[3], double blur) {
  double voxels = 1.0, largest = 0.0;
  for (int d = 0; d < 3; d++) {
    voxels *= (double)size[d];
    largest = fmax(largest, voxel[d]);
  }
  size_t step = 1;
  for (size_t s = 2; s <= 4 && voxels / pow((double)step, 3.0) > FULL; s++) {
    bool fits = blur >= 0.9 * (double)s * largest;
    for (int d = 0; d < 3; d++) fits &= size[d] % s == 0;
    if (fits) step = s;
  }
  return step;
}

/* Work slices first to first + size[2] - 1 of the region, greys 0 pore and 1 grain. */
static enum status slab_read(const struct region *region, const struct scanner *scanner,
                             size_t step, size_t first, struct deblur *slab) {
  enum status status = STATUS_OK;
  const size_t *n = slab->size, plane = region->size[0] * region->size[1];
  const size_t batch = region_batch(region);
  const float pore = (float)scanner->pore;
  const float scale = (float)(1.0 / (scanner->grain - scanner->pore) / pow((double)step, 3.0));
  float *slices = NULL;
  size_t numbers[64];
  TRY(memory_allocate(&slices, batch * plane, sizeof *slices, "slices"));
  memset(slab->grey, 0, n[0] * n[1] * n[2] * sizeof *slab->grey);
  for (size_t z = 0; z < n[2] * step; z += batch) {
    const size_t count = n[2] * step - z < batch ? n[2] * step - z : batch;
    for (size_t i = 0; i < count; i++) numbers[i] = first * step + z + i;
    TRY(region_read(region, numbers, count, slices));
#pragma omp parallel for schedule(static)
    for (size_t y = 0; y < n[1]; y++)
      for (size_t i = 0; i < count * step; i++) {
        const float *in = slices + (i / step * region->size[1] + y * step + i % step) * // NOLINT
                                       region->size[0];
        float *out = slab->grey + ((z + i / step) / step * n[1] + y) * n[0]; // NOLINT: step > 0
        for (size_t x = 0; x < n[0] * step; x++) out[x / step] += scale * (in[x] - pore); // NOLINT
      }
  }
cleanup:
  memory_free(&slices);
  return status;
}

static void slab_keep(const struct deblur *slab, size_t skipped, size_t count, size_t first,
                      struct coarse *restored) {
  const size_t plane = slab->size[0] * slab->size[1];
  uint8_t *levels = restored->levels + first * plane;
  for (size_t i = 0; i < count * plane; i++) {
    levels[i] = (uint8_t)(slab->share[skipped * plane + i] * (float)LEVELS + 0.5f);
    restored->histogram.counts[levels[i]]++;
  }
  restored->histogram.total += count * plane;
}

/* Volume (m^3) over which noise is as one voxel's, its power at low frequencies over its variance:
 * of white noise filtered by a Gaussian of that length, (2 sqrt(pi) length)^3, a voxel at least. */
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
  /* No longer than the blur: what is longer is the grains' texture. */
  const double length =
      fmin(fmax(scanner->noise_correlation, DEBLUR_CORRELATION_LEAST * least), fmax(blur, least));
  const double volume_alike = noise_volume(length, region->voxel);
  work->correlation = length / least;
  work->power = pow(scanner->noise / contrast, 2.0) * volume_alike / volume;
  /* Noise finer than DEBLUR_CORRELATION_LEAST is overrated as it is. */
  const double own = noise_volume(fmin(scanner->noise_correlation, length), region->voxel);
  const double smoother = fmax(1.0, SMOOTHER * own / volume_alike);
  work->surface = scanner->smooth_walls > 0.0  ? pow(smoother, scanner->smooth_walls)
                  : scanner->fine_relief > 0.0 ? pow(FINER, scanner->fine_relief)
                                               : 1.0;
}

enum status restore_run(const struct region *region, const struct scanner *scanner, double width,
                        struct coarse *restored) {
  enum status status = STATUS_OK;
  struct deblur slab = {0};
  struct deblur_scanner work;
  struct progress progress;
  const size_t step = restore_step(region->size, region->voxel, width);
  double voxels = 1.0;
  *restored = (struct coarse){.step = step, .unit = 1.0 / LEVELS};
  for (int d = 0; d < 3; d++) {
    restored->size[d] = region->size[d] / step;
    voxels *= (double)restored->size[d];
  }
  if (voxels > HELD) return STATUS_OK;
  restore_scanner(region, scanner, width, step, &work);
  const size_t plane = restored->size[0] * restored->size[1], nz = restored->size[2];
  const size_t margin = (size_t)ceil(MARGIN * fmax(work.blur[2], 1.0));
  size_t depth = (size_t)(WORKED / (double)plane);
  depth = depth > 3 * margin ? depth - 2 * margin : margin;
  if (nz <= depth + margin) depth = nz;
  const size_t most = depth + 2 * margin < nz ? depth + 2 * margin : nz;
  TRY(memory_allocate(&restored->levels, plane * nz, 1, "the scan without its blur"));
  TRY(grey_histogram_start(-0.5, 1.0, LEVELS + 1, &restored->histogram));
  TRY(deblur_start(plane * most, &work, &slab));
  slab.size[0] = restored->size[0];
  slab.size[1] = restored->size[1];
  progress_start(&progress, "restoring", "slices", (double)nz);
  for (size_t z = 0; z < nz; z += depth) {
    const size_t count = nz - z < depth ? nz - z : depth, first = z > margin ? z - margin : 0;
    const size_t end = z + count + margin < nz ? z + count + margin : nz;
    slab.size[2] = end - first;
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
