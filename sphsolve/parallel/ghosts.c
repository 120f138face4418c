#include "sphsolve/parallel/ghosts.h"

#include <math.h>
#include <string.h>

#include "common/balance.h"
#include "common/memory.h"

/* Partition again by work if the load of the busiest rank exceeds the mean by this factor. */
#define IMBALANCE_MAX 1.05
#define TAG_ITEMS 8

static size_t units_of(size_t items, size_t unit) {
  return (items + unit - 1) / unit;
}

enum status ghosts_partition(struct ghosts *g, size_t items, size_t unit, const double *work) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  size_t *partition = NULL;
  double sum = 0;
  if (ranks == 1) {
    g->end = items;
    return STATUS_OK;
  }
  TRY(memory_allocate(&partition, ranks + 1, sizeof *partition, "shares of the ranks"));
  const bool known = g->partition != NULL && work != NULL && g->partition[ranks] > 0;
  const size_t units = known ? units_of(g->partition[ranks], unit) : ranks;
  for (size_t r = 0; r <= ranks; r++) partition[r] = known ? units_of(g->partition[r], unit) : r;
  const size_t here = known ? partition[own + 1] - partition[own] : 0;
  for (size_t u = 0; u < here; u++) sum += work[u];
  const double most = ranks_max(sum), total = ranks_sum(sum);
  if (known) g->imbalance = total > 0 ? most * (double)ranks / total : 1;
  if (known && g->imbalance > IMBALANCE_MAX)
    TRY(balance_partition(units, partition[own], here, work, partition));
  if (g->partition == NULL)
    TRY(memory_allocate(&g->partition, ranks + 1, sizeof *g->partition, "shares of the ranks"));
  for (size_t r = 0; r <= ranks; r++) {
    const double place = (double)partition[r] / (double)units;
    const size_t at = (size_t)lrint(place * (double)items / (double)unit) * unit;
    g->partition[r] = at < items && r < ranks ? at : items;
  }
  g->begin = g->partition[own];
  g->end = g->partition[own + 1];
cleanup:
  memory_free(&partition);
  return status;
}

void ghosts_free(struct ghosts *g) {
  MEMORY_FREE(&g->partition, &g->wanted, &g->number, &g->send, &g->receive, &g->send_start,
              &g->receive_start, &g->out, &g->in);
}

void ghosts_free_buffers(struct ghosts *g) {
  MEMORY_FREE(&g->out, &g->in);
}

enum status ghosts_plan_exchange(struct ghosts *g, size_t items) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  size_t n = 0, owner = 0, *counts = NULL;
  uint32_t *asked = NULL; /* indices in the arrays of the owner */
  MEMORY_FREE(&g->send, &g->receive);
  ghosts_free_buffers(g);
  if (g->send_start == NULL) {
    TRY(memory_allocate(&g->send_start, ranks + 1, sizeof *counts, "ghosts"));
    TRY(memory_allocate(&g->receive_start, ranks + 1, sizeof *counts, "ghosts"));
  }
  TRY(memory_allocate(&counts, 2 * ranks, sizeof *counts, "ghosts"));
  for (size_t c = 0; c < items; c++) n += g->wanted[c];
  TRY(memory_allocate(&g->receive, n + 1, sizeof *g->receive, "ghosts"));
  TRY(memory_allocate(&asked, n + 1, sizeof *asked, "ghosts"));
  n = 0;
  for (size_t c = 0; c < items; c++) {
    if (!g->wanted[c]) continue;
    const size_t number = ghosts_number(g, c);
    while (number >= g->partition[owner + 1]) g->receive_start[++owner] = n;
    g->receive[n] = (uint32_t)c;
    asked[n++] = (uint32_t)(number - g->partition[owner]);
    counts[owner]++;
  }
  while (owner < ranks) g->receive_start[++owner] = n;
  ranks_swap_counts(counts, counts + ranks);
  for (size_t r = 0; r < ranks; r++) g->send_start[r + 1] = g->send_start[r] + counts[ranks + r];
  const size_t m = g->send_start[ranks];
  TRY(memory_allocate(&g->send, m + 1, sizeof *g->send, "ghosts"));
  TRY(memory_allocate(&g->out, m + 1, g->bytes_most, "messages to ranks"));
  TRY(memory_allocate(&g->in, n + 1, g->bytes_most, "messages from ranks"));
  for (size_t r = 0; r < ranks; r++) {
    const size_t to = g->send_start[r], from = g->receive_start[r];
    if (g->send_start[r + 1] > to)
      ranks_receive(g->send + to, (g->send_start[r + 1] - to) * sizeof *g->send, (int)r, g->tag);
    if (g->receive_start[r + 1] > from)
      ranks_send(asked + from, (g->receive_start[r + 1] - from) * sizeof *asked, (int)r, g->tag);
  }
  ranks_wait();
  for (size_t k = 0; k < m; k++) g->send[k] += (uint32_t)g->begin;
cleanup:
  MEMORY_FREE(&counts, &asked);
  return status;
}

void ghosts_post(struct ghosts *g, int count, const struct ghost_field *fields) {
  const size_t ranks = (size_t)ranks_count();
  size_t width = 0;
  ghosts_finish(g);
  for (int f = 0; f < count; f++) {
    g->field[f] = fields[f];
    width += fields[f].size;
  }
  g->fields = count;
  g->pending = true;
  char *to = g->out;
  for (size_t k = 0; k < g->send_start[ranks]; k++)
    for (int f = 0; f < count; to += fields[f++].size)
      memcpy(to, (const char *)fields[f].data + g->send[k] * fields[f].size, fields[f].size);
  for (size_t r = 0; r < ranks; r++) {
    const size_t out = g->send_start[r], in = g->receive_start[r];
    if (g->receive_start[r + 1] > in)
      ranks_receive(g->in + in * width, (g->receive_start[r + 1] - in) * width, (int)r, g->tag);
    if (g->send_start[r + 1] > out)
      ranks_send(g->out + out * width, (g->send_start[r + 1] - out) * width, (int)r, g->tag);
  }
}

void ghosts_finish(struct ghosts *g) {
  if (!g->pending) return;
  ranks_wait();
  g->pending = false;
  const char *from = g->in;
  for (size_t k = 0; k < g->receive_start[ranks_count()]; k++)
    for (int f = 0; f < g->fields; from += g->field[f++].size)
      memcpy((char *)g->field[f].data + g->receive[k] * g->field[f].size, from, g->field[f].size);
}

void ghosts_add(struct ghosts *g, uint32_t *sums, size_t count) {
  const size_t ranks = (size_t)ranks_count(), width = count * sizeof *sums;
  ghosts_finish(g);
  /* The messages of ghosts_post in the opposite direction. */
  char *out = g->in, *in = g->out;
  for (size_t k = 0; k < g->receive_start[ranks]; k++)
    memcpy(out + k * width, sums + g->receive[k] * count, width);
  for (size_t r = 0; r < ranks; r++) {
    const size_t from = g->receive_start[r], to = g->send_start[r];
    if (g->send_start[r + 1] > to)
      ranks_receive(in + to * width, (g->send_start[r + 1] - to) * width, (int)r, g->tag);
    if (g->receive_start[r + 1] > from)
      ranks_send(out + from * width, (g->receive_start[r + 1] - from) * width, (int)r, g->tag);
  }
  ranks_wait();
  for (size_t k = 0; k < g->send_start[ranks]; k++)
    for (size_t i = 0; i < count; i++) {
      uint32_t share;
      memcpy(&share, in + k * width + i * sizeof share, sizeof share);
      sums[g->send[k] * count + i] += share;
    }
}

enum status ghosts_exchange(size_t size, const size_t *send, const void *out, size_t *start,
                            void *in) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  const char *from = out;
  char *to = NULL;
  ranks_swap_counts(send, start + 1);
  start[0] = 0;
  for (size_t r = 0; r < ranks; r++) start[r + 1] += start[r];
  TRY(memory_allocate(&to, start[ranks] + 1, size, "messages from ranks"));
  for (size_t r = 0; r < ranks; r++)
    if (r != own && start[r + 1] > start[r])
      ranks_receive(to + start[r] * size, (start[r + 1] - start[r]) * size, (int)r, TAG_ITEMS);
  for (size_t r = 0; r < ranks; r++) {
    if (r == own || send[r] == 0) continue;
    ranks_send(from, send[r] * size, (int)r, TAG_ITEMS);
    from += send[r] * size;
  }
  ranks_wait();
cleanup:
  memcpy(in, &to, sizeof to);
  return status;
}
