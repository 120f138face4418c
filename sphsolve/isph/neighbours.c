#include "sphsolve/isph/neighbours.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/variants.h"
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

/* Candidates of a particle, a few at a time: distance vector, volume and support of the pair, and
 * the kernel that is found from them; `turned` is the volume of those that are reflected. */
#define BLOCK 128
struct block {
  double r[3][BLOCK], volume[BLOCK], turned[BLOCK], support[BLOCK], w[BLOCK], slope[BLOCK];
} __attribute__((aligned(32)));

/* Finds w and slope of the first n, both 0 beyond the support. */
ROW void find_kernels(enum kernel kernel, int dimensions, const struct isph *s, struct block *b,
                      size_t n) {
  const double scale_w = s->kernel_w, scale_slope = s->kernel_slope;
  for (size_t k = 0; k < n; k++) {
    const double x = b->r[0][k], y = b->r[1][k], z = b->r[2][k], he = b->support[k];
    const double square = x * x + y * y + z * z;
    double w, slope;
    isph_kernel(kernel, dimensions, sqrt(square), he, &w, &slope);
    b->w[k] = square < he * he ? w * scale_w : 0;
    b->slope[k] = square < he * he ? slope * scale_slope : 0;
  }
}

/* Four sums at a time, in a fixed order on any machine. */
#define LANES 4
typedef double lanes __attribute__((vector_size(LANES * sizeof(double)), may_alias));
#define LANES_AT(array, k) (*(const lanes *)&(array)[k])

ROW double lanes_sum(const lanes *sum) {
  return ((*sum)[0] + (*sum)[1]) + ((*sum)[2] + (*sum)[3]);
}

/* Adds sum volume slope r r; n is a multiple of LANES. */
ROW void add_moment(const struct block *b, const double *volume, size_t n, double moment[6]) {
  lanes sum[6] = {{0}};
  for (size_t k = 0; k < n; k += LANES) {
    const lanes x = LANES_AT(b->r[0], k), y = LANES_AT(b->r[1], k), z = LANES_AT(b->r[2], k);
    const lanes f = LANES_AT(volume, k) * LANES_AT(b->slope, k), fx = f * x, fy = f * y;
    sum[0] += fx * x, sum[1] += fx * y, sum[2] += fx * z;
    sum[3] += fy * y, sum[4] += fy * z, sum[5] += f * z * z;
  }
  for (int c = 0; c < 6; c++) moment[c] += lanes_sum(&sum[c]);
}

/* Finds the kernels of the first n neighbours of a block and adds them to the sums. */
TARGETS static void add_block(const struct isph *s, struct block *b, size_t n, bool turned,
                              double moment[6], struct neighbourhood *sums) {
  const enum kernel kernel = s->scene->isph.kernel;
  lanes sum[4] = {{0}};
  for (; n % LANES != 0; n++) {
    for (int a = 0; a < 3; a++) b->r[a][n] = 0;
    b->volume[n] = b->turned[n] = 0, b->support[n] = s->spacing;
  }
  if (kernel == KERNEL_CUBIC && s->dimensions == 3)
    find_kernels(KERNEL_CUBIC, 3, s, b, n);
  else if (kernel == KERNEL_CUBIC)
    find_kernels(KERNEL_CUBIC, 2, s, b, n);
  else
    find_kernels(kernel, s->dimensions, s, b, n);
  for (size_t k = 0; k < n; k += LANES) {
    const lanes volume = LANES_AT(b->volume, k), f = volume * LANES_AT(b->slope, k);
    for (int a = 0; a < 3; a++) sum[a] += f * LANES_AT(b->r[a], k);
    sum[3] += volume * LANES_AT(b->w, k);
  }
  for (int a = 0; a < 3; a++) sums->gradient_sum[a] += lanes_sum(&sum[a]);
  sums->kernel_sum += lanes_sum(&sum[3]);
  if (turned) {
    add_moment(b, b->turned, n, sums->wall_moment);
    for (size_t k = 0; k < n; k++) b->volume[k] -= b->turned[k];
  }
  add_moment(b, b->volume, n, moment);
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
  const uint32_t own = (uint32_t)i | (uint32_t)IMAGE_NONE << PAIR_BITS;
  size_t count = chunk->pair_count;
  struct block b;
  for (size_t at = 0; at < n; at += BLOCK) {
    const size_t here = n - at < BLOCK ? n - at : BLOCK;
    bool turned = false;
    for (size_t k = 0; k < here; k++) {
      const uint32_t entry = candidates[at + k], j = entry & PAIR_MASK;
      const bool reflected = held && isph_is_reflected(images, s, entry);
      double r[3];
      isph_separation_at(images, s, xi, s->position, entry, r);
      if (entry == own) r[0] = 2 * hi; /* no neighbour of its own */
      for (int a = 0; a < 3; a++) b.r[a][k] = r[a];
      b.volume[k] = s->volume[j], b.support[k] = 0.5 * (hi + s->support[j]);
      b.turned[k] = reflected ? b.volume[k] : 0;
      turned = turned || reflected;
    }
    add_block(s, &b, here, turned, sums->moment, sums);
    for (size_t k = 0; k < here; k++) {
      chunk->pair[count] = candidates[at + k];
      chunk->slope[count] = (float)b.slope[k];
      count += b.w[k] > 0;
    }
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
  struct block b;
  for (size_t at = 0; at < n;) {
    size_t here = 0;
    for (; at < n && here < BLOCK; at++) {
      double r[3];
      if (isph_is_reflected(images, s, candidates[at]) && is_beyond(s, candidates[at])) continue;
      isph_separation_at(images, s, s->position[i], s->boundary_position, candidates[at], r);
      for (int a = 0; a < 3; a++) b.r[a][here] = r[a];
      b.volume[here] = isph_wall_volume(s, candidates[at] & PAIR_MASK);
      b.support[here] = s->support[i];
      chunk->wall[chunk->wall_count + here++] = candidates[at];
    }
    add_block(s, &b, here, false, sums->wall_moment, sums);
    for (size_t k = 0; k < here; k++) chunk->wall_slope[chunk->wall_count++] = (float)b.slope[k];
  }
}

TARGETS static enum status search_chunk(struct isph *s, struct isph_chunk *chunk) {
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
  if (s->near != NULL) isph_neighbourhood_maximum(s, s->surface, s->near);
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
