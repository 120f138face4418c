#include "sphsolve/isph/cells.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/kernel.h"

static int clamp_index(double value, int count) {
  if (!(value > 0)) return 0;
  return value < count - 1 ? (int)value : count - 1;
}

uint32_t isph_cell_of(const struct isph_cells *cells, const double x[3]) {
  int at[3];
  for (int a = 0; a < 3; a++)
    at[a] = clamp_index((x[a] - cells->origin[a]) / cells->size[a], cells->count[a]);
  const int *axis = cells->axis, *n = cells->count;
  return (uint32_t)((at[axis[2]] * n[axis[1]] + at[axis[1]]) * n[axis[0]] + at[axis[0]]);
}

enum status isph_cells_shape(const struct isph *s, double margin, struct isph_cells *cells) {
  double wanted = 0.5 * s->scene->isph.support_ratio * s->spacing;
  double total = 1;
  for (int a = 0; a < 3; a++) {
    double beyond = s->periodic[a] || (s->dimensions == 2 && a == 1) ? 0 : margin;
    double length = s->high[a] - s->low[a] + 2 * beyond;
    cells->count[a] = (int)fmax(1, floor(length / wanted));
    cells->origin[a] = s->low[a] - beyond;
    cells->size[a] = length / cells->count[a];
    total *= cells->count[a];
  }
  /* Ranks divide the domain into layers across its longest axis, since these have the fewest cells.
   */
  int longest = 2;
  for (int a = 1; a >= 0; a--)
    if (cells->count[a] > cells->count[longest]) longest = a;
  cells->axis[0] = longest == 0 ? 1 : 0;
  cells->axis[1] = longest == 2 ? 1 : 2;
  cells->axis[2] = longest;
  if (total > 1e9)
    return FAIL(STATUS_INPUT,
                "domain: %.2g cells of %.3g m; make the domain smaller or the "
                "spacing wider",
                total, wanted);
  return memory_allocate(&cells->start, (size_t)total + 1, sizeof *cells->start, "cells");
}

void isph_cells_sort(const struct isph_cells *cells, size_t n, const uint32_t *cell,
                     uint32_t *order) {
  size_t total = (size_t)cells->count[0] * (size_t)cells->count[1] * (size_t)cells->count[2];
  memset(cells->start, 0, (total + 1) * sizeof *cells->start);
  for (size_t i = 0; i < n; i++) cells->start[cell[i] + 1]++;
  for (size_t c = 0; c < total; c++) cells->start[c + 1] += cells->start[c];
  for (size_t i = 0; i < n; i++) order[cells->start[cell[i]]++] = (uint32_t)i;
  for (size_t c = total; c > 0; c--) cells->start[c] = cells->start[c - 1];
  cells->start[0] = 0;
}

enum status isph_sort_walls(struct isph *s) {
  enum status status = STATUS_OK;
  uint32_t *cell = NULL;
  if (s->wall_cells.start == NULL) TRY(isph_cells_shape(s, s->support_max, &s->wall_cells));
  size_t n = s->boundary_count;
  if (s->wall_order == NULL)
    TRY(memory_allocate(&s->wall_order, n, sizeof *s->wall_order, "walls"));
  TRY(memory_allocate(&cell, n, sizeof *cell, "walls"));
  for (size_t j = 0; j < n; j++) cell[j] = isph_cell_of(&s->wall_cells, s->boundary_position[j]);
  isph_cells_sort(&s->wall_cells, n, cell, s->wall_order);
cleanup:
  memory_free(&cell);
  return status;
}

/* Distance of x from the interval 0 .. size. */
static inline double outside(double x, double size) {
  return x < 0 ? -x : x > size ? x - size : 0;
}

size_t isph_cells_collect(const struct isph *s, const struct isph_cells *cells,
                          const uint32_t *order, double (*x)[3], const double xi[3], double reach,
                          uint32_t *candidates) {
  size_t found = 0;
  double reach2 = reach * reach;
  const int x0 = cells->axis[0], b = cells->axis[1], c = cells->axis[2];
  int from[3], to[3];
  for (int a = 0; a < 3; a++) {
    const bool images = s->periodic[a] || s->reflects[a];
    from[a] = images && xi[a] - reach < s->low[a] ? -1 : 0;
    to[a] = images && xi[a] + reach > s->high[a] ? 1 : 0;
  }
  for (int sz = from[2]; sz <= to[2]; sz++)
    for (int sy = from[1]; sy <= to[1]; sy++)
      for (int sx = from[0]; sx <= to[0]; sx++) {
        uint32_t code = (uint32_t)((sx + 1) + 3 * (sy + 1) + 9 * (sz + 1));
        const struct isph_image *image = &s->image[code];
        double at[3];
        int low[3], high[3];
        bool empty = false;
        for (int a = 0; a < 3; a++) {
          at[a] = image->turn[a] * (xi[a] - image->shift[a]);
          double first = (at[a] - reach - cells->origin[a]) / cells->size[a];
          double last = (at[a] + reach - cells->origin[a]) / cells->size[a];
          empty = empty || last < 0 || first >= cells->count[a];
          low[a] = clamp_index(first, cells->count[a]);
          high[a] = clamp_index(last, cells->count[a]);
        }
        if (empty) continue;
        for (int cz = low[c]; cz <= high[c]; cz++) {
          double z0 = cells->origin[c] + cz * cells->size[c];
          double dz = outside(at[c] - z0, cells->size[c]);
          for (int cy = low[b]; cy <= high[b]; cy++) {
            double y0 = cells->origin[b] + cy * cells->size[b];
            double dy = outside(at[b] - y0, cells->size[b]);
            if (dy * dy + dz * dz > reach2) continue;
            size_t row =
                ((size_t)cz * (size_t)cells->count[b] + (size_t)cy) * (size_t)cells->count[x0];
            uint32_t begin = cells->start[row + (size_t)low[x0]];
            uint32_t end = cells->start[row + (size_t)high[x0] + 1];
            if (found + (end - begin) > ISPH_CANDIDATES) return ISPH_CANDIDATES + 1;
            for (uint32_t k = begin; k < end; k++) {
              uint32_t j = order != NULL ? order[k] : k;
              double rx = at[0] - x[j][0], ry = at[1] - x[j][1], rz = at[2] - x[j][2];
              candidates[found] = j | code << PAIR_BITS;
              found += rx * rx + ry * ry + rz * rz < reach2;
            }
          }
        }
      }
  return found;
}

enum status isph_probe(const struct isph *s, const double x[3], double support, double *kernel_sum,
                       double velocity[3]) {
  uint32_t candidates[ISPH_CANDIDATES];
  double he = support, w, slope;
  *kernel_sum = 0;
  velocity[0] = velocity[1] = velocity[2] = 0;
  size_t n = isph_cells_collect(s, &s->cells, NULL, s->position, x, he, candidates);
  if (n > ISPH_CANDIDATES)
    return FAIL(STATUS_NUMERIC, "t = %.4g s: particles crowd at an inflow; use a smaller isph.dt",
                s->time);
  for (size_t k = 0; k < n; k++) {
    double r[3];
    uint32_t j = candidates[k] & PAIR_MASK;
    isph_separation(s, x, s->position, candidates[k], r);
    isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]),
                he, &w, &slope);
    w *= s->kernel_w * s->volume[j];
    *kernel_sum += w;
    for (int a = 0; a < 3; a++) velocity[a] += w * s->velocity[j][a];
  }
  if (*kernel_sum > 0)
    for (int a = 0; a < 3; a++) velocity[a] /= *kernel_sum;
  return STATUS_OK;
}
