#include "ct2model/scan.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "ct2model/resample/reduce.h"
#include "ct2model/scan/slice_check.h"

enum { BATCH_LEAST = 4, BATCH_MOST = 128 };
static const double BATCH_BYTES = 16e6; /* memory for the reduced slices of a batch */

/* Data of one thread. */
struct worker {
  char *buffer;      /* the slice as read */
  float *row, *sums; /* row: one row of greys; sums: those of a coarse slice */
  uint32_t *levels;  /* counts if the region has levels; otherwise `greys` is used */
  uint64_t held;     /* pixels in `levels` */
  struct grey_histogram greys;
};

struct scan {
  const struct region *region;
  struct pipeline *pipeline;
  struct resampler resampler;
  struct slice_check check; /* for greys in the scan's own slices; otherwise empty */
  bool has_levels;
  double low, high; /* levels */
  size_t batch, worker_count;
  struct worker *workers;
};

/* Starts a histogram for too many levels for one bin each: the bins span the range of a few slices
 * and a margin. */
static enum status start_bins(struct scan *scan) {
  enum status status = STATUS_OK;
  const struct region *region = scan->region;
  const size_t bins = 1u << 18, slices = 8, plane = region->size[0] * region->size[1];
  double low = INFINITY, high = -INFINITY;
  float *slice = NULL;
  TRY(memory_allocate(&slice, plane, sizeof *slice, "a slice"));
  for (size_t i = 0; i < slices; i++) {
    size_t z = i * (region->size[2] - 1) / (slices - 1);
    TRY(region_read(region, &z, 1, slice));
    for (size_t p = 0; p < plane; p++) {
      low = fmin(low, (double)slice[p]);
      high = fmax(high, (double)slice[p]);
    }
  }
  double margin = high > low ? 0.05 * (high - low) : 0.5;
  TRY(grey_histogram_start(low - margin, (high - low + 2.0 * margin) / (double)bins, bins,
                           &scan->pipeline->histogram));
cleanup:
  memory_free(&slice);
  return status;
}

static enum status scan_start(struct pipeline *pipeline, struct scan *scan) {
  enum status status = STATUS_OK;
  const struct region *region = &pipeline->region;
  const size_t plane = region->size[0] * region->size[1];
  const double reduced = (double)pipeline->size[0] * (double)pipeline->size[1] * sizeof(float);
  struct grey_histogram *histogram = &pipeline->histogram;
  *scan = (struct scan){.region = region, .pipeline = pipeline};
  scan->batch = (size_t)fmin(BATCH_MOST, fmax(BATCH_LEAST, floor(BATCH_BYTES / reduced)));
  scan->batch -= scan->batch % pipeline->coarse.step; // NOLINT: a step is one slice at least
  if (!pipeline->labels.on && region->held == NULL)
    TRY(slice_check_start(region->size[2], &scan->check));
  scan->has_levels = region_has_levels(region);
  if (pixel_levels(pipeline->labels.on ? PIXEL_U8 : pipeline->stack.type, &scan->low,
                   &scan->high)) {
    double first = region->scale < 0.0 ? -scan->high : scan->low;
    TRY(grey_histogram_start(first - 0.5, 1.0, (size_t)(scan->high - scan->low) + 1, histogram));
  } else {
    TRY(start_bins(scan));
  }
  TRY(memory_allocate(&pipeline->middle, plane, sizeof *pipeline->middle, "the middle slice"));
  if (pipeline->resampled) {
    size_t sites = pipeline->size[0] * pipeline->size[1] * pipeline->size[2];
    TRY(memory_allocate(&pipeline->volume, sites, sizeof *pipeline->volume, "the resampled model"));
    TRY(resampler_start(pipeline->request->filter, region->size, pipeline->size, scan->batch,
                        &scan->resampler));
  }
  size_t threads = (size_t)omp_get_max_threads();
  TRY(memory_allocate(&scan->workers, threads, sizeof *scan->workers, "threads' slices"));
  for (; scan->worker_count < threads; scan->worker_count++) {
    struct worker *worker = &scan->workers[scan->worker_count];
    TRY(memory_allocate(&worker->buffer, region_buffer_size(region), 1, "a slice"));
    TRY(memory_allocate(&worker->row, region->size[0], sizeof *worker->row, "a row"));
    TRY(memory_allocate(&worker->sums, coarse_sums(&pipeline->coarse), sizeof *worker->sums,
                        "an averaged slice"));
    if (scan->has_levels)
      TRY(memory_allocate(&worker->levels, PIXEL_COUNTS, sizeof *worker->levels, "a histogram"));
    else
      TRY(grey_histogram_start(histogram->low, histogram->width, histogram->bins, &worker->greys));
  }
cleanup:
  return status;
}

static void scan_end(struct scan *scan) {
  size_t threads = scan->workers != NULL ? (size_t)omp_get_max_threads() : 0;
  for (size_t i = 0; i < threads; i++) {
    MEMORY_FREE(&scan->workers[i].buffer, &scan->workers[i].row, &scan->workers[i].sums,
                &scan->workers[i].levels);
    grey_histogram_end(&scan->workers[i].greys);
  }
  memory_free(&scan->workers);
  resampler_end(&scan->resampler);
  slice_check_end(&scan->check);
}

/* Moves a worker's counts into the pipeline's histogram; integer sums have no order. */
static void gather_counts(const struct scan *scan, struct worker *worker) {
  struct grey_histogram *histogram = &scan->pipeline->histogram;
  const size_t bins = histogram->bins;
#pragma omp critical
  {
    for (size_t b = 0; b < bins && worker->levels != NULL; b++) {
      uint64_t count = pixels_counted(worker->levels, b, scan->region->stack->type);
      histogram->counts[scan->region->scale < 0.0 ? bins - 1 - b : b] += count;
    }
    for (size_t b = 0; b < bins && worker->levels == NULL; b++)
      histogram->counts[b] += worker->greys.counts[b];
    histogram->total += worker->levels != NULL ? worker->held : worker->greys.total;
  }
  if (worker->levels != NULL) memset(worker->levels, 0, PIXEL_COUNTS * sizeof *worker->levels);
  worker->held = 0;
}

static enum status take_slice(struct scan *scan, size_t z, size_t place) {
  enum status status = STATUS_OK;
  const struct region *region = scan->region;
  const size_t nx = region->size[0], ny = region->size[1];
  struct worker *worker = &scan->workers[omp_get_thread_num()];
  struct coarse *coarse = &scan->pipeline->coarse;
  struct pixel_rows rows;
  TRY(region_read_rows(region, z, worker->buffer, &rows));
  if (scan->check.count > 0) slice_check_add(&scan->check, z, &rows, region->size);
  if (worker->held + nx * ny > UINT32_MAX) gather_counts(scan, worker);
  worker->held += nx * ny;
  const bool wanted = scan->pipeline->resampled && resampler_wants(&scan->resampler, z);
  const bool by_rows = wanted && resampler_takes_rows(&scan->resampler);
  struct reduction reduction;
  if (by_rows) resampler_begin(&scan->resampler, place, &reduction);
  for (size_t y = 0; y < ny; y++) {
    const float *greys = by_rows || !scan->has_levels || coarse->step > 1
                             ? pixel_rows_at(&rows, y, nx, worker->row)
                             : NULL;
    if (scan->has_levels)
      pixels_count(worker->levels, (const char *)rows.first + y * rows.stride, nx, rows.type);
    else
      grey_histogram_add(&worker->greys, greys, nx);
    if (by_rows) reduction_add(&reduction, greys);
    if (coarse->step > 1) coarse_add(coarse, y, z, greys, worker->sums);
  }
  if (coarse->step > 1 && (z + 1) % coarse->step == 0)
    coarse_store(coarse, z / coarse->step, worker->sums);
  if (wanted && !by_rows) TRY(resampler_point(&scan->resampler, &rows, place));
  surface_sample_keep(&scan->pipeline->sample, z, &rows);
  for (size_t y = 0; y < ny && z == region->size[2] / 2; y++)
    pixel_rows_read(&rows, y, nx, scan->pipeline->middle + y * nx);
cleanup:
  return status;
}

enum status scan_take(struct pipeline *pipeline) {
  enum status status = STATUS_OK;
  struct scan scan;
  struct progress progress;
  const size_t slices = pipeline->region.size[2], step = pipeline->coarse.step;
  TRY(scan_start(pipeline, &scan));
  progress_start(&progress, "reading", "slices", (double)slices);
  for (size_t z = 0; z < slices; z += scan.batch) {
    size_t n = slices - z < scan.batch ? slices - z : scan.batch;
#pragma omp parallel for schedule(dynamic)
    for (size_t first = 0; first < n; first += step) { /* one thread per coarse slice */
      enum status slice_status = STATUS_OK;
      for (size_t i = first; i < first + step && slice_status == STATUS_OK; i++)
        slice_status = take_slice(&scan, z + i, i);
      if (slice_status != STATUS_OK) {
#pragma omp critical
        status = slice_status;
      }
    }
    if (status != STATUS_OK) goto cleanup;
    if (pipeline->resampled) resampler_add(&scan.resampler, z, n, pipeline->volume);
    progress_update(&progress, (double)(z + n), NULL);
  }
  for (size_t i = 0; i < scan.worker_count; i++) gather_counts(&scan, &scan.workers[i]);
  progress_end(&progress);
  TRY(slice_check_warn(&scan.check, &pipeline->region));
cleanup:
  scan_end(&scan);
  return status;
}
