/* Enclosed bodies of water, which fill the room they are in: they have no surface, and their
 * pressure is determined only up to a constant. */
#include "sphsolve/isph/enclosed.h"

#include <math.h>

#include "common/memory.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/well.h"

/* Particles that are neighbours, directly or through others, form a body of water. A body none of
 * whose particles is on the surface by more than ENCLOSED fills its room. As it is incompressible
 * and has no free volume, the sources of its rows have to add up to 0, or the pressure equation has
 * no solution. So its particles count as not on the surface (a particle that disorder puts on it by
 * a thousandth would take up the volume of all others, at a thousand times the pressure: 46 MPa in
 * a tank short of four of its 600 particles), the mean of its source is subtracted, and its lowest
 * pressure is set to that of half a particle under a level surface. */
#define ENCLOSED 0.5

/* The first particle (root) of the set that i belongs to; shortens the path to it (union-find). */
static uint32_t first_of(uint32_t *above, uint32_t i) {
  while (above[i] != i) i = above[i] = above[above[i]];
  return i;
}

/* Joins pairs into sets of connected particles, as far as this rank knows them; following `above`
 * leads to a set's root. */
static void join_pairs(const struct isph *s, uint32_t *above) {
  for (size_t i = 0; i < s->count; i++) above[i] = (uint32_t)i;
  for (size_t c = 0; c < s->chunk_count; c++) {
    const struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++)
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
        uint32_t j = chunk->pair[p] & PAIR_MASK;
        if (j > i && j < s->local.end) continue; /* found from j as well */
        if (!(chunk->slope[p] > 0)) continue;    /* behind a wall */
        uint32_t a = first_of(above, (uint32_t)i), b = first_of(above, j);
        if (a < b) above[b] = a;
        if (b < a) above[a] = b;
      }
  }
}

/* Whether particle i of the chunk has a window of given head as a neighbour, or is in a well. */
static bool at_head(const struct isph *s, const struct isph_chunk *chunk, size_t i) {
  if (s->on.wells && isph_in_well(s, s->position[i])) return true;
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++)
    if (s->boundary_kind[chunk->wall[p] & PAIR_MASK] == BOUNDARY_OPEN_HEAD) return true;
  return false;
}

/* Sets body[i]: the number of the particle's body, which is that of its first particle among those
 * of all ranks, and the largest surface weight in the body. Without walls inside the tank all
 * particles are one body: any part that separates has a surface. */
static void find_bodies(struct isph *s) {
  uint32_t *above = s->scratch;
  const bool parted = s->wall_box_count > 1;
  const size_t offset = isph_first_chunk(s) * CHUNK;
  double most = 0;
  for (size_t c = 0; c < s->chunk_count; c++)
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++) {
      s->body[i][0] = parted ? (double)(offset + i - s->local.begin) : 0;
      s->body[i][1] =
          (s->on.open_sides || s->on.wells) && at_head(s, &s->chunks[c], i) ? 1 : s->surface[i];
      most = fmax(most, s->body[i][1]);
    }
  if (!parted) {
    most = ranks_max(most);
    for (size_t i = s->local.begin; i < s->local.end; i++) s->body[i][1] = most;
    return;
  }
  join_pairs(s, above);
  for (bool changed = true; changed;) {
    isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->body)});
    for (size_t i = 0; i < s->count; i++) {
      double *own = s->body[i], *first = s->body[first_of(above, (uint32_t)i)];
      first[0] = fmin(first[0], own[0]), first[1] = fmax(first[1], own[1]);
    }
    changed = false;
    for (size_t i = s->local.begin; i < s->local.end; i++) {
      double *own = s->body[i];
      const double *first = s->body[first_of(above, (uint32_t)i)];
      changed = changed || own[0] != first[0] || own[1] != first[1];
      own[0] = first[0], own[1] = first[1];
    }
    changed = ranks_any(changed && isph_is_distributed(s));
  }
}

enum status isph_find_enclosed(struct isph *s) {
  enum status status = STATUS_OK;
  double *own = NULL;
  size_t count = 0;
  const size_t offset = isph_first_chunk(s) * CHUNK;
  find_bodies(s);
  memory_free(&s->enclosed);
  s->enclosed_count = 0;
  for (int pass = 0; pass < 2; pass++) {
    count = 0;
    for (size_t i = s->local.begin; i < s->local.end; i++) {
      if (s->body[i][1] >= ENCLOSED) continue;
      s->surface[i] = 0;
      if (s->body[i][0] != (double)(offset + i - s->local.begin)) continue;
      if (pass > 0) own[count] = s->body[i][0];
      count++;
    }
    if (pass == 0) TRY(memory_allocate(&own, count, sizeof *own, "bodies of water"));
  }
  if (!ranks_any(count > 0)) goto cleanup;
  TRY(isph_gather(own, count, sizeof *own, &s->enclosed, &s->enclosed_count));
cleanup:
  memory_free(&own);
  return status;
}

static bool in_body(const struct isph *s, size_t i, double body) {
  return s->body[i][0] == body && s->body[i][1] < ENCLOSED;
}

void isph_enclosed_source(struct isph *s, double *source) {
  for (size_t k = 0; k < s->enclosed_count; k++) {
    double total[2]; /* source, volume */
#pragma omp parallel for schedule(static)
    for (size_t c = 0; c < s->chunk_count; c++) {
      double sum[2] = {0};
      for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
        if (in_body(s, i, s->enclosed[k])) sum[0] += source[i], sum[1] += s->volume[i];
      s->sums[c][0] = sum[0], s->sums[c][1] = sum[1];
    }
    isph_sum_chunks(s, 2, total);
    for (size_t i = s->local.begin; i < s->local.end; i++)
      if (in_body(s, i, s->enclosed[k])) source[i] -= total[0] / total[1] * s->volume[i];
  }
}

/* Pressure half a particle under a level surface, or at the depth of particle i under a reflecting
 * side, if that is less. */
static double top_pressure(const struct isph *s, size_t i) {
  double depth = 0;
  for (int a = 0; a < 3; a++) {
    const double *x = s->position[i], half = 0.5 * s->spacing;
    const double under = s->force[a] > 0 ? x[a] - s->low[a] : s->high[a] - x[a];
    depth += fabs(s->force[a]) * (s->reflects[a][s->force[a] < 0] ? fmin(half, under) : half);
  }
  return s->density * depth;
}

void isph_enclosed_level(struct isph *s) {
  for (size_t k = 0; k < s->enclosed_count; k++) {
    double least = INFINITY;
    for (size_t i = s->local.begin; i < s->local.end; i++)
      if (in_body(s, i, s->enclosed[k])) least = fmin(least, s->pressure[i] - top_pressure(s, i));
    least = -ranks_max(-least);
    for (size_t i = s->local.begin; i < s->local.end; i++)
      if (in_body(s, i, s->enclosed[k])) s->pressure[i] -= least;
  }
}
