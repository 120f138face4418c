/* Saves and restores the complete state of a walk. */
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/walk.h"

enum status walk_gather(const struct walk *w, const void *own, size_t size, void *all) {
  enum status status = STATUS_OK;
  const int ranks = ranks_count();
  size_t *start = NULL;
  TRY(memory_allocate(&start, (size_t)ranks + 1, sizeof *start, "walkers of ranks"));
  for (int r = 0; r <= ranks; r++)
    start[r] = walk_group_start(w->settings.walkers, WALK_GROUPS * r / ranks);
  memcpy((char *)all + w->moments.first * size, own, w->moments.count * size);
  ranks_gather(all, start, size);
cleanup:
  memory_free(&start);
  return status;
}

/* Each walker belongs to one rank; its positions are 0 on the others. */
enum status walk_sum_track(struct walk *w) {
  enum status status = STATUS_OK;
  const size_t count = (size_t)3 * WALK_TRACKED * WALK_TRACK;
  float *place = &w->track[0][0][0];
  double *sum = NULL;
  if (ranks_count() == 1) return STATUS_OK;
  TRY(memory_allocate(&sum, count, sizeof *sum, "tracks of walkers"));
  for (size_t i = 0; i < count; i++) sum[i] = (double)place[i];
  ranks_sum_all(sum, count);
  for (size_t i = 0; i < count; i++) place[i] = (float)sum[i];
cleanup:
  memory_free(&sum);
  return status;
}

/* One array of a walk: `words` 32-bit words per walker, of any type. */
struct part {
  char name[16];
  void *data;
  size_t words;
};

static size_t parts_of(struct walk *w, struct part *part) {
  const size_t spot = sizeof(struct walk_spot) / 4;
  size_t count = 0;
  part[count++] = (struct part){"walkers", w->walkers, sizeof(struct walker) / 4};
  part[count++] = (struct part){"start", w->moments.start, spot};
  for (int p = 0; p < WALK_PLANES; p++, count++) {
    part[count] = (struct part){"", w->passage[p], 1};
    snprintf(part[count].name, sizeof part->name, "passage%d", p);
  }
  for (int k = 0; k < w->moments.lags; k++, count++) {
    part[count] = (struct part){"", w->moments.from[k], spot};
    snprintf(part[count].name, sizeof part->name, "from%d", k);
  }
  return count;
}

#define PARTS (2 + WALK_PLANES + WALK_LAGS)
#define PATH 512
#define SUMS (sizeof((struct walk *)NULL)->moments.sums / sizeof(double))

static enum status save_numbers(struct h5_file *file, const char *group, const struct walk *w) {
  enum status status = STATUS_OK;
  const struct walk_settings *s = &w->settings;
  const double numbers[8] = {s->peclet,    s->direction[0], s->direction[1], s->direction[2],
                             s->tolerance, s->flight,       s->most_steps,   0};
  int64_t rejected[2] = {(int64_t)w->rejected.advections, (int64_t)w->rejected.flights};
  ranks_sum_whole(rejected, 2);
  const uint64_t counts[8] = {s->walkers,
                              s->seed,
                              w->steps,
                              w->moments.intervals,
                              (uint64_t)w->moments.lags,
                              (uint64_t)rejected[0],
                              (uint64_t)rejected[1],
                              w->cells->count};
  TRY(h5_write_attribute(file, group, "numbers", H5_F64, 8, numbers));
  TRY(h5_write_attribute(file, group, "counts", H5_U64, 8, counts));
cleanup:
  return status;
}

/* Saves what is summed over all ranks: sums of groups, positions of the tracked walkers. */
static enum status save_shared(struct h5_file *file, const char *group, struct walk *w) {
  enum status status = STATUS_OK;
  double *sums = NULL;
  char path[PATH];
  const size_t dims[1] = {SUMS}, track[1] = {(size_t)3 * WALK_TRACKED * WALK_TRACK};
  const size_t frames[1] = {(size_t)w->frames * sizeof *w->frame / sizeof(uint32_t)};
  TRY(memory_allocate(&sums, SUMS, sizeof *sums, "sums of walkers"));
  memcpy(sums, w->moments.sums, sizeof w->moments.sums);
  ranks_sum_all(sums, SUMS);
  snprintf(path, sizeof path, "%.255s/sums", group);
  TRY(h5_write(file, path, H5_F64, 1, dims, sums, false));
  TRY(walk_sum_track(w));
  snprintf(path, sizeof path, "%.255s/track", group);
  TRY(h5_write(file, path, H5_F32, 1, track, w->track, false));
  walk_frames_sum(w);
  snprintf(path, sizeof path, "%.255s/frames", group);
  TRY(h5_write(file, path, H5_U32, 1, frames, w->frame, true));
  for (size_t i = 0; i < WALK_TRACKED; i++) /* set to 0 again where it belongs to another rank */
    for (int t = 0; t < WALK_TRACK && i - w->moments.first >= w->moments.count; t++)
      memset(w->track[t][i], 0, sizeof w->track[t][i]);
cleanup:
  memory_free(&sums);
  return status;
}

enum status walk_save(struct h5_file *file, const char *group, struct walk *walk) {
  enum status status = STATUS_OK;
  struct part part[PARTS];
  uint32_t *all = NULL;
  const size_t count = parts_of(walk, part);
  char path[PATH];
  TRY(h5_make_group(file, group));
  TRY(save_numbers(file, group, walk));
  TRY(save_shared(file, group, walk));
  for (size_t p = 0; p < count; p++) {
    const size_t dims[2] = {walk->settings.walkers, part[p].words};
    TRY(memory_allocate(&all, dims[0], 4 * dims[1], "walkers of all ranks"));
    TRY(walk_gather(walk, part[p].data, 4 * dims[1], all));
    snprintf(path, sizeof path, "%.255s/%.15s", group, part[p].name);
    TRY(h5_write(file, path, H5_U32, 2, dims, all, false));
    memory_free(&all);
  }
cleanup:
  memory_free(&all);
  return status;
}

/* Selects from the walkers of a file, in any order, those of this rank. */
static enum status select_own(const struct walker *all, struct walk *w) {
  size_t count = 0;
  for (size_t i = 0; i < w->settings.walkers; i++) {
    if (all[i].id - w->moments.first >= w->moments.count) continue;
    if (count < w->moments.count) w->walkers[count] = all[i];
    count++;
  }
  return count == w->moments.count ? STATUS_OK : STATUS_INPUT;
}

static enum status load_part(struct h5_file *file, const char *group, struct walk *w,
                             const struct part *part) {
  enum status status = STATUS_OK;
  uint32_t *data = NULL;
  char path[PATH];
  size_t dims[2];
  snprintf(path, sizeof path, "%.255s/%.15s", group, part->name);
  TRY(h5_read(file, path, H5_U32, 2, dims, &data));
  if (dims[0] != w->settings.walkers || dims[1] != part->words)
    TRY_FAIL(STATUS_INPUT, "%s: %s has another size than the walk; start afresh", h5_path(file),
             path);
  if (part->data != w->walkers)
    memcpy(part->data, data + w->moments.first * dims[1],
           w->moments.count * dims[1] * sizeof *data);
  else if (select_own((const struct walker *)(const void *)data, w) != STATUS_OK)
    TRY_FAIL(STATUS_INPUT, "%s: %s misses walkers; start afresh", h5_path(file), path);
cleanup:
  memory_free(&data);
  return status;
}

static enum status load_shared(struct h5_file *file, const char *group, struct walk *w) {
  enum status status = STATUS_OK;
  double *sums = NULL;
  float *track = NULL;
  uint32_t *frames = NULL;
  char path[PATH];
  size_t count[3];
  snprintf(path, sizeof path, "%.255s/sums", group);
  TRY(h5_read(file, path, H5_F64, 1, &count[0], &sums));
  snprintf(path, sizeof path, "%.255s/track", group);
  TRY(h5_read(file, path, H5_F32, 1, &count[1], &track));
  snprintf(path, sizeof path, "%.255s/frames", group);
  TRY(h5_read(file, path, H5_U32, 1, &count[2], &frames));
  const size_t bytes = count[2] * sizeof *frames;
  w->frames = (int)(bytes / sizeof *w->frame);
  if (bytes > WALK_FRAMES * sizeof *w->frame || bytes % sizeof *w->frame != 0 || count[0] != SUMS ||
      count[1] != (size_t)3 * WALK_TRACKED * WALK_TRACK)
    TRY_FAIL(STATUS_INPUT, "%s: %s has another size than the walk; start afresh", h5_path(file),
             group);
  memcpy(w->frame, frames, bytes);
  for (int f = 0; f < w->frames && ranks_own() > 0; f++)
    memset(w->frame[f].count, 0, sizeof w->frame[f].count);
  memcpy(w->moments.sums, sums, sizeof w->moments.sums);
  for (int g = 0; g < WALK_GROUPS; g++)
    for (int k = 0; k < WALK_LAGS && (g < w->moments.group[0] || g >= w->moments.group[1]); k++)
      memset(w->moments.sums[k][g], 0, sizeof w->moments.sums[k][g]);
  for (size_t i = 0; i < WALK_TRACKED; i++)
    for (int t = 0; t < WALK_TRACK && i - w->moments.first < w->moments.count; t++)
      memcpy(w->track[t][i], track + 3 * (WALK_TRACKED * (size_t)t + i), sizeof w->track[t][i]);
cleanup:
  MEMORY_FREE(&sums, &track, &frames);
  return status;
}

/* Checks what the moves rely on: walkers are in existing cells, in the pore. */
static bool is_valid(const struct walk *walk) {
  const struct walk_cells *c = walk->cells;
  for (size_t i = 0; i < walk->moments.count; i++) {
    const struct walker *w = &walk->walkers[i];
    if (w->number < 0 || (size_t)w->number >= c->count || w->id >= walk->settings.walkers)
      return false;
    for (int a = 0; a < 3; a++)
      if (!(w->x[a] >= -0.5f && w->x[a] <= 0.5f) || w->wrapped[a] < 0 || w->wrapped[a] >= c->n[a])
        return false;
    struct walker found = *w;
    if (!walk_find(c, &found) || found.number != w->number || found.address != w->address ||
        found.walls != w->walls || !(walk_distance(c, w) > 0))
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
  if (ranks_own() == 0) walk->rejected = (struct walk_rejected){counts[5], counts[6]};
  for (int k = 0; k < (int)counts[4]; k++, walk->moments.lags++)
    TRY(memory_allocate(&walk->moments.from[k], walk->moments.count, sizeof *walk->moments.from[k],
                        "places of walkers"));
  const size_t count = parts_of(walk, part);
  for (size_t p = 0; p < count; p++) TRY(load_part(file, group, walk, &part[p]));
  TRY(load_shared(file, group, walk));
  if (!is_valid(walk))
    TRY_FAIL(STATUS_INPUT, "%s: walkers are not where the flow has pores; start afresh",
             h5_path(file));
cleanup:
  if (status != STATUS_OK) walk_end(walk);
  return status;
}
