#include "sphsolve/isph/candidates.h"

#include <math.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/wall.h"

/* Whether the wall particle of an entry has moved out of the domain through a reflecting side. */
static bool is_beyond(const struct isph *s, uint32_t entry) {
  const double *x = s->boundary_position[entry & PAIR_MASK];
  for (int a = 0; a < 3; a++)
    if ((s->reflects[a][0] && x[a] < s->low[a]) || (s->reflects[a][1] && x[a] > s->high[a]))
      return true;
  return false;
}

struct isph_group isph_group_from(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                                  bool alone) {
  struct isph_group g = {.begin = i, .end = i + 1, .support = s->support[i]};
  memcpy(g.low, s->position[i], sizeof g.low);
  memcpy(g.high, s->position[i], sizeof g.high);
  for (size_t k = i + 1; !alone && k < chunk->end && k < i + GROUP_MOST; k++, g.end++) {
    const double most = GROUP_EXTENT * s->support[k];
    double low[3], high[3];
    bool near = true;
    for (int a = 0; a < 3; a++) {
      const double x = s->position[k][a];
      low[a] = x < g.low[a] ? x : g.low[a], high[a] = x > g.high[a] ? x : g.high[a];
      near = near && high[a] - low[a] <= most;
    }
    if (!near) break;
    memcpy(g.low, low, sizeof low), memcpy(g.high, high, sizeof high);
    g.support = fmax(g.support, s->support[k]);
  }
  return g;
}

typedef int64_t eight_flags __attribute__((vector_size(64)));
typedef uint8_t eight_bytes __attribute__((vector_size(8), may_alias));
typedef uint16_t eight_places __attribute__((vector_size(16), aligned(2), may_alias));
typedef uint32_t eight_entries __attribute__((vector_size(32), aligned(4), may_alias));

/* Appends the particles of a stretch to the candidates, eight at a time: those beyond its end are
 * overwritten by the next. */
TARGETS static void add_stretch(const struct isph *s, const struct isph_stretch *of,
                                struct isph_candidates *c) {
  const struct isph_image *image = &s->image[of->code];
  const double turned = image->reflected && isph_sides_hold(s) ? 1 : 0;
  const double *turn = image->turn, *shift = image->shift;
  for (uint32_t k = of->begin, to = (uint32_t)c->count; k < of->end;
       k += EIGHT_WIDE, to += EIGHT_WIDE) {
    double(*const x)[3] = &s->position[k];
    for (int a = 0; a < 3; a++) {
      const eight at = {x[0][a], x[1][a], x[2][a], x[3][a], x[4][a], x[5][a], x[6][a], x[7][a]};
      EIGHT(c->x[a], to) = at * turn[a] + shift[a];
    }
    const eight volume = EIGHT(s->volume, k);
    EIGHT(c->half, to) = 0.5 * EIGHT(s->support, k);
    EIGHT(c->volume, to) = volume, EIGHT(c->turned, to) = turned * volume;
    for (uint32_t l = 0; l < EIGHT_WIDE; l++) c->entry[to + l] = (k + l) | of->code << PAIR_BITS;
  }
  c->count += of->end - of->begin;
}

/* Appends the wall particles of a stretch. */
static void add_walls(const struct isph *s, const struct isph_stretch *of,
                      struct isph_candidates *c) {
  const struct isph_image *image = &s->image[of->code];
  for (uint32_t k = of->begin; k < of->end; k++) {
    const uint32_t j = s->wall_order[k], entry = j | of->code << PAIR_BITS;
    if (image->reflected && is_beyond(s, entry)) continue;
    const size_t to = c->count++;
    c->entry[to] = entry;
    for (int a = 0; a < 3; a++)
      c->x[a][to] = s->boundary_position[j][a] * image->turn[a] + image->shift[a];
    c->half[to] = c->turned[to] = 0, c->volume[to] = isph_wall_volume(s, j);
  }
}

bool isph_find_candidates(const struct isph *s, const struct isph_group *g, bool walls,
                          struct isph_candidates *c) {
  struct isph_stretch near[ISPH_STRETCHES];
  const double reach = walls ? g->support : 0.5 * (g->support + s->support_now);
  const size_t n =
      isph_cells_collect(s, walls ? &s->wall_cells : &s->cells, g->low, g->high, reach, near);
  c->count = 0;
  if (n == ISPH_STRETCHES) return false;
  for (size_t k = 0; k < n; k++)
    if (walls)
      add_walls(s, &near[k], c);
    else
      add_stretch(s, &near[k], c);
  for (size_t k = c->count; k % EIGHT_WIDE != 0; k++) /* none that is found */
    c->x[0][k] = INFINITY, c->x[1][k] = c->x[2][k] = c->half[k] = 0, c->entry[k] = 0;
  return true;
}

/* The places of the bits that are set in a byte, one in each byte of the value, in their order. */
#define PLACE(b, l)                                                                                \
  ((b) >> (l)&1 ? (uint64_t)(l) << 8 * __builtin_popcount((b) & ((1u << (l)) - 1)) : 0)
#define PLACES(b)                                                                                  \
  PLACE(b, 0) | PLACE(b, 1) | PLACE(b, 2) | PLACE(b, 3) | PLACE(b, 4) | PLACE(b, 5) |              \
      PLACE(b, 6) | PLACE(b, 7)
#define PLACES_4(b) PLACES(b), PLACES((b) + 1u), PLACES((b) + 2u), PLACES((b) + 3u)
#define PLACES_16(b) PLACES_4(b), PLACES_4((b) + 4u), PLACES_4((b) + 8u), PLACES_4((b) + 12u)
#define PLACES_64(b) PLACES_16(b), PLACES_16((b) + 16u), PLACES_16((b) + 32u), PLACES_16((b) + 48u)
static const uint64_t places[256] = {PLACES_64(0u), PLACES_64(64u), PLACES_64(128u),
                                     PLACES_64(192u)};

/* Eight at a time. */
TARGETS size_t isph_choose(const struct isph_candidates *c, const double x[3], double half,
                           uint32_t own, uint16_t *chosen) {
  size_t n = 0;
  for (size_t k = 0; k < c->count; k += EIGHT_WIDE) {
    const eight dx = x[0] - EIGHT(c->x[0], k), dy = x[1] - EIGHT(c->x[1], k);
    const eight dz = x[2] - EIGHT(c->x[2], k), support = half + EIGHT(c->half, k);
    const eight_flags near = dx * dx + dy * dy + dz * dz < support * support;
    const eight_flags same =
        __builtin_convertvector(*(const eight_entries *)&c->entry[k] == own, eight_flags);
    const eight_bytes found = __builtin_convertvector(near & ~same, eight_bytes);
    uint64_t bits;
    memcpy(&bits, &found, sizeof bits);
    bits = (bits & 0x0101010101010101) * 0x0102040810204080 >> 56; /* bit l is byte l */
    *(eight_places *)&chosen[n] =
        __builtin_convertvector(*(const eight_bytes *)&places[bits], eight_places) + (uint16_t)k;
    n += (size_t)__builtin_popcountll(bits);
  }
  return n;
}
