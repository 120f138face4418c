#include "ct2model/scanner/windows.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/constants.h"
#include "ct2model/scanner/edge_response.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/restore.h"

size_t window_voxels(const struct window *window) {
  return window->size[0] * window->size[1] * window->size[2];
}

void windows_end(struct windows *all) {
  for (size_t i = 0; i < all->count; i++) {
    MEMORY_FREE(&all->window[i].grey, &all->window[i].smooth, &all->window[i].distance,
                &all->window[i].work);
  }
  all->count = 0;
}

static enum status window_start(struct window *window) {
  enum status status = STATUS_OK;
  const size_t n = window_voxels(window);
  window->grey = window->smooth = window->distance = window->work = NULL;
  TRY(memory_allocate(&window->grey, n, sizeof(float), "a window of the scan"));
  TRY(memory_allocate(&window->smooth, n, sizeof(float), "a window of the scan"));
  TRY(memory_allocate(&window->distance, n, sizeof(float), "a window of the scan"));
  TRY(memory_allocate(&window->work, n, sizeof(float), "a window of the scan"));
cleanup:
  return status;
}

static enum status window_read(const struct region *region, struct window *window) {
  enum status status = STATUS_OK;
  const size_t plane = region->size[0] * region->size[1];
  const size_t nx = window->size[0], ny = window->size[1];
  float *slice = NULL;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t z = 0; z < window->size[2]; z++) {
    const size_t number = window->first[2] + z;
    TRY(region_read(region, &number, 1, slice));
    for (size_t y = 0; y < ny; y++)
      memcpy(window->grey + (z * ny + y) * nx,
             slice + (window->first[1] + y) * region->size[0] + window->first[0],
             nx * sizeof *slice);
  }
cleanup:
  memory_free(&slice);
  return status;
}

static void windows_start(const struct region *region, const struct grey_phases *phases,
                          struct windows *all) {
  *all = (struct windows){.region = region, .pore = phases->pore_peak, .grain = phases->grain_peak};
  all->unit = fmin(region->voxel[0], fmin(region->voxel[1], region->voxel[2]));
  for (int d = 0; d < 3; d++) all->stretch[d] = region->voxel[d] / all->unit;
}

/* Reads one more window, whose position and size are set. */
static enum status windows_add(struct windows *all) {
  enum status status = STATUS_OK;
  struct window *window = &all->window[all->count++];
  TRY(window_start(window));
  TRY(window_read(all->region, window));
  for (size_t v = 0; v < window_voxels(window); v++)
    window->grey[v] = (float)(((double)window->grey[v] - all->pore) / (all->grain - all->pore));
cleanup:
  return status;
}

enum status windows_read_middle(const struct region *region, const struct grey_phases *phases,
                                size_t side, struct windows *all) {
  windows_start(region, phases, all);
  for (int d = 0; d < 3; d++) {
    all->window[0].size[d] = region->size[d] < side ? region->size[d] : side;
    all->window[0].first[d] = (region->size[d] - all->window[0].size[d]) / 2;
  }
  return windows_add(all);
}

enum status windows_read(const struct region *region, const struct grey_phases *phases,
                         struct windows *all) {
  enum status status = STATUS_OK;
  windows_start(region, phases, all);
  /* At most so many windows that their volume is twice that of the region. */
  double times = 1.0;
  for (int d = 0; d < 3; d++)
    times *= fmax(1.0, (double)region->size[d] / (double)(d < 2 ? WINDOW_SIDE : WINDOW_DEPTH));
  const size_t wanted = times > 1.0 ? (size_t)fmin(fmax(ceil(2.0 * times), 3.0), WINDOWS) : 1;
  for (size_t i = 0; i < wanted; i++) {
    struct window *window = &all->window[all->count];
    const size_t last = wanted - 1, spread = i * (WINDOWS - 1) / (last > 0 ? last : 1);
    const size_t place[3] = {3 * spread % WINDOWS + spread / 2 % 2, 5 * spread % WINDOWS, spread};
    for (int d = 0; d < 3; d++) {
      const size_t most = d < 2 ? WINDOW_SIDE : WINDOW_DEPTH, whole = region->size[d];
      window->size[d] = whole < most ? whole : most;
      window->first[d] = wanted > 1 ? (whole - window->size[d]) * place[d] / (WINDOWS - 1) : 0;
      if (window->first[d] + window->size[d] > whole) window->first[d] = whole - window->size[d];
    }
    TRY(windows_add(all));
  }
cleanup:
  return status;
}

void windows_rescale(struct windows *all, double pore, double grain) {
  const double contrast = all->grain - all->pore;
  for (size_t i = 0; i < all->count; i++) {
    struct window *w = &all->window[i];
    for (size_t v = 0; v < window_voxels(w); v++)
      w->grey[v] = (float)(((double)w->grey[v] - pore) / (grain - pore));
  }
  all->grain = all->pore + contrast * grain;
  all->pore += contrast * pore;
}

/* Standard deviation of the smoothing, in voxels, that reduces the noise to a tenth of the
 * contrast, so that surfaces are found where they are and not where the noise puts them; the noise
 * is assumed to be correlated over 0.7 voxels. At least one voxel: distances from unsmoothed greys
 * would depend on the voxel's own noise, and edges would look sharper. */
static double choose_smoothing(double noise_ratio) {
  static const double SMOOTHING[] = {1.0, 1.4, 2.0};
  for (size_t i = 0; i + 1 < sizeof SMOOTHING / sizeof *SMOOTHING; i++)
    if (pow(0.49 / (0.49 + SMOOTHING[i] * SMOOTHING[i]), 0.75) / noise_ratio < SMOOTHED_NOISE)
      return SMOOTHING[i];
  return 2.0;
}

enum status windows_find_surfaces(struct windows *all, double contrast_to_noise, double limit) {
  enum status status = STATUS_OK;
  const double smoothing = choose_smoothing(contrast_to_noise);
  const double sigma[3] = {smoothing / all->stretch[0], smoothing / all->stretch[1],
                           smoothing / all->stretch[2]};
  for (size_t i = 0; i < all->count; i++) {
    struct window *w = &all->window[i];
    gaussian_filter(w->grey, w->size, sigma, w->work, w->smooth);
    if (w->size[2] < 2 || w->size[0] < 8 || w->size[1] < 8) { /* too small to find surfaces in */
      for (size_t v = 0; v < window_voxels(w); v++) w->distance[v] = 0.0f;
      continue;
    }
    TRY(edge_distances(w->smooth, w->size, all->stretch, limit, w->distance));
  }
cleanup:
  return status;
}

/* There may be a surface just outside a window: within a quarter of the window from a side, depths
 * are limited to the distance to that side. */
static void bound_depth(const struct window *w, const double stretch[3]) {
  for (size_t i = 0; i < w->size[0] * w->size[1] * w->size[2]; i++) {
    const size_t at[3] = {i % w->size[0], i / w->size[0] % w->size[1], i / w->size[0] / w->size[1]};
    for (int d = 0; d < 3; d++) {
      const size_t last = w->size[d] - 1, side = at[d] < last - at[d] ? at[d] : last - at[d];
      const float most = (float)(((double)side + 0.5) * stretch[d]);
      if (4 * side < last && fabsf(w->distance[i]) > most)
        w->distance[i] = copysignf(most, w->distance[i]);
    }
  }
}

void windows_bound_depth(struct windows *all) {
  for (size_t i = 0; i < all->count; i++) bound_depth(&all->window[i], all->stretch);
}

/* The smallest grey and the next one, and the number of voxels of each. */
struct end_grey {
  double grey, next, count, next_count;
};
static void end_grey_add(struct end_grey *last, double grey) {
  if (grey < last->grey) {
    last->next = last->grey, last->next_count = last->count;
    last->grey = grey, last->count = 0.0;
  } else if (grey > last->grey && grey < last->next) {
    last->next = grey, last->next_count = 0.0;
  }
  last->count += grey == last->grey;
  last->next_count += grey == last->next;
}

void windows_find_clipping(const struct windows *all, double ends[2]) {
  for (int side = 0; side < 2; side++) {
    const double sign = side == 0 ? 1.0 : -1.0;
    struct end_grey last = {INFINITY, INFINITY, 0.0, 0.0};
    double n = 0.0;
    for (size_t i = 0; i < all->count; i++) {
      const struct window *w = &all->window[i];
      for (size_t v = 0; v < window_voxels(w); v++) end_grey_add(&last, sign * (double)w->grey[v]);
      n += (double)window_voxels(w);
    }
    const bool cut = last.count > CLIPPED_FRACTION * n && last.count > last.next_count;
    ends[side] = sign * (cut ? last.grey : -INFINITY);
  }
}

/* Nearly normal deviate of variance 1: the sum of four uniform numbers (Steele, Lea and Flood 2014,
 * SplitMix64). */
static float deviate(uint64_t n) {
  double sum = -2.0;
  for (uint64_t k = 1; k <= 4; k++) {
    uint64_t z = (4 * n + k) * 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
    sum += (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
  }
  return (float)(sum * 1.7320508075688772);
}

static void add_noise(struct window *w, const double stretch[3], double noise, double length,
                      uint64_t first) {
  const size_t n = window_voxels(w);
  double sigma[3], square = 0.0;
  for (int d = 0; d < 3; d++) sigma[d] = length / stretch[d];
  for (size_t v = 0; v < n; v++) w->smooth[v] = deviate(first + v);
  gaussian_filter(w->smooth, w->size, sigma, w->work, w->smooth);
  for (size_t v = 0; v < n; v++) square += (double)w->smooth[v] * (double)w->smooth[v];
  const float scale = (float)(noise / sqrt(square / (double)n));
  for (size_t v = 0; v < n; v++) w->grey[v] += scale * w->smooth[v];
}

size_t windows_step(const struct windows *scan) {
  return scan->count > WINDOWS / 2 ? 2 : 1;
}

enum status windows_simulate(const struct windows *scan, double blur, double fringe, double noise,
                             double length, struct windows *simulated) {
  enum status status = STATUS_OK;
  double sigma[3], weight[3];
  *simulated = *scan;
  simulated->count = 0;
  simulated->pore = 0.0;
  simulated->grain = 1.0;
  for (int d = 0; d < 3; d++) {
    sigma[d] = blur / scan->stretch[d];
    weight[d] = fringe * sigma[d] * sigma[d];
  }
  for (size_t i = 0; i < scan->count; i += windows_step(scan)) {
    const float *distance = scan->window[i].distance;
    struct window *w = &simulated->window[simulated->count];
    *w = scan->window[i];
    simulated->count++;
    TRY(window_start(w));
    for (size_t v = 0; v < window_voxels(w); v++)
      w->smooth[v] = fminf(fmaxf(0.5F - distance[v], 0.0F), 1.0F);
    gaussian_filter(w->smooth, w->size, sigma, w->work, w->smooth);
    laplacian_subtract(w->smooth, w->size, weight, w->grey);
    add_noise(w, scan->stretch, noise, length,
              i * (uint64_t)WINDOW_SIDE * WINDOW_SIDE * WINDOW_DEPTH);
  }
cleanup:
  return status;
}

enum status grain_window(const struct window *window, const double stretch[3],
                         const struct deblur_scanner *scanner, struct deblur *deblur,
                         float *distance) {
  enum status status = STATUS_OK;
  memcpy(deblur->size, window->size, sizeof deblur->size);
  memcpy(deblur->grey, window->grey, window_voxels(window) * sizeof *window->grey);
  deblur->scanner = *scanner;
  deblur->iterations = ITERATIONS_COMPARED;
  deblur->compared = true;
  TRY(deblur_run(deblur));
  TRY(edge_distances(deblur->share, window->size, stretch, WALL_RANGE, distance));
cleanup:
  return status;
}

enum status grain_windows(const struct windows *scan, const struct scanner *scanner,
                          struct windows *grains) {
  enum status status = STATUS_OK;
  struct deblur deblur = {0};
  struct deblur_scanner work;
  *grains = *scan;
  grains->count = 0;
  /* All windows have one size. */
  restore_scanner(scan->region, scanner, scanner->blur, &work);
  TRY(deblur_start(window_voxels(&scan->window[0]), &work, &deblur));
  for (size_t i = 0; i < scan->count; i += windows_step(scan)) {
    struct window *w = &grains->window[grains->count++];
    *w = (struct window){0};
    memcpy(w->size, scan->window[i].size, sizeof w->size);
    TRY(memory_allocate(&w->distance, window_voxels(w), sizeof(float), "a window of the scan"));
    TRY(grain_window(&scan->window[i], scan->stretch, &work, &deblur, w->distance));
  }
cleanup:
  deblur_end(&deblur);
  return status;
}
