#include "ct2model/calibrate/sweep_table.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/output_file.h"

enum { ROWS = 256, MOST_ROWS = 2 * ROWS + 1 };

/* Chooses greys of the region first, first + step, ... at each of which both phases occur. */
static void choose_rows(const struct sweep_source *source, double *first, double *step,
                        size_t *count) {
  const struct grey_histogram *histogram = source->histogram;
  double low = grey_histogram_quantile(histogram, 0.0005);
  double high = grey_histogram_quantile(histogram, 0.9995);
  if (histogram->width == 1.0 && high - low < 2.0 * ROWS) {
    *first = floor(low) + 0.5;
    *step = 1.0;
    *count = (size_t)fmax(1.0, floor(high - *first) + 1.0);
  } else {
    *first = low;
    *step = (high - low) / (ROWS - 1);
    *count = ROWS;
  }
}

/* Counts voxels of the mirrored volume: counts[i] above row i - 1 and up to row i. */
static void count_volume(const struct sweep_source *source, double first, double step, size_t rows,
                         double *counts, double *total) {
  const struct mirroring *mirroring = &source->mirroring;
  const size_t nx = mirroring->size[0], ny = mirroring->size[1];
#pragma omp parallel for schedule(static)
  for (size_t z = 0; z < mirroring->size[2]; z++) {
    uint64_t below[MOST_ROWS] = {0}, all = 0;
    for (size_t y = 0; y < ny; y++) {
      const float *greys = source->volume + (z * ny + y) * nx;
      const unsigned often = mirroring_count(mirroring, 1, y) * mirroring_count(mirroring, 2, z);
      for (size_t x = 0; x < nx; x++) {
        const unsigned count = often * mirroring_count(mirroring, 0, x);
        double row = ceil(((double)greys[x] - first) / step);
        if (row < (double)rows) below[row > 0.0 ? (size_t)row : 0] += count;
        all += count;
      }
    }
#pragma omp critical(volume_counts) /* integer sums do not depend on the order */
    {
      for (size_t i = 0; i < rows; i++) counts[i] += (double)below[i];
      *total += (double)all;
    }
  }
}

static void reverse(double *values, size_t n) {
  for (size_t i = 0; i < n / 2; i++) {
    double swap = values[i];
    values[i] = values[n - 1 - i];
    values[n - 1 - i] = swap;
  }
}

static double void_ratio_of(double pores, double total) {
  return total > pores ? pores / (total - pores) : INFINITY;
}

enum status sweep_table_make(const struct sweep_source *source, struct sweep_table *table) {
  enum status status = STATUS_OK;
  const struct grey_histogram *histogram = source->histogram;
  double first, step;
  memset(table, 0, sizeof *table);
  choose_rows(source, &first, &step, &table->count);
  size_t n = table->count;
  TRY(memory_allocate(&table->threshold, n, sizeof(double), "the sweep"));
  TRY(memory_allocate(&table->void_ratio, n, sizeof(double), "the sweep"));
  TRY(memory_allocate(&table->histogram, n, sizeof(double), "the sweep"));
  double total = (double)histogram->total, last = 0.0;
  for (size_t i = 0; i < n; i++) {
    double grey = first + step * (double)i;
    double pores = total * grey_histogram_porosity(histogram, grey);
    table->threshold[i] = source->unit * grey;
    table->void_ratio[i] = void_ratio_of(pores, total);
    table->histogram[i] = pores - last;
    last = pores;
  }
  if (source->volume != NULL) {
    TRY(memory_allocate(&table->void_ratio_resampled, n, sizeof(double), "the sweep"));
    TRY(memory_allocate(&table->histogram_resampled, n, sizeof(double), "the sweep"));
    total = 0.0;
    count_volume(source, first, step, n, table->histogram_resampled, &total);
    double pores = 0.0;
    for (size_t i = 0; i < n; i++) {
      pores += table->histogram_resampled[i];
      table->void_ratio_resampled[i] = void_ratio_of(pores, total);
    }
  }
  if (source->dark_grains) {
    double *columns[] = {table->threshold, table->void_ratio, table->histogram,
                         table->void_ratio_resampled, table->histogram_resampled};
    for (size_t c = 0; c < sizeof columns / sizeof *columns; c++)
      if (columns[c] != NULL) reverse(columns[c], n);
  }
cleanup:
  if (status != STATUS_OK) sweep_table_end(table);
  return status;
}

void sweep_table_end(struct sweep_table *table) {
  MEMORY_FREE(&table->threshold, &table->void_ratio, &table->histogram,
              &table->void_ratio_resampled, &table->histogram_resampled);
}

enum status sweep_table_write(const struct sweep_table *table, const char *path) {
  enum status status = STATUS_OK;
  bool both = table->void_ratio_resampled != NULL;
  char *text = NULL;
  size_t size = 0;
  FILE *stream = open_memstream(&text, &size);
  if (stream == NULL) return FAIL(STATUS_RUN, "out of memory for the table");
  fprintf(stream, "threshold,void_ratio,histogram%s\n",
          both ? ",void_ratio_resampled,histogram_resampled" : "");
  for (size_t i = 0; i < table->count; i++) {
    fprintf(stream, "%.8g,%.8g,%.10g", table->threshold[i], table->void_ratio[i],
            table->histogram[i]);
    if (both)
      fprintf(stream, ",%.8g,%.10g", table->void_ratio_resampled[i], table->histogram_resampled[i]);
    fputc('\n', stream);
  }
  if (fclose(stream) != 0) TRY_FAIL(STATUS_RUN, "out of memory for the table");
  TRY(output_write(path, text, size));
cleanup:
  free(text);
  return status;
}
