#include "sphsolve/isph/fill.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/ranks.h"

/* The edges of all regions cut the domain into blocks, each of one kind: water or not, in one soil
 * or in none. Blocks of the same kind side by side are joined, and each box that comes of it is
 * filled with rows of its own that fit it, so that its water is all there.
 *
 * Every particle of a run stands for the same mass of water, in soil as outside: in soil they stand
 * further apart from the start, as water that comes in will stand there. Particles of two masses
 * have two supports, and where the light ones leave the soil they neither see the walls, whose
 * particles are a spacing apart, nor mix evenly with the others: the free water behind soil of
 * porosity .3 thinned out to fillings of .4 and the run ended, after hours of nothing happening. */

#define BLOCKS_MOST 2e7
#define UNEVEN 0.1 /* of a row's pitch: beyond it the others make up for the volume */

struct blocks {
  double *edge[3]; /* [count + 1] */
  size_t count[3];
  double *porosity; /* [blocks]: of the water's place, 0 where there is none */
};

static bool used(const struct isph *s, int a) {
  return !(s->dimensions == 2 && a == 1);
}

static int compare(const void *a, const void *b) {
  const double *x = a, *y = b;
  return (*x > *y) - (*x < *y);
}

static enum status find_edges(const struct isph *s, int a, struct blocks *blocks) {
  const struct scene *scene = s->scene;
  const double near = 1e-6 * s->spacing;
  enum status status = memory_allocate(&blocks->edge[a], 2 * scene->region_count + 2,
                                       sizeof **blocks->edge, "regions");
  if (status != STATUS_OK) return status;
  double *edge = blocks->edge[a];
  size_t n = 0, kept = 0;
  edge[n++] = s->low[a], edge[n++] = s->high[a];
  for (size_t k = 0; k < scene->region_count && used(s, a); k++)
    for (int side = 0; side < 2 && scene->regions[k].type != REGION_INFLOW; side++) {
      const double at = scene->regions[k].box[a + 3 * side];
      if (at > s->low[a] + near && at < s->high[a] - near) edge[n++] = at;
    }
  qsort(edge, n, sizeof *edge, compare);
  for (size_t k = 1; k < n; k++)
    if (edge[k] > edge[kept] + near) edge[++kept] = edge[k];
  edge[kept] = s->high[a];
  blocks->count[a] = kept;
  return STATUS_OK;
}

double isph_fill_porosity(const struct scene *scene, const double x[3]) {
  double porosity = 1;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    bool inside = region->type == REGION_POROUS;
    for (int a = 0; a < 3; a++)
      if (scene->dimensions == 3 || a != 1)
        inside = inside && x[a] >= region->box[a] && x[a] < region->box[a + 3];
    if (inside) porosity = region->porosity;
  }
  return porosity;
}

static void free_blocks(struct blocks *b) {
  for (int a = 0; a < 3; a++) memory_free(&b->edge[a]);
  memory_free(&b->porosity);
}

static size_t block_at(const struct blocks *b, const size_t at[3]) {
  return (at[2] * b->count[1] + at[1]) * b->count[0] + at[0];
}

/* What each block is; and the largest porosity of all places where water can be. */
static enum status find_blocks(const struct isph *s, const struct lattice *lattice,
                               struct blocks *b, double *largest) {
  enum status status = STATUS_OK;
  double total = 1;
  for (int a = 0; a < 3; a++) {
    TRY(find_edges(s, a, b));
    total *= (double)b->count[a];
  }
  if (total > BLOCKS_MOST)
    TRY_FAIL(STATUS_INPUT,
             "%s: regions: their edges cut the domain into %.2g blocks; let boxes share their "
             "edges",
             s->scene->path, total);
  TRY(memory_allocate(&b->porosity, (size_t)total, sizeof *b->porosity, "regions"));
  *largest = 0;
  size_t at[3];
  for (at[2] = 0; at[2] < b->count[2]; at[2]++)
    for (at[1] = 0; at[1] < b->count[1]; at[1]++)
      for (at[0] = 0; at[0] < b->count[0]; at[0]++) {
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = 0.5 * (b->edge[a][at[a]] + b->edge[a][at[a] + 1]);
        const enum site_kind kind = lattice_kind_at(s->scene, lattice->saturated, x);
        const double porosity = isph_fill_porosity(s->scene, x);
        if (kind == SITE_WALL) continue;
        *largest = fmax(*largest, porosity);
        if (kind == SITE_FLUID) b->porosity[block_at(b, at)] = porosity;
      }
cleanup:
  return status;
}

/* Whether the blocks [from, to) are all water in a place of such porosity. */
static bool all_are(const struct blocks *b, const size_t from[3], const size_t to[3],
                    double porosity) {
  size_t at[3];
  for (at[2] = from[2]; at[2] < to[2]; at[2]++)
    for (at[1] = from[1]; at[1] < to[1]; at[1]++)
      for (at[0] = from[0]; at[0] < to[0]; at[0]++)
        if (b->porosity[block_at(b, at)] != porosity) return false;
  return true;
}

/* The largest box of equal blocks from `from` on, x first. */
static void join_blocks(const struct blocks *b, const size_t from[3], size_t to[3]) {
  const double porosity = b->porosity[block_at(b, from)];
  for (int a = 0; a < 3; a++) to[a] = from[a] + 1;
  for (int a = 0; a < 3; a++)
    for (; to[a] < b->count[a]; to[a]++) {
      size_t first[3], end[3];
      memcpy(first, from, sizeof first), memcpy(end, to, sizeof end);
      first[a] = to[a], end[a] = to[a] + 1;
      if (!all_are(b, first, end, porosity)) break;
    }
}

/* Rows along each axis of a box for particles of so much volume each, the shortest axis first: what
 * an axis too short for a whole row misses the longer ones make up for. */
static void count_rows(const struct isph *s, const double length[3], double volume, int rows[3]) {
  bool done[3] = {false, !used(s, 1), false};
  rows[1] = 1;
  for (int left = s->dimensions; left > 0; left--) {
    const double pitch = left == 3 ? cbrt(volume) : left == 2 ? sqrt(volume) : volume;
    int shortest = -1;
    for (int a = 0; a < 3; a++)
      if (!done[a] && (shortest < 0 || length[a] < length[shortest])) shortest = a;
    rows[shortest] = (int)fmax(1, round(length[shortest] / pitch));
    const double own = length[shortest] / rows[shortest];
    volume /= fabs(own / pitch - 1) > UNEVEN ? own : pitch;
    done[shortest] = true;
  }
}

static const double *velocity_at(const struct isph *s, const double x[3]) {
  static const double still[3] = {0};
  const double *velocity = still;
  for (size_t k = 0; k < s->scene->region_count; k++) {
    const struct region *region = &s->scene->regions[k];
    bool inside = region->type == REGION_WATER;
    for (int a = 0; a < 3; a++)
      if (used(s, a)) inside = inside && x[a] >= region->box[a] && x[a] < region->box[a + 3];
    if (inside) velocity = region->velocity;
  }
  return velocity;
}

/* The particles of a box, of all those counted by next_id this rank's [first, end). */
static enum status fill_box(struct isph *s, const double low[3], const double length[3],
                            double porosity, uint64_t first, uint64_t end) {
  int rows[3];
  double pitch[3], volume = 1;
  count_rows(s, length, pow(s->spacing, s->dimensions) * s->porosity_most / porosity, rows);
  for (int a = 0; a < 3; a++) {
    pitch[a] = length[a] / rows[a];
    if (used(s, a)) volume *= pitch[a];
  }
  for (int k = 0; k < rows[2]; k++)
    for (int j = 0; j < rows[1]; j++)
      for (int i = 0; i < rows[0]; i++) {
        const double x[3] = {low[0] + (i + 0.5) * pitch[0], low[1] + (j + 0.5) * pitch[1],
                             low[2] + (k + 0.5) * pitch[2]};
        if (s->next_id < first || s->next_id >= end) {
          s->next_id++;
          continue;
        }
        enum status status =
            isph_add_particle(s, x, velocity_at(s, x), porosity * s->density * volume);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

/* Box after box, each rank's run of the particles of all; the first pass only counts. */
static enum status fill_all(struct isph *s, const struct blocks *b, double *left, uint64_t first,
                            uint64_t end) {
  size_t from[3];
  s->next_id = 0;
  for (from[2] = 0; from[2] < b->count[2]; from[2]++)
    for (from[1] = 0; from[1] < b->count[1]; from[1]++)
      for (from[0] = 0; from[0] < b->count[0]; from[0]++) {
        const double porosity = left[block_at(b, from)];
        const struct blocks rest = {.porosity = left,
                                    .count = {b->count[0], b->count[1], b->count[2]}};
        size_t to[3], at[3];
        double low[3], length[3];
        if (!(porosity > 0)) continue;
        join_blocks(&rest, from, to);
        for (int a = 0; a < 3; a++)
          low[a] = b->edge[a][from[a]], length[a] = b->edge[a][to[a]] - low[a];
        for (at[2] = from[2]; at[2] < to[2]; at[2]++)
          for (at[1] = from[1]; at[1] < to[1]; at[1]++)
            for (at[0] = from[0]; at[0] < to[0]; at[0]++) left[block_at(b, at)] = 0;
        enum status status = fill_box(s, low, length, porosity, first, end);
        if (status != STATUS_OK) return status;
      }
  return STATUS_OK;
}

enum status isph_fill_measure(struct isph *s, const struct lattice *lattice) {
  struct blocks b = {0};
  const enum status status = find_blocks(s, lattice, &b, &s->porosity_most);
  free_blocks(&b);
  return status;
}

enum status isph_fill(struct isph *s, const struct lattice *lattice) {
  enum status status = STATUS_OK;
  struct blocks b = {0};
  double *left = NULL, largest;
  TRY(find_blocks(s, lattice, &b, &largest));
  const size_t n = b.count[0] * b.count[1] * b.count[2];
  const uint64_t ranks = (uint64_t)ranks_count(), own = (uint64_t)ranks_own();
  TRY(memory_allocate(&left, n, sizeof *left, "regions"));
  memcpy(left, b.porosity, n * sizeof *left);
  TRY(fill_all(s, &b, left, 0, 0));
  s->started = s->next_id;
  const uint64_t first = s->started * own / ranks, end = s->started * (own + 1) / ranks;
  TRY(isph_reserve(s, end > first ? (size_t)(end - first) : 1));
  memcpy(left, b.porosity, n * sizeof *left);
  TRY(fill_all(s, &b, left, first, end));
cleanup:
  free_blocks(&b);
  memory_free(&left);
  return status;
}
