/* Gathering of the columns of a row cluster: relative to its present position, in single precision
 * and in units of 2 h, image by image, without those out of reach of all its rows; and the geometry
 * of a pair. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_GATHER_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_GATHER_H

#include <math.h>
#include <string.h>

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/engine/pairs.h"
#include "sphsolve/wcsph/engine/simd.h"

/* Lengths in the buffer are in units of 2 h: the square root is computed doubled (simd.h), so that
 * it is r/h without another operation. */
#define FAR_AWAY 1e6f
/* Largest number of sums of a row over its columns. */
#define MAX_SUMS 12

enum local_field { LX, LY, LZ, LVX, LVY, LVZ, LSTATE, LTERM, LWEIGHT = LVX, LSLOT, LMASK };
/* Additional data of walls: the depth in h as LSTATE; the source of the columns, i.e. the lanes
 * LMASK of the vectors from slot LSLOT on (both integers), local->entries of them; and the
 * prescribed velocity as the first three fields. */
enum gather_more { GATHER_DEPTH = 1, GATHER_PLACE = 2, GATHER_MOVE = 4 };

/* Present position of a row cluster. */
struct reference {
  uint32_t centre[3];
  float half[3]; /* 2 h */
  uint32_t x[CLUSTER][3];
  bool live[CLUSTER];
};

SIMD_INLINE void reference_make(const struct pass *pass, size_t cluster, bool wall,
                                struct reference *ref) {
  const struct particles *p = pass->particles;
  int first = -1;
  int32_t low[3] = {0}, high[3] = {0};
  for (int l = 0; l < CLUSTER; l++) {
    size_t i = cluster * CLUSTER + (size_t)l;
    ref->live[l] = wall ? p->site[i] != NO_SITE : p->id[i] != NO_PARTICLE;
    if (!ref->live[l]) continue;
    for (int a = 0; a < 3; a++)
      ref->x[l][a] = wall ? frame_wall_position(&p->frame, a, p->site[i]) : p->x[a][i];
    if (first < 0) first = l;
    for (int a = 0; a < 3; a++) {
      int32_t d = (int32_t)(ref->x[l][a] - ref->x[first][a]);
      low[a] = d < low[a] ? d : low[a];
      high[a] = d > high[a] ? d : high[a];
    }
  }
  for (int a = 0; a < 3; a++) {
    uint32_t span = (uint32_t)high[a] - (uint32_t)low[a];
    ref->centre[a] = (first < 0 ? 0 : ref->x[first][a]) + (uint32_t)low[a] + span / 2;
    ref->half[a] = (float)(span - span / 2) * pass->scale[a];
  }
}

/* Appends the columns of one list within reach of the cluster to the buffer from `n` on, with
 * `fields` values each from `source` (NULL: zeros) after the position. Returns the new count. */
SIMD_INLINE size_t gather_columns(const struct pass *pass, struct local *local, size_t n,
                                  const struct neighbour_list *list, size_t row, bool wall,
                                  const struct reference *ref, int fields,
                                  const float *const *source, int more) {
  const struct particles *p = pass->particles;
  size_t words;
  struct list_reader reader = {.word = list_row(list, row, &words)};
  reader.end = reader.word + words;
  float *field[LOCAL_FIELDS];
  for (int f = 0; f < LOCAL_FIELDS; f++) field[f] = local->field[f];
  /* Copies, as the stores below would otherwise make the compiler reload these values. */
  const uint32_t *const *x_of = (const uint32_t *const *)p->x;
  const uint32_t *places[3] = {x_of[0], x_of[1], x_of[2]}, *ids = p->id, *sites = p->site;
  const uint32_t step[3] = {p->frame.step[0], p->frame.step[1], p->frame.step[2]};
  const uint32_t site_mask[3] = {p->frame.site_mask[0], p->frame.site_mask[1],
                                 p->frame.site_mask[2]};
  const uint32_t site_shift[3] = {(uint32_t)p->frame.site_shift[0],
                                  (uint32_t)p->frame.site_shift[1],
                                  (uint32_t)p->frame.site_shift[2]};
  const size_t capacity = local->capacity;
  size_t entries = 0;
  uvec origin[3];
  vec scale[3], half[3], limit = vec_set(pass->radius * pass->radius), zero = vec_set(0.0f);
  vec depth_unit = vec_set((float)(p->depth_unit / pass->smoothing_length));
  for (int a = 0; a < 3; a++) {
    scale[a] = vec_set(pass->scale[a]);
    half[a] = vec_set(ref->half[a]);
    origin[a] = uvec_set(ref->centre[a] - (wall ? p->frame.step[a] / 2 : 0));
  }
  while (list_next(&reader)) {
    if (__builtin_expect(reader.turned, 0))
      for (int a = 0; a < 3; a++) {
        uint32_t image = reader.image >> (IMAGE_BITS * a) & ((1u << IMAGE_BITS) - 1);
        int bits = p->frame.image_bits[a];
        uint32_t offset = bits == 0 ? 0 : image << (32 - bits);
        origin[a] = uvec_set(ref->centre[a] - offset - (wall ? p->frame.step[a] / 2 : 0));
      }
    if (n + 2 * SIMD_LANES > capacity) {
      local->overflow = true;
      break;
    }
    size_t start = (size_t)reader.cluster * CLUSTER;
    uint32_t lanes = reader.pair ? 0xffffu : 0xffu;
    for (size_t k = 0; k < SIMD_LANES; k += SIMD_WIDTH) {
      size_t slot = start + k;
      vec x[3], sum = zero;
      uint32_t mask = lanes >> k;
      if (SIMD_WIDTH < SIMD_LANES && mask == 0) break;
      if (wall) {
        uvec site = uvec_load(sites + slot);
        mask &= uvec_differ(site, uvec_set(NO_SITE));
        for (int a = 0; a < 3; a++)
          x[a] = vec_from((site >> site_shift[a] & site_mask[a]) * step[a] - origin[a]);
      } else {
        mask &= uvec_differ(uvec_load(ids + slot), uvec_set(NO_PARTICLE));
        for (int a = 0; a < 3; a++) x[a] = vec_from(uvec_load(places[a] + slot) - origin[a]);
      }
      for (int a = 0; a < 3; a++) {
        x[a] *= scale[a];
        vec gap = vec_beyond(x[a], half[a]);
        sum += gap * gap;
      }
      mask &= vec_below(sum, limit);
      for (int a = 0; a < 3; a++) vec_compress(field[a] + n, mask, x[a]);
      for (int f = 0; f < fields; f++) {
        vec value = zero;
        if (f < 3 && more & GATHER_MOVE) {
          if (p->wall_velocity != NULL)
            value = vec_halves(p->wall_velocity[p->wall_region[slot / CLUSTER]][f],
                               p->wall_velocity[p->wall_region[slot / CLUSTER + 1]][f]);
        } else if (source[f] != NULL) {
          value = vec_load(source[f] + slot);
        }
        vec_compress(field[LVX + f] + n, mask, value);
      }
      if (more & GATHER_PLACE) {
        const uint32_t from = (uint32_t)slot;
        memcpy(field[LSLOT] + entries, &from, sizeof from);
        memcpy(field[LMASK] + entries, &mask, sizeof mask);
        entries += mask != 0;
      }
      if (more & GATHER_DEPTH)
        vec_compress(field[LSTATE] + n, mask,
                     vec_from(uvec_load16(p->wall_depth + slot)) * depth_unit);
      n += (size_t)__builtin_popcount(mask);
    }
  }
  if (more & GATHER_PLACE) local->entries = entries;
  return n;
}

/* Pads to full vectors with columns out of reach of all rows. */
SIMD_INLINE size_t pad_columns(struct local *local, size_t n, int fields) {
  size_t full = (n + SIMD_LANES - 1) / SIMD_LANES * SIMD_LANES;
  for (; n < full; n++) {
    for (int a = 0; a < 3; a++) local->field[a][n] = FAR_AWAY;
    for (int f = 0; f < fields; f++) local->field[LVX + f][n] = 0;
  }
  return full;
}

/* Offset of column vector k from the row, in 2 h; s = r/h; inverse = 4/s. */
struct geometry {
  vec x, y, z, s, inverse;
};
SIMD_INLINE struct geometry pair_geometry(const struct local *local, size_t k, const vec at[3]) {
  struct geometry g;
  g.x = vec_load(local->field[LX] + k) - at[0];
  g.y = vec_load(local->field[LY] + k) - at[1];
  g.z = vec_load(local->field[LZ] + k) - at[2];
  vec square = g.x * g.x + (g.y * g.y + (g.z * g.z + (float)PAIR_TINY));
  g.s = vec_twice_sqrt(square, &g.inverse);
  return g;
}

SIMD_INLINE void row_position(const struct pass *pass, const struct reference *ref, int l,
                              vec at[3]) {
  for (int a = 0; a < 3; a++)
    at[a] = vec_set((float)(int32_t)(ref->x[l][a] - ref->centre[a]) * pass->scale[a]);
}

/* Row l of a row cluster: the slot of its particle and its position for pair_geometry; false if the
 * slot is empty. */
SIMD_INLINE bool row_begin(const struct pass *pass, const struct reference *ref, size_t cluster,
                           int l, size_t *slot, vec at[3]) {
  if (!ref->live[l]) return false;
  *slot = cluster * CLUSTER + (size_t)l;
  row_position(pass, ref, l, at);
  return true;
}

/* Gathers a row cluster of fluid with its columns of fluid, `fields` values each from `source`.
 * Returns their number, padded to full vectors. */
SIMD_INLINE size_t gather_fluid(const struct pass *pass, struct local *local, size_t cluster,
                                int fields, const float *const *source, struct reference *ref) {
  reference_make(pass, cluster, false, ref);
  const size_t n =
      gather_columns(pass, local, 0, pass->fluid_fluid, cluster, false, ref, fields, source, 0);
  return pad_columns(local, n, fields);
}

/* Sums over the columns of a row: of the pressure, of velocity differences with the weights of
 * viscosity and shift, and of the offsets (the gradient of the particle concentration). */
struct row_force {
  double pressure[3], velocity[3], concentration[3];
};

#endif
