/* Record of a walk for output. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/hdf5_table.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/walk.h"

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

/* Converts to SI units: the first spacing is `length` m, the time unit `time` s. */
static void convert(struct walk_record *r, double length, double time) {
  r->dt *= time, r->interval *= time, r->flight *= length;
  for (int k = 0; k < r->count; k++) r->lags[k].time *= time;
  for (int p = 0; p < WALK_PLANES; p++) {
    r->plane[p] *= length;
    for (int q = 0; q < WALK_QUANTILES; q++) r->passage[p][q] *= time;
  }
  for (size_t t = 0; t < r->tracked; t++)
    for (size_t w = 0; w < WALK_TRACKED; w++)
      for (int a = 0; a < 3; a++) r->track[t][w][a] *= (float)length;
  for (int f = 0; f < r->frames; f++) {
    r->frame[f].time *= time;
    for (int d = 0; d < 2; d++) r->frame[f].low[d] *= length, r->frame[f].width[d] *= length;
  }
}

/* Writes the histograms of the plume: fractions of the walkers by displacement, and the lower ends
 * and widths of the bins, m. */
static enum status write_frames(struct h5_file *file, const char *group,
                                const struct walk_record *r) {
  enum status status = STATUS_OK;
  const struct walk_frame *first = r->frame;
  const size_t frames = (size_t)r->frames, shape[3] = {frames, WALK_ACROSS_BINS, WALK_ALONG_BINS};
  float *share = NULL;
  char path[96];
  if (frames == 0) return STATUS_OK;
  const struct h5_column columns[] = {{"plume_time", H5_F64, 1, &first->time},
                                      {"plume_low", H5_F64, 2, first->low},
                                      {"plume_width", H5_F64, 2, first->width}};
  TRY(memory_allocate(&share, frames * WALK_ACROSS_BINS * WALK_ALONG_BINS, sizeof *share,
                      "pictures of the plume"));
  for (size_t f = 0, to = 0; f < frames; f++)
    for (int j = 0; j < WALK_ACROSS_BINS; j++)
      for (int i = 0; i < WALK_ALONG_BINS; i++)
        share[to++] = (float)(r->frame[f].count[j][i] / r->walkers);
  snprintf(path, sizeof path, "%s/plume", group);
  TRY(h5_write(file, path, H5_F32, 3, shape, share, true));
  TRY(h5_write_columns(file, group, frames, sizeof *first, 3, columns));
cleanup:
  memory_free(&share);
  return status;
}

enum status walk_record_write(struct h5_file *file, const char *group, struct walk_record *r,
                              double length, double time) {
  enum status status = STATUS_OK;
  const struct h5_number numbers[] = {{"walkers", H5_F64, 1, &r->walkers},
                                      {"steps", H5_F64, 1, &r->steps},
                                      {"dt", H5_F64, 1, &r->dt},
                                      {"flight", H5_F64, 1, &r->flight},
                                      {"not_carried", H5_F64, 1, &r->not_carried},
                                      {"not_flown", H5_F64, 1, &r->not_flown}};
  const struct walk_lag *l = r->lags;
  const struct h5_column lags[] = {
      {"lag", H5_F64, 1, &l->time},
      {"longitudinal", H5_F64, 1, &l->longitudinal},
      {"longitudinal_standard_error", H5_F64, 1, &l->longitudinal_error},
      {"transverse", H5_F64, 1, &l->transverse},
      {"transverse_standard_error", H5_F64, 1, &l->transverse_error},
      {"velocity_correlation", H5_F64, 1, &l->correlation}};
  const struct h5_column distance = {"passage_distance", H5_F64, 1, r->plane};
  const struct h5_column passage = {"passage_time", H5_F64, WALK_QUANTILES, r->passage};
  const size_t shape[3] = {r->tracked, WALK_TRACKED, 3};
  char path[96];
  convert(r, length, time);
  TRY(h5_make_group(file, group));
  TRY(h5_write_numbers(file, group, sizeof numbers / sizeof *numbers, numbers));
  TRY(h5_write_columns(file, group, (size_t)r->count, sizeof *l, 6, lags));
  TRY(h5_write_columns(file, group, WALK_PLANES, sizeof *r->plane, 1, &distance));
  TRY(h5_write_columns(file, group, WALK_PLANES, sizeof *r->passage, 1, &passage));
  snprintf(path, sizeof path, "%s/track", group);
  TRY(h5_write(file, path, H5_F32, 3, shape, r->track, true));
  TRY(h5_write_attribute(file, path, "interval", H5_F64, 1, &r->interval));
  TRY(write_frames(file, group, r));
cleanup:
  return status;
}
