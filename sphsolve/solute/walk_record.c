/* Record of a walk for output. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/walk.h"

#define PATH 512

static int by_value(const void *a, const void *b) {
  const float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

enum status walk_record(struct walk *walk, struct walk_record *r) {
  enum status status = STATUS_OK;
  const size_t n = walk->settings.walkers;
  float *sorted = NULL;
  memset(r, 0, sizeof *r);
  r->settled =
      walk_done(walk, &r->verdict) && r->verdict.lag >= 0 &&
      fmax(r->verdict.longitudinal_error, r->verdict.transverse_error) <= walk->settings.tolerance;
  r->count = walk_lags(walk, r->lags);
  r->walkers = (double)n, r->steps = (double)walk->steps;
  r->dt = walk->dt, r->flight = (double)walk->step.flight, r->interval = WALK_INTERVAL * walk->dt;
  r->not_carried = ranks_sum((double)walk->rejected.advections);
  r->not_flown = ranks_sum((double)walk->rejected.flights);
  TRY(memory_allocate(&sorted, n, sizeof *sorted, "times of passage"));
  for (int p = 0; p < WALK_PLANES; p++) {
    r->plane[p] = walk->plane[p];
    TRY(walk_gather(walk, walk->passage[p], sizeof *sorted, sorted));
    for (size_t w = 0; w < n; w++)
      if (!(sorted[w] > 0)) sorted[w] = INFINITY;
    qsort(sorted, n, sizeof *sorted, by_value);
    for (size_t q = 0; q < WALK_QUANTILES; q++) {
      const double time = (double)sorted[(2 * q + 1) * n / (2 * WALK_QUANTILES)];
      r->passage[p][q] = isfinite(time) ? time : NAN;
    }
  }
  TRY(walk_sum_track(walk));
  r->track = walk->track, walk->track = NULL;
  walk_frames_sum(walk);
  r->frame = walk->frame, walk->frame = NULL, r->frames = walk->frames;
  r->tracked = walk->moments.intervals < WALK_TRACK ? walk->moments.intervals : WALK_TRACK;
cleanup:
  memory_free(&sorted);
  return status;
}

void walk_record_free(struct walk_record *r) {
  MEMORY_FREE(&r->track, &r->frame);
}

static enum status write_lags(struct h5_file *file, const char *group, const char *name,
                              const struct walk_record *r, size_t offset, double unit) {
  double values[WALK_LAGS];
  char path[PATH];
  const size_t dims[1] = {(size_t)r->count};
  for (int k = 0; k < r->count; k++) {
    memcpy(&values[k], (const char *)&r->lags[k] + offset, sizeof values[k]);
    values[k] *= unit;
  }
  snprintf(path, sizeof path, "%.255s/%s", group, name);
  return h5_write(file, path, H5_F64, 1, dims, values, false);
}

static enum status write_number(struct h5_file *file, const char *group, const char *name,
                                double value) {
  return h5_write_attribute(file, group, name, H5_F64, 1, &value);
}

static enum status write_passages(struct h5_file *file, const char *group,
                                  const struct walk_record *r, double length, double time) {
  enum status status = STATUS_OK;
  const size_t dims[2] = {WALK_PLANES, WALK_QUANTILES};
  double passage[WALK_PLANES][WALK_QUANTILES], plane[WALK_PLANES];
  char path[PATH];
  for (int p = 0; p < WALK_PLANES; p++) {
    plane[p] = length * r->plane[p];
    for (int q = 0; q < WALK_QUANTILES; q++) passage[p][q] = time * r->passage[p][q];
  }
  snprintf(path, sizeof path, "%.255s/passage_distance", group);
  TRY(h5_write(file, path, H5_F64, 1, dims, plane, false));
  snprintf(path, sizeof path, "%.255s/passage_time", group);
  TRY(h5_write(file, path, H5_F64, 2, dims, passage, false));
cleanup:
  return status;
}

/* Writes the positions of the tracked walkers, m from the centre of the first cell, in the
 * unwrapped periodic box, and the time between two of them, s. */
static enum status write_tracks(struct h5_file *file, const char *group, struct walk_record *r,
                                double length, double time) {
  enum status status = STATUS_OK;
  const size_t dims[3] = {r->tracked, WALK_TRACKED, 3};
  char path[PATH];
  for (size_t t = 0; t < r->tracked; t++)
    for (size_t w = 0; w < WALK_TRACKED; w++)
      for (int a = 0; a < 3; a++) r->track[t][w][a] *= (float)length;
  snprintf(path, sizeof path, "%.255s/track", group);
  TRY(h5_write(file, path, H5_F32, 3, dims, r->track, true));
  TRY(write_number(file, path, "interval", time * r->interval));
cleanup:
  return status;
}

/* Writes the histograms of the plume: fractions of the walkers by displacement, and the lower ends
 * and widths of the bins, m. */
static enum status write_frames(struct h5_file *file, const char *group,
                                const struct walk_record *r, double length, double time) {
  enum status status = STATUS_OK;
  const size_t frames = (size_t)r->frames;
  const size_t shape[3] = {frames, WALK_ACROSS_BINS, WALK_ALONG_BINS}, pair[2] = {frames, 2};
  float *share = NULL;
  double times[WALK_FRAMES], low[WALK_FRAMES][2], width[WALK_FRAMES][2];
  char path[PATH];
  if (frames == 0) return STATUS_OK;
  TRY(memory_allocate(&share, frames * WALK_ACROSS_BINS * WALK_ALONG_BINS, sizeof *share,
                      "pictures of the plume"));
  for (size_t f = 0, to = 0; f < frames; f++) {
    times[f] = time * r->frame[f].time;
    for (int d = 0; d < 2; d++) {
      low[f][d] = length * r->frame[f].low[d];
      width[f][d] = length * r->frame[f].width[d];
    }
    for (int j = 0; j < WALK_ACROSS_BINS; j++)
      for (int i = 0; i < WALK_ALONG_BINS; i++)
        share[to++] = (float)(r->frame[f].count[j][i] / r->walkers);
  }
  snprintf(path, sizeof path, "%.255s/plume", group);
  TRY(h5_write(file, path, H5_F32, 3, shape, share, true));
  snprintf(path, sizeof path, "%.255s/plume_time", group);
  TRY(h5_write(file, path, H5_F64, 1, &frames, times, false));
  snprintf(path, sizeof path, "%.255s/plume_low", group);
  TRY(h5_write(file, path, H5_F64, 2, pair, low, false));
  snprintf(path, sizeof path, "%.255s/plume_width", group);
  TRY(h5_write(file, path, H5_F64, 2, pair, width, false));
cleanup:
  memory_free(&share);
  return status;
}

enum status walk_record_write(struct h5_file *file, const char *group, struct walk_record *r,
                              double length, double time) {
  enum status status = STATUS_OK;
  TRY(h5_make_group(file, group));
  TRY(write_number(file, group, "walkers", r->walkers));
  TRY(write_number(file, group, "steps", r->steps));
  TRY(write_number(file, group, "dt", time * r->dt));
  TRY(write_number(file, group, "flight", length * r->flight));
  TRY(write_number(file, group, "not_carried", r->not_carried));
  TRY(write_number(file, group, "not_flown", r->not_flown));
#define COLUMN(name, member, unit)                                                                 \
  TRY(write_lags(file, group, name, r, offsetof(struct walk_lag, member), unit))
  COLUMN("lag", time, time);
  COLUMN("longitudinal", longitudinal, 1);
  COLUMN("longitudinal_standard_error", longitudinal_error, 1);
  COLUMN("transverse", transverse, 1);
  COLUMN("transverse_standard_error", transverse_error, 1);
  COLUMN("velocity_correlation", correlation, 1);
#undef COLUMN
  TRY(write_passages(file, group, r, length, time));
  TRY(write_tracks(file, group, r, length, time));
  TRY(write_frames(file, group, r, length, time));
cleanup:
  return status;
}
