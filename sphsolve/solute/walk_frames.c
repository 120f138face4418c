/* Histograms of the plume: displacements of the walkers from their starts, at times that double.
 * They are the mean distribution of a solute released at a point, over all such points. */
#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/walk.h"

/* A direction across the flow: the normal part of the axis that is most transverse. */
static void direction_across(const struct walk *walk, double across[3]) {
  const double *e = walk->settings.direction;
  int axis = 2;
  double length = 0;
  for (int a = 0; a < 3; a++)
    if ((walk->cells->dimensions == 3 || a != 1) && fabs(e[a]) < fabs(e[axis])) axis = a;
  for (int a = 0; a < 3; a++) {
    across[a] = (a == axis ? 1 : 0) - e[axis] * e[a];
    length = hypot(length, across[a]);
  }
  for (int a = 0; a < 3; a++) across[a] /= length;
}

static void place_of(const struct walk *walk, size_t w, const double across[3], double place[2]) {
  place[0] = walk_displacement(walk, walk->settings.direction, &walk->now[w], w);
  place[1] = walk_displacement(walk, across, &walk->now[w], w);
}

void walk_frames_take(struct walk *walk) {
  const uint64_t intervals = walk->moments.intervals;
  if ((intervals & (intervals - 1)) != 0 || walk->frames == WALK_FRAMES) return;
  struct walk_frame *frame = &walk->frame[walk->frames++];
  double across[3], place[2], most[4] = {-INFINITY, -INFINITY, -INFINITY, -INFINITY};
  direction_across(walk, across);
  for (size_t w = 0; w < walk->moments.count; w++) {
    place_of(walk, w, across, place);
    for (int d = 0; d < 2; d++) {
      most[d] = fmax(most[d], place[d]);
      most[2 + d] = fmax(most[2 + d], -place[d]);
    }
  }
  ranks_max_all(most, 4);
  frame->time = (double)walk->steps * walk->dt;
  const int bins[2] = {WALK_ALONG_BINS, WALK_ACROSS_BINS};
  for (int d = 0; d < 2; d++) {
    frame->low[d] = -most[2 + d];
    frame->width[d] = fmax(most[d] + most[2 + d], 1e-6) / bins[d];
  }
  for (size_t w = 0; w < walk->moments.count; w++) {
    int bin[2];
    place_of(walk, w, across, place);
    for (int d = 0; d < 2; d++) {
      bin[d] = (int)((place[d] - frame->low[d]) / frame->width[d]);
      bin[d] = bin[d] < 0 ? 0 : bin[d] < bins[d] ? bin[d] : bins[d] - 1;
    }
    frame->count[bin[1]][bin[0]]++;
  }
}

/* Adds the counts of all ranks on the first rank, and sets them to 0 on the others. */
void walk_frames_sum(struct walk *walk) {
  for (int f = 0; f < walk->frames && ranks_count() > 1; f++)
    for (int j = 0; j < WALK_ACROSS_BINS; j++) {
      int64_t sum[WALK_ALONG_BINS];
      for (int i = 0; i < WALK_ALONG_BINS; i++) sum[i] = walk->frame[f].count[j][i];
      ranks_sum_whole(sum, WALK_ALONG_BINS);
      for (int i = 0; i < WALK_ALONG_BINS; i++)
        walk->frame[f].count[j][i] = ranks_own() == 0 ? (uint32_t)sum[i] : 0;
    }
}
