#include "sphsolve/isph/sort.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/particles.h"

enum { TAG = 5 };

static size_t layer_cells(const struct isph *s) {
  return (size_t)s->cells.count[s->cells.axis[0]] * (size_t)s->cells.count[s->cells.axis[1]];
}
static int layer_count(const struct isph *s) {
  return s->cells.count[s->cells.axis[2]];
}

/* The layer that holds the particle with that number in the order of all. */
static int layer_of(const struct isph *s, size_t number) {
  int low = 0, high = layer_count(s) - 1;
  while (low < high) {
    const int middle = (low + high + 1) / 2;
    if (s->layer_start[middle] <= (double)number)
      low = middle;
    else
      high = middle - 1;
  }
  return low;
}

/* Layers that rank r is responsible for: those of its own particles, and empty ones beside them. */
static bool layers_of(const struct isph *s, int r, int *low, int *high) {
  const size_t from = s->local.partition[r], to = s->local.partition[r + 1];
  if (from == to) return false;
  *low = from == 0 ? 0 : layer_of(s, from);
  *high = layer_count(s) - 1;
  if (to < s->total) {
    *high = layer_of(s, to);
    if (s->layer_start[*high] >= (double)to) --*high;
  }
  return true;
}

/* Whether a rank with own layers low .. high holds the particles of a layer. */
static bool is_held(const struct isph *s, int low, int high, int layer) {
  const int axis = s->cells.axis[2], n = layer_count(s);
  const int beyond = (int)ceil(s->support_max / s->cells.size[axis] - 1e-9);
  low -= beyond, high += beyond;
  if (layer >= low && layer <= high) return true;
  return s->periodic[axis] && (layer + n <= high || layer - n >= low);
}

bool isph_answers_for(const struct isph *s, const double x[3]) {
  if (!isph_is_distributed(s)) return true;
  const int layer = (int)(isph_cell_of(&s->cells, x) / layer_cells(s));
  for (int r = 0, low, high; r < ranks_count(); r++)
    if (layers_of(s, r, &low, &high) && layer <= high) return r == ranks_own();
  return false;
}

/* Divides all particles among the ranks, from the number of particles in each layer of cells. */
static enum status partition(struct isph *s) {
  enum status status = STATUS_OK;
  const size_t layers = (size_t)layer_count(s), plane = layer_cells(s);
  double *work = NULL;
  if (s->layer_start == NULL) {
    TRY(memory_allocate(&s->layer_start, layers + 1, sizeof *s->layer_start, "shares"));
    TRY(memory_allocate(&s->chunk_partition, (size_t)ranks_count() + 1, sizeof *s->chunk_partition,
                        "shares"));
  }
  memset(s->layer_start, 0, (layers + 1) * sizeof *s->layer_start);
  for (size_t i = 0; i < s->count; i++) s->layer_start[s->cell_of[i] / plane + 1]++;
  ranks_sum_all(s->layer_start, layers + 1);
  for (size_t l = 0; l < layers; l++) s->layer_start[l + 1] += s->layer_start[l];
  s->total = (size_t)s->layer_start[layers];
  s->local.tag = TAG;
  s->local.bytes_most = sizeof(double[6]);
  TRY(memory_allocate(&work, s->chunk_count + 1, sizeof *work, "shares"));
  for (size_t c = 0; c < s->chunk_count; c++)
    work[c] = (double)(s->chunks[c].pair_count + s->chunks[c].wall_count);
  TRY(ghosts_partition(&s->local, s->total, CHUNK, work));
  for (int r = 0; r <= ranks_count(); r++)
    s->chunk_partition[r] = (s->local.partition[r] + CHUNK - 1) / CHUNK;
cleanup:
  memory_free(&work);
  return status;
}

/* Each rank receives from all others the particles that it is to hold: those of lower ranks are
 * placed before the ones that it keeps, those of higher ranks behind. */
static enum status migrate(struct isph *s) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own(), plane = layer_cells(s);
  struct isph_kept state;
  char *out = NULL, *in = NULL;
  size_t *send = NULL, *start = NULL, n = 0, kept = 0;
  int low, high;
  isph_fields_kept(s, &state);
  TRY(memory_allocate(&send, ranks, sizeof *send, "shares"));
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "shares"));
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) TRY(memory_allocate(&out, n + 1, state.bytes, "particles that change hands"));
    n = 0;
    for (size_t r = 0; r < ranks; r++) {
      if (r == own || !layers_of(s, (int)r, &low, &high)) continue;
      for (size_t i = 0; i < s->count; i++) {
        if (!is_held(s, low, high, (int)(s->cell_of[i] / plane))) continue;
        if (pass == 0)
          send[r]++;
        else
          isph_kept_pack(s, &state, i, out + n * state.bytes);
        n++;
      }
    }
  }
  TRY(ghosts_exchange(state.bytes, send, out, start, &in));
  memory_free(&out);
  const bool any = layers_of(s, (int)own, &low, &high);
  for (size_t i = 0; any && i < s->count; i++)
    if (is_held(s, low, high, (int)(s->cell_of[i] / plane)))
      isph_kept_move(s, &state, kept++, i, 1);
  const size_t lower = start[own], all = start[ranks];
  TRY(isph_reserve(s, kept + all));
  isph_kept_move(s, &state, lower, 0, kept);
  for (size_t k = 0; k < all; k++)
    isph_kept_unpack(s, &state, k < lower ? k : kept + k, in + k * state.bytes);
  s->count = kept + all;
cleanup:
  memory_free(&send);
  memory_free(&start);
  memory_free(&out);
  memory_free(&in);
  return status;
}

static enum status distribute(struct isph *s) {
  enum status status = STATUS_OK;
  s->total = s->count;
  if (ranks_count() > 1) {
    for (size_t i = 0; i < s->count; i++) s->cell_of[i] = isph_cell_of(&s->cells, s->position[i]);
    TRY(partition(s));
    TRY(migrate(s));
  }
  if (s->total / CHUNK + 1 > s->partial_room) {
    s->partial_room = s->total / CHUNK * 9 / 8 + 1;
    TRY(memory_resize(&s->partial, s->partial_room, sizeof *s->partial, "sums"));
  }
cleanup:
  return status;
}

static void find_own(struct isph *s) {
  struct ghosts *g = &s->local;
  g->begin = 0, g->end = s->count;
  if (!isph_is_distributed(s)) return;
  const size_t plane = layer_cells(s), from = g->partition[ranks_own()];
  int low, high;
  bool before = false;
  g->runs = 0, g->end = 0;
  if (!layers_of(s, ranks_own(), &low, &high)) return;
  for (int l = 0; l < layer_count(s); l++) {
    const bool here = is_held(s, low, high, l);
    if (here && !before) {
      g->run[g->runs].here = s->cells.start[(size_t)l * plane];
      g->run[g->runs++].number = (size_t)s->layer_start[l];
    }
    before = here;
  }
  const int first = layer_of(s, from);
  g->begin = s->cells.start[(size_t)first * plane] + (from - (size_t)s->layer_start[first]);
  g->end = g->begin + (g->partition[ranks_own() + 1] - from);
}

/* Brings the state of the particles into `order`. */
static void permute(struct isph *s) {
  struct isph_kept state;
  char *to = s->scratch;
  const uint32_t *order = s->order;
  isph_fields_kept(s, &state);
  for (size_t k = 0; k < state.count; k++) {
    char *from = isph_field_data(s, &state.field[k]);
    const size_t size = state.field[k].size;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < s->count; i++) memcpy(to + i * size, from + order[i] * size, size);
    if (s->count > 0) memcpy(from, to, s->count * size);
  }
}

enum status isph_sort(struct isph *s) {
  enum status status = STATUS_OK;
  if (s->cells.start == NULL) TRY(isph_cells_shape(s, 0, &s->cells));
  TRY(distribute(s));
#pragma omp parallel for schedule(static)
  for (size_t i = 0; i < s->count; i++) s->cell_of[i] = isph_cell_of(&s->cells, s->position[i]);
  isph_cells_sort(&s->cells, s->count, s->cell_of, s->order);
  permute(s);
  find_own(s);
cleanup:
  return status;
}

enum status isph_find_ghosts(struct isph *s) {
  enum status status = STATUS_OK;
  struct ghosts *g = &s->local;
  if (!isph_is_distributed(s)) return STATUS_OK;
  TRY(memory_allocate(&g->wanted, s->count + 1, 1, "ghosts"));
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    chunk->outer = false;
    for (size_t p = 0; p < chunk->pair_count; p++) {
      size_t j = chunk->pair[p] & PAIR_MASK;
      if (j < g->begin || j >= g->end) g->wanted[j] = chunk->outer = true;
    }
  }
  /* isph_probe may read any particle. */
  for (size_t j = 0; s->on.open_sides && j < s->count; j++)
    g->wanted[j] = j < g->begin || j >= g->end;
  TRY(ghosts_plan_exchange(g, s->count));
cleanup:
  memory_free(&g->wanted);
  return status;
}
