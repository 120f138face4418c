/* Ordering of the fluid along the curve, distributed over ranks: keys determine the rank that sorts
 * a particle; the division into clusters proceeds from rank to rank; particles outside a rank's
 * partition are then sent to their owner. Equal keys keep their order, as in particles_sort. */
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/engine_ranks.h"
#include "sphsolve/wcsph/engine/order.h"

enum { KEY_BITS = 32, TAG_CLUSTERS = 9 };
/* Sources with this bit are indices of particles received from other ranks. */
#define RECEIVED 0x80000000u

/* The fluid, or walls on their sites, of which a cluster has only one region. */
struct ordered {
  struct particles *p;
  struct ghosts *g;
  bool walls;
  const uint16_t *region; /* NULL: there is only one region */
};

/* Transfers of particles: `leave` are the slots to be sent, ordered by rank; slot s then receives
 * the particle that `source` names, or stays empty. */
struct moves {
  uint32_t *leave;
  size_t *send, *start;
  uint32_t *source;
  size_t slots;
};

static void moves_free(struct moves *m) {
  MEMORY_FREE(&m->leave, &m->send, &m->start, &m->source);
}

static enum status moves_make(struct moves *m, size_t leaving) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  memset(m, 0, sizeof *m);
  TRY(memory_allocate(&m->send, ranks, sizeof *m->send, "particles that change hands"));
  TRY(memory_allocate(&m->start, ranks + 1, sizeof *m->start, "particles that change hands"));
  TRY(memory_allocate(&m->leave, leaving + 1, sizeof *m->leave, "particles that change hands"));
cleanup:
  return status;
}

/* Collective: applies the transfers field by field, using the memory of the new velocity. */
static enum status moves_apply(struct particles *p, struct moves *m) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), clusters = m->slots / CLUSTER;
  uint32_t *out = NULL, *in = NULL;
  struct slot_array kept[SLOT_ARRAYS];
  size_t leaving = 0;
  for (size_t r = 0; r < ranks; r++) leaving += m->send[r];
  const size_t before = p->clusters;
  TRY(particles_resize(p, clusters > before ? clusters : before));
  const size_t fields = particles_kept(p, kept);
  TRY(memory_allocate(&out, leaving + 1, sizeof *out, "particles that change hands"));
  for (size_t f = 0; f < fields; f++) {
    const uint32_t *from = *kept[f].array;
    const bool is_id = kept[f].array == (void **)&p->id;
    uint32_t *to = (uint32_t *)(void *)p->v_next[0];
    for (size_t k = 0; k < leaving; k++) out[k] = from[m->leave[k]];
    TRY(ghosts_exchange(sizeof *out, m->send, out, m->start, &in));
    uint32_t first = 0;
    for (size_t s = 0; s < m->slots; s++) {
      const uint32_t at = m->source[s];
      if (at == NO_PARTICLE)
        to[s] = is_id ? NO_PARTICLE : first;
      else
        to[s] = at >= RECEIVED ? in[at - RECEIVED] : from[at];
      if (s % CLUSTER == 0) first = to[s];
    }
    for (size_t s = m->slots; s < p->capacity; s++) to[s] = is_id ? NO_PARTICLE : 0;
    p->v_next[0] = *kept[f].array;
    *kept[f].array = to;
    memory_free(&in);
  }
  p->clusters = clusters;
cleanup:
  MEMORY_FREE(&out, &in);
  return status;
}

static size_t count_below(const uint64_t *entries, size_t n, uint64_t key) {
  size_t low = 0, high = n;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (entries[middle] >> 32 < key)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Collective: finds where the keys of each rank begin among the sorted local entries, such that
 * ranks keep their shares of the clusters. */
static enum status find_parts(const struct ghosts *g, const uint64_t *entries, size_t n,
                              size_t *part) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count();
  uint64_t *key = NULL;
  int64_t *below = NULL, all = (int64_t)n;
  TRY(memory_allocate(&key, ranks + 1, sizeof *key, "shares of the ranks"));
  TRY(memory_allocate(&below, ranks + 1, sizeof *below, "shares of the ranks"));
  ranks_sum_whole(&all, 1);
  /* The largest key with fewer entries below it than the preceding ranks' share. */
  for (int bit = KEY_BITS - 1; bit >= 0; bit--) {
    for (size_t r = 1; r < ranks; r++)
      below[r] = (int64_t)count_below(entries, n, key[r] | (uint64_t)1 << bit);
    ranks_sum_whole(below, ranks);
    for (size_t r = 1; r < ranks; r++) {
      const double share = (double)g->partition[r] / (double)g->partition[ranks];
      if ((double)below[r] < share * (double)all) key[r] |= (uint64_t)1 << bit;
    }
  }
  for (size_t r = 1; r < ranks; r++) part[r] = count_below(entries, n, key[r]);
  part[0] = 0;
  part[ranks] = n;
cleanup:
  MEMORY_FREE(&key, &below);
  return status;
}

static void keys_of(const struct ordered *o, uint64_t *entries, size_t *n) {
  struct particles *p = o->p;
  const struct frame *frame = &p->frame;
  const int bits = order_bits(frame);
  *n = 0;
  for (size_t i = 0; i < particles_slots(p); i++) {
    if (p->id[i] == NO_PARTICLE) continue;
    uint32_t cell[3];
    for (int a = 0; a < 3; a++) {
      p->x[a][i] = frame_fold(frame, a, p->x[a][i]);
      cell[a] =
          (uint32_t)(((uint64_t)p->x[a][i] * (2 * frame->sites[a])) >> (32 - frame->image_bits[a]));
      if (o->walls) cell[a] = frame->step[a] == 0 ? 0 : 2 * (p->x[a][i] / frame->step[a]);
    }
    entries[(*n)++] = (uint64_t)order_key(frame, bits, cell) << 32 | i;
  }
}

/* Sorts the particles over the ranks, without empty slots; *n: number on this rank. */
static enum status sort(const struct ordered *o, size_t *n) {
  enum status status = STATUS_OK;
  struct particles *p = o->p;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  uint64_t *entries = NULL, *scratch = NULL, *merged = NULL;
  uint32_t *out = NULL, *in = NULL;
  size_t *part = NULL;
  struct moves m = {0};
  TRY(memory_allocate(&entries, particles_slots(p) + 1, sizeof *entries, "sorting keys"));
  TRY(memory_allocate(&scratch, particles_slots(p) + 1, sizeof *scratch, "sorting keys"));
  TRY(memory_allocate(&part, ranks + 1, sizeof *part, "shares of the ranks"));
  keys_of(o, entries, n);
  order_sort(entries, scratch, *n);
  memory_free(&scratch);
  TRY(find_parts(o->g, entries, *n, part));
  const size_t stay = part[own + 1] - part[own], leaving = *n - stay;
  TRY(moves_make(&m, leaving));
  TRY(memory_allocate(&out, leaving + 1, sizeof *out, "sorting keys"));
  size_t k = 0;
  for (size_t r = 0; r < ranks; r++) {
    m.send[r] = r == own ? 0 : part[r + 1] - part[r];
    for (size_t e = part[r]; r != own && e < part[r + 1]; e++, k++) {
      m.leave[k] = (uint32_t)entries[e];
      out[k] = (uint32_t)(entries[e] >> 32);
    }
  }
  TRY(ghosts_exchange(sizeof *out, m.send, out, m.start, &in));
  memory_free(&out);
  const size_t come = m.start[ranks], total = stay + come, lower = m.start[own];
  TRY(memory_allocate(&merged, total + 1, sizeof *merged, "sorting keys"));
  for (size_t c = 0; c < come; c++)
    merged[c < lower ? c : c + stay] = (uint64_t)in[c] << 32 | RECEIVED | c;
  if (stay > 0) memcpy(merged + lower, entries + part[own], stay * sizeof *merged);
  MEMORY_FREE(&entries, &in);
  TRY(memory_allocate(&scratch, total + 1, sizeof *scratch, "sorting keys"));
  order_sort(merged, scratch, total);
  memory_free(&scratch);
  m.slots = (total + CLUSTER - 1) / CLUSTER * CLUSTER;
  TRY(memory_allocate(&m.source, m.slots + 1, sizeof *m.source, "particle order"));
  for (size_t s = 0; s < m.slots; s++) m.source[s] = s < total ? (uint32_t)merged[s] : NO_PARTICLE;
  memory_free(&merged);
  TRY(moves_apply(p, &m));
  *n = total;
cleanup:
  moves_free(&m);
  MEMORY_FREE(&entries, &scratch, &merged, &out, &in, &part);
  return status;
}

/* State of the division into clusters before a particle. */
struct clustering {
  struct cluster_builder builder;
  uint64_t used; /* slots used */
  uint16_t region;
};

/* Slot of particle k, the next one. */
static uint64_t next_slot(const struct ordered *o, size_t k, struct clustering *c) {
  const struct particles *p = o->p;
  const uint32_t x[3] = {p->x[0][k], p->x[1][k], p->x[2][k]};
  const uint16_t region = o->region != NULL ? o->region[p->id[k]] : 0;
  const bool turns = c->used > 0 && region != c->region;
  c->region = region;
  if (turns) c->builder.members = 0;
  if (!cluster_builder_takes(&c->builder, x) || turns)
    c->used = (c->used + CLUSTER - 1) / CLUSTER * CLUSTER;
  return c->used++;
}

/* Global slots of the n ordered particles of this rank; *total: number of clusters. Each rank first
 * divides as if it were the first one, then corrects this with the true state from the previous
 * rank: from the first common beginning of a cluster on, both agree. */
static void build_clusters(const struct ordered *o, size_t n, uint64_t *slot, size_t *total) {
  const int own = ranks_own(), last = ranks_count() - 1;
  struct clustering end, open;
  memset(&end, 0, sizeof end);
  cluster_builder_start(&end.builder, &o->p->frame, o->p->reach);
  for (size_t k = 0; k < n; k++) slot[k] = next_slot(o, k, &end);
  size_t same = 0;
  uint64_t more = 0;
  if (own > 0) {
    ranks_receive(&open, sizeof open, own - 1, TAG_CLUSTERS);
    ranks_wait();
    open.builder.frame = &o->p->frame;
    for (; same < n; same++) {
      const uint64_t at = next_slot(o, same, &open);
      more = at - slot[same];
      if (at % CLUSTER == 0 && slot[same] % CLUSTER == 0) break;
      slot[same] = at;
    }
    if (same < n)
      end.used += more;
    else
      end = open;
  }
  if (own < last) {
    ranks_send(&end, sizeof end, own + 1, TAG_CLUSTERS);
    ranks_wait();
  }
  for (size_t k = same; k < n; k++) slot[k] += more;
  const uint64_t clusters = (end.used + CLUSTER - 1) / CLUSTER;
  *total = (size_t)ranks_max((double)clusters);
}

/* Sends particles outside the partition to their owner, and moves all to their slots. */
static enum status redistribute(const struct ordered *o, size_t n, const uint64_t *slot) {
  enum status status = STATUS_OK;
  struct particles *p = o->p;
  const struct ghosts *g = o->g;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  const uint64_t first = (uint64_t)g->partition[own] * CLUSTER,
                 end = (uint64_t)g->partition[own + 1] * CLUSTER;
  uint64_t *out = NULL, *in = NULL;
  struct moves m;
  TRY(moves_make(&m, n));
  TRY(memory_allocate(&out, n + 1, sizeof *out, "particle order"));
  m.slots = (size_t)(end - first);
  TRY(memory_allocate(&m.source, m.slots + 1, sizeof *m.source, "particle order"));
  for (size_t s = 0; s < m.slots; s++) m.source[s] = NO_PARTICLE;
  size_t leaving = 0;
  for (size_t k = 0, r = 0; k < n; k++) {
    while (slot[k] >= (uint64_t)g->partition[r + 1] * CLUSTER) r++;
    if (r == own) {
      m.source[slot[k] - first] = (uint32_t)k;
      continue;
    }
    m.send[r]++;
    m.leave[leaving] = (uint32_t)k;
    out[leaving++] = slot[k];
  }
  TRY(ghosts_exchange(sizeof *out, m.send, out, m.start, &in));
  for (size_t c = 0; c < m.start[ranks]; c++) m.source[in[c] - first] = RECEIVED | (uint32_t)c;
  MEMORY_FREE(&out, &in);
  TRY(moves_apply(p, &m));
cleanup:
  moves_free(&m);
  MEMORY_FREE(&out, &in);
  return status;
}

enum status engine_order(struct engine *engine) {
  enum status status = STATUS_OK;
  struct ghosts *g = &engine->ranks.fluid;
  const struct ordered fluid = {&engine->particles, g, false, NULL};
  uint64_t *slot = NULL;
  size_t n = 0, clusters;
  TRY(engine_drop_ghosts(engine));
  TRY(sort(&fluid, &n));
  TRY(memory_allocate(&slot, n + 1, sizeof *slot, "particle order"));
  build_clusters(&fluid, n, slot, &clusters);
  TRY(engine_partition(engine, clusters));
  TRY(redistribute(&fluid, n, slot));
  g->begin = 0, g->end = engine->particles.clusters;
cleanup:
  memory_free(&slot);
  return status;
}

enum status engine_order_walls(struct engine *engine, double range) {
  enum status status = STATUS_OK;
  const struct lattice *l = engine->lattice;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  struct particles *p = &engine->particles, w = {.frame = p->frame, .reach = p->reach};
  struct ghosts *g = &engine->ranks.walls;
  const struct ordered walls = {&w, g, true, engine->fields.wall_region ? l->region : NULL};
  uint32_t *sites = NULL;
  uint64_t *slot = NULL;
  size_t n = 0, clusters;
  g->tag = 4;
  g->bytes_most = (size_t)(engine->fields.wall_v ? 4 : 2) * CLUSTER * sizeof(float);
  TRY(particles_find_walls(l, range, l->size[2] * own / ranks, l->size[2] * (own + 1) / ranks,
                           &sites, &n));
  TRY(particles_resize(&w, (n + CLUSTER - 1) / CLUSTER));
  for (size_t s = 0; s < particles_slots(&w); s++) {
    w.id[s] = s < n ? sites[s] : NO_PARTICLE;
    size_t at[3] = {0};
    if (s < n) {
      at[0] = sites[s] % l->size[0];
      at[1] = sites[s] / l->size[0] % l->size[1];
      at[2] = sites[s] / (l->size[0] * l->size[1]);
    }
    for (int a = 0; a < 3; a++) w.x[a][s] = frame_site_position(&w.frame, a, (uint32_t)at[a]);
  }
  memory_free(&sites);
  /* Initially even shares. */
  TRY(ghosts_partition(g, ranks * PARTITION_UNIT, PARTITION_UNIT, NULL));
  TRY(sort(&walls, &n));
  TRY(memory_allocate(&slot, n + 1, sizeof *slot, "wall order"));
  build_clusters(&walls, n, slot, &clusters);
  TRY(ghosts_partition(g, clusters, PARTITION_UNIT, NULL));
  TRY(redistribute(&walls, n, slot));
  g->begin = 0, g->end = w.clusters;
  TRY(particles_set_walls(l, range, &engine->fields, w.id, particles_slots(&w), p));
cleanup:
  MEMORY_FREE(&sites, &slot);
  particles_free(&w);
  return status;
}
