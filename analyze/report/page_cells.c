#include "analyze/report/page_cells.h"

#include <math.h>

#include "common/memory.h"
#include "common/statistics.h"

static const double colour_top = 0.98;

struct plane plane_along(const struct run *run, int across, int up, size_t side) {
  struct plane plane = {.across = across, .up = up, .normal = 3 - across - up};
  const int axes[2] = {across, up};
  const size_t nx = run->size[across], ny = run->size[up];
  plane.every = ((nx > ny ? nx : ny) + side - 1) / side;
  for (int i = 0; i < 2; i++) {
    const int d = axes[i];
    plane.size[i] = (run->size[d] + plane.every - 1) / plane.every;
    plane.cell[i] = run->spacing[d] * (double)plane.every;
    plane.low[i] = run->origin[d] - 0.5 * run->spacing[d];
  }
  const size_t layer = run->size[plane.normal] / 2;
  plane.at = run->origin[plane.normal] + (double)layer * run->spacing[plane.normal];
  return plane;
}

size_t plane_site(const struct run *run, const struct plane *plane, size_t i, size_t j) {
  const size_t stride[3] = {1, run->size[0], run->size[0] * run->size[1]};
  return i * plane->every * stride[plane->across] + j * plane->every * stride[plane->up] +
         run->size[plane->normal] / 2 * stride[plane->normal];
}

static size_t clamped(double at, size_t size) {
  return (size_t)fmin(fmax(floor(at), 0.0), (double)size - 1.0);
}

enum status plane_cells(const struct plane *plane, const double *points, size_t n, double reach,
                        size_t **cell) {
  enum status status = STATUS_OK;
  TRY(memory_allocate(cell, n, sizeof **cell, "a picture"));
  for (size_t i = 0; i < n; i++) {
    const double *x = &points[3 * i];
    const size_t a = clamped((x[plane->across] - plane->low[0]) / plane->cell[0], plane->size[0]);
    const size_t b = clamped((x[plane->up] - plane->low[1]) / plane->cell[1], plane->size[1]);
    const bool near = fabs(x[plane->normal] - plane->at) <= reach;
    (*cell)[i] = near ? b * plane->size[0] + a : CELL_NONE;
  }
cleanup:
  return status;
}

enum status cells_mean(const size_t *cell, size_t n, const double *values, size_t components,
                       size_t cells, float **means) {
  enum status status = STATUS_OK;
  float *count = NULL;
  TRY(memory_allocate(&count, cells, sizeof *count, "a picture"));
  TRY(memory_allocate(means, components * cells, sizeof **means, "a picture"));
  for (size_t i = 0; i < n; i++) {
    if (cell[i] == CELL_NONE) continue;
    count[cell[i]] += 1.0f;
    for (size_t k = 0; k < components; k++)
      (*means)[components * cell[i] + k] += (float)values[components * i + k];
  }
  for (size_t i = 0; i < components * cells; i++) /* none: 0 / 0 is NAN */
    (*means)[i] /= count[i / components];
cleanup:
  memory_free(&count);
  return status;
}

enum status cells_high(const float *values, size_t n, double *high) {
  enum status status = STATUS_OK;
  double *above = NULL;
  size_t count = 0;
  TRY(memory_allocate(&above, n, sizeof *above, "a picture"));
  for (size_t i = 0; i < n; i++)
    if (fabsf(values[i]) > 0.0f) above[count++] = fabs((double)values[i]); /* not NAN */
  TRY(quantile_find(above, count, colour_top, high));
cleanup:
  memory_free(&above);
  return status;
}
