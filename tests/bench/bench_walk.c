/* Speed of the random walk on a flow of 240^3 cells past spheres, beside a plain implementation:
 * one walker after the other in the order they began, velocities between the faces (Pollock 1988)
 * read from the flow's arrays, functions of the library, flights into grain refused. Time is that
 * of the processor. bench_walk OUT.json [SIDE] [WALKERS] [INTERVALS] [RUN.hdf]: RUN, a flow of
 * stokes, instead of spheres. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/walk.h"
#include "sphsolve/solute/walk_random.h"

#define PERIOD 40 /* cells between spheres */
#define PECLET_SPACING 1.0

static void must(enum status status) {
  if (status == STATUS_OK) return;
  fprintf(stderr, "bench_walk: %s\n", error_message());
  exit(1);
}

static double ball_distance(const void *context, const double x[3]) {
  (void)context;
  double square = 0;
  for (int a = 0; a < 3; a++) square += (x[a] - 0.5 * PERIOD) * (x[a] - 0.5 * PERIOD);
  return sqrt(square) - 0.48 * PERIOD;
}

static void past_ball(const void *context, const double x[3], double u[3]) {
  const double share = fmin(1, 0.3 * fmax(ball_distance(context, x), 0));
  u[0] = share, u[1] = 0.4 * share, u[2] = 0.2 * share;
}

/* The flow in one box, again and again, until some `side` cells along each axis. */
static void repeat(const struct solute_flow *one, int side, struct solute_flow *flow) {
  int all[3];
  for (int a = 0; a < 3; a++) all[a] = one->n[a] * (int)fmax(1, round((double)side / one->n[a]));
  must(solute_flow_allocate(all, one->spacing, flow));
  for (int k = 0; k < all[2]; k++)
    for (int j = 0; j < all[1]; j++)
      for (int i = 0; i < all[0]; i++) {
        const size_t to = solute_flow_at(flow, i, j, k),
                     from = solute_flow_at(one, i % one->n[0], j % one->n[1], k % one->n[2]);
        flow->distance[to] = one->distance[from], flow->volume[to] = one->volume[from];
        for (int a = 0; a < 3; a++) {
          flow->aperture[a][to] = one->aperture[a][from];
          flow->velocity[a][to] = one->velocity[a][from];
        }
      }
  memcpy(flow->mean_velocity, one->mean_velocity, sizeof flow->mean_velocity);
  flow->speed = one->speed, flow->porosity = one->porosity;
}

/* Past one sphere, or of a run. */
static void make_flow(int side, const char *run, struct solute_flow *flow) {
  const int n[3] = {PERIOD, PERIOD, PERIOD};
  const double h[3] = {1, 1, 1};
  struct solute_flow one;
  if (run == NULL)
    must(solute_flow_build(n, h, ball_distance, past_ball, NULL, &one));
  else
    must(solute_flow_read(run, &one));
  repeat(&one, side, flow);
  solute_flow_free(&one);
}

struct plain {
  double x[3];
};

static double plain_distance(const struct solute_flow *f, const double x[3]) {
  int low[3];
  double share[3], sum = 0;
  for (int a = 0; a < 3; a++) {
    const double place = x[a] - 0.5;
    low[a] = (int)floor(place);
    share[a] = place - low[a];
    low[a] = ((low[a] % f->n[a]) + f->n[a]) % f->n[a];
  }
  for (int c = 0; c < 8; c++)
    sum += (c & 1 ? share[0] : 1 - share[0]) * (c & 2 ? share[1] : 1 - share[1]) *
           (c & 4 ? share[2] : 1 - share[2]) *
           (double)f->distance[solute_flow_at(f, low[0] + (c & 1), low[1] + (c >> 1 & 1),
                                              low[2] + (c >> 2))];
  return sum;
}

static void plain_velocity(const struct solute_flow *f, const double x[3], double u[3]) {
  int cell[3];
  for (int a = 0; a < 3; a++) {
    cell[a] = (int)floor(x[a]) % f->n[a];
    if (cell[a] < 0) cell[a] += f->n[a];
  }
  for (int a = 0; a < 3; a++) {
    int up[3] = {cell[0], cell[1], cell[2]};
    up[a]++;
    const double t = x[a] - floor(x[a]);
    u[a] = ((1 - t) * (double)f->velocity[a][solute_flow_at(f, cell[0], cell[1], cell[2])] +
            t * (double)f->velocity[a][solute_flow_at(f, up[0], up[1], up[2])]) /
           f->speed;
  }
}

static double plain_steps(const struct solute_flow *f, struct plain *walkers, size_t count,
                          int steps, double dt, double flight) {
  const double started = clock_processor_seconds();
  for (int s = 0; s < steps; s++)
    for (size_t w = 0; w < count; w++) {
      double u[3], middle[3], to[3];
      uint32_t word[4] = {(uint32_t)w, (uint32_t)s, 0, 0};
      plain_velocity(f, walkers[w].x, u);
      for (int a = 0; a < 3; a++) middle[a] = walkers[w].x[a] + 0.5 * dt * u[a];
      plain_velocity(f, middle, u);
      philox4x32(word, 1, 0);
      const double z = 2 * (double)random_share(word[0]) - 1, r = sqrt(1 - z * z);
      const double angle = 6.283185307179586 * (double)random_share(word[1]);
      const double way[3] = {r * cos(angle), r * sin(angle), z};
      for (int a = 0; a < 3; a++) to[a] = walkers[w].x[a] + dt * u[a] + flight * way[a];
      if (plain_distance(f, to) > 0) memcpy(walkers[w].x, to, sizeof to);
    }
  return clock_processor_seconds() - started;
}

static void add(json_t *list, const char *name, double measured, double bound, double seconds) {
  printf("%-64s %10.4g\n", name, measured);
  json_array_append_new(list, json_pack("{s:s, s:s, s:o, s:f, s:o, s:f}", "case", name, "status",
                                        isnan(bound) || measured >= bound ? "pass" : "fail",
                                        "reference", json_null(), "measured", measured, "bound",
                                        isnan(bound) ? json_null() : json_real(bound), "seconds",
                                        seconds));
}

static void begin(const struct solute_flow *flow, const struct walk_cells *cells, size_t count,
                  struct walk *walk) {
  struct walk_settings s = {
      .peclet = PECLET_SPACING, .tolerance = 0.01, .walkers = count, .seed = 1};
  for (int a = 0; a < 3; a++) s.direction[a] = flow->mean_velocity[a] / flow->speed;
  must(walk_begin(cells, &s, walk));
}

static double walk_seconds(const struct solute_flow *flow, const struct walk_cells *cells,
                           size_t count, int intervals) {
  static struct walk walk;
  begin(flow, cells, count, &walk);
  const double started = clock_processor_seconds();
  for (int i = 0; i < intervals; i++) must(walk_advance(&walk));
  const double seconds = clock_processor_seconds() - started;
  walk_end(&walk);
  return seconds;
}

/* Million steps a second, of a fraction of the steps. */
static double plain_speed(const struct solute_flow *flow, const struct walk_cells *cells,
                          size_t count, int intervals, double *seconds) {
  static struct walk walk;
  struct plain *plain = NULL;
  const int steps = intervals * WALK_INTERVAL / 16;
  begin(flow, cells, count, &walk);
  must(memory_allocate(&plain, count, sizeof *plain, "plain walkers"));
  for (size_t w = 0; w < count; w++)
    for (int a = 0; a < 3; a++)
      plain[walk.walkers[w].id].x[a] =
          0.5 + (double)walk.walkers[w].cell[a] + (double)walk.walkers[w].x[a];
  *seconds = plain_steps(flow, plain, count, steps, walk.dt, (double)walk.step.flight);
  memory_free(&plain);
  walk_end(&walk);
  return 1e-6 * (double)count * steps / *seconds;
}

int main(int argc, char **argv) {
  const int side = argc > 2 ? atoi(argv[2]) : 240, intervals = argc > 4 ? atoi(argv[4]) : 3;
  const size_t count = argc > 3 ? (size_t)atol(argv[3]) : 1000000;
  struct solute_flow flow;
  struct walk_cells cells;
  char label[128];
  json_t *list = json_array();
  if (argc < 2) return 2;
  log_start("bench_walk", LOG_QUIET);
  const char *run = argc > 5 ? argv[5] : NULL;
  make_flow(side, run, &flow);
  const double started = clock_processor_seconds();
  must(walk_cells_make(&flow, &cells));
  const double making = clock_processor_seconds() - started;
  double seconds, speed = 0;
  /* A hundredth, a tenth and all of the walkers: the time goes with the steps. */
  for (size_t share = 100; share > 0; share /= 10) {
    const double steps = (double)(count / share) * intervals * WALK_INTERVAL;
    speed = 1e-6 * steps / (seconds = walk_seconds(&flow, &cells, count / share, intervals));
    snprintf(label, sizeof label,
             "walk%s: million steps a second of processor, %d x %d x %d cells, %.2g steps",
             run == NULL ? "" : " in sand", flow.n[0], flow.n[1], flow.n[2], steps);
    add(list, label, speed, share > 1 || run != NULL ? NAN : 20, seconds);
  }
  const double slow = plain_speed(&flow, &cells, count, intervals, &seconds);
  add(list, "walk: the same by a plain implementation", slow, NAN, seconds);
  add(list, "walk: times as fast", speed / slow, 1, 0);
  snprintf(label, sizeof label, "walk: seconds to make %zu cells with pores", cells.count);
  add(list, label, making, NAN, making);
  json_dump_file(list, argv[1], JSON_INDENT(1));
  json_decref(list);
  walk_cells_free(&cells);
  solute_flow_free(&flow);
  return 0;
}
