#include "ct2model/scanner/restored.h"

#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/resample/reduce.h"
#include "ct2model/scanner/restore.h"

enum { BATCH = 32 };

/* Levels of 255 between which the surface must lie: beyond, the void ratio asks for more or less
 * grain than there are edges. */
static const double LEAST = 10.0, MOST = 245.0;

void restored_end(struct restored *restored) {
  coarse_end(&restored->scan);
}

struct region restored_region(const struct restored *restored, const struct region *region) {
  return coarse_region(&restored->scan, region);
}

enum status restored_take(const struct region *region, const struct scanner *scanner, double blur,
                          double void_ratio, struct restored *restored) {
  enum status status = STATUS_OK;
  struct coarse *scan = &restored->scan;
  TRY(restore_run(region, scanner, blur, scan));
  if (scan->levels == NULL) {
    log_warning("the scan is too large for its blur to be taken out in memory: %zux%zux%zu; --crop",
                region->size[0], region->size[1], region->size[2]);
    return STATUS_OK;
  }
  restored->threshold = grey_histogram_quantile(&scan->histogram, void_ratio / (1.0 + void_ratio));
  if (!(restored->threshold > LEAST && restored->threshold < MOST)) {
    const double middle = grey_histogram_porosity(&scan->histogram, 127.5);
    log_warning("the edges of the scan give a void ratio of %.3g, not %.3g: the surface is taken "
                "where the threshold says, with the scanner's blur and noise",
                middle / (1.0 - middle), void_ratio);
    restored_end(restored);
  }
cleanup:
  return status;
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
      const uint8_t *slice = restored->scan.levels + (z + i) * nx * in[1];
      float *row = rows + i * nx;
      struct reduction reduction;
      resampler_begin(&resampler, i, &reduction);
      for (size_t y = 0; y < in[1]; y++) {
        for (size_t x = 0; x < nx; x++) row[x] = (float)slice[y * nx + x];
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
