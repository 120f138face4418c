#include "ct2model/scanner/narrow_throats.h"

#include <math.h>

#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/ramp.h"

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
