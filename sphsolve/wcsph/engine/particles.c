#include "sphsolve/wcsph/engine/particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/order.h"

/* Depths of wall particles end here, in the reach of fluid: deeper ones act the same
 * (effects/wall_subvoxel.h). */
#define DEEPEST 1.2

struct each {
  void **array;
  bool wanted;
};

/* Every per-slot array of the fluid, 4 bytes each; the first `kept` travel with the particle. */
static size_t fluid_arrays(struct particles *p, const struct particle_fields *fields,
                           struct each list[24], size_t *kept) {
  size_t n = 0;
  for (int a = 0; a < 3; a++) list[n++] = (struct each){(void **)&p->x[a], true};
  for (int a = 0; a < 3; a++) list[n++] = (struct each){(void **)&p->v[a], true};
  list[n++] = (struct each){(void **)&p->state, true};
  list[n++] = (struct each){(void **)&p->id, true};
  for (int a = 0; a < 3; a++) list[n++] = (struct each){(void **)&p->shift[a], fields->shift};
  *kept = n;
  for (int a = 0; a < 3; a++) list[n++] = (struct each){(void **)&p->v_next[a], true};
  list[n++] = (struct each){(void **)&p->rate, fields->rate};
  for (int k = 0; k < 2; k++) list[n++] = (struct each){(void **)&p->flux[k], fields->eulerian};
  for (int k = 0; k < 5; k++)
    list[n++] = (struct each){(void **)&p->site_terms[k], fields->eulerian};
  return n;
}

static size_t wall_arrays(struct particles *p, const struct particle_fields *fields,
                          struct each list[24]) {
  size_t n = 0;
  list[n++] = (struct each){(void **)&p->wall_state, fields->wall_state};
  list[n++] = (struct each){(void **)&p->wall_base, fields->wall_base};
  for (int a = 0; a < 3; a++) list[n++] = (struct each){(void **)&p->wall_v[a], fields->wall_v};
  return n;
}

static size_t count_wanted(const struct each *list, size_t n) {
  size_t wanted = 0;
  /* cppcheck-suppress uninitvar ; the callers fill the first n entries in the argument n itself */
  for (size_t i = 0; i < n; i++) wanted += list[i].wanted;
  return wanted;
}

size_t particles_bytes_fluid(const struct particle_fields *fields) {
  struct particles none;
  struct each list[24];
  size_t kept;
  return 4 * count_wanted(list, fluid_arrays(&none, fields, list, &kept));
}

size_t particles_bytes_wall(const struct particle_fields *fields) {
  struct particles none;
  struct each list[24];
  return sizeof(uint32_t) + (fields->wall_depth ? sizeof(uint16_t) : 0) +
         4 * count_wanted(list, wall_arrays(&none, fields, list));
}

/* The fields a set of particles has, seen from what is allocated. */
static struct particle_fields fields_of(const struct particles *p) {
  return (struct particle_fields){
      .shift = p->shift[0] != NULL, .rate = p->rate != NULL, .eulerian = p->flux[0] != NULL};
}

static enum status grow_fluid(struct particles *p, const struct particle_fields *fields,
                              size_t slots) {
  enum status status = STATUS_OK;
  struct each list[24];
  size_t kept, n = fluid_arrays(p, fields, list, &kept), capacity = slots + SLOT_PADDING;
  if (capacity <= p->capacity) return STATUS_OK;
  for (size_t i = 0; i < n; i++)
    if (list[i].wanted) TRY(memory_resize(list[i].array, capacity, sizeof(float), "particles"));
  p->capacity = capacity;
cleanup:
  return status;
}

enum status particles_make_site_terms(struct particles *p) {
  enum status status = STATUS_OK;
  for (int k = 0; k < 2 && p->flux[k] == NULL; k++)
    TRY(memory_allocate(&p->flux[k], p->capacity, sizeof *p->flux[k], "flux of particles"));
  for (int k = 0; k < 5 && p->site_terms[k] == NULL; k++)
    TRY(memory_allocate(&p->site_terms[k], p->capacity, sizeof *p->site_terms[k], "site terms"));
cleanup:
  return status;
}

enum status particles_resize(struct particles *p, size_t clusters) {
  struct particle_fields fields = fields_of(p);
  enum status status = grow_fluid(p, &fields, clusters * CLUSTER);
  if (status != STATUS_OK) return status;
  p->clusters = clusters;
  for (size_t i = clusters * CLUSTER; i < p->capacity; i++) p->id[i] = NO_PARTICLE;
  return STATUS_OK;
}

enum status particles_hold(struct particles *p, size_t from, size_t count, size_t to,
                           size_t clusters) {
  struct each list[24];
  size_t kept;
  const struct particle_fields fields = fields_of(p);
  const enum status status = grow_fluid(p, &fields, clusters * CLUSTER);
  if (status != STATUS_OK) return status;
  const size_t n = fluid_arrays(p, &fields, list, &kept);
  for (size_t f = 0; f < n; f++) {
    if (!list[f].wanted || (f >= kept && f < kept + 3)) continue;
    uint32_t *array = *list[f].array;
    memmove(array + to * CLUSTER, array + from * CLUSTER, count * CLUSTER * sizeof *array);
  }
  p->clusters = clusters;
  for (size_t i = clusters * CLUSTER; i < p->capacity; i++) p->id[i] = NO_PARTICLE;
  return STATUS_OK;
}

/* Of `size` bytes a cluster, and for the padding behind them. */
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
  struct each list[24];
  const size_t n = wall_arrays(p, &none, list);
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
  struct each list[24];
  const size_t n = wall_arrays(p, &none, list);
  for (size_t i = 0; i < n; i++) memory_free(list[i].array);
  memory_free(&p->site);
  memory_free(&p->wall_depth);
  memory_free(&p->wall_region);
  p->wall_clusters = 0;
}

size_t particles_kept(struct particles *p, void **kept[16]) {
  const struct particle_fields fields = fields_of(p);
  struct each list[24];
  size_t count, n = 0;
  fluid_arrays(p, &fields, list, &count);
  for (size_t f = 0; f < count; f++)
    if (list[f].wanted) kept[n++] = list[f].array;
  return n;
}

enum status particles_sort(struct particles *p) {
  enum status status = STATUS_OK;
  uint64_t *entries = NULL, *scratch = NULL;
  uint32_t *order;
  const struct frame *frame = &p->frame;
  size_t slots = particles_slots(p), n = 0, used = 0, held = 2 * p->count;
  int bits = order_bits(frame);
  TRY(memory_allocate(&entries, p->count, sizeof *entries, "sorting keys"));
  TRY(memory_allocate(&scratch, p->count, sizeof *scratch, "sorting keys"));
  for (size_t i = 0; i < slots; i++)
    if (p->id[i] != NO_PARTICLE) entries[n++] = i;
#pragma omp parallel for schedule(static)
  for (size_t k = 0; k < n; k++) {
    size_t i = entries[k];
    uint32_t cell[3];
    for (int a = 0; a < 3; a++) {
      p->x[a][i] = frame_fold(frame, a, p->x[a][i]);
      cell[a] =
          (uint32_t)(((uint64_t)p->x[a][i] * (2 * frame->sites[a])) >> (32 - frame->image_bits[a]));
    }
    entries[k] = (uint64_t)order_key(frame, bits, cell) << 32 | i;
  }
  order_sort(entries, scratch, n);

  order = (uint32_t *)(void *)scratch; /* done with, and mostly large enough */
  struct cluster_builder builder;
  cluster_builder_start(&builder, frame, p->reach);
  for (size_t k = 0; k < n; k++) {
    uint32_t i = (uint32_t)entries[k], x[3] = {p->x[0][i], p->x[1][i], p->x[2][i]};
    if (used + 2 * CLUSTER > held) {
      held += held / 2 + 2 * CLUSTER;
      TRY(memory_resize(&scratch, held, sizeof *order, "particle order"));
      order = (uint32_t *)(void *)scratch;
    }
    if (!cluster_builder_takes(&builder, x))
      while (used % CLUSTER != 0) order[used++] = NO_PARTICLE;
    order[used++] = i;
  }
  while (used % CLUSTER != 0) order[used++] = NO_PARTICLE;

  struct particle_fields fields = fields_of(p);
  TRY(grow_fluid(p, &fields, used));
  struct each list[24];
  size_t kept;
  fluid_arrays(p, &fields, list, &kept);
  for (size_t f = 0; f < kept; f++) {
    if (!list[f].wanted) continue;
    const uint32_t *from = *list[f].array;
    uint32_t *to = (uint32_t *)(void *)p->v_next[0];
    bool is_id = list[f].array == (void **)&p->id;
    for (size_t s = 0, first = 0; s < used; s++) {
      if (s % CLUSTER == 0) first = order[s];
      to[s] = order[s] != NO_PARTICLE ? from[order[s]] : is_id ? NO_PARTICLE : from[first];
    }
    for (size_t s = used; s < p->capacity; s++) to[s] = is_id ? NO_PARTICLE : 0;
    p->v_next[0] = *list[f].array;
    *list[f].array = to;
  }
  p->clusters = used / CLUSTER;
cleanup:
  memory_free(&scratch);
  memory_free(&entries);
  return status;
}

/* Marks sites of planes [first, end) with fluid within `range`, as a box: three sweeps, one per
 * axis, periodic. */
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
  /* Where these are not all planes, with those around them. */
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
  memory_free(&from);
  memory_free(&to);
  return status;
}

static void site_of(const struct lattice *lattice, size_t i, size_t at[3]) {
  at[0] = i % lattice->size[0];
  at[1] = i / lattice->size[0] % lattice->size[1];
  at[2] = i / (lattice->size[0] * lattice->size[1]);
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

static enum status make_walls(const struct lattice *lattice, double range,
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
  memory_free(&sites);
  memory_free(&scratch);
  memory_free(&entries);
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
    p->depth_unit = DEEPEST * range / UINT16_MAX;
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
  struct each list[24];
  size_t arrays = wall_arrays(p, fields, list);
  for (size_t f = 0; f < arrays; f++)
    if (list[f].wanted)
      TRY(memory_allocate(list[f].array, capacity, sizeof(float), "wall particles"));
  p->wall_sum = (uint32_t *)(void *)p->wall_state;
cleanup:
  return status;
}

enum status particles_make(const struct lattice *lattice, double range, double reach,
                           double clearance, const struct particle_fields *fields,
                           struct particles *p) {
  enum status status = STATUS_OK;
  memset(p, 0, sizeof *p);
  frame_make(lattice, clearance, &p->frame);
  p->reach = reach;
  if (lattice->count >= NO_PARTICLE)
    TRY_FAIL(STATUS_INPUT, "%zu sites are more than one process takes (2^32 - 1)", lattice->count);
  if ((uint64_t)p->frame.site_mask[2] << p->frame.site_shift[2] > UINT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%zu x %zu x %zu sites are more than the engine takes (32 bits in all)",
             lattice->size[0], lattice->size[1], lattice->size[2]);
  /* The walls first: ordering them takes memory that the fluid does not need yet. */
  if (ranks_count() == 1) TRY(make_walls(lattice, range, fields, p));
  p->count = lattice->fluid_count;
cleanup:
  if (status != STATUS_OK) particles_free(p);
  return status;
}

enum status particles_place(const struct lattice *lattice, const struct particle_fields *fields,
                            size_t first, size_t count, struct particles *p) {
  enum status status = STATUS_OK;
  size_t slot = 0, number = 0;
  p->clusters = (count + CLUSTER - 1) / CLUSTER;
  TRY(grow_fluid(p, fields, p->clusters * CLUSTER));
  for (size_t i = 0; i < lattice->count && slot < count; i++) {
    if (lattice->kind[i] != SITE_FLUID || number++ < first) continue;
    size_t at[3];
    site_of(lattice, i, at);
    for (int a = 0; a < 3; a++) p->x[a][slot] = frame_site_position(&p->frame, a, (uint32_t)at[a]);
    p->id[slot++] = (uint32_t)i;
  }
  for (; slot < p->capacity; slot++) p->id[slot] = NO_PARTICLE;
cleanup:
  return status;
}

void particles_free(struct particles *p) {
  const struct particle_fields none = {0};
  struct each list[24];
  size_t kept;
  const size_t n = fluid_arrays(p, &none, list, &kept);
  for (size_t i = 0; i < n; i++) memory_free(list[i].array);
  particles_drop_walls(p);
  memory_free(&p->wall_velocity);
  memset(p, 0, sizeof *p);
}

void particles_position(const struct particles *p, const struct lattice *lattice, size_t slot,
                        double position[3]) {
  for (int a = 0; a < 3; a++) {
    const uint32_t half = p->frame.step[a] / 2;
    position[a] =
        lattice->origin[a] +
        p->frame.unit[a] * ((double)frame_fold(&p->frame, a, p->x[a][slot]) - (double)half);
  }
}
