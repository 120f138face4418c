/* Dispersion and conduction in pores by random walk, against exact solutions and against the
 * closure problem, and whether walkers that were even stay even. verify_walk [FILE.json
 * [COARSE.hdf FINE.hdf]] writes FILE.json (a list of case, status, reference, measured, bound,
 * seconds). Measured is what is compared with the reference; bound the largest relative error that
 * passes. COARSE, FINE: flows of stokes through sand on some 10 and 20 cells a grain, walked too.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/log.h"
#include "sphsolve/solute/curve.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/walk.h"
#include "tests/verify/rows.h"

typedef double distance_function(const void *, const double *);
typedef void velocity_function(const void *, const double *, double *);

/* In units of the box. */
struct body {
  double centre[3], radius;
};

static double slit_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  return b->radius - fabs(x[0] - b->centre[0]);
}
static void slit_velocity(const void *context, const double x[3], double u[3]) {
  const struct body *b = context;
  const double y = (x[0] - b->centre[0]) / b->radius;
  u[0] = u[1] = 0, u[2] = 1.5 * (1 - y * y);
}

static double tube_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  return b->radius - hypot(x[0] - b->centre[0], x[1] - b->centre[1]);
}
static void tube_velocity(const void *context, const double x[3], double u[3]) {
  const struct body *b = context;
  const double r = 1 - tube_distance(context, x) / b->radius;
  u[0] = u[1] = 0, u[2] = 2 * (1 - r * r);
}

/* Walls at 45 degrees to the axes x and z, where x - z is 0 or .5 of the box. */
static double turned_distance(const void *context, const double x[3]) {
  (void)context;
  const double y = x[0] - x[2] - floor(x[0] - x[2]);
  return (0.25 - fabs(y - 0.5)) * sqrt(0.5);
}
static void turned_velocity(const void *context, const double x[3], double u[3]) {
  const double y = turned_distance(context, x) / (0.5 * sqrt(0.5));
  u[0] = u[2] = 6 * y * (1 - y), u[1] = 0;
}

static double cylinder_distance(const void *context, const double x[3]) {
  return -tube_distance(context, x);
}
static double ball_distance(const void *context, const double x[3]) {
  const struct body *b = context;
  double square = 0;
  for (int a = 0; a < 3; a++) square += pow(x[a] - b->centre[a], 2);
  return sqrt(square) - b->radius;
}
/* Oblique, slower near the body: the projection bends it round. */
static void past_cylinder(const void *context, const double x[3], double u[3]) {
  const double share = fmin(1, 6 * fmax(cylinder_distance(context, x), 0));
  u[0] = share, u[1] = 0.4 * share, u[2] = 0;
}
static void past_ball(const void *context, const double x[3], double u[3]) {
  const double share = fmin(1, 6 * fmax(ball_distance(context, x), 0));
  u[0] = share, u[1] = 0.4 * share, u[2] = 0.2 * share;
}

static struct walk_settings settings_of(const struct solute_flow *flow, double peclet_of_spacing,
                                        double tolerance) {
  static uint32_t seed;
  struct walk_settings s = {
      .peclet = peclet_of_spacing, .direction = {0, 0, 1}, .tolerance = tolerance, .seed = seed++};
  for (int a = 0; a < 3 && flow->speed > 0; a++)
    s.direction[a] = flow->mean_velocity[a] / flow->speed;
  return s;
}

/* Until D_L is known as well as wanted, D_T too where there is one, or the steps of all walkers are
 * used up: the error that is stated is then larger than wanted. */
static struct walk_verdict walked(const struct solute_flow *flow, double peclet_of_spacing,
                                  double wanted, size_t walkers, double most_steps, bool across,
                                  double *seconds) {
  static struct walk walk;
  struct walk_cells cells;
  struct walk_verdict v;
  struct walk_settings s = settings_of(flow, peclet_of_spacing, wanted);
  s.walkers = walkers;
  const double started = clock_processor_seconds();
  must(walk_cells_make(flow, &cells));
  must(walk_begin(&cells, &s, &walk));
  do {
    for (int i = 0; i < 16; i++) must(walk_advance(&walk));
    walk_done(&walk, &v);
  } while ((double)walk.steps * (double)walkers < most_steps &&
           (v.lag < 0 || v.longitudinal_error > wanted || (across && v.transverse_error > wanted)));
  printf("  %zu walkers, %llu steps, lag %d: +- %.2g %%, %.2g %%\n", walkers,
         (unsigned long long)walk.steps, v.lag, 100 * v.longitudinal_error,
         100 * v.transverse_error);
  walk_end(&walk);
  walk_cells_free(&cells);
  *seconds = clock_processor_seconds() - started;
  return v;
}

static void taylor(const char *name, const int n[3], const struct body *body,
                   distance_function *distance, velocity_function *velocity, double length,
                   double factor, double peclet) {
  const double h[3] = {1.0 / n[0], 1.0 / n[0], 1.0 / n[0]};
  struct solute_flow flow;
  char label[120];
  double seconds;
  must(solute_flow_build(n, h, distance, velocity, body, &flow));
  const struct walk_verdict d =
      walked(&flow, peclet * h[0] / length, 0.006, 65536, 6e8, false, &seconds);
  snprintf(label, sizeof label, "%s, Pe %g, %.0f cells", name, peclet, length * n[0]);
  report(label, 1 + peclet * peclet / factor, d.longitudinal, 0.01, seconds);
  report("  the same, within the error that is stated", 1 + peclet * peclet / factor,
         d.longitudinal, d.longitudinal_error, 0);
  solute_flow_free(&flow);
}

static void channels(void) {
  const struct body slit = {{0.503, 0, 0}, 0.437}, tube = {{0.503, 0.497, 0}, 0.45};
  const double half = 0.5 * sqrt(0.5);
  for (double peclet = 10; peclet < 200; peclet *= 10) {
    taylor("slit, 1 + Pe^2/210", (int[3]){32, 1, 4}, &slit, slit_distance, slit_velocity,
           2 * slit.radius, 210, peclet);
    taylor("tube, 1 + Pe^2/48", (int[3]){32, 32, 4}, &tube, tube_distance, tube_velocity,
           tube.radius, 48, peclet);
  }
  taylor("slit at 45 degrees", (int[3]){64, 1, 64}, NULL, turned_distance, turned_velocity, half,
         210, 10);
}

static struct solute_estimate estimate(const struct walk_verdict *v) {
  return (struct solute_estimate){v->longitudinal, v->transverse, v->longitudinal_error,
                                  v->transverse_error};
}

struct comparison {
  const char *name;
  double length;             /* of the Peclet number */
  double wanted, most_steps; /* of a walk: its error, and the steps of all walkers */
  bool twice;                /* walked on cells twice as long as well, to the limit of both */
  bool resolved;             /* within 3 % alone, and within the errors alone */
};

/* The walk against the closure problem on the same flow, Pe 0.1 to 1000, within 3 % and the errors
 * that both state: of the closure problem that of resolution, for both have the same flow. */
static void beside_closure(const struct comparison *k, const struct solute_flow *flow) {
  static struct solute_result r;
  static struct solute_state state;
  struct solute_flow half = {0};
  r = (struct solute_result){.length = k->length, .count = 5, .peclet = {0.1, 1, 10, 100, 1000}};
  memset(&state, 0, sizeof state);
  must(solute_curve_by_closure(flow, &state, &r));
  if (k->twice) must(solute_flow_coarsen(flow, &half));
  for (int i = 0; i < r.count; i++) {
    const struct solute_estimate *e = &r.closure[i].value;
    const double peclet = r.peclet[i] * flow->spacing[0] / k->length;
    char label[120];
    double seconds, more = 0, resolution[2];
    const struct walk_verdict v =
        walked(flow, peclet, k->wanted, 16384, k->most_steps, true, &seconds);
    struct solute_estimate w = estimate(&v);
    if (k->twice) {
      const double twice_peclet = peclet * half.spacing[0] / flow->spacing[0];
      const struct walk_verdict c =
          walked(&half, twice_peclet, k->wanted, 16384, k->most_steps / 3, true, &more);
      const struct solute_estimate coarse = estimate(&c);
      solute_walk_limit(&w, &coarse, 2, resolution);
    }
    for (int across = 0; across < 2; across++) {
      const double closed = across ? e->transverse : e->longitudinal,
                   found = across ? w.transverse : w.longitudinal,
                   walk = across ? w.transverse_error : w.longitudinal_error,
                   both = hypot(walk, r.closure[i].resolution[across]);
      snprintf(label, sizeof label, "%s, D_%c, Pe %g, beside the closure problem", k->name,
               across ? 'T' : 'L', r.peclet[i]);
      report(label, closed, found, 0.03 + (k->resolved ? walk : both), across ? 0 : seconds + more);
      if (k->resolved)
        report("  the same, within the errors that are stated", closed, found, both, 0);
    }
  }
  solute_flow_free(&half);
}

static void past_bodies(const char *name, const int n[3], const struct body *body,
                        distance_function *distance, velocity_function *velocity) {
  const double h[3] = {1.0 / n[0], 1.0 / n[0], 1.0 / n[0]};
  struct solute_flow flow;
  must(solute_flow_build(n, h, distance, velocity, body, &flow));
  beside_closure(&(struct comparison){name, 1, 0.02, 3e8, false, false}, &flow);
  solute_flow_free(&flow);
}

static void through_sand(const char *run, double wanted, double most_steps, bool resolved) {
  struct solute_flow flow;
  char name[40];
  must(solute_flow_read(run, &flow));
  snprintf(name, sizeof name, "sand, %.0f cells a grain", flow.grain_size / flow.spacing[0]);
  beside_closure(&(struct comparison){name, flow.grain_size, wanted, most_steps, true, resolved},
                 &flow);
  solute_flow_free(&flow);
}

enum { SHELLS = 7, OCTANTS = 8, BINS = SHELLS * OCTANTS };

static int bin_of(const struct walk_cells *c, const struct walker *w, const double centre[3]) {
  static const float edges[SHELLS - 1] = {0.1f, 0.2f, 0.4f, 0.7f, 1.2f, 3};
  const float d = walk_distance(c, w);
  int shell = 0, octant = 0;
  while (shell < SHELLS - 1 && d > edges[shell]) shell++;
  for (int a = 0; a < 3; a++)
    octant |= ((double)w->wrapped[a] + 0.5 + (double)w->x[a] > centre[a] * c->n[a]) << a;
  return shell * OCTANTS + octant;
}

/* Chi-square of walkers around a ball after 1e5 steps, in shells from the wall and octants. */
static void stays_even(double peclet_of_spacing) {
  enum { SIDE = 24, SUB = 16, WALKERS = 4096, INTERVALS = 3136, EVERY = 32 };
  const int n[3] = {SIDE, SIDE, SIDE};
  const double h[3] = {1.0 / SIDE, 1.0 / SIDE, 1.0 / SIDE};
  const struct body ball = {{0.496, 0.517, 0.508}, 0.304};
  static struct walk walk;
  struct solute_flow flow;
  struct walk_cells c;
  double share[BINS] = {0}, found[BINS] = {0}, volume = 0, all = 0, square = 0;
  const double started = clock_processor_seconds();
  must(solute_flow_build(n, h, ball_distance, past_ball, &ball, &flow));
  must(walk_cells_make(&flow, &c));
  for (size_t i = 0; i < c.count; i++)
    for (int s = 0; s < SUB * SUB * SUB; s++) {
      const int32_t at = c.place[i];
      const int sub[3] = {s % SUB, s / SUB % SUB, s / SUB / SUB};
      struct walker w = {.wrapped = {at % SIDE, at / SIDE % SIDE, at / SIDE / SIDE, 0}};
      walk_find(&c, &w);
      for (int a = 0; a < 3; a++) w.x[a] = ((float)sub[a] + 0.5f) / SUB - 0.5f;
      if (!(walk_distance(&c, &w) > 0)) continue;
      volume++;
      share[bin_of(&c, &w, ball.centre)]++;
    }
  struct walk_settings s = settings_of(&flow, peclet_of_spacing, 0.01);
  s.walkers = WALKERS;
  must(walk_begin(&c, &s, &walk));
  for (int i = 1; i <= INTERVALS; i++) {
    must(walk_advance(&walk));
    if (i % EVERY) continue;
    all += WALKERS;
    for (int w = 0; w < WALKERS; w++) found[bin_of(&c, &walk.walkers[w], ball.centre)]++;
  }
  for (int b = 0; b < BINS; b++) {
    const double expected = share[b] / volume * all;
    square += (found[b] - expected) * (found[b] - expected) / expected;
  }
  char label[120];
  snprintf(label, sizeof label, "even after %.3g steps, U h / D = %g: chi-square",
           (double)walk.steps, peclet_of_spacing);
  report(label, BINS - 1, square, 3 * sqrt(2.0 / (BINS - 1)), clock_processor_seconds() - started);
  walk_end(&walk);
  walk_cells_free(&c);
  solute_flow_free(&flow);
}

int main(int argc, char **argv) {
  const struct body cylinder = {{0.503, 0.489, 0}, 0.36}, ball = {{0.503, 0.489, 0.51}, 0.42};
  log_start("verify_walk", LOG_QUIET);
  rows_open(argc > 1 ? argv[1] : "walk.json");
  channels();
  past_bodies("cylinders", (int[3]){48, 48, 1}, &cylinder, cylinder_distance, past_cylinder);
  past_bodies("spheres", (int[3]){32, 32, 32}, &ball, ball_distance, past_ball);
  if (argc > 2) through_sand(argv[2], 0.02, 1.5e8, false);
  if (argc > 3) through_sand(argv[3], 0.015, 2.2e8, true);
  stays_even(0.01);
  stays_even(10);
  return rows_close();
}
