/* A snapshot lists the particles in the order of their ids, so that snapshots can be compared line
 * by line; each rank writes a contiguous range of lines. */
#include "sphsolve/isph/snapshot.h"

#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/ranks.h"

/* Which lines this rank writes, and where its particles have to be sent. */
struct lines {
  size_t first, count; /* range of lines that this rank writes */
  size_t *send;        /* [ranks]: number of own particles whose lines that rank writes */
  uint32_t *item;      /* own particles, sorted by the rank that writes them */
  /* [count]: line, from `first`, of each particle in the order in which they arrive */
  uint32_t *place;
};

/* Sends the values of a field at the own particles to the ranks that write them. */
static enum status send_field(const struct isph *s, const struct lines *lines, const void *field,
                              size_t size, void *written) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = (size_t)ranks_own();
  const char *from = (const char *)field + s->local.begin * size;
  char *out = NULL, *in = NULL, *to = written;
  size_t *start = NULL, others = 0, k = 0;
  for (size_t r = 0; r < ranks; r++) others += r == own ? 0 : lines->send[r];
  TRY(memory_allocate(&out, others + 1, size, "a snapshot"));
  TRY(memory_allocate(&start, ranks + 1, sizeof *start, "a snapshot"));
  const uint32_t *item = lines->item, *mine = NULL;
  for (size_t r = 0; r < ranks; item += lines->send[r++]) {
    if (r == own) mine = item;
    for (size_t j = 0; r != own && j < lines->send[r]; j++)
      memcpy(out + size * k++, from + size * item[j], size);
  }
  if (ranks > 1) TRY(ghosts_exchange(size, lines->send, out, start, &in));
  for (size_t j = 0; j < lines->count; j++) {
    const bool own_line = ranks == 1 || (j >= start[own] && j < start[own + 1]);
    const char *value = own_line ? from + size * mine[j - start[own]] : in + size * j;
    memcpy(to + size * lines->place[j], value, size);
  }
cleanup:
  memory_free(&out);
  memory_free(&in);
  memory_free(&start);
  return status;
}

/* Line of a particle: the number of particles with a lower id, counted by one bit for each. */
static size_t line_of(const int64_t *there, const uint64_t *before, uint64_t id) {
  const uint64_t below = (uint64_t)there[id / 64] & (((uint64_t)1 << id % 64) - 1);
  return before[id / 64] + (size_t)__builtin_popcountll(below);
}

static enum status find_lines(const struct isph *s, struct lines *lines) {
  enum status status = STATUS_OK;
  const size_t ranks = (size_t)ranks_count(), own = s->local.end - s->local.begin;
  const size_t words = s->next_id / 64 + 1;
  int64_t *there = NULL; /* a bit for each id that exists; the ranks' bits are summed */
  uint64_t *before = NULL;
  uint32_t *line = NULL, *place = NULL;
  size_t *next = NULL;
  const uint64_t *id = s->id + s->local.begin;
  TRY(memory_allocate(&there, words, sizeof *there, "a snapshot"));
  TRY(memory_allocate(&before, words, sizeof *before, "a snapshot"));
  TRY(memory_allocate(&line, s->capacity, sizeof *line, "a snapshot"));
  TRY(memory_allocate(&next, ranks + 1, sizeof *next, "a snapshot"));
  TRY(memory_allocate(&lines->send, ranks, sizeof *lines->send, "a snapshot"));
  TRY(memory_allocate(&lines->item, own, sizeof *lines->item, "a snapshot"));
  for (size_t i = 0; i < own; i++)
    there[id[i] / 64] = (int64_t)((uint64_t)there[id[i] / 64] | (uint64_t)1 << id[i] % 64);
  ranks_sum_whole(there, words);
  for (size_t w = 1; w < words; w++)
    before[w] = before[w - 1] + (uint64_t)__builtin_popcountll((uint64_t)there[w - 1]);
  lines->first = s->total * (size_t)ranks_own() / ranks;
  lines->count = s->total * ((size_t)ranks_own() + 1) / ranks - lines->first;
  /* Two passes over the lines' ranks: to count, and to fill. */
  for (int pass = 0; pass < 2; pass++) {
    for (size_t i = 0; i < own; i++) {
      const size_t at = line_of(there, before, id[i]);
      size_t r = at * ranks / s->total;
      while (at >= s->total * (r + 1) / ranks) r++;
      while (at < s->total * r / ranks) r--;
      if (pass == 0) lines->send[r]++;
      if (pass == 1) lines->item[next[r]++] = (uint32_t)i;
      line[s->local.begin + i] = (uint32_t)(at - s->total * r / ranks);
    }
    for (size_t r = 1; pass == 0 && r < ranks; r++) next[r] = next[r - 1] + lines->send[r - 1];
  }
  /* The line of each particle in the order in which they arrive. */
  TRY(memory_allocate(&place, lines->count, sizeof *place, "a snapshot"));
  TRY(memory_allocate(&lines->place, lines->count, sizeof *place, "a snapshot"));
  for (size_t k = 0; k < lines->count; k++) lines->place[k] = (uint32_t)k;
  TRY(send_field(s, lines, line, sizeof *line, place));
  if (lines->count > 0) memcpy(lines->place, place, lines->count * sizeof *place);
cleanup:
  memory_free(&place);
  memory_free(&there);
  memory_free(&before);
  memory_free(&line);
  memory_free(&next);
  return status;
}

/* A field of a snapshot as it is stored in the state. */
struct source {
  const struct isph *state;
  const struct lines *lines;
  const struct isph_field *field;
};

static enum status fill(const void *context, void *data) {
  const struct source *source = context;
  const struct isph_field *field = source->field;
  double *values = data;
  if (field->exists) {
    const enum status status = send_field(source->state, source->lines,
                                          isph_field_data(source->state, field), field->size, data);
    if (status != STATUS_OK || field->factor == 1) return status;
  }
  for (size_t k = 0; k < source->lines->count; k++) /* such a field is one number of type double */
    values[k] = field->exists ? values[k] * field->factor : field->without;
  return STATUS_OK;
}

enum status isph_write_snapshot(const struct isph *s, struct recorder *recorder) {
  enum status status = STATUS_OK;
  struct lines l = {0};
  struct isph_field list[ISPH_FIELDS];
  struct source sources[ISPH_FIELDS];
  struct snapshot_field fields[ISPH_FIELDS], place = {.components = 0};
  size_t shown = 0;
  for (size_t k = 0, count = isph_fields(s, list); k < count; k++) {
    const struct isph_field *f = &list[k];
    sources[k] = (struct source){s, &l, f};
    const struct snapshot_field field = {.name = f->as != NULL ? f->as : f->name,
                                         .unit = f->as != NULL ? f->as_unit : f->unit,
                                         .description = f->as != NULL ? f->as_text : f->text,
                                         .type = f->type,
                                         .components = f->components,
                                         .fill = fill,
                                         .context = &sources[k]};
    if (f->at == offsetof(struct isph, position)) place = field;
    if (f->shown) fields[shown++] = field;
  }
  TRY(find_lines(s, &l));
  TRY(recorder_snapshot(recorder, s->time, s->step, l.count, &place, shown, fields));
cleanup:
  memory_free(&l.send);
  memory_free(&l.item);
  memory_free(&l.place);
  return status;
}
