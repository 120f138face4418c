#include "ct2model/surface/surface_sample.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Slices of a window: it contains the largest islands that count as noise. */
enum { SLICES = 16 };
/* Voxels of all windows together, at most. */
static const double VOXELS_MOST = 12e6;

enum status surface_sample_start(const struct region *region, struct surface_sample *sample) {
  const size_t *n = region->size;
  const bool whole = (double)n[0] * (double)n[1] * (double)n[2] <= VOXELS_MOST;
  size_t free_places[3];
  *sample = (struct surface_sample){.region = region};
  sample->size[2] = n[2] < SLICES || whole ? n[2] : SLICES;
  sample->count = n[2] / sample->size[2];
  if (sample->count > SAMPLE_WINDOWS) sample->count = SAMPLE_WINDOWS;
  double side = floor(sqrt(VOXELS_MOST / (double)(sample->count * sample->size[2])));
  for (int d = 0; d < 2; d++) sample->size[d] = (double)n[d] < side || whole ? n[d] : (size_t)side;
  for (int d = 0; d < 3; d++) free_places[d] = n[d] - sample->size[d];
  for (size_t i = 0; i < sample->count; i++) {
    /* The eight positions along x and along y are in another order than those along z. */
    const size_t part[3] = {3 * i % SAMPLE_WINDOWS, 5 * i % SAMPLE_WINDOWS, i};
    for (int d = 0; d < 3; d++) {
      size_t parts = d < 2 ? SAMPLE_WINDOWS - 1 : sample->count - 1;
      sample->first[i][d] = parts > 0 ? part[d] * free_places[d] / parts : 0;
    }
  }
  return memory_allocate(&sample->greys,
                         sample->count * sample->size[0] * sample->size[1] * sample->size[2],
                         sizeof *sample->greys, "windows of the scan");
}

void surface_sample_end(struct surface_sample *sample) {
  memory_free(&sample->greys);
  sample->count = 0;
}

void surface_sample_keep(struct surface_sample *sample, size_t z, const struct pixel_rows *rows) {
  const size_t nx = sample->size[0], ny = sample->size[1];
  for (size_t i = 0; i < sample->count; i++) {
    const size_t *first = sample->first[i];
    if (z < first[2] || z >= first[2] + sample->size[2]) continue;
    float *out = sample->greys + (i * sample->size[2] + z - first[2]) * nx * ny;
    struct pixel_rows part = *rows;
    part.first = (const char *)part.first + first[0] * pixel_size(part.type);
    for (size_t y = 0; y < ny; y++) pixel_rows_read(&part, first[1] + y, nx, out + y * nx);
  }
}

enum status surface_sample_measure(const struct surface_sample *sample,
                                   const struct wall_request *request, double *surface,
                                   double *error) {
  enum status status = STATUS_OK;
  double surfaces[SAMPLE_WINDOWS] = {0};
  struct wall_request part = *request;
  struct region window = *sample->region;
  part.mirror = true; /* nothing is known beyond a window: its end slices are repeated */
  double sum = 0.0, squares = 0.0, volume = 1.0, n = (double)sample->count;
  for (int d = 0; d < 3; d++) {
    const double share = (double)sample->size[d] / (double)sample->region->size[d];
    window.size[d] = sample->size[d];
    part.size[d] = (size_t)fmax(1.0, round(share * (double)request->size[d]));
    volume *= (double)sample->size[d] * window.voxel[d];
  }
#pragma omp parallel for schedule(dynamic)
  for (size_t i = 0; i < sample->count; i++) {
    struct wall_result walls = {0};
    struct region sampled = window;
    sampled.held_type = PIXEL_F32;
    sampled.held = sample->greys + i * sampled.size[0] * sampled.size[1] * sampled.size[2];
    enum status window_status = wall_measure(&sampled, &part, &walls);
    surfaces[i] = walls.surface_area / volume;
    wall_result_end(&walls);
    if (window_status != STATUS_OK) {
#pragma omp critical
      status = window_status;
    }
  }
  for (size_t i = 0; i < sample->count; i++) {
    sum += surfaces[i];
    squares += surfaces[i] * surfaces[i];
  }
  *surface = sum / n;
  *error = n > 1.0 ? sqrt(fmax(0.0, squares / n - *surface * *surface) / (n - 1.0)) : NAN;
  return status;
}
