#include "sphsolve/isph/cells.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/constants.h"
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
  const double support = s->scene->isph.support_ratio * s->spacing;
  double length[3], total = ROW_CUTS;
  int longest = 2;
  for (int a = 2; a >= 0; a--) {
    const double beyond = s->periodic[a] || (s->dimensions == 2 && a == 1) ? 0 : margin;
    length[a] = s->high[a] - s->low[a] + 2 * beyond;
    cells->origin[a] = s->low[a] - beyond;
    if (isph_uses_axis(s, a) && length[a] > length[longest]) longest = a;
  }
  for (int a = 0; a < 3; a++) {
    /* Ranks divide the domain into layers across its longest axis, and hold those within reach. */
    const double wanted = (a == longest ? CELL_LAYER : CELL_WIDTH) * support;
    cells->count[a] = (int)fmax(1, floor(length[a] / wanted));
    cells->size[a] = length[a] / cells->count[a];
    total *= cells->count[a];
  }
  if (total > 1e9)
    return FAIL(STATUS_INPUT,
                "domain: %.2g cells of %.3g m; make the domain smaller or the "
                "spacing wider",
                total / ROW_CUTS, CELL_LAYER * support);
  const int row = longest != 0 ? 0 : s->dimensions == 2 ? 2 : 1;
  cells->axis[0] = row, cells->axis[1] = 3 - row - longest, cells->axis[2] = longest;
  cells->count[row] *= ROW_CUTS, cells->size[row] /= ROW_CUTS;
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

/* Distance between two intervals. */
static inline double gap(double low, double high, double from, double to) {
  return low > to ? low - to : from > high ? from - high : 0;
}

size_t isph_cells_collect(const struct isph *s, const struct isph_cells *cells, const double low[3],
                          const double high[3], double reach, struct isph_stretch *found) {
  size_t n = 0, points = 0;
  const double per = 1 / cells->size[cells->axis[0]];
  const int x0 = cells->axis[0], b = cells->axis[1], c = cells->axis[2];
  int from[3], to[3];
  for (int a = 0; a < 3; a++) {
    const bool below = s->periodic[a] || s->reflects[a][0];
    const bool above = s->periodic[a] || s->reflects[a][1];
    from[a] = below && low[a] - reach < s->low[a] ? -1 : 0;
    to[a] = above && high[a] + reach > s->high[a] ? 1 : 0;
  }
  for (int sz = from[2]; sz <= to[2]; sz++)
    for (int sy = from[1]; sy <= to[1]; sy++)
      for (int sx = from[0]; sx <= to[0]; sx++) {
        uint32_t code = (uint32_t)((sx + 1) + 3 * (sy + 1) + 9 * (sz + 1));
        const struct isph_image *image = &s->image[code];
        double begin[3], end[3]; /* of the box, from the origin of the cells */
        int first[3], last[3];
        bool empty = false;
        for (int a = 0; a < 3; a++) {
          const double p = image->turn[a] * (low[a] - image->shift[a]) - cells->origin[a];
          const double q = image->turn[a] * (high[a] - image->shift[a]) - cells->origin[a];
          begin[a] = p < q ? p : q, end[a] = p < q ? q : p;
          const double lowest = (begin[a] - reach) / cells->size[a];
          const double highest = (end[a] + reach) / cells->size[a];
          empty = empty || highest < 0 || lowest >= cells->count[a];
          first[a] = clamp_index(lowest, cells->count[a]);
          last[a] = clamp_index(highest, cells->count[a]);
        }
        if (empty) continue;
        for (int cz = first[c]; cz <= last[c]; cz++) {
          const double dz = gap(begin[c], end[c], cz * cells->size[c], (cz + 1) * cells->size[c]);
          for (int cy = first[b]; cy <= last[b]; cy++) {
            const double dy = gap(begin[b], end[b], cy * cells->size[b], (cy + 1) * cells->size[b]);
            const double left = reach * reach - dy * dy - dz * dz;
            if (left < 0) continue;
            const size_t row =
                ((size_t)cz * (size_t)cells->count[b] + (size_t)cy) * (size_t)cells->count[x0];
            const double along = sqrt(left);
            const int l = clamp_index((begin[x0] - along) * per, cells->count[x0]);
            const int h = clamp_index((end[x0] + along) * per, cells->count[x0]);
            found[n].begin = cells->start[row + (size_t)l];
            found[n].end = cells->start[row + (size_t)h + 1];
            found[n].code = code;
            points += found[n].end - found[n].begin;
            n += found[n].end > found[n].begin;
            if (points > ISPH_CANDIDATES || n == ISPH_STRETCHES) return ISPH_STRETCHES;
          }
        }
      }
  return n;
}

enum status isph_probe(const struct isph *s, const double x[3], double support, double *kernel_sum,
                       double velocity[3]) {
  struct isph_stretch near[ISPH_STRETCHES];
  double he = support, w, slope;
  *kernel_sum = 0;
  velocity[0] = velocity[1] = velocity[2] = 0;
  size_t n = isph_cells_collect(s, &s->cells, x, x, he, near);
  if (n == ISPH_STRETCHES)
    return FAIL(STATUS_NUMERIC, "t = %.4g s: particles crowd at an inflow; use a smaller isph.dt",
                s->time);
  for (size_t k = 0; k < n; k++)
    for (uint32_t j = near[k].begin; j < near[k].end; j++) {
      const uint32_t entry = j | near[k].code << PAIR_BITS;
      double r[3], turned[3];
      isph_separation(s, x, s->position, entry, r);
      if (dot(r, r) >= he * he) continue;
      isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(dot(r, r)), he, &w, &slope);
      w *= s->kernel_w * s->volume[j];
      *kernel_sum += w;
      isph_turn(IMAGES_REFLECTED, s, entry, s->velocity[j], turned);
      for (int a = 0; a < 3; a++) velocity[a] += w * turned[a];
    }
  if (*kernel_sum > 0)
    for (int a = 0; a < 3; a++) velocity[a] /= *kernel_sum;
  return STATUS_OK;
}
