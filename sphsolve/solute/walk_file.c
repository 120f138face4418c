/* All bits of a walk, to go on from. */
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/solute/walk.h"

/* One array of a walk: `count` rows of `words` 32-bit words, whatever they stand for. */
struct part {
  char name[16];
  void *data;
  size_t count, words;
};

static size_t parts_of(struct walk *w, struct part *part) {
  const size_t n = w->settings.walkers, spot = sizeof(struct walk_spot) / 4;
  size_t count = 0;
  part[count++] = (struct part){"walkers", w->walkers, n, sizeof(struct walker) / 4};
  part[count++] = (struct part){"start", w->moments.start, n, spot};
  part[count++] = (struct part){"sums", w->moments.sums, WALK_LAGS, sizeof w->moments.sums[0] / 4};
  part[count++] = (struct part){"track", w->track, WALK_TRACK, 3 * WALK_TRACKED};
  for (int p = 0; p < WALK_PLANES; p++, count++) {
    part[count] = (struct part){"", w->passage[p], n, 1};
    snprintf(part[count].name, sizeof part->name, "passage%d", p);
  }
  for (int k = 0; k < w->moments.lags; k++, count++) {
    part[count] = (struct part){"", w->moments.from[k], n, spot};
    snprintf(part[count].name, sizeof part->name, "from%d", k);
  }
  return count;
}

#define PARTS (4 + WALK_PLANES + WALK_LAGS)
#define PATH 512

static enum status save_numbers(struct h5_file *file, const char *group, const struct walk *w) {
  enum status status = STATUS_OK;
  const struct walk_settings *s = &w->settings;
  const double numbers[8] = {s->peclet,    s->direction[0], s->direction[1], s->direction[2],
                             s->tolerance, s->flight,       s->most_steps,   0};
  const uint64_t counts[8] = {s->walkers,
                              s->seed,
                              w->steps,
                              w->moments.intervals,
                              (uint64_t)w->moments.lags,
                              w->kept.carried,
                              w->kept.flown,
                              w->cells->count};
  TRY(h5_write_attribute(file, group, "numbers", H5_F64, 8, numbers));
  TRY(h5_write_attribute(file, group, "counts", H5_U64, 8, counts));
cleanup:
  return status;
}

enum status walk_save(struct h5_file *file, const char *group, const struct walk *walk) {
  enum status status = STATUS_OK;
  struct walk own = *walk; /* for its pointers; nothing is changed */
  struct part part[PARTS];
  const size_t count = parts_of(&own, part);
  char path[PATH];
  /* The sums stand in the walk itself. */
  part[2].data = (void *)(uintptr_t)walk->moments.sums;
  TRY(h5_make_group(file, group));
  TRY(save_numbers(file, group, walk));
  for (size_t p = 0; p < count; p++) {
    const size_t dims[2] = {part[p].count, part[p].words};
    snprintf(path, sizeof path, "%.255s/%.15s", group, part[p].name);
    TRY(h5_write(file, path, H5_U32, 2, dims, part[p].data, false));
  }
cleanup:
  return status;
}

static enum status load_part(struct h5_file *file, const char *group, const struct part *part) {
  enum status status = STATUS_OK;
  uint32_t *data = NULL;
  char path[PATH];
  size_t dims[2];
  snprintf(path, sizeof path, "%.255s/%.15s", group, part->name);
  TRY(h5_read(file, path, H5_U32, 2, dims, &data));
  if (dims[0] != part->count || dims[1] != part->words)
    TRY_FAIL(STATUS_INPUT, "%s: %s has another size than the walk; start afresh", h5_path(file),
             path);
  memcpy(part->data, data, dims[0] * dims[1] * sizeof *data);
cleanup:
  memory_free(&data);
  return status;
}

/* What the moves take as given: walkers stand in cells that are, in the pore. */
static bool sound(const struct walk *walk) {
  const struct walk_cells *c = walk->cells;
  for (size_t i = 0; i < walk->settings.walkers; i++) {
    const struct walker *w = &walk->walkers[i];
    if (w->number < 0 || (size_t)w->number >= c->count || w->id >= walk->settings.walkers)
      return false;
    for (int a = 0; a < 3; a++)
      if (!(w->x[a] >= -0.5f && w->x[a] <= 0.5f) || w->wrapped[a] < 0 || w->wrapped[a] >= c->n[a])
        return false;
    struct walker found = *w;
    if (!walk_find(c, &found) || memcmp(&found, w, sizeof found) != 0 || !(walk_distance(c, w) > 0))
      return false;
  }
  return true;
}

enum status walk_load(struct h5_file *file, const char *group, const struct walk_cells *cells,
                      struct walk *walk) {
  enum status status = STATUS_OK;
  struct part part[PARTS];
  double numbers[8];
  uint64_t counts[8];
  *walk = (struct walk){0};
  TRY(h5_read_attribute(file, group, "numbers", H5_F64, 8, numbers));
  TRY(h5_read_attribute(file, group, "counts", H5_U64, 8, counts));
  if (counts[7] != cells->count || counts[4] > WALK_LAGS || counts[0] >= UINT32_MAX ||
      !(numbers[0] >= 0) || !(numbers[5] > 0))
    TRY_FAIL(STATUS_INPUT, "%s: the walk in it is of another flow; start afresh", h5_path(file));
  const struct walk_settings settings = {.peclet = numbers[0],
                                         .direction = {numbers[1], numbers[2], numbers[3]},
                                         .tolerance = numbers[4],
                                         .flight = numbers[5],
                                         .most_steps = numbers[6],
                                         .walkers = (size_t)counts[0],
                                         .seed = (uint32_t)counts[1]};
  TRY(walk_begin(cells, &settings, walk));
  walk->steps = counts[2], walk->moments.intervals = counts[3];
  walk->kept = (struct walk_kept){counts[5], counts[6]};
  for (int k = 0; k < (int)counts[4]; k++, walk->moments.lags++)
    TRY(memory_allocate(&walk->moments.from[k], settings.walkers, sizeof *walk->moments.from[k],
                        "places of walkers"));
  const size_t count = parts_of(walk, part);
  for (size_t p = 0; p < count; p++) TRY(load_part(file, group, &part[p]));
  if (!sound(walk))
    TRY_FAIL(STATUS_INPUT, "%s: walkers are not where the flow has pores; start afresh",
             h5_path(file));
cleanup:
  if (status != STATUS_OK) walk_end(walk);
  return status;
}
