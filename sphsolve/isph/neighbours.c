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
#include "sphsolve/isph/candidates.h"
#include "sphsolve/isph/enclosed.h"
#include "sphsolve/isph/moment.h"
#include "sphsolve/isph/near_surface.h"
#include "sphsolve/isph/sort.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/sight.h"
#include "sphsolve/isph/wall.h"

/* Beyond the last pair of a chunk are pairs with particle 0, of no weight, for loops over eight at
 * a time. */
#define BEYOND EIGHT_WIDE

static enum status grow(struct isph_chunk *chunk, const struct isph_switches *on, size_t pairs,
                        size_t walls) {
  enum status status = STATUS_OK;
  pairs += BEYOND;
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

/* Neighbours of a particle, a few at a time: distance vector, volume and support of the pair, and
 * the kernel that is found from them; `turned` is the volume of those that are reflected. */
#define BLOCK 128
struct block {
  double r[3][BLOCK], volume[BLOCK], turned[BLOCK], support[BLOCK], w[BLOCK], slope[BLOCK];
} __attribute__((aligned(32)));

/* Finds w and slope of the first n. */
ROW void find_kernels(enum kernel kernel, int dimensions, const struct isph *s, struct block *b,
                      size_t n) {
  const double scale_w = s->kernel_w, scale_slope = s->kernel_slope;
  for (size_t k = 0; k < n; k++) {
    const double x = b->r[0][k], y = b->r[1][k], z = b->r[2][k], he = b->support[k];
    const double square = x * x + y * y + z * z;
    double w, slope;
    isph_kernel(kernel, dimensions, sqrt(square), he, &w, &slope);
    b->w[k] = w * scale_w, b->slope[k] = slope * scale_slope;
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
    if ((s->reflects[a][0] && x[a] - reach < s->low[a]) ||
        (s->reflects[a][1] && x[a] + reach > s->high[a]))
      return IMAGES_REFLECTED;
    if (s->periodic[a]) images = IMAGES_PERIODIC;
  }
  return images;
}

/* Appends the chosen candidates to a list, with their slopes, and adds them to the sums. Those that
 * are `hidden` (NULL: none) fill the neighbourhood as images do, with a slope of 0. */
TARGETS static void add_chosen(const struct isph *s, const struct isph_candidates *c,
                               const uint16_t *chosen, size_t n, const double x[3], double half,
                               uint32_t *entries, float *slopes, double moment[6],
                               struct neighbourhood *sums, const bool *hidden) {
  struct block b;
  for (size_t at = 0; at < n; at += BLOCK) {
    const size_t here = n - at < BLOCK ? n - at : BLOCK;
    double turned = 0;
    for (size_t k = 0; k < here; k++) {
      const size_t from = chosen[at + k];
      for (int a = 0; a < 3; a++) b.r[a][k] = x[a] - c->x[a][from];
      b.volume[k] = c->volume[from], b.turned[k] = c->turned[from];
      b.support[k] = half + c->half[from];
      if (hidden != NULL && hidden[at + k]) b.turned[k] = b.volume[k];
      entries[at + k] = c->entry[from];
      turned += b.turned[k];
    }
    add_block(s, &b, here, turned > 0, moment, sums);
    for (size_t k = 0; k < here; k++) slopes[at + k] = (float)b.slope[k];
    for (size_t k = 0; k < here && hidden != NULL; k++)
      if (hidden[at + k]) slopes[at + k] = 0;
  }
}

/* Finds which of the chosen candidates walls hide from particle i; returns whether any wall can. An
 * outline is not between two points nearer to each other than both to outlines. */
static bool hide(const struct isph *s, size_t i, const struct isph_screens *screens,
                 const struct isph_candidates *c, const uint16_t *chosen, size_t n, bool *hidden) {
  for (size_t k = 0; k < n && screens->count > 0; k++) {
    const size_t j = c->entry[chosen[k]] & PAIR_MASK;
    const double reach = 0.5 * s->support[i] + c->half[chosen[k]];
    const double clear = s->facing != NULL ? s->facing[i].distance + s->facing[j].distance : 0;
    hidden[k] = isph_pair_is_hidden(s, screens, i, c->entry[chosen[k]], reach, clear);
  }
  return screens->count > 0;
}

/* The same for windows among the chosen wall particles. */
static bool hide_windows(const struct isph *s, size_t i, const struct isph_screens *screens,
                         const struct isph_candidates *c, const uint16_t *chosen, size_t n,
                         bool *hidden) {
  const bool any = s->on.open_sides && screens->count > 0;
  for (size_t k = 0; k < n && any; k++) {
    const size_t from = chosen[k];
    const double y[3] = {c->x[0][from], c->x[1][from], c->x[2][from]};
    hidden[k] = s->boundary_kind[c->entry[from] & PAIR_MASK] != BOUNDARY_WALL &&
                isph_is_hidden(s, screens, s->position[i], y, s->support[i], 0);
  }
  return any;
}

/* Finds neighbours and sums of particle i among the candidates of its group. */
static enum status search(struct isph *s, struct isph_chunk *chunk, size_t i,
                          const struct isph_candidates *water, const struct isph_candidates *walls,
                          const struct isph_screens *screens) {
  uint16_t chosen[CANDIDATES_ROOM];
  bool hidden[CANDIDATES_ROOM];
  const double *xi = s->position[i], hi = s->support[i];
  const uint32_t own = (uint32_t)i | (uint32_t)IMAGE_NONE << PAIR_BITS;
  struct neighbourhood sums = {0};
  double w, slope;
  enum status status = STATUS_OK;
  s->images[i] = (uint8_t)images_near(s, xi, fmax(0.5 * (hi + s->support_now), hi));
  isph_kernel(s->scene->isph.kernel, s->dimensions, 0, hi, &w, &slope);
  sums.kernel_sum = s->volume[i] * w * s->kernel_w;

  size_t n = isph_choose(water, xi, 0.5 * hi, own, chosen);
  TRY(grow(chunk, &s->on, chunk->pair_count + n, chunk->wall_count));
  s->pair_first[i] = (uint32_t)chunk->pair_count, s->pair_number[i] = (uint16_t)n;
  add_chosen(s, water, chosen, n, xi, 0.5 * hi, chunk->pair + chunk->pair_count,
             chunk->slope + chunk->pair_count, sums.moment, &sums,
             hide(s, i, screens, water, chosen, n, hidden) ? hidden : NULL);
  chunk->pair_count += n;
  const double of_water = sums.kernel_sum;

  n = isph_choose(walls, xi, hi, UINT32_MAX, chosen);
  TRY(grow(chunk, &s->on, chunk->pair_count, chunk->wall_count + n));
  s->wall_first[i] = (uint32_t)chunk->wall_count, s->wall_number[i] = (uint16_t)n;
  if (n > 0)
    add_chosen(s, walls, chosen, n, xi, hi, chunk->wall + chunk->wall_count,
               chunk->wall_slope + chunk->wall_count, sums.wall_moment, &sums,
               hide_windows(s, i, screens, walls, chosen, n, hidden) ? hidden : NULL);
  chunk->wall_count += n;

  s->kernel_sum[i] = sums.kernel_sum;
  if (s->on.surface)
    s->surface[i] = surface_weight(s, hi, sums.kernel_sum, sums.kernel_sum - of_water,
                                   sums.gradient_sum, sums.moment, sums.wall_moment);
  memcpy(s->gradient_sum[i], sums.gradient_sum, sizeof sums.gradient_sum);
  /* The correction is from the water alone, so that it is exact for linear fields next to a wall
   * too. It is the identity if there are too few neighbours. */
  double inverse[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  isph_moment_inverse(s->dimensions, sums.moment, inverse);
  for (int c = 0; c < 9; c++) s->correction[i][c] = (float)inverse[c];
  for (int k = 0; k < 6; k++) sums.moment[k] += sums.wall_moment[k];
  const double one_sided =
      s->on.soil && s->on.surface ? isph_front_find(s, chunk, i, sums.moment) : 0;
  if (s->on.surface) s->surface[i] = isph_packing_surface(s, i);
  if (s->on.soil) isph_moment_defect(s, i, sums.moment, one_sided);
  for (int k = 0; k < 6 && s->linear != NULL; k++) s->linear[i][k] = (float)sums.moment[k];
cleanup:
  return status;
}

static enum status search_chunk(struct isph *s, struct isph_chunk *chunk) {
  enum status status = STATUS_OK;
  struct isph_candidates water, walls;
  struct isph_screens screens = {0};
  bool alone = false;
  chunk->pair_count = chunk->wall_count = 0;
  walls.count = 0;
  for (size_t i = chunk->begin; i < chunk->end;) {
    const struct isph_group g = isph_group_from(s, chunk, i, alone);
    const double *x = s->position[i];
    const bool water_fits = isph_find_candidates(s, &g, false, &water);
    const bool walls_fit = s->boundary_count == 0 || isph_find_candidates(s, &g, true, &walls);
    const double reach = 0.5 * (g.support + s->support_now);
    const bool screens_fit = isph_screens_find(s, g.low, g.high, reach, &screens);
    if (!(water_fits && walls_fit && screens_fit) && !alone) {
      alone = true;
      continue;
    }
    if (!water_fits)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d neighbours at (%.4g, %.4g, %.4g) m: "
                  "the particles have clumped; use a smaller isph.dt",
                  s->time, ISPH_CANDIDATES, x[0], x[1], x[2]);
    if (!walls_fit || !screens_fit)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: more than %d wall particles within the support of %.3g m at (%.4g, "
                  "%.4g, %.4g) m: soil of so low a porosity needs a smaller isph.support_ratio, or "
                  "is a wall",
                  s->time, ISPH_CANDIDATES, s->support[i], x[0], x[1], x[2]);
    for (; i < g.end; i++) TRY(search(s, chunk, i, &water, &walls, &screens));
  }
  memset(chunk->pair + chunk->pair_count, 0, BEYOND * sizeof *chunk->pair);
  memset(chunk->slope + chunk->pair_count, 0, BEYOND * sizeof *chunk->slope);
cleanup:
  return status;
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
  if (s->on.surface) isph_neighbourhood_maximum(s, s->surface, s->near);
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
