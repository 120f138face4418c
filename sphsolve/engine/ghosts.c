#include "sphsolve/engine/ghosts.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"

/* Cut anew by work where the busiest rank has so much more than the mean. */
#define IMBALANCE_MOST 1.05
#define FIELD_BYTES (CLUSTER * sizeof(float))

/* The place, as a share of all clusters, up to which the runs of the last cut held `wanted` work.
 */
static double place_of(const size_t *cut, const double *work, double wanted) {
  const int ranks = ranks_count();
  double sum = 0;
  for (int r = 0; r < ranks; r++) {
    if (work[r] > 0 && sum + work[r] >= wanted)
      return ((double)cut[r] + (double)(cut[r + 1] - cut[r]) * (wanted - sum) / work[r]) /
             (double)cut[ranks];
    sum += work[r];
  }
  return 1;
}

enum status ghosts_cut(struct ghosts *g, size_t clusters, const double *work) {
  enum status status = STATUS_OK;
  const int ranks = ranks_count();
  size_t *old = g->cut;
  if (ranks == 1) {
    g->end = clusters;
    return STATUS_OK;
  }
  double total = 0, most = 0;
  g->cut = NULL;
  TRY(memory_allocate(&g->cut, (size_t)ranks + 1, sizeof *g->cut, "shares of the ranks"));
  for (int r = 0; r < ranks && work != NULL; r++) {
    total += work[r];
    most = fmax(most, work[r]);
  }
  g->imbalance = total > 0 ? most * ranks / total : 1;
  for (int r = 1; r < ranks; r++) {
    double place = (double)r / ranks;
    if (old != NULL && total > 0)
      place = g->imbalance > IMBALANCE_MOST ? place_of(old, work, total * r / ranks)
                                            : (double)old[r] / (double)old[ranks];
    size_t units = (size_t)lrint(place * (double)clusters / GHOST_UNIT);
    g->cut[r] = units * GHOST_UNIT < clusters ? units * GHOST_UNIT : clusters;
  }
  g->cut[ranks] = clusters;
  g->begin = g->cut[ranks_own()];
  g->end = g->cut[ranks_own() + 1];
cleanup:
  memory_free(&old);
  return status;
}

void ghosts_free(struct ghosts *g) {
  memory_free(&g->cut);
  memory_free(&g->wanted);
  memory_free(&g->send);
  memory_free(&g->receive);
  memory_free(&g->send_start);
  memory_free(&g->receive_start);
  memory_free(&g->out);
  memory_free(&g->in);
}

bool ghosts_want(struct ghosts *g, const struct neighbour_list *list, size_t begin, size_t end) {
  bool any = false;
  for (size_t row = begin; row < end; row++) {
    size_t words;
    struct list_reader reader = {.word = list_row(list, row, &words)};
    reader.end = reader.word + words;
    while (list_next(&reader))
      for (size_t c = reader.cluster; c <= reader.cluster + (reader.pair ? 1 : 0); c++)
        if (c < g->begin || c >= g->end) g->wanted[c] = any = true;
  }
  return any;
}

enum status ghosts_agree(struct ghosts *g, size_t clusters) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  size_t n = 0, *counts = NULL;
  memory_free(&g->send);
  memory_free(&g->receive);
  memory_free(&g->out);
  memory_free(&g->in);
  if (g->send_start == NULL) {
    TRY(memory_allocate(&g->send_start, ranks + 1, sizeof *counts, "ghosts"));
    TRY(memory_allocate(&g->receive_start, ranks + 1, sizeof *counts, "ghosts"));
  }
  TRY(memory_allocate(&counts, 2 * ranks, sizeof *counts, "ghosts"));
  for (size_t c = 0; c < clusters; c++) n += g->wanted[c];
  TRY(memory_allocate(&g->receive, n + 1, sizeof *g->receive, "ghosts"));
  n = 0;
  for (size_t r = 0; r < ranks; r++) {
    g->receive_start[r] = n;
    for (size_t c = g->cut[r]; c < g->cut[r + 1]; c++)
      if (g->wanted[c]) g->receive[n++] = (uint32_t)c;
    counts[r] = n - g->receive_start[r];
  }
  g->receive_start[ranks] = n;
  ranks_swap_counts(counts, counts + ranks);
  for (size_t r = 0; r < ranks; r++) g->send_start[r + 1] = g->send_start[r] + counts[ranks + r];
  const size_t m = g->send_start[ranks];
  TRY(memory_allocate(&g->send, m + 1, sizeof *g->send, "ghosts"));
  TRY(memory_allocate(&g->out, (m + 1) * GHOST_FIELDS, FIELD_BYTES, "messages to ranks"));
  TRY(memory_allocate(&g->in, (n + 1) * GHOST_FIELDS, FIELD_BYTES, "messages from ranks"));
  for (size_t r = 0; r < ranks; r++) {
    const size_t to = g->send_start[r], from = g->receive_start[r];
    if (g->send_start[r + 1] > to)
      ranks_receive(g->send + to, (g->send_start[r + 1] - to) * sizeof *g->send, (int)r, g->tag);
    if (g->receive_start[r + 1] > from)
      ranks_send(g->receive + from, (g->receive_start[r + 1] - from) * sizeof *g->send, (int)r,
                 g->tag);
  }
  ranks_wait();
cleanup:
  memory_free(&counts);
  return status;
}

void ghosts_post(struct ghosts *g, int fields, void *const *arrays) {
  const size_t ranks = (size_t)ranks_count(), width = (size_t)fields * FIELD_BYTES;
  ghosts_finish(g);
  g->fields = fields;
  g->pending = true;
  memcpy(g->array, arrays, (size_t)fields * sizeof *arrays);
  char *out = (char *)g->out, *in = (char *)g->in;
  for (size_t k = 0; k < g->send_start[ranks]; k++)
    for (int f = 0; f < fields; f++)
      memcpy(out + k * width + (size_t)f * FIELD_BYTES,
             (const char *)arrays[f] + g->send[k] * FIELD_BYTES, FIELD_BYTES);
  for (size_t r = 0; r < ranks; r++) {
    const size_t from = g->send_start[r], to = g->receive_start[r];
    if (g->receive_start[r + 1] > to)
      ranks_receive(in + to * width, (g->receive_start[r + 1] - to) * width, (int)r, g->tag);
    if (g->send_start[r + 1] > from)
      ranks_send(out + from * width, (g->send_start[r + 1] - from) * width, (int)r, g->tag);
  }
}

void ghosts_finish(struct ghosts *g) {
  const size_t ranks = (size_t)ranks_count(), width = (size_t)g->fields * FIELD_BYTES;
  if (!g->pending) return;
  ranks_wait();
  g->pending = false;
  const char *in = (const char *)g->in;
  for (size_t k = 0; k < g->receive_start[ranks]; k++)
    for (int f = 0; f < g->fields; f++)
      memcpy((char *)g->array[f] + g->receive[k] * FIELD_BYTES,
             in + k * width + (size_t)f * FIELD_BYTES, FIELD_BYTES);
}

enum status ghosts_gather(const struct ghosts *g, void *array, size_t size) {
  if (g->cut != NULL) ranks_gather(array, g->cut, size);
  return STATUS_OK;
}
