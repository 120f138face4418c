/* Walls of the engine: the selection of sites and their order. */
#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/order.h"
#include "sphsolve/wcsph/engine/particle_arrays.h"

size_t particles_bytes_wall(const struct particle_fields *fields) {
  return sizeof(uint32_t) + (fields->wall_depth ? sizeof(uint16_t) : 0) + slot_bytes(fields, WALL);
}

/* Moves one array with `size` bytes per cluster, and its padding. */
static enum status hold_array(void *array, size_t from, size_t count, size_t to, size_t clusters,
                              size_t held, size_t size) {
  enum status status = STATUS_OK;
  const size_t padding = SLOT_PADDING / CLUSTER;
  char *data;
  memcpy(&data, array, sizeof data);
  if (data == NULL) return STATUS_OK;
  if (clusters > held) TRY(memory_resize(array, clusters + padding, size, "wall particles"));
  memcpy(&data, array, sizeof data);
  memmove(data + to * size, data + from * size, count * size);
  TRY(memory_resize(array, clusters + padding, size, "wall particles"));
cleanup:
  return status;
}

enum status particles_hold_walls(struct particles *p, size_t from, size_t count, size_t to,
                                 size_t clusters) {
  enum status status = STATUS_OK;
  const struct particle_fields none = {0};
  const size_t held = p->wall_clusters, slot = CLUSTER * sizeof(float);
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = slot_arrays(p, &none, WALL, list);
  for (size_t f = 0; f < n; f++)
    TRY(hold_array(list[f].array, from, count, to, clusters, held, slot));
  TRY(hold_array(&p->site, from, count, to, clusters, held, slot));
  TRY(hold_array(&p->wall_depth, from, count, to, clusters, held, slot / 2));
  TRY(hold_array(&p->wall_region, from, count, to, clusters, held, sizeof *p->wall_region));
  p->wall_clusters = clusters;
  p->wall_sum = (uint32_t *)(void *)p->wall_state;
  for (size_t w = clusters * CLUSTER; p->site != NULL && w < clusters * CLUSTER + SLOT_PADDING; w++)
    p->site[w] = NO_SITE;
cleanup:
  return status;
}

void particles_drop_walls(struct particles *p) {
  const struct particle_fields none = {0};
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = slot_arrays(p, &none, WALL, list);
  for (size_t i = 0; i < n; i++) memory_free(list[i].array);
  MEMORY_FREE(&p->site, &p->wall_depth, &p->wall_region);
  p->wall_clusters = 0;
}

/* Marks sites of planes [first, end) that have fluid within a box of half width `range`: three
 * periodic sweeps, one per axis. */
static enum status mark_near_fluid(const struct lattice *lattice, double range, size_t first,
                                   size_t end, uint8_t **near) {
  enum status status = STATUS_OK;
  uint8_t *from = NULL, *to = NULL;
  const size_t plane = lattice->size[0] * lattice->size[1], planes = lattice->size[2];
  size_t stride[3] = {1, lattice->size[0], plane}, around[3];
  for (int a = 0; a < 3; a++) {
    around[a] = (size_t)ceil(range / lattice->spacing[a]);
    if (around[a] > lattice->size[a] / 2) around[a] = lattice->size[a] / 2;
    if (lattice->dimensions == 2 && a == 1) around[a] = 0;
  }
  /* If these are not all planes, the surrounding ones are included. */
  const size_t halo = end - first < planes ? around[2] : 0, held = end - first + 2 * halo;
  TRY(memory_allocate(&from, held * plane, 1, "wall search"));
  TRY(memory_allocate(&to, held * plane, 1, "wall search"));
  for (size_t k = 0; k < held; k++) {
    const size_t at = (first + k + planes - halo) % planes;
    for (size_t i = 0; i < plane; i++)
      from[k * plane + i] = lattice->kind[at * plane + i] == SITE_FLUID;
  }
  for (int a = 0; a < 3; a++) {
    const size_t n = a == 2 ? held : lattice->size[a];
    for (size_t i = 0; i < held * plane; i++) {
      size_t at = i / stride[a] % n;
      uint8_t any = 0;
      for (size_t j = at + n - around[a]; j <= at + n + around[a]; j++)
        any |= from[i + (j % n) * stride[a] - at * stride[a]];
      to[i] = any;
    }
    uint8_t *swap = from;
    from = to;
    to = swap;
  }
  memmove(from, from + halo * plane, (end - first) * plane);
  *near = from;
  from = NULL;
cleanup:
  MEMORY_FREE(&from, &to);
  return status;
}

enum status particles_find_walls(const struct lattice *lattice, double range, size_t first,
                                 size_t end, uint32_t **sites, size_t *count) {
  enum status status = STATUS_OK;
  uint8_t *near = NULL;
  const size_t plane = lattice->size[0] * lattice->size[1];
  *count = 0;
  if (lattice->wall_count == 0 || first == end) return STATUS_OK;
  TRY(mark_near_fluid(lattice, range, first, end, &near));
  for (int pass = 0; pass < 2; pass++) {
    if (pass == 1) TRY(memory_allocate(sites, *count, sizeof **sites, "wall sites"));
    *count = 0;
    for (size_t i = first * plane; i < end * plane; i++) {
      if (!near[i - first * plane] || lattice->kind[i] != SITE_WALL) continue;
      if (pass == 1) (*sites)[*count] = (uint32_t)i;
      ++*count;
    }
  }
cleanup:
  memory_free(&near);
  return status;
}

enum status particles_make_walls(const struct lattice *lattice, double range,
                                 const struct particle_fields *fields, struct particles *p) {
  enum status status = STATUS_OK;
  uint64_t *entries = NULL, *scratch = NULL;
  uint32_t *order, *sites = NULL;
  size_t n = 0, used = 0;
  const struct frame *frame = &p->frame;
  int bits = order_bits(frame);
  if (lattice->wall_count == 0) return STATUS_OK;
  TRY(particles_find_walls(lattice, range, 0, lattice->size[2], &sites, &n));
  TRY(memory_allocate(&entries, n, sizeof *entries, "sorting keys"));
  for (size_t k = 0; k < n; k++) {
    size_t at[3];
    site_of(lattice, sites[k], at);
    uint32_t cell[3] = {(uint32_t)at[0] * 2, (uint32_t)at[1] * 2, (uint32_t)at[2] * 2};
    entries[k] = (uint64_t)order_key(frame, bits, cell) << 32 | sites[k];
  }
  memory_free(&sites);
  TRY(memory_allocate(&scratch, n, sizeof *scratch, "sorting keys"));
  order_sort(entries, scratch, n);
  size_t held = 2 * n;
  order = (uint32_t *)(void *)scratch; /* as in particles_sort */
  struct cluster_builder builder;
  cluster_builder_start(&builder, frame, p->reach);
  for (size_t k = 0; k < n; k++) {
    size_t i = (uint32_t)entries[k], at[3];
    uint32_t x[3];
    if (used + 2 * CLUSTER > held) {
      held += held / 2 + 2 * CLUSTER;
      TRY(memory_resize(&scratch, held, sizeof *order, "wall order"));
      order = (uint32_t *)(void *)scratch;
    }
    site_of(lattice, i, at);
    for (int a = 0; a < 3; a++) x[a] = frame_site_position(frame, a, (uint32_t)at[a]);
    const bool turns = fields->wall_region && lattice->region != NULL && k > 0 &&
                       lattice->region[i] != lattice->region[(uint32_t)entries[k - 1]];
    if (turns) builder.members = 0;
    if (!cluster_builder_takes(&builder, x) || turns)
      while (used % CLUSTER != 0) order[used++] = NO_PARTICLE;
    order[used++] = (uint32_t)i;
  }
  while (used % CLUSTER != 0) order[used++] = NO_PARTICLE;
  memory_free(&entries);
  TRY(particles_set_walls(lattice, range, fields, order, used, p));
cleanup:
  MEMORY_FREE(&sites, &scratch, &entries);
  return status;
}

enum status particles_set_walls(const struct lattice *lattice, double range,
                                const struct particle_fields *fields, const uint32_t *order,
                                size_t used, struct particles *p) {
  enum status status = STATUS_OK;
  p->wall_clusters = used / CLUSTER;
  size_t capacity = used + SLOT_PADDING;
  TRY(memory_allocate(&p->site, capacity, sizeof *p->site, "wall sites"));
  if (fields->wall_depth) {
    p->depth_unit = WALL_DEPTH_MAX * range / UINT16_MAX;
    TRY(memory_allocate(&p->wall_depth, capacity, sizeof *p->wall_depth, "wall depths"));
  }
  if (fields->wall_region && lattice->region != NULL) {
    TRY(memory_allocate(&p->wall_region, capacity / CLUSTER, sizeof *p->wall_region, "wall sites"));
    for (size_t c = 0; c < p->wall_clusters; c++)
      p->wall_region[c] = lattice->region[order[c * CLUSTER]];
  }
  for (size_t s = 0; s < capacity; s++) {
    size_t i = s < used ? order[s] : NO_PARTICLE, at[3];
    p->site[s] = NO_SITE;
    if (i == NO_PARTICLE) continue;
    site_of(lattice, i, at);
    p->site[s] = 0;
    for (int a = 0; a < 3; a++) p->site[s] |= (uint32_t)at[a] << p->frame.site_shift[a];
    if (fields->wall_depth) {
      double depth = fmax(-(double)lattice->wall_distance[i], 0) / p->depth_unit;
      p->wall_depth[s] = (uint16_t)lrint(fmin(depth, UINT16_MAX));
    }
  }
  struct slot_array list[SLOT_ARRAYS];
  size_t arrays = slot_arrays(p, fields, WALL, list);
  for (size_t f = 0; f < arrays; f++)
    if (list[f].wanted)
      TRY(memory_allocate(list[f].array, capacity, sizeof(float), "wall particles"));
  p->wall_sum = (uint32_t *)(void *)p->wall_state;
cleanup:
  return status;
}
