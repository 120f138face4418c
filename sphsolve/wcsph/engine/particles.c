#include "sphsolve/wcsph/engine/particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/wcsph/engine/order.h"
#include "sphsolve/wcsph/engine/particle_arrays.h"

size_t particles_bytes_kept(const struct particle_fields *fields) {
  return slot_bytes(fields, KEPT);
}

size_t particles_bytes_fluid(const struct particle_fields *fields) {
  return slot_bytes(fields, FLUID);
}

/* The optional arrays that are allocated. */
static struct particle_fields fields_of(const struct particles *p) {
  return (struct particle_fields){
      .shift = p->shift[0] != NULL, .rate = p->rate != NULL, .eulerian = p->flux[0] != NULL};
}

static enum status grow_fluid(struct particles *p, const struct particle_fields *fields,
                              size_t slots) {
  enum status status = STATUS_OK;
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = slot_arrays(p, fields, FLUID, list), capacity = slots + SLOT_PADDING;
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
  struct slot_array list[SLOT_ARRAYS];
  const struct particle_fields fields = fields_of(p);
  const enum status status = grow_fluid(p, &fields, clusters * CLUSTER);
  if (status != STATUS_OK) return status;
  const size_t n = slot_arrays(p, &fields, KEPT | STEP, list);
  for (size_t f = 0; f < n; f++) {
    if (!list[f].wanted) continue;
    uint32_t *array = *list[f].array;
    memmove(array + to * CLUSTER, array + from * CLUSTER, count * CLUSTER * sizeof *array);
  }
  p->clusters = clusters;
  for (size_t i = clusters * CLUSTER; i < p->capacity; i++) p->id[i] = NO_PARTICLE;
  return STATUS_OK;
}

size_t particles_kept(struct particles *p, struct slot_array kept[SLOT_ARRAYS]) {
  const struct particle_fields fields = fields_of(p);
  const size_t all = slot_arrays(p, &fields, KEPT, kept);
  size_t n = 0;
  for (size_t f = 0; f < all; f++)
    if (kept[f].wanted) kept[n++] = kept[f];
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

  order = (uint32_t *)(void *)scratch; /* reuses its memory, which is usually large enough */
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
  struct slot_array list[SLOT_ARRAYS];
  const size_t kept = particles_kept(p, list);
  for (size_t f = 0; f < kept; f++) {
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
  MEMORY_FREE(&scratch, &entries);
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
    TRY_FAIL(STATUS_INPUT, "%zu points are more than one process takes (2^32 - 1)", lattice->count);
  if ((uint64_t)p->frame.site_mask[2] << p->frame.site_shift[2] > UINT32_MAX)
    TRY_FAIL(STATUS_INPUT, "%zu x %zu x %zu points are more than the engine takes (32 bits in all)",
             lattice->size[0], lattice->size[1], lattice->size[2]);
  /* Walls first, as their ordering needs memory that the fluid does not occupy yet. */
  if (ranks_count() == 1) TRY(particles_make_walls(lattice, range, fields, p));
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
  struct slot_array list[SLOT_ARRAYS];
  const size_t n = slot_arrays(p, &none, FLUID, list);
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
