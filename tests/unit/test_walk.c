/* The random walk: its random numbers, a velocity without divergence, walkers that stay even,
 * Taylor dispersion in a slit, the same bits for any number of threads and after a restart. */
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "common/memory.h"
#include "tests/unit/long_tests.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/walk.h"
#include "sphsolve/solute/walk_random.h"

/* Test vectors of Random123 (kat_vectors), of the authors of Philox. */
static void test_philox(void **state) {
  (void)state;
  static const uint32_t vectors[3][10] = {
      {0, 0, 0, 0, 0, 0, 0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
      {0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff, 0x408f276d,
       0x41c83b0e, 0xa20bc7c6, 0x6d5451fd},
      {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344, 0xa4093822, 0x299f31d0, 0xd16cfe09,
       0x94fdcceb, 0x5001e420, 0x24126ea1}};
  for (int v = 0; v < 3; v++) {
    uint32_t counter[4];
    memcpy(counter, vectors[v], sizeof counter);
    philox4x32(counter, vectors[v][4], vectors[v][5]);
    for (int i = 0; i < 4; i++) assert_int_equal(counter[i], vectors[v][6 + i]);
  }
}

/* Oblique flow around a ball that does not fit the lattice, with slip at it or without. */
static const double centre[3] = {5.9, 6.4, 6.2}, radius = 3.7;

static double ball_distance(const void *context, const double x[3]) {
  (void)context;
  double square = 0;
  for (int a = 0; a < 3; a++) square += (x[a] - centre[a]) * (x[a] - centre[a]);
  return sqrt(square) - radius;
}

static void past_ball(const void *context, const double x[3], double u[3]) {
  const double share = *(const bool *)context ? 1 : fmin(1, ball_distance(NULL, x) / 2);
  u[0] = 0.3 * share, u[1] = -0.2 * share, u[2] = share;
}

static void make_ball(bool slip, struct walk_cells *cells, double direction[3]) {
  const int n[3] = {12, 12, 12};
  const double spacing[3] = {1, 1, 1};
  struct solute_flow flow;
  assert_int_equal(solute_flow_build(n, spacing, ball_distance, past_ball, &slip, &flow),
                   STATUS_OK);
  assert_int_equal(walk_cells_make(&flow, cells), STATUS_OK);
  for (int a = 0; a < 3; a++) direction[a] = flow.mean_velocity[a] / flow.speed;
  solute_flow_free(&flow);
}

/* At any point the three slopes add up to 0, and neighbours agree on what passes their face. */
static void test_no_divergence(void **state) {
  (void)state;
  struct walk_cells c;
  double direction[3];
  make_ball(false, &c, direction);
  double divergence = 0, jump = 0;
  for (size_t i = 0; i < c.count; i++) {
    const int32_t at = c.place[i];
    for (int s = 0; s < 8; s++) {
      struct walker w = {.number = (int32_t)i};
      double sum = 0;
      const float place[3] = {s & 1 ? 0.3f : -0.2f, s & 2 ? 0.4f : -0.45f, s & 4 ? 0.1f : -0.3f};
      for (int a = 0; a < 3; a++) {
        for (int b = 0; b < 3; b++) w.x[b] = place[b];
        w.x[a] = -0.5f;
        const float low = walk_velocity(&c, w.number, w.x)[a];
        w.x[a] = place[a] + 0.05f;
        const float up = walk_velocity(&c, w.number, w.x)[a];
        w.x[a] = place[a] - 0.05f;
        sum += (double)(up - walk_velocity(&c, w.number, w.x)[a]) / 0.1;
        w.wrapped = (walk_place){at % 12, at / 12 % 12, at / 144, 0};
        w.wrapped[a] = (w.wrapped[a] + 11) % 12, w.x[a] = 0.5f;
        const float other = walk_find(&c, &w) ? walk_velocity(&c, w.number, w.x)[a] : 0;
        jump = fmax(jump, (double)fabsf(low - other));
        w.number = (int32_t)i;
      }
      divergence = fmax(divergence, fabs(sum));
    }
  }
  assert_true(divergence < 2e-5);
  assert_true(jump < 2e-6);
  walk_cells_free(&c);
}

static void begin(const struct walk_cells *c, const double direction[3], double peclet,
                  size_t walkers, struct walk *walk) {
  const struct walk_settings settings = {.peclet = peclet,
                                         .direction = {direction[0], direction[1], direction[2]},
                                         .tolerance = 0.01,
                                         .walkers = walkers,
                                         .seed = 7};
  assert_int_equal(walk_begin(c, &settings, walk), STATUS_OK);
}

enum { SHELLS = 6, OCTANTS = 8, BINS = SHELLS * OCTANTS };

/* Near the wall in thin shells, in each octant: where walkers would gather first. */
static int bin_of(const struct walk_cells *c, const struct walker *w) {
  static const float edges[SHELLS - 1] = {0.1f, 0.25f, 0.5f, 1, 2};
  const float d = walk_distance(c, w);
  int shell = 0, octant = 0;
  while (shell < SHELLS - 1 && d > edges[shell]) shell++;
  for (int a = 0; a < 3; a++)
    octant |= ((double)w->wrapped[a] + 0.5 + (double)w->x[a] > centre[a]) << a;
  return shell * OCTANTS + octant;
}

static void expect_even(bool slip, double peclet) {
  enum { SUB = 12, WALKERS = 8192, LOOKS = 40 };
  struct walk_cells c;
  struct walk walk;
  double direction[3], share[BINS] = {0}, found[BINS] = {0}, volume = 0, square = 0;
  make_ball(slip, &c, direction);
  begin(&c, direction, peclet, WALKERS, &walk);
  for (size_t i = 0; i < c.count; i++)
    for (int s = 0; s < SUB * SUB * SUB; s++) {
      const int32_t at = c.place[i];
      struct walker w = {.wrapped = {at % 12, at / 12 % 12, at / 144, 0}};
      walk_find(&c, &w);
      w.x[0] = ((float)(s % SUB) + 0.5f) / SUB - 0.5f;
      w.x[1] = ((float)(s / SUB % SUB) + 0.5f) / SUB - 0.5f;
      w.x[2] = ((float)(s / SUB / SUB) + 0.5f) / SUB - 0.5f;
      if (!(walk_distance(&c, &w) > 0)) continue;
      volume++;
      share[bin_of(&c, &w)]++;
    }
  for (int look = 0; look < LOOKS; look++) {
    for (int i = 0; i < 3; i++) assert_int_equal(walk_advance(&walk), STATUS_OK);
    for (size_t w = 0; w < WALKERS; w++) found[bin_of(&c, &walk.walkers[w])]++;
  }
  for (int b = 0; b < BINS; b++) {
    const double expected = share[b] / volume * WALKERS * LOOKS;
    square += (found[b] - expected) * (found[b] - expected) / expected;
  }
  /* Chi-square with 47 degrees of freedom: 82.7 once in a thousand. */
  if (!(square < 82.7)) fail_msg("chi-square %.1f of %d bins, Pe %g", square, BINS, peclet);
  assert_true(walk.rejected.advections < walk.steps * WALKERS / 5000);
  assert_true(walk.rejected.flights < walk.steps * WALKERS / 500);
  walk_end(&walk);
  walk_cells_free(&c);
}

static void test_stays_even(void **state) {
  (void)state;
  expect_even(false, 0.01);
  expect_even(true, 5); /* stream lines that run into the cut cells at full speed */
}

static void long_test_stays_even(void **state) {
  (void)state;
  expect_even(false, 5);
}

struct slit {
  double low, gap; /* cells, normal to z */
};

static double slit_distance(const void *context, const double x[3]) {
  const struct slit *s = context;
  return fmin(x[2] - s->low, s->low + s->gap - x[2]);
}

static void slit_velocity(const void *context, const double x[3], double u[3]) {
  const struct slit *s = context;
  const double t = (x[2] - s->low) / s->gap;
  u[0] = t > 0 && t < 1 ? 6 * t * (1 - t) : 0, u[1] = u[2] = 0;
}

/* D_L / D = 1 + Pe^2 / 210 (Taylor 1953; Aris 1956) within 2 % and the error that is told. */
static void test_slit(void **state) {
  (void)state;
  const int n[3] = {4, 1, 20};
  const double spacing[3] = {1, 1, 1}, direction[3] = {1, 0, 0}, peclet = 60;
  const struct slit slit = {.low = 2.3, .gap = 16};
  struct solute_flow flow;
  struct walk_cells c;
  struct walk walk;
  struct walk_lag lags[WALK_LAGS];
  assert_int_equal(solute_flow_build(n, spacing, slit_distance, slit_velocity, &slit, &flow),
                   STATUS_OK);
  assert_int_equal(walk_cells_make(&flow, &c), STATUS_OK);
  begin(&c, direction, peclet / slit.gap, 16384, &walk);
  for (int i = 0; i < 128; i++) assert_int_equal(walk_advance(&walk), STATUS_OK);
  const int count = walk_moments_lags(&walk.moments, direction, 2, walk.diffusion,
                                      WALK_INTERVAL * walk.dt, (double)walk.step.time, lags);
  const struct walk_lag *last = &lags[count - 1];
  const double exact = 1 + peclet * peclet / 210;
  const double error = fabs(last->longitudinal / exact - 1);
  if (!(error < 0.02 + 2.5 * last->longitudinal_error / exact))
    fail_msg("D_L / D %.4f +- %.4f, not %.4f", last->longitudinal, last->longitudinal_error, exact);
  assert_true(fabs(last->velocity - 1) < 0.005);
  assert_true(fabs(last->correlation) < 0.02);
  walk_end(&walk);
  walk_cells_free(&c);
  solute_flow_free(&flow);
}

/* Of the velocity that walkers see in a slit of six cells, wherever its walls lie in theirs:
 * D_L / D - 1 is the mean square of its integral from the wall, that of a parabola over 210; and
 * all of the water passes the pore. */
static void test_narrow_slit(void **state) {
  (void)state;
  enum { N = 10, SUB = 100 };
  const int n[3] = {4, 1, N};
  const double spacing[3] = {1, 1, 1};
  for (double low = 1.25; low <= 2; low += 0.25) {
    const struct slit slit = {.low = low == 2 ? 1.998 : low, .gap = 6};
    struct solute_flow flow;
    struct walk_cells c;
    double speed[N * SUB], mean = 0, passed = 0, square = 0, inside = 0;
    assert_int_equal(solute_flow_build(n, spacing, slit_distance, slit_velocity, &slit, &flow),
                     STATUS_OK);
    assert_int_equal(walk_cells_make(&flow, &c), STATUS_OK);
    for (int s = 0; s < N * SUB; s++) {
      struct walker w = {.wrapped = {1, 0, s / SUB, 0}};
      w.x[2] = ((float)(s % SUB) + 0.5f) / SUB - 0.5f;
      const double z = (s + 0.5) / SUB;
      const bool open = walk_find(&c, &w) && z > slit.low && z < slit.low + slit.gap;
      speed[s] = open ? (double)walk_velocity(&c, w.number, w.x)[0] : NAN;
      if (open) mean += speed[s], inside++;
    }
    mean /= inside;
    for (int s = 0; s < N * SUB; s++) {
      if (isnan(speed[s])) continue;
      passed += (speed[s] - mean) / SUB;
      square += passed * passed;
    }
    const double found = square / inside * 210 / (slit.gap * slit.gap);
    if (!(fabs(found / (mean * mean) - 1) < 0.01 && fabs(mean - 1) < 0.002))
      fail_msg("wall at %g: D_L - D %.4f of what it is, mean %.4f", slit.low, found, mean);
    walk_cells_free(&c);
    solute_flow_free(&flow);
  }
}

static void expect_same(const struct walk *a, const struct walk *b) {
  const size_t n = a->settings.walkers;
  assert_int_equal(a->steps, b->steps);
  assert_memory_equal(a->walkers, b->walkers, n * sizeof *a->walkers);
  assert_memory_equal(a->moments.sums, b->moments.sums, sizeof a->moments.sums);
  for (int p = 0; p < WALK_PLANES; p++)
    assert_memory_equal(a->passage[p], b->passage[p], n * sizeof(float));
  assert_memory_equal(a->track, b->track, WALK_TRACK * sizeof *a->track);
  assert_int_equal(a->frames, b->frames);
  assert_memory_equal(a->frame, b->frame, WALK_FRAMES * sizeof *a->frame);
}

static void test_same_bits(void **state) {
  (void)state;
  struct walk_cells c;
  struct walk one, four, again;
  double direction[3];
  char path[64];
  struct h5_file *file = NULL;
  snprintf(path, sizeof path, "/tmp/test_walk_%d.hdf", (int)getpid());
  make_ball(false, &c, direction);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  begin(&c, direction, 5, 1000, &one);
  for (int i = 0; i < 21; i++) assert_int_equal(walk_advance(&one), STATUS_OK);
  omp_set_num_threads(4);
  begin(&c, direction, 5, 1000, &four);
  for (int i = 0; i < 11; i++) assert_int_equal(walk_advance(&four), STATUS_OK);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  if (walk_save(file, "/walk", &four) != STATUS_OK) fail_msg("%s", error_message());
  assert_int_equal(h5_commit(file), STATUS_OK);
  for (int i = 0; i < 10; i++) assert_int_equal(walk_advance(&four), STATUS_OK);
  expect_same(&one, &four);
  assert_int_equal(h5_open_output(path, &file), STATUS_OK);
  if (walk_load(file, "/walk", &c, &again) != STATUS_OK) fail_msg("%s", error_message());
  h5_close(file);
  for (int i = 0; i < 10; i++) assert_int_equal(walk_advance(&again), STATUS_OK);
  expect_same(&one, &again);
  omp_set_num_threads(threads);
  unlink(path);
  walk_end(&one);
  walk_end(&four);
  walk_end(&again);
  walk_cells_free(&c);
  assert_int_equal(memory_in_use(), 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_philox),     cmocka_unit_test(test_no_divergence),
      cmocka_unit_test(test_stays_even), cmocka_unit_test(long_test_stays_even),
      cmocka_unit_test(test_slit),       cmocka_unit_test(test_narrow_slit),
      cmocka_unit_test(test_same_bits),
  };
  long_tests_choose();
  return cmocka_run_group_tests(tests, NULL, NULL);
}
