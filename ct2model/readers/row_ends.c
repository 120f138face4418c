#include "ct2model/readers/row_ends.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "ct2model/readers/constants.h"

/* Widths that are compared: that of the image, up to ASIDE less or more, and one further width. */
enum { ASIDE = 4, GIVEN = ASIDE, MORE = 2 * ASIDE + 1, WIDTHS, ROWS = 4000, ENDS_LEAST = 3 };

/* If the width is wrong by a few pixels, each row is shifted against the previous one and the image
 * is sheared, which real layers may be, too. But the last pixel of a row and the first one of the
 * next row lie on opposite sides of the body. With the correct width these pairs differ more than
 * neighbours do; with a wrong one they are neighbours. */
struct pairs {
  size_t width[WIDTHS];
  double neighbours, usual; /* number of neighbours within rows, and the sum of their differences */
  double ends[WIDTHS], sum[WIDTHS], square[WIDTHS];
  double below[WIDTHS]; /* sum of differences of pixels one width apart */
};

/* Adds n pixels, the first of which has the index `first` in the file. */
static void add(const float *pixels, size_t n, size_t first, struct pairs *pairs) {
  for (size_t i = 0; i + 1 < n; i++)
    pairs->usual += fabs((double)pixels[i + 1] - (double)pixels[i]);
  pairs->neighbours += (double)(n - 1);
  for (size_t k = 0; k < WIDTHS; k++) {
    const size_t w = pairs->width[k];
    for (size_t i = w - 1 - first % w; i + 1 < n; i += w) {
      const double step = fabs((double)pixels[i + 1] - (double)pixels[i]);
      pairs->ends[k]++;
      pairs->sum[k] += step;
      pairs->square[k] += step * step;
    }
    for (size_t i = 0; k < MORE && i + pairs->width[MORE - 1] < n; i++)
      pairs->below[k] += fabs((double)pixels[i + w] - (double)pixels[i]);
  }
}

/* A width is significant if its row ends differ by five standard errors; for the given width by
 * three. */
static size_t choose(const struct pairs *pairs, bool more) {
  const double usual = pairs->usual / pairs->neighbours;
  double mean[WIDTHS] = {0.0}, deviation[WIDTHS] = {0.0}, most = 1.2 * usual;
  size_t best = 0;
  for (size_t k = 0; k < WIDTHS; k++) {
    mean[k] = pairs->sum[k] / pairs->ends[k];
    deviation[k] =
        sqrt(fmax(0.0, pairs->square[k] / pairs->ends[k] - mean[k] * mean[k]) / pairs->ends[k]);
  }
  const double given = mean[GIVEN] - 3.0 * deviation[GIVEN];
  if (more) return given > fmax(usual, mean[MORE]) ? 0 : pairs->width[MORE];
  if (!(given < usual)) return 0;
  for (size_t k = 0; k < MORE; k++) {
    if (k == GIVEN || !(mean[k] > most) || !(mean[k] - 5.0 * deviation[k] > usual) ||
        !(pairs->below[k] < pairs->below[GIVEN]))
      continue;
    most = mean[k];
    best = pairs->width[k];
  }
  return best;
}

/* Means of the differences between rows that follow one another in the file. Of those at the ends
 * of slices one row lies at one side of the body and the next at the other. */
struct row_steps {
  size_t rows; /* of the file, in all */
  size_t first, count;
  double *step; /* [count]: between rows first + i and first + i + 1 */
};

/* The number of rows in a slice that tells best where large steps are; 0: none does. */
static size_t best_height(const struct row_steps *steps, size_t given) {
  double sum = 0.0, square = 0.0, most = 0.0;
  size_t best = 0;
  for (size_t i = 0; i < steps->count; i++) {
    sum += steps->step[i];
    square += steps->step[i] * steps->step[i];
  }
  const double n = (double)steps->count, mean = sum / n;
  for (size_t h = 2; h <= steps->rows; h++) {
    double ends = 0.0, at_ends = 0.0;
    if (steps->rows % h != 0) continue;
    for (size_t i = h - 1 - steps->first % h; i < steps->count; i += h) {
      ends++;
      at_ends += steps->step[i];
    }
    if (ends < ENDS_LEAST || !(at_ends > ends * mean)) continue;
    /* The variance that the ends explain; the rest is that of rows. */
    const double explained = pow(at_ends - ends * mean, 2.0) * n / (ends * (n - ends));
    const double error = sqrt((square - n * mean * mean - explained) / n / ends);
    const double other = (sum - at_ends) / (n - ends);
    if (!(explained > most)) continue;
    most = explained;
    best =
        at_ends / ends > ROW_STEP_LEAST * other && at_ends / ends - other > ROW_STEP_ERRORS * error
            ? h
            : 0;
  }
  return best == given ? 0 : best;
}

enum status row_ends_height(const struct image *image, size_t *height) {
  enum status status = STATUS_OK;
  const size_t nx = image->size[0], ny = image->size[1], n = nx * ny;
  const size_t wanted = ROWS / ny + 2, pages = image->pages < wanted ? image->pages : wanted;
  struct row_steps steps = {.rows = image->pages * ny};
  void *stored = NULL;
  float *pixels = NULL;
  *height = 0;
  if (image->pages < 2) return STATUS_OK;
  steps.first = (image->pages - pages) / 2 * ny;
  TRY(memory_allocate(&stored, n, pixel_size(image->type), "a slice"));
  TRY(memory_allocate(&pixels, n + nx, sizeof *pixels, "a slice"));
  TRY(memory_allocate(&steps.step, pages * ny, sizeof *steps.step, "rows"));
  for (size_t z = 0; z < pages; z++) {
    memcpy(pixels, pixels + n, nx * sizeof *pixels); /* the last row of the page before */
    TRY(image->reader->read(image, steps.first / ny + z, stored));
    pixels_to_float(pixels + nx, stored, n, image->type);
    for (size_t y = z == 0 ? 1 : 0; y < ny; y++, steps.count++)
      for (size_t x = 0; x < nx; x++)
        steps.step[steps.count] +=
            fabs((double)pixels[(y + 1) * nx + x] - (double)pixels[y * nx + x]) / (double)nx;
  }
  *height = best_height(&steps, ny);
cleanup:
  MEMORY_FREE(&stored, &pixels, &steps.step);
  return status;
}

enum status row_ends_judge(const struct image *image, size_t *width) {
  enum status status = STATUS_OK;
  const size_t rows = image->size[1], n = image->size[0] * rows;
  const size_t step = image->pages / (ROWS / rows + 1) + 1;
  struct pairs pairs = {0};
  void *stored = NULL;
  float *pixels = NULL;
  if (image->size[0] <= 2 * ASIDE || rows <= 2 * ASIDE) return STATUS_OK;
  for (size_t k = 0; k < MORE; k++) pairs.width[k] = image->size[0] - ASIDE + k;
  pairs.width[MORE] = *width > 0 ? *width : image->size[0];
  TRY(memory_allocate(&stored, n, pixel_size(image->type), "a slice"));
  TRY(memory_allocate(&pixels, n, sizeof *pixels, "a slice"));
  for (size_t z = 0; z < image->pages; z += step) {
    TRY(image->reader->read(image, z, stored));
    pixels_to_float(pixels, stored, n, image->type);
    add(pixels, n, z * n, &pairs);
  }
  *width = choose(&pairs, *width > 0);
cleanup:
  memory_free(&stored);
  memory_free(&pixels);
  return status;
}
