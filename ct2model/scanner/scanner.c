#include "ct2model/scanner/scanner.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/calibrate/calibrate.h"
#include "ct2model/scanner/gaussian.h"
#include "ct2model/scanner/noise.h"

enum { WINDOWS = 6, SIDE = 96, DEPTH = 40, WINDOWS_LEAST = 3 };

/* One window of the scan, greys 0 in the pore and 1 in the grain. */
struct window {
  size_t first[3], size[3];
  float *grey, *smooth, *distance, *work;
};

struct windows {
  const struct region *region;
  double stretch[3], unit, pore, grain;
  size_t count;
  struct window window[WINDOWS];
};

static void windows_end(struct windows *all) {
  for (size_t i = 0; i < all->count; i++) {
    memory_free(&all->window[i].grey);
    memory_free(&all->window[i].smooth);
    memory_free(&all->window[i].distance);
    memory_free(&all->window[i].work);
  }
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

/* Windows from corner to corner of the region. */
static enum status windows_read(const struct region *region, const struct grey_phases *phases,
                                struct windows *all) {
  enum status status = STATUS_OK;
  const double contrast = phases->grain_peak - phases->pore_peak;
  *all = (struct windows){.region = region, .pore = phases->pore_peak, .grain = phases->grain_peak};
  all->unit = fmin(region->voxel[0], fmin(region->voxel[1], region->voxel[2]));
  for (int d = 0; d < 3; d++) all->stretch[d] = region->voxel[d] / all->unit;
  /* No more than would see all of the region twice. */
  double times = 1.0;
  for (int d = 0; d < 3; d++)
    times *= fmax(1.0, (double)region->size[d] / (double)(d < 2 ? SIDE : DEPTH));
  const size_t wanted = times > 1.0 ? (size_t)fmin(fmax(ceil(2.0 * times), 3.0), WINDOWS) : 1;
  for (size_t i = 0; i < wanted; i++) {
    struct window *window = &all->window[i];
    const size_t last = wanted - 1, spread = i * (WINDOWS - 1) / (last > 0 ? last : 1);
    const size_t part[3] = {3 * spread % WINDOWS + spread / 2 % 2, 5 * spread % WINDOWS, spread};
    size_t n = 1;
    all->count++;
    for (int d = 0; d < 3; d++) {
      const size_t most = d < 2 ? SIDE : DEPTH, whole = region->size[d];
      window->size[d] = whole < most ? whole : most;
      window->first[d] = wanted > 1 ? (whole - window->size[d]) * part[d] / (WINDOWS - 1) : 0;
      if (window->first[d] + window->size[d] > whole) window->first[d] = whole - window->size[d];
      n *= window->size[d];
    }
    TRY(memory_allocate(&window->grey, n, sizeof(float), "a window of the scan"));
    TRY(memory_allocate(&window->smooth, n, sizeof(float), "a window of the scan"));
    TRY(memory_allocate(&window->distance, n, sizeof(float), "a window of the scan"));
    TRY(memory_allocate(&window->work, n, sizeof(float), "a window of the scan"));
    TRY(window_read(region, window));
    for (size_t v = 0; v < n; v++)
      window->grey[v] = (float)(((double)window->grey[v] - all->pore) / contrast);
  }
cleanup:
  return status;
}

/* Smoothing that leaves noise of a tenth of the contrast, so that surfaces are found where they are
 * and not where noise is; noise correlated over 0.7 voxels is taken for granted. A voxel at least:
 * a distance from the voxel's own grey would know of its noise, and edges look sharper. */
static double choose_smoothing(double noise_ratio) {
  static const double TRIED[] = {1.0, 1.4, 2.0};
  for (size_t i = 0; i + 1 < sizeof TRIED / sizeof *TRIED; i++)
    if (pow(0.49 / (0.49 + TRIED[i] * TRIED[i]), 0.75) / noise_ratio < 0.1) return TRIED[i];
  return 2.0;
}

static enum status find_surfaces(struct windows *all, double smoothing) {
  enum status status = STATUS_OK;
  const double sigma[3] = {smoothing / all->stretch[0], smoothing / all->stretch[1],
                           smoothing / all->stretch[2]};
  for (size_t i = 0; i < all->count; i++) {
    struct window *w = &all->window[i];
    gaussian_filter(w->grey, w->size, sigma, w->work, w->smooth);
    if (w->size[2] < 2 || w->size[0] < 8 || w->size[1] < 8) { /* no volume to find surfaces in */
      const size_t n = w->size[0] * w->size[1] * w->size[2];
      for (size_t v = 0; v < n; v++) w->distance[v] = 0.0f;
      continue;
    }
    TRY(edge_distances(w->smooth, w->size, all->stretch, EDGE_REACH + 2.0, w->distance));
  }
cleanup:
  return status;
}

/* Standard deviation of the blur itself: the voxel averages over its own width, 1/12, and the bins
 * over theirs. */
static double blur_of(const struct edge_fit *fit) {
  const double own = (1.0 + 1.0 / (EDGE_FINE * EDGE_FINE)) / 12.0;
  return sqrt(fmax(fit->deviation * fit->deviation - own, 0.01));
}

/* The response of all windows, its fit, and how far the windows' own fits scatter about it. */
static bool fit_windows(const struct windows *all, double reach, struct scanner *scanner,
                        struct edge_fit *fit) {
  double sum = 0.0, square = 0.0, n = 0.0;
  scanner->response = (struct edge_response){0};
  for (size_t i = 0; i < all->count; i++) {
    const struct window *w = &all->window[i];
    struct edge_response own = {0};
    struct edge_fit mine;
    edge_response_add(w->grey, w->smooth, w->distance, w->size, all->stretch, reach, &own);
    for (size_t b = 0; b < EDGE_BINS; b++) {
      scanner->response.sum[b] += own.sum[b];
      scanner->response.count[b] += own.count[b];
    }
    if (!edge_fit_find(&own, reach, &mine)) continue;
    sum += blur_of(&mine);
    square += blur_of(&mine) * blur_of(&mine);
    n += 1.0;
  }
  if (!edge_fit_find(&scanner->response, reach, fit)) return false;
  const double mean = sum / fmax(n, 1.0), own = blur_of(fit);
  const double scatter = n > 1.0 ? sqrt(fmax(square / n - mean * mean, 0.0) / (n - 1.0)) : 0.0;
  scanner->blur = own * all->unit;
  /* Few windows say little of their scatter: a twentieth at least. */
  scanner->blur_error = fmax(scatter, (n < WINDOWS_LEAST ? 0.1 : 0.05) * own) * all->unit;
  scanner->fringe = fmax(fit->fringe, 0.0);
  return true;
}

/* Beyond a window's sides there may be a surface: no voxel is known to lie deeper than the side is
 * far, within a quarter of the window. */
static void bound_depth(const struct windows *all, const struct window *w) {
  for (size_t i = 0; i < w->size[0] * w->size[1] * w->size[2]; i++) {
    const size_t at[3] = {i % w->size[0], i / w->size[0] % w->size[1], i / w->size[0] / w->size[1]};
    for (int d = 0; d < 3; d++) {
      const size_t last = w->size[d] - 1, side = at[d] < last - at[d] ? at[d] : last - at[d];
      const float most = (float)(((double)side + 0.5) * all->stretch[d]);
      if (4 * side < last && fabsf(w->distance[i]) > most)
        w->distance[i] = copysignf(most, w->distance[i]);
    }
  }
}

static void measure_noise(const struct windows *all, double noise_ratio, const struct edge_fit *fit,
                          struct scanner *scanner) {
  struct noise_sums sums = {0};
  const double levels[2] = {fit->pore, fit->grain}, most = fmax(0.5, 4.5 / noise_ratio);
  for (size_t i = 0; i < all->count; i++) bound_depth(all, &all->window[i]);
  for (int phase = 0; phase < 2 && sums.count < 2000.0; phase++)
    for (double depth = 3.0; depth >= 2.0 && sums.count < 2000.0; depth -= 0.5) {
      sums = (struct noise_sums){0};
      for (size_t i = 0; i < all->count; i++)
        noise_add(all->window[i].grey, all->window[i].distance, all->window[i].size,
                  fmax(depth * fit->deviation, 1.5), phase ? -1.0 : 1.0, levels[phase], most,
                  &sums);
    }
  const double contrast = all->grain - all->pore;
  double length = 0.0, axes = 0.0;
  for (int a = 0; a < 3; a++) {
    if (sums.pairs[a] < 30.0) continue;
    length += noise_length(&sums, a) * all->region->voxel[a];
    axes += 1.0;
  }
  scanner->noise = noise_deviation(&sums) * contrast;
  scanner->noise_correlation = axes > 0.0 ? length / axes : NAN;
  scanner->contrast_to_noise = (fit->grain - fit->pore) * contrast / scanner->noise;
}

static double resolution_of(const struct edge_fit *fit) {
  double low = 0.0, high = 4.0 / fit->deviation; /* cycles a voxel */
  for (int i = 0; i < 60; i++) {
    const double middle = 0.5 * (low + high);
    if (edge_fit_transfer(fit, middle) > 0.1)
      low = middle;
    else
      high = middle;
  }
  return 1.0 / high;
}

enum status scanner_measure(const struct region *region, const struct grey_phases *phases,
                            struct scanner *scanner) {
  enum status status = STATUS_OK;
  struct windows all = {0};
  struct edge_fit fit;
  *scanner = (struct scanner){.blur = NAN,
                              .blur_error = NAN,
                              .fringe = NAN,
                              .pore = NAN,
                              .grain = NAN,
                              .noise = NAN,
                              .contrast_to_noise = NAN,
                              .noise_correlation = NAN,
                              .resolution = NAN};
  if (!(phases->contrast_to_noise > 0.0)) return STATUS_OK;
  TRY(windows_read(region, phases, &all));
  TRY(find_surfaces(&all, choose_smoothing(phases->contrast_to_noise)));
  /* First over a middling reach, then over that of the blur found. */
  double reach = 5.0;
  bool found = fit_windows(&all, reach, scanner, &fit);
  if (!found) found = fit_windows(&all, reach = 3.0, scanner, &fit);
  for (int again = 0; found && again < 2; again++) {
    const double wanted = fmin(fmax(3.2 * fit.deviation, 3.5), EDGE_REACH);
    struct scanner other = *scanner;
    struct edge_fit its;
    if (fabs(wanted / reach - 1.0) < 0.1 || !fit_windows(&all, wanted, &other, &its)) break;
    *scanner = other;
    fit = its;
    reach = wanted;
  }
  if (!found || !(fit.grain - fit.pore > 0.3)) goto cleanup;
  measure_noise(&all, phases->contrast_to_noise, &fit, scanner);
  if (!(scanner->noise > 0.0)) goto cleanup;
  scanner->known = true;
  scanner->unit = all.unit;
  scanner->pore = all.pore + fit.pore * (all.grain - all.pore);
  scanner->grain = all.pore + fit.grain * (all.grain - all.pore);
  scanner->resolution = resolution_of(&fit) * all.unit;
cleanup:
  if (!scanner->known) scanner->blur = scanner->blur_error = scanner->fringe = NAN;
  windows_end(&all);
  return status;
}
