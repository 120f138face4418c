#include "sphsolve/solute/walk.h"

#include <math.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/walk_random.h"

size_t walk_walkers(double tolerance) {
  const double displacements = DISPLACEMENTS_VARIANCE / pow(NOISE_SHARE * tolerance, 2);
  const double groups =
      ceil(fmax(displacements / DISPLACEMENTS_PER_WALKER, WALKERS_MIN) / WALK_GROUPS);
  return (size_t)fmin(groups, 1e6) * WALK_GROUPS;
}

static double time_step(double peclet, double flight) {
  const double diffusion = peclet > 0 ? 1 / peclet : 1, dt = flight * flight / (6 * diffusion);
  return peclet > 0 ? fmin(dt, ADVECTION_MAX) : dt;
}

/* At least two displacements of each walker over the first lag, of 32, 64 ... steps, that exceeds
 * the memory. */
struct walk_pace walk_pace(double peclet, double widest, double across, double wanted) {
  struct walk_pace pace = {.dt = time_step(peclet, FLIGHT_MAX)};
  const double memory = MEMORY_FACTOR * widest * widest * (peclet > 0 ? peclet : 1) / across;
  const double each =
      DISPLACEMENTS_VARIANCE / pow(NOISE_SHARE * wanted, 2) / (double)walk_walkers(wanted);
  pace.steps = WALK_INTERVAL * exp2(ceil(log2(fmax(memory / pace.dt / WALK_INTERVAL, 1))));
  pace.steps *= fmax(2, each);
  return pace;
}

double walk_bytes(size_t walkers) {
  const double each = sizeof(struct walker) * 2 + (double)sizeof(struct walk_spot) * 16 +
                      sizeof(float) * WALK_PLANES;
  return each * (double)walkers + sizeof(float) * 3.0 * WALK_TRACKED * WALK_TRACK;
}

double walk_cells_bytes(size_t cells, size_t with_pores) {
  /* Corners and bricks of all cells; in addition, first the search for the surface
   * (walk_cells.c), then a record and an index of each open cell. */
  return (sizeof(int16_t) + (double)sizeof(struct walk_brick) / 64) * (double)cells +
         fmax(4 * sizeof(float) * (double)cells,
              (sizeof(struct walk_cell) + sizeof(int32_t)) * (double)with_pores);
}

/* Draws a cell and a position in it until the position is in the pore: a uniform distribution. */
static bool place_walker(const struct walk_cells *c, uint32_t seed, struct walker *w) {
  for (uint32_t draw = 0; draw < 1u << 20; draw++) {
    uint32_t word[4];
    walk_draw(w->id, draw, seed, word);
    const int32_t at = c->place[(uint64_t)word[0] * c->count >> 32];
    w->cell = (walk_place){at % c->n[0], at / c->n[0] % c->n[1], at / c->n[0] / c->n[1], 0};
    w->wrapped = w->cell;
    walk_find(c, w);
    for (int a = 0; a < 3; a++) w->x[a] = random_share(word[a + 1]) - 0.5f;
    if (walk_distance(c, w) > 0) return true;
  }
  return false;
}

/* Records the position and velocity of each walker; returns the number of walkers in grain. Cells
 * and spots of the walkers that follow are prefetched. */
static size_t record_spots(const struct walk *walk, struct walk_spot *spots) {
  enum { AHEAD = 16 };
  const double *e = walk->settings.direction;
  const struct walk_cells *c = walk->cells;
  const size_t count = walk->moments.count;
  size_t lost = 0;
#pragma omp parallel for schedule(static) reduction(+ : lost)
  for (size_t i = 0; i < count; i++) {
    const struct walker *w = &walk->walkers[i], *next = w + (i + AHEAD < count ? AHEAD : 0);
    __builtin_prefetch(&c->cell[next->number < 0 ? 0 : next->number]);
    __builtin_prefetch(&spots[next->id - walk->moments.first], 1);
    if (!(walk_distance(c, w) > 0)) {
      lost++;
      continue;
    }
    struct walk_spot *spot = &spots[w->id - walk->moments.first];
    const walk_vector v = walk_velocity(c, w->number, w->x);
    double along = 0;
    for (int a = 0; a < 3; a++) {
      spot->cell[a] = w->cell[a], spot->x[a] = w->x[a];
      along += e[a] * (double)v[a] / (double)c->stretch[a];
    }
    spot->along = (float)along;
  }
  return lost;
}

static double box_along(const struct walk_cells *c, const double e[3]) {
  double length = 0;
  for (int a = 0; a < 3; a++) length += fabs(e[a]) * c->n[a] / (double)c->stretch[a];
  return length;
}

enum status walk_begin(const struct walk_cells *cells, const struct walk_settings *settings,
                       struct walk *walk) {
  enum status status = STATUS_OK;
  *walk = (struct walk){.cells = cells, .settings = *settings};
  struct walk_settings *s = &walk->settings;
  if (s->walkers == 0) s->walkers = walk_walkers(s->tolerance);
  if (!(s->flight > 0)) s->flight = FLIGHT_MAX;
  for (int a = 0; a < 3; a++) s->flight = fmin(s->flight, 1 / (double)cells->stretch[a]);
  if (s->walkers >= UINT32_MAX)
    return FAIL(STATUS_INPUT, "%zu walkers are more than can be counted", s->walkers);
  walk->diffusion = s->peclet > 0 ? 1 / s->peclet : 1;
  walk->dt = time_step(s->peclet, s->flight);
  walk->step = (struct walk_step){.time = s->peclet > 0 ? (float)walk->dt : 0,
                                  .flight = (float)sqrt(6 * walk->diffusion * walk->dt),
                                  .seed = s->seed};
  const double stretch[3] = {1 / (double)cells->stretch[0], 1 / (double)cells->stretch[1],
                             1 / (double)cells->stretch[2]};
  struct walk_moments *m = &walk->moments;
  walk_moments_begin(s->walkers, stretch, m);
  TRY(memory_allocate(&walk->walkers, m->count, sizeof *walk->walkers, "walkers"));
  TRY(memory_allocate(&walk->spare, m->count, sizeof *walk->spare, "walkers"));
  TRY(memory_allocate(&walk->now, m->count, sizeof *walk->now, "places of walkers"));
  TRY(memory_allocate(&m->start, m->count, sizeof *m->start, "places of walkers"));
  TRY(memory_allocate(&walk->track, WALK_TRACK, sizeof *walk->track, "tracks of walkers"));
  TRY(memory_allocate(&walk->frame, WALK_FRAMES, sizeof *walk->frame, "pictures of the plume"));
  for (int p = 0; p < WALK_PLANES; p++) {
    walk->plane[p] = box_along(cells, s->direction) * (double)(1 << p);
    TRY(memory_allocate(&walk->passage[p], m->count, sizeof(float), "passages of walkers"));
  }
  bool placed = true;
#pragma omp parallel for schedule(static) reduction(&& : placed)
  for (size_t w = 0; w < m->count; w++) {
    walk->walkers[w].id = (uint32_t)(m->first + w);
    placed = place_walker(cells, s->seed, &walk->walkers[w]) && placed;
  }
  if (ranks_any(!placed))
    TRY_FAIL(STATUS_INPUT, "no pore to walk in: the flow's cells are all but closed");
  record_spots(walk, m->start);
cleanup:
  if (status != STATUS_OK) walk_end(walk);
  return status;
}

void walk_end(struct walk *walk) {
  MEMORY_FREE(&walk->walkers, &walk->spare, &walk->now, &walk->track, &walk->frame);
  for (int p = 0; p < WALK_PLANES; p++) memory_free(&walk->passage[p]);
  walk_moments_free(&walk->moments);
}

/* Sorts the walkers by brick (counting sort, stable), so that its cells are fetched only once for
 * all of them. */
static enum status sort(struct walk *walk) {
  enum status status = STATUS_OK;
  uint32_t *first = NULL;
  struct walker *sorted = walk->spare;
  const size_t count = walk->moments.count;
  TRY(memory_allocate(&first, walk->cells->bricks + 1, sizeof *first, "walkers in order"));
  for (size_t w = 0; w < count; w++) first[walk->walkers[w].address / 64 + 1]++;
  for (size_t b = 0; b < walk->cells->bricks; b++) first[b + 1] += first[b];
  for (size_t w = 0; w < count; w++)
    sorted[first[walk->walkers[w].address / 64]++] = walk->walkers[w];
  walk->spare = walk->walkers, walk->walkers = sorted;
cleanup:
  memory_free(&first);
  return status;
}

/* Sets first passages since the last sample, assuming uniform motion in between. */
static void record_passages(struct walk *walk) {
  if (!(walk->settings.peclet > 0)) return;
  const double end = (double)walk->steps * walk->dt, interval = WALK_INTERVAL * walk->dt;
  const struct walk_spot *before =
      walk->moments.lags > 0 ? walk->moments.from[0] : walk->moments.start;
#pragma omp parallel for schedule(static)
  for (size_t w = 0; w < walk->moments.count; w++) {
    const double to = walk_displacement(walk, walk->settings.direction, &walk->now[w], w),
                 from = walk_displacement(walk, walk->settings.direction, &before[w], w);
    for (int p = 0; p < WALK_PLANES; p++)
      if (to >= walk->plane[p] && !(walk->passage[p][w] > 0))
        walk->passage[p][w] =
            (float)(end - interval * (to - walk->plane[p]) / fmax(to - from, 1e-30));
  }
}

enum status walk_advance(struct walk *walk) {
  enum status status = STATUS_OK;
  const size_t count = walk->moments.count;
  TRY(sort(walk));
  walk_steps(walk->cells, &walk->step, walk->walkers, count, walk->steps, WALK_INTERVAL,
             &walk->rejected);
  walk->steps += WALK_INTERVAL;
  const size_t lost = (size_t)ranks_sum((double)record_spots(walk, walk->now));
  if (lost > 0)
    TRY_FAIL(STATUS_NUMERIC, "%zu of %zu walkers are in grain after %llu steps", lost,
             walk->settings.walkers, (unsigned long long)walk->steps);
  record_passages(walk);
  if (walk->moments.intervals < WALK_TRACK)
    for (size_t w = 0; w < count && walk->moments.first + w < WALK_TRACKED; w++)
      for (int a = 0; a < 3; a++)
        walk->track[walk->moments.intervals][walk->moments.first + w][a] =
            (float)(((double)walk->now[w].cell[a] + (double)walk->now[w].x[a]) *
                    walk->moments.stretch[a]);
  TRY(walk_moments_add(&walk->moments, walk->now));
  walk_frames_take(walk);
cleanup:
  return status;
}

int walk_lags(const struct walk *walk, struct walk_lag lags[WALK_LAGS]) {
  static struct walk_moments all; /* too large for a small stack */
  all = walk->moments;            /* each group belongs to one rank; 0 on the others */
  ranks_sum_all(&all.sums[0][0][0], sizeof all.sums / sizeof(double));
  return walk_moments_lags(&all, walk->settings.direction, walk->cells->dimensions, walk->diffusion,
                           WALK_INTERVAL * walk->dt, (double)walk->step.time, lags);
}

/* Memory for the longest distance across the flow, time units at D_T = D. */
static double memory(const struct walk *walk) {
  const struct walk_cells *c = walk->cells;
  double widest = 0;
  for (int a = 0; a < 3; a++)
    if ((c->dimensions == 3 || a != 1) && fabs(walk->settings.direction[a]) < ALONG_COSINE)
      widest = fmax(widest, c->n[a] / (double)c->stretch[a]);
  return MEMORY_FACTOR * widest * widest / walk->diffusion;
}

bool walk_done(const struct walk *walk, struct walk_verdict *verdict) {
  struct walk_lag lags[WALK_LAGS];
  const int count = walk_lags(walk, lags);
  *verdict = walk_moments_judge(lags, count, memory(walk));
  if (walk->settings.most_steps > 0 && (double)walk->steps >= walk->settings.most_steps)
    return true;
  return verdict->lag >= 0 &&
         fmax(verdict->longitudinal_error, verdict->transverse_error) <= walk->settings.tolerance;
}
