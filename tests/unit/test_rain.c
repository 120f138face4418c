/* Rain of method isph: it arrives to less than a particle, lifts a level and stands in a pond at
 * the rates it should, spares what a roof covers, and gives the same bits on any number of threads.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sphsolve/isph/effects/rain.h"
#include "tests/unit/isph_scene.h"

/* A tank of .2 m x .3 m with `regions` in it. */
static void start_tank(struct run *run, const char *regions) {
  char text[2000];
  snprintf(text, sizeof text,
           "scene = { name = \"rain\"; method = \"isph\"; end_time = \"20 s\"; }; "
           "domain = { size = [\"0.2 m\", \"0.3 m\"]; spacing = \"1 cm\"; "
           "periodic = [false, false]; }; "
           "regions = ( %s ); force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };",
           regions);
  start(run, text);
}

static double mass_of(const struct isph *s) {
  double mass = 0;
  for (size_t i = 0; i < s->count; i++) mass += s->mass[i];
  return mass;
}

#define WATER "{ type = \"water\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; }, "

static int in_order(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* A fifth of a row: four particles of twenty, spread over the floor; the golden ratio leaves .382
 * of it at most between four places and the next lap's first. */
static void two_millimetres_arrive(void **state) {
  (void)state;
  struct run run;
  start_tank(&run, "{ type = \"rain\"; box = [\"0\", \"0.29 m\", \"0.2 m\", \"0.3 m\"]; "
                   "rate = \"1 mm/s\"; }");
  assert_int_equal(run.s.count, 0);
  advance(&run, 2); /* 4 to rounding */
  const double *rain = isph_own_numbers(&run.s, "rain");
  double at[5];
  assert_int_equal(run.s.count, 4);
  for (size_t i = 0; i < run.s.count; i++) {
    at[i] = run.s.position[i][0];
    assert_true(fabs(run.s.position[i][2] - 0.005) < 1e-3);
  }
  qsort(at, 4, sizeof *at, in_order);
  at[4] = 0.2 + at[0];
  for (int k = 0; k < 4; k++) assert_true(at[k + 1] - at[k] < 0.4 * 0.2);
  assert_true(fabs((rain[RAIN_FALLEN] + rain[RAIN_PENDING]) / (1000 * 1e-3 * 0.2 * run.s.time) -
                   1) < 1e-12);
  assert_true(fabs(run.s.passed.entered / run.s.thickness - mass_of(&run.s)) < 1e-12);
  finish(&run);
}

/* How far the pressure on the floor is above the weight of the water, as a height, m. */
static double level_error(uint32_t draw) {
  struct run run;
  const double floor[3] = {0.1, 0, 0};
  double pressure = 0;
  start_tank(&run, WATER "{ type = \"rain\"; box = [\"0\", \"0.29 m\", \"0.2 m\", \"0.3 m\"]; "
                         "times = [\"0 s\", \"2 s\", \"2.1 s\"]; "
                         "rate = [\"0\", \"3 cm/s\", \"0\"]; }");
  draw_places(&run, draw);
  const double mass = mass_of(&run.s), fell = 0.5 * 2.1 * 0.03;
  advance(&run, 4);
  for (int n = 0; n < 20; n++)
    advance(&run, 4 + 0.05 * n), pressure += pressure_at(&run.s, floor) / 20;
  const double *rain = isph_own_numbers(&run.s, "rain");
  const double level = 0.1 + rain[RAIN_FALLEN] / 200;
  printf("level %g of %g m\n", pressure / 9810, 0.1 + fell);
  assert_true(fabs((rain[RAIN_FALLEN] + rain[RAIN_PENDING]) / (1000 * 0.2 * fell) - 1) < 1e-12);
  assert_true(fabs(mass_of(&run.s) - mass - rain[RAIN_FALLEN]) < 1e-12 * mass);
  assert_true(rain[RAIN_PENDING] < run.s.mass[0]);
  finish(&run);
  return pressure / 9810 - level;
}

/* A level rises by the integral of a table of rates, and the floor bears it. Drops stir the water
 * at random: single draws are .2 to 1.1 mm off. */
static void a_level_rises(void **state) {
  (void)state;
  enum { DRAWS = 3 };
  double error = 0;
  for (uint32_t draw = 0; draw < DRAWS; draw++) error += level_error(draw) / DRAWS;
  assert_true(fabs(error) < 1e-3);
}

/* On soil of conductivity k and depth L over air, rain of 1.5 k stands half of L high: the pond h
 * drives k (L + h)/L through it (Darcy), after some times L/k. */
static void what_soil_cannot_take_stands_on_it(void **state) {
  (void)state;
  struct run run;
  double pond = 0;
  start_tank(&run, "{ type = \"porous\"; box = [\"0\", \"0\", \"0.2 m\", \"0.1 m\"]; "
                   "porosity = 0.4; permeability = \"2 cm/s\"; saturated = false; }, "
                   "{ type = \"inflow\"; box = [\"0\", \"0\", \"0.2 m\", \"1 cm\"]; "
                   "head = \"0\"; }, "
                   "{ type = \"rain\"; box = [\"0\", \"0.29 m\", \"0.2 m\", \"0.3 m\"]; "
                   "rate = \"3 cm/s\"; }");
  run.s.passed = (struct conservation_passed){.entered = 1e3, .left = 1e3}; /* as after days */
  advance(&run, 20);
  for (int n = 0; n < 20; n++) {
    advance(&run, 20 + 0.1 * n);
    for (size_t i = 0; i < run.s.count; i++) {
      const double above = 0.5 + (run.s.position[i][2] - 0.1) / 0.01; /* of its own height */
      pond += run.s.mass[i] / 200 * fmax(0, fmin(1, above)) / 20;
    }
  }
  printf("pond %g m, exact 0.05\n", pond);
  assert_true(fabs(pond - 0.05) < 0.005);
  const double mass = mass_of(&run.s) * run.s.thickness;
  const struct conservation water = {.passed = run.s.passed, .mass = {0, mass}};
  printf("mass open by %g of %g kg\n", conservation_mass_open(&water), mass);
  assert_true(fabs(conservation_mass_open(&water)) < (double)run.s.count * 0x1p-52 * mass);
  finish(&run);
}

/* Rain stays on a roof until it runs over its edge. */
static void a_roof_keeps_it_off(void **state) {
  (void)state;
  struct run run;
  start_tank(&run, "{ type = \"wall\"; box = [\"0\", \"0.1 m\", \"0.1 m\", \"0.12 m\"]; }, "
                   "{ type = \"rain\"; box = [\"0\", \"0.2 m\", \"0.2 m\", \"0.3 m\"]; "
                   "rate = \"1 mm/s\"; }");
  advance(&run, 2.001);
  for (size_t i = 0; i < run.s.count; i++) {
    const double *x = run.s.position[i], ground = x[0] < 0.1 ? 0.12 : 0;
    assert_true(fabs(x[2] - ground - 0.005) < 1e-3);
  }
  finish(&run);
}

static void begin_rain(struct run *run) {
  start_tank(run, WATER "{ type = \"rain\"; box = [\"0\", \"0.29 m\", \"0.2 m\", \"0.3 m\"]; "
                        "rate = \"9 mm/s\"; }");
  advance(run, 0.3);
}

static void read_rain(const struct isph *s, double found[2]) {
  memcpy(found, isph_own_numbers(s, "rain"), 2 * sizeof *found); /* fallen, pending */
}

static void threads_agree_and_a_state_comes_back(void **state) {
  (void)state;
  same_on_threads_and_back(begin_rain, 2e-3, 30, 100, read_rain);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_millimetres_arrive), cmocka_unit_test(a_level_rises),
      cmocka_unit_test(what_soil_cannot_take_stands_on_it), cmocka_unit_test(a_roof_keeps_it_off),
      cmocka_unit_test(threads_agree_and_a_state_comes_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
