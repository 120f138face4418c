#include "sphsolve/isph/state.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/front.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"

#define CANDIDATES 8192 /* most candidates for the neighbours of a particle */

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

static enum status shape_cells(const struct isph *s, double margin, struct isph_cells *cells) {
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

/* Stable counting sort by cell: fills `order` with the old index of each new place. */
static void sort_by_cell(const struct isph_cells *cells, size_t n, const uint32_t *cell,
                         uint32_t *order) {
  size_t total = (size_t)cells->count[0] * (size_t)cells->count[1] * (size_t)cells->count[2];
  memset(cells->start, 0, (total + 1) * sizeof *cells->start);
  for (size_t i = 0; i < n; i++) cells->start[cell[i] + 1]++;
  for (size_t c = 0; c < total; c++) cells->start[c + 1] += cells->start[c];
  for (size_t i = 0; i < n; i++) order[cells->start[cell[i]]++] = (uint32_t)i;
  for (size_t c = total; c > 0; c--) cells->start[c] = cells->start[c - 1];
  cells->start[0] = 0;
}

static void permute(struct isph *s, void *data, size_t size) {
  char *from = data, *to = s->scratch;
  const uint32_t *order = s->order;
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) memcpy(to + i * size, from + order[i] * size, size);
  memcpy(from, to, s->count * size);
}

enum status isph_sort(struct isph *s) {
  enum status status = STATUS_OK;
  if (s->cells.start == NULL) TRY(shape_cells(s, 0, &s->cells));
  TRY(isph_distribute(s));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) s->cell_of[i] = isph_cell_of(&s->cells, s->position[i]);
  sort_by_cell(&s->cells, s->count, s->cell_of, s->order);
  permute(s, s->position, sizeof *s->position);
  permute(s, s->velocity, sizeof *s->velocity);
  permute(s, s->pressure, sizeof *s->pressure);
  permute(s, s->mass, sizeof *s->mass);
  if (s->packing != NULL) permute(s, s->packing, sizeof *s->packing);
  permute(s, s->id, sizeof *s->id);
  isph_find_own(s);
cleanup:
  return status;
}

/* Boundary particles keep their initial order, so that a resumed run adds up in the same order;
 * only the index of the cells is rebuilt when walls move. */
enum status isph_sort_walls(struct isph *s) {
  enum status status = STATUS_OK;
  uint32_t *cell = NULL;
  if (s->wall_cells.start == NULL) TRY(shape_cells(s, s->support_max, &s->wall_cells));
  size_t n = s->boundary_count;
  if (s->wall_order == NULL)
    TRY(memory_allocate(&s->wall_order, n, sizeof *s->wall_order, "walls"));
  TRY(memory_allocate(&cell, n, sizeof *cell, "walls"));
  for (size_t j = 0; j < n; j++) cell[j] = isph_cell_of(&s->wall_cells, s->boundary_position[j]);
  sort_by_cell(&s->wall_cells, n, cell, s->wall_order);
cleanup:
  memory_free(&cell);
  return status;
}

/* Collects the entries (index | image) of all points of `cells` closer to xi than `reach`. Returns
 * more than CANDIDATES if they do not fit. */
static size_t collect(const struct isph *s, const struct isph_cells *cells, const uint32_t *order,
                      double (*x)[3], const double xi[3], double reach, uint32_t *candidates) {
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
          double dz = fmax(0, fmax(z0 - at[c], at[c] - z0 - cells->size[c]));
          for (int cy = low[b]; cy <= high[b]; cy++) {
            double y0 = cells->origin[b] + cy * cells->size[b];
            double dy = fmax(0, fmax(y0 - at[b], at[b] - y0 - cells->size[b]));
            if (dy * dy + dz * dz > reach2) continue;
            size_t row =
                ((size_t)cz * (size_t)cells->count[b] + (size_t)cy) * (size_t)cells->count[x0];
            uint32_t begin = cells->start[row + (size_t)low[x0]];
            uint32_t end = cells->start[row + (size_t)high[x0] + 1];
            if (found + (end - begin) > CANDIDATES) return CANDIDATES + 1;
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

static enum status grow(struct isph_chunk *chunk, const struct isph_switches *on, size_t pairs,
                        size_t walls) {
  enum status status = STATUS_OK;
  if (pairs > chunk->pair_capacity) {
    size_t n = pairs + pairs / 4 + 64 * CHUNK / 8;
    TRY(memory_resize(&chunk->pair, n, sizeof *chunk->pair, "neighbour lists"));
    TRY(memory_resize(&chunk->slope, n, sizeof *chunk->slope, "neighbour lists"));
    TRY(memory_resize(&chunk->matrix, n, sizeof *chunk->matrix, "pressure matrix"));
    if (on->links || on->anisotropy)
      TRY(memory_resize(&chunk->mobility, n, sizeof *chunk->mobility, "neighbour lists"));
    if (on->links)
      TRY(memory_resize(&chunk->path_porosity, n, sizeof *chunk->path_porosity, "neighbour lists"));
    if (on->links && on->anisotropy)
      TRY(memory_resize(&chunk->plain, n, sizeof *chunk->plain, "neighbour lists"));
    chunk->pair_capacity = n;
  }
  if (walls > chunk->wall_capacity) {
    size_t n = walls + walls / 4 + CHUNK;
    TRY(memory_resize(&chunk->wall, n, sizeof *chunk->wall, "neighbour lists"));
    TRY(memory_resize(&chunk->wall_slope, n, sizeof *chunk->wall_slope, "neighbour lists"));
    chunk->wall_capacity = n;
  }
cleanup:
  return status;
}

/* Sums over the neighbourhood of a particle; wall_moment is that of walls and of reflected water.
 */
struct neighbourhood {
  double kernel_sum, gradient_sum[3], moment[6], wall_moment[6];
};

/* Adds a neighbour at distance vector r with volume and slope to the sums of a particle. */
static inline void add_sums(double volume, double w, double slope, const double r[3],
                            struct neighbourhood *sums, double moment[6]) {
  double f = volume * slope;
  sums->kernel_sum += volume * w;
  for (int a = 0; a < 3; a++) sums->gradient_sum[a] += f * r[a];
  moment[0] += f * r[0] * r[0], moment[1] += f * r[0] * r[1], moment[2] += f * r[0] * r[2];
  moment[3] += f * r[1] * r[1], moment[4] += f * r[1] * r[2], moment[5] += f * r[2] * r[2];
}

/* Which kinds of images can lie within `reach` of x. */
static enum isph_images images_near(const struct isph *s, const double x[3], double reach) {
  enum isph_images images = IMAGES_NONE;
  for (int a = 0; a < 3; a++) {
    if (x[a] - reach >= s->low[a] && x[a] + reach <= s->high[a]) continue;
    if (s->reflects[a]) return IMAGES_REFLECTED;
    if (s->periodic[a]) images = IMAGES_PERIODIC;
  }
  return images;
}

/* Finds the pairs of particle i among the candidates and adds up its neighbourhood. */
ROW void find_pairs(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                    size_t i, const uint32_t *candidates, size_t n, struct neighbourhood *sums) {
  const double *xi = s->position[i], hi = s->support[i];
  size_t count = chunk->pair_count;
  for (size_t k = 0; k < n; k++) {
    uint32_t entry = candidates[k], j = entry & PAIR_MASK;
    if (entry == ((uint32_t)i | (uint32_t)IMAGE_NONE << PAIR_BITS)) continue;
    double r[3], w, slope;
    isph_separation_at(images, s, xi, s->position, entry, r);
    double r2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], he = 0.5 * (hi + s->support[j]);
    if (r2 >= he * he) continue;
    isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(r2), he, &w, &slope);
    w *= s->kernel_w, slope *= s->kernel_slope;
    add_sums(s->volume[j], w, slope, r, sums,
             isph_is_reflected(images, s, entry) ? sums->wall_moment : sums->moment);
    chunk->pair[count] = entry;
    chunk->slope[count] = (float)slope;
    count++;
  }
  chunk->pair_count = count;
}

/* Whether the wall particle of an entry has moved out of the domain through a reflecting side. */
static bool is_beyond(const struct isph *s, uint32_t entry) {
  const double *x = s->boundary_position[entry & PAIR_MASK];
  for (int a = 0; a < 3; a++)
    if (s->reflects[a] && (x[a] < s->low[a] || x[a] > s->high[a])) return true;
  return false;
}

/* As find_pairs, for pairs with boundary particles. */
ROW void find_walls(enum isph_images images, const struct isph *s, struct isph_chunk *chunk,
                    size_t i, const uint32_t *candidates, size_t n, struct neighbourhood *sums) {
  const double *xi = s->position[i], hi = s->support[i];
  for (size_t k = 0; k < n; k++) {
    double r[3], w, slope;
    if (isph_is_reflected(images, s, candidates[k]) && is_beyond(s, candidates[k])) continue;
    isph_separation_at(images, s, xi, s->boundary_position, candidates[k], r);
    isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]),
                hi, &w, &slope);
    w *= s->kernel_w, slope *= s->kernel_slope;
    add_sums(isph_wall_volume(s, candidates[k] & PAIR_MASK), w, slope, r, sums, sums->wall_moment);
    chunk->wall[chunk->wall_count] = candidates[k];
    chunk->wall_slope[chunk->wall_count++] = (float)slope;
  }
}

static enum status search_chunk(struct isph *s, struct isph_chunk *chunk) {
  uint32_t candidates[CANDIDATES];
  const enum kernel kernel = s->scene->isph.kernel;
  const int dimensions = s->dimensions;
  chunk->pair_count = chunk->wall_count = 0;
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const double *xi = s->position[i], hi = s->support[i];
    struct neighbourhood sums = {0};
    double w, slope, reach = 0.5 * (hi + s->support_now);
    s->images[i] = (uint8_t)images_near(s, xi, fmax(reach, hi));
    size_t n = collect(s, &s->cells, NULL, s->position, xi, reach, candidates);
    size_t n_wall = 0;
    if (n > CANDIDATES)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d neighbours at (%.4g, %.4g, %.4g) m: "
                  "the particles have clumped; use a smaller isph.dt",
                  s->time, CANDIDATES, xi[0], xi[1], xi[2]);
    enum status status = grow(chunk, &s->on, chunk->pair_count + n, chunk->wall_count);
    if (status != STATUS_OK) return status;
    isph_kernel(kernel, dimensions, 0, hi, &w, &slope);
    sums.kernel_sum = s->volume[i] * w * s->kernel_w;
    s->pair_first[i] = (uint32_t)chunk->pair_count;
    ISPH_ROW(s, i, find_pairs, s, chunk, i, candidates, n, &sums);
    s->pair_number[i] = (uint16_t)(chunk->pair_count - s->pair_first[i]);

    double water = sums.kernel_sum;
    s->wall_first[i] = (uint32_t)chunk->wall_count;
    s->wall_number[i] = 0;
    if (s->boundary_count > 0)
      n_wall = collect(s, &s->wall_cells, s->wall_order, s->boundary_position, xi, hi, candidates);
    if (n_wall > CANDIDATES)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d wall particles within the support of %.3g m at (%.4g, "
                  "%.4g, %.4g) m: soil of so low a porosity needs a smaller isph.support_ratio, or "
                  "is a wall",
                  s->time, CANDIDATES, hi, xi[0], xi[1], xi[2]);
    if (n_wall > 0) {
      status = grow(chunk, &s->on, chunk->pair_count, chunk->wall_count + n_wall);
      if (status != STATUS_OK) return status;
      ISPH_ROW(s, i, find_walls, s, chunk, i, candidates, n_wall, &sums);
      s->wall_number[i] = (uint16_t)(chunk->wall_count - s->wall_first[i]);
    }

    s->kernel_sum[i] = sums.kernel_sum;
    if (s->on.surface)
      s->surface[i] = surface_weight(s, hi, sums.kernel_sum, sums.kernel_sum - water,
                                     sums.gradient_sum, sums.moment, sums.wall_moment);
    memcpy(s->gradient_sum[i], sums.gradient_sum, sizeof sums.gradient_sum);
    /* The correction is from the water alone, so that it is exact for linear fields next to a wall
     * too. It is the identity if there are too few neighbours. */
    double inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    isph_moment_inverse(dimensions, sums.moment, inverse);
    for (int c = 0; c < 9; c++) s->correction[i][c] = (float)inverse[c];
    for (int k = 0; k < 6; k++) sums.moment[k] += sums.wall_moment[k];
    if (s->on.soil) {
      const double one_sided = s->on.surface ? isph_front_find(s, chunk, i, sums.moment) : 0;
      isph_moment_defect(s, i, sums.moment, one_sided);
    }
    for (int k = 0; k < 6 && s->linear != NULL; k++) s->linear[i][k] = (float)sums.moment[k];
  }
  return STATUS_OK;
}

enum status isph_probe(const struct isph *s, const double x[3], double support, double *kernel_sum,
                       double velocity[3]) {
  uint32_t candidates[CANDIDATES];
  double he = support, w, slope;
  *kernel_sum = 0;
  velocity[0] = velocity[1] = velocity[2] = 0;
  size_t n = collect(s, &s->cells, NULL, s->position, x, he, candidates);
  if (n > CANDIDATES)
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

static enum status shape_chunks(struct isph *s) {
  size_t n = (s->local.end - s->local.begin + CHUNK - 1) / CHUNK;
  if (n > s->chunk_capacity) {
    enum status status = memory_resize(&s->sums, n, sizeof *s->sums, "sums");
    if (status == STATUS_OK)
      status = memory_resize(&s->chunks, n, sizeof *s->chunks, "neighbour lists");
    if (status != STATUS_OK) return status;
    s->chunk_capacity = n;
  }
  s->chunk_count = n;
  for (size_t c = 0; c < n; c++) {
    s->chunks[c].begin = s->local.begin + c * CHUNK;
    s->chunks[c].end = c + 1 < n ? s->chunks[c].begin + CHUNK : s->local.end;
  }
  return STATUS_OK;
}

void isph_find_near_surface(const struct isph *s, double *near) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      near[i] = s->surface[i];
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++)
        near[i] = fmax(near[i], s->surface[chunk->pair[p] & PAIR_MASK]);
    }
  }
}

enum status isph_find_neighbours(struct isph *s) {
  enum status status = shape_chunks(s);
  if (status != STATUS_OK) return status;
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    enum status here = search_chunk(s, &s->chunks[c]);
    if (here != STATUS_OK) {
#pragma omp critical(isph_search)
      status = here;
    }
  }
  TRY(ranks_agree(status));
  TRY(isph_find_ghosts(s));
  if (s->on.surface) TRY(isph_find_enclosed(s));
  if (s->on.surface)
    isph_send(s, 2, (struct ghost_field[]){ISPH_FIELD(s->surface), ISPH_FIELD(s->gradient_sum)});
  if (s->on.surface) isph_reflection_part(s);
  if (s->near != NULL) isph_find_near_surface(s, s->near);
  if (s->calm != NULL) isph_calm_thickness(s);
  if (s->linear != NULL) isph_linear_find(s);
  if (s->on.soil) isph_moment_correct(s);
  s->pairs_now = 0;
  for (size_t c = 0; c < s->chunk_count; c++)
    s->pairs_now += (double)(s->chunks[c].pair_count + s->chunks[c].wall_count);
  s->pair_interactions += s->pairs_now;
cleanup:
  return status;
}
