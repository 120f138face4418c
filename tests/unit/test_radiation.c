/* Sides of method isph that let waves out: the depth at a side by the characteristic, a hump that
 * leaves, levels that come back to the given head whatever flows, what soil before a side does, and
 * the same bits on any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sphsolve/isph/energy.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/radiation.h"
#include "tests/unit/isph_scene.h"

/* A channel of that length, m, .1 m deep, with `regions` in it, up to a side of that head. */
static void start_channel(struct run *run, double length, bool radiates, const char *regions) {
  char text[2000];
  snprintf(text, sizeof text,
           "scene = { name = \"channel\"; method = \"isph\"; end_time = \"99 s\"; }; "
           "domain = { size = [\"%g m\", \"0.2 m\"]; spacing = \"2 cm\"; "
           "periodic = [false, false]; }; "
           "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"%g m\", \"0.1 m\"]; }, "
           "{ type = \"inflow\"; box = [\"%g m\", \"0\", \"%g m\", \"0.2 m\"]; head = \"0.1 m\"; "
           "radiates = %s; }, %s ); "
           "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };",
           length, length, length - 0.02, length, radiates ? "true" : "false", regions);
  start(run, text);
}

/* The incoming invariant u - 2 sqrt(g h) is that of the mean; to first order Flather's. */
static void the_depth_keeps_the_incoming_invariant(void **state) {
  (void)state;
  const double g = 9.81, still = 0.15;
  assert_true(isph_radiation_depth(still, 0, g) == pow(sqrt(still), 2));
  for (int n = -5; n <= 5; n++) {
    const double excess = 0.2 * n, depth = isph_radiation_depth(still, excess, g);
    assert_true(fabs(excess - 2 * sqrt(g * depth) + 2 * sqrt(g * still)) < 1e-12);
  }
  const double small = 1e-4, flather = small * sqrt(still / g);
  assert_true(fabs((isph_radiation_depth(still, small, g) - still) / flather - 1) < 1e-4);
  assert_true(isph_radiation_depth(still, -10, g) == 0); /* it has all run out */
}

/* Of the energy of a hump at the closed end, what is left when it has been at the outlet once, and
 * what came back at the closed end. */
static double left_of_a_hump(bool radiates) {
  struct run run;
  start_channel(&run, 1, radiates,
                "{ type = \"water\"; box = [\"0\", \"0.1 m\", \"0.4 m\", \"0.12 m\"]; }");
  advance(&run, 0.5);
  const double first = isph_kinetic_energy(&run.s);
  advance(&run, 2.5);
  const double left = isph_kinetic_energy(&run.s) / first;
  finish(&run);
  return left;
}

static void a_hump_leaves(void **state) {
  (void)state;
  const double radiates = left_of_a_hump(true), fixed = left_of_a_hump(false);
  print_message("left of its energy: %.4f, before a fixed head %.4f\n", radiates, fixed);
  assert_true(radiates < 0.05 * fixed);
}

/* An inflow that starts at once in water at rest lifts the level by u sqrt(h/g), 21 % of it at 20
 * cm/s; after 8 s, 16 L/c, .3 % of that is left, and the head is the given one in the mean. */
static void heads_come_back(void **state) {
  (void)state;
  enum { READS = 100 };
  for (int fast = 0; fast < 2; fast++) {
    char regions[200];
    struct run run;
    double mean = 0;
    const double speed = fast ? 0.2 : 0.05;
    snprintf(regions, sizeof regions,
             "{ type = \"inflow\"; box = [\"0\", \"0\", \"2 cm\", \"0.1 m\"]; flux = \"%g m/s\"; }",
             speed);
    start_channel(&run, 0.5, true, regions);
    for (int n = 0; n < READS; n++) {
      advance(&run, 8 + 4.0 * n / READS);
      mean += run.s.sides[0].head / READS;
    }
    const double *now = isph_own_numbers(&run.s, "radiation");
    print_message("inflow %g m/s: mean head %.5f of 0.1 m, mean velocity %.4f m/s\n", speed, mean,
                  now[RADIATION_MEAN]);
    assert_true(fabs(mean / 0.1 - 1) < 0.01);
    assert_true(fabs(now[RADIATION_MEAN] / speed - 1) < 0.1);
    finish(&run);
  }
}

/* Soil before the lower part of a window: depths and velocities are those of the water above it,
 * and the heads of both parts are one. */
static void soil_before_a_side_takes_no_part(void **state) {
  (void)state;
  struct run run;
  start_channel(&run, 1, true,
                "{ type = \"porous\"; box = [\"0.6 m\", \"0\", \"1 m\", \"0.04 m\"]; porosity = "
                "0.4; grain_size = \"5 mm\"; }");
  assert_int_equal(run.s.side_count, 2);
  double *now = isph_own_numbers(&run.s, "radiation");
  now[RADIATION_NOW] = 0.1, now[RADIATION_MEAN] = 0;
  isph_apply_tables(&run.s, 0);
  for (int k = 0; k < 2; k++)
    assert_true(fabs(run.s.sides[k].head - 0.04 - isph_radiation_depth(0.06, 0.1, 9.81)) < 1e-12);
  finish(&run);
}

static void begin_radiation(struct run *run) {
  start_channel(run, 1, true,
                "{ type = \"water\"; box = [\"0.6 m\", \"0.1 m\", \"0.9 m\", \"0.14 m\"]; }, "
                "{ type = \"inflow\"; box = [\"0\", \"0\", \"2 cm\", \"0.2 m\"]; "
                "times = [\"0 s\", \"1 s\"]; head = [\"0.1 m\", \"0.13 m\"]; radiates = true; }");
  advance(run, 0.3);
}

static void read_radiation(const struct isph *s, double found[2]) {
  const double *numbers = isph_own_numbers(s, "radiation");
  found[0] = numbers[RADIATION_NOW] + numbers[RADIATION_MEAN];
  found[1] = s->sides[0].head + s->sides[1].head;
}

static void threads_agree_and_a_state_comes_back(void **state) {
  (void)state;
  same_on_threads_and_back(begin_radiation, 4e-3, 30, 100, read_radiation);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_depth_keeps_the_incoming_invariant), cmocka_unit_test(a_hump_leaves),
      cmocka_unit_test(heads_come_back), cmocka_unit_test(soil_before_a_side_takes_no_part),
      cmocka_unit_test(threads_agree_and_a_state_comes_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
