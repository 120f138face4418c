#include "sphsolve/isph/neighbours.h"

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
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/enclosed.h"
#include "sphsolve/isph/moment.h"
#include "sphsolve/isph/near_surface.h"
#include "sphsolve/isph/sort.h"
#include "sphsolve/isph/wall.h"

static enum status grow(struct isph_chunk *chunk, const struct isph_switches *on, size_t pairs,
                        size_t walls) {
  enum status status = STATUS_OK;
  if (pairs > chunk->pair_capacity) {
    size_t n = pairs + pairs / 4 + 64 * CHUNK / 8;
    TRY(memory_resize(&chunk->pair, n, sizeof *chunk->pair, "neighbour lists"));
    TRY(memory_resize(&chunk->slope, n, sizeof *chunk->slope, "neighbour lists"));
    TRY(memory_resize(&chunk->matrix, n, sizeof *chunk->matrix, "pressure matrix"));
    if (on->links)
      TRY(memory_resize(&chunk->mobility, n, sizeof *chunk->mobility, "neighbour lists"));
    if (on->links)
      TRY(memory_resize(&chunk->path_porosity, n, sizeof *chunk->path_porosity, "neighbour lists"));
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

/* Sums over the neighbourhood of a particle; wall_moment is that of walls, and of the images at
 * sides that hold the water. */
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
  const bool held = isph_sides_hold(s);
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
             held && isph_is_reflected(images, s, entry) ? sums->wall_moment : sums->moment);
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
  uint32_t candidates[ISPH_CANDIDATES];
  const enum kernel kernel = s->scene->isph.kernel;
  const int dimensions = s->dimensions;
  chunk->pair_count = chunk->wall_count = 0;
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const double *xi = s->position[i], hi = s->support[i];
    struct neighbourhood sums = {0};
    double w, slope, reach = 0.5 * (hi + s->support_now);
    s->images[i] = (uint8_t)images_near(s, xi, fmax(reach, hi));
    size_t n = isph_cells_collect(s, &s->cells, NULL, s->position, xi, reach, candidates);
    size_t n_wall = 0;
    if (n > ISPH_CANDIDATES)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d neighbours at (%.4g, %.4g, %.4g) m: "
                  "the particles have clumped; use a smaller isph.dt",
                  s->time, ISPH_CANDIDATES, xi[0], xi[1], xi[2]);
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
      n_wall = isph_cells_collect(s, &s->wall_cells, s->wall_order, s->boundary_position, xi, hi,
                                  candidates);
    if (n_wall > ISPH_CANDIDATES)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d wall particles within the support of %.3g m at (%.4g, "
                  "%.4g, %.4g) m: soil of so low a porosity needs a smaller isph.support_ratio, or "
                  "is a wall",
                  s->time, ISPH_CANDIDATES, hi, xi[0], xi[1], xi[2]);
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
