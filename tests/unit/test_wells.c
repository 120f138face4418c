/* Wells and drains of method isph: flow to a hole in a square (exact), a well's drawdown (Thiem),
 * drains that never give, mass, and the same bits on any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sphsolve/isph/images.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/step.h"
#include "tests/unit/isph_scene.h"

#define CONDUCTIVITY 0.01 /* m/s */

/* A square of soil, without gravity, between four windows of head .5 m, and a region in it. */
static void start_square(struct run *run, const char *well) {
  char text[2000];
  snprintf(
      text, sizeof text,
      "scene = { name = \"square\"; method = \"isph\"; end_time = \"60 s\"; }; "
      "domain = { size = [\"1 m\", \"1 m\"]; spacing = \"40 mm\"; "
      "periodic = [false, false]; }; "
      "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"1 m\", \"1 m\"]; "
      "porosity = 0.4; permeability = \"1e-2 m/s\"; }, "
      "{ type = \"inflow\"; box = [\"0\", \"0\", \"25 mm\", \"1 m\"]; head = \"0.5 m\"; }, "
      "{ type = \"inflow\"; box = [\".975 m\", \"0\", \"1 m\", \"1 m\"]; head = \"0.5 m\"; }, "
      "{ type = \"inflow\"; box = [\"25 mm\", \"0\", \".975 m\", \"25 mm\"]; head = \"0.5 m\"; }, "
      "{ type = \"inflow\"; box = [\"25 mm\", \".975 m\", \".975 m\", \"1 m\"]; "
      "head = \"0.5 m\"; }, { %s } );",
      well);
  start(run, text);
}

/* From rest and without a force no step is too long for the effects. */
static void march(struct run *run, double until) {
  while (run->s.time < until - 1e-9) assert_int_equal(isph_advance(&run->s, 0.04), STATUS_OK);
}

static double pumped(const struct run *run) {
  return run->s.wells[0].taken + run->s.wells[0].pending;
}

static double mass_of(const struct isph *s) {
  double mass = 0;
  for (size_t i = 0; i < s->count; i++) mass += s->mass[i];
  return mass;
}

/* Heat that a cylinder of radius r at the middle of a square of side w gives to its sides: 2 pi k /
 * ln(1.0787 w/(2 r)) (Balcerzak, Raynor 1961; in Incropera, DeWitt, table 4.1, 1.08). */
static double exact_flow(double radius, double head) {
  return 2 * M_PI * CONDUCTIVITY * head / log(1.0787 * 0.5 / radius);
}

static void a_drain_takes_what_its_head_asks_for(void **state) {
  (void)state;
  struct run run;
  start_square(&run, "type = \"drain\"; centre = [\".5 m\", \".5 m\"]; radius = \".15 m\"");
  const double mass = mass_of(&run.s);
  march(&run, 1.2);
  const double early = pumped(&run), at = run.s.time;
  march(&run, 3.2);
  const double flow = (pumped(&run) - early) / (run.s.time - at) / 1000,
               exact = exact_flow(0.15, 0.5);
  const struct isph_well *well = &run.s.wells[0];
  printf("drain %g exact %g (%+.2f %%)\n", flow, exact, 100 * (flow / exact - 1));
  assert_true(fabs(flow / exact - 1) < 0.06);
  assert_true(well->taken > 0 && well->pending < run.s.mass[0]);
  assert_true(fabs(mass + run.s.passed.entered / run.s.thickness - well->taken - mass_of(&run.s)) <
              1e-12 * mass);
  finish(&run);
}

/* Four spacings across, anywhere on the lattice. Ending at whole particles it would take 5 to 7 %
 * too little. */
static void a_drain_of_four_spacings_takes_as_much(void **state) {
  (void)state;
  static const char *const centres[] = {"[\".5 m\", \".5 m\"]", "[\".51 m\", \".5 m\"]",
                                        "[\".516 m\", \".504 m\"]"};
  for (int n = 0; n < 3; n++) {
    struct run run;
    char drain[200];
    snprintf(drain, sizeof drain, "type = \"drain\"; centre = %s; radius = \".08 m\"", centres[n]);
    start_square(&run, drain);
    march(&run, 1.2);
    const double early = pumped(&run), at = run.s.time;
    march(&run, 4.4);
    const double flow = (pumped(&run) - early) / (run.s.time - at) / 1000,
                 exact = exact_flow(0.08, 0.5);
    printf("drain of 4 spacings %g exact %g (%+.2f %%)\n", flow, exact, 100 * (flow / exact - 1));
    assert_true(fabs(flow / exact - 1) < 0.03);
    finish(&run);
  }
}

/* Head between (.25, 0) and (.35, 0) from a source of k times unit strength at the middle of a unit
 * square with head 0 on its sides: the alternating images -ln(r)/(2 pi), summed to 81 by 81. Thiem
 * (1906) without the sides: ln(.35/.25)/(2 pi) = .05355. */
#define FALL 0.0556546

static void a_well_takes_its_rate_and_draws_down(void **state) {
  (void)state;
  struct run run;
  const double rate = 5e-3, near[3] = {0.75, 0, 0.5}, far[3] = {0.85, 0, 0.5};
  double fall = 0;
  int n = 0;
  start_square(&run, "type = \"well\"; rate = \"5e-3 m^2/s\"; centre = [\".5 m\", \".5 m\"]; "
                     "radius = \".1 m\"");
  march(&run, 1.2);
  while (run.s.time < 5 - 1e-9) {
    march(&run, run.s.time + 0.24);
    fall += (pressure_at(&run.s, far) - pressure_at(&run.s, near)) / (1000 * 9.80665), n++;
  }
  const double exact = FALL * rate / CONDUCTIVITY;
  printf("well: falls by %g, exact %g (%+.2f %%)\n", fall / n, exact, 100 * (fall / n / exact - 1));
  assert_true(fabs(pumped(&run) / (1000 * rate * run.s.time) - 1) < 1e-12);
  assert_true(fabs(fall / n / exact - 1) < 0.06);
  finish(&run);
}

/* The head that .5 m^2/s ask for falls by 13 m to the well's edge, beyond vacuum. */
static void a_rate_that_soil_does_not_bring_is_told(void **state) {
  (void)state;
  static const char *const rates[] = {"5e-3 m^2/s", "0.5 m^2/s"};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char well[200];
    snprintf(well, sizeof well,
             "type = \"well\"; rate = \"%s\"; centre = [\".5 m\", \".5 m\"]; radius = \".1 m\"",
             rates[k]);
    start_square(&run, well);
    for (int n = 0; n < 120; n++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
    assert_int_equal(run.s.wells[0].starved, k == 1 ? 100 : 0);
    finish(&run);
  }
}

static void a_drain_never_gives(void **state) {
  (void)state;
  struct run run;
  start_square(&run, "type = \"drain\"; head = \"0.6 m\"; centre = [\".5 m\", \".5 m\"]; "
                     "radius = \".15 m\"");
  const double mass = mass_of(&run.s);
  march(&run, 1);
  printf("higher drain: flow %g pumped %g of %g\n", run.s.wells[0].flow, pumped(&run), mass);
  assert_true(fabs(run.s.wells[0].flow) < 1e-4 * exact_flow(0.15, 0.5));
  assert_true(run.s.wells[0].taken == 0);
  assert_true(mass_of(&run.s) - mass < 1e-12 * mass);
  finish(&run);
}

static void begin_drain(struct run *run) {
  start_square(run, "type = \"drain\"; centre = [\".5 m\", \".5 m\"]; radius = \".15 m\"");
  march(run, 0.6);
}

static void read_drain(const struct isph *s, double found[2]) {
  found[0] = s->wells[0].taken, found[1] = s->wells[0].pending;
}

static void threads_agree_and_a_state_comes_back(void **state) {
  (void)state;
  same_on_threads_and_back(begin_drain, 0.04, 10, 15, read_drain);
}

/* What the row of the particle nearest to a place weighs along x. */
static double weight_along(const struct isph *s, double x, double z) {
  size_t i = 0;
  double sum = 0;
  for (size_t k = 0; k < s->count; k++)
    if (hypot(s->position[k][0] - x, s->position[k][2] - z) <
        hypot(s->position[i][0] - x, s->position[i][2] - z))
      i = k;
  const struct isph_chunk *chunk = s->chunks;
  while (i >= chunk->end) chunk++;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    double r[3];
    isph_separation(s, s->position[i], s->position, chunk->pair[p], r);
    sum += s->volume[chunk->pair[p] & PAIR_MASK] * (double)chunk->slope[p] * r[0] * r[0];
  }
  return sum;
}

/* Beside a closed side and at the other a row has the weight of one inside. */
static void rows_at_sides_weigh_as_inside(void **state) {
  (void)state;
  struct run run;
  start(
      &run,
      "scene = { name = \"sides\"; method = \"isph\"; end_time = \"60 s\"; }; domain = { size = "
      "[\"1 m\", \"1 m\"]; spacing = \"40 mm\"; periodic = [false, false]; }; regions = ( { type = "
      "\"porous\"; box = [\"0\", \"0\", \"1 m\", \"1 m\"]; porosity = 0.4; permeability = \"1e-2 "
      "m/s\"; }, { type = \"inflow\"; box = [\"0\", \"0\", \"25 mm\", \"1 m\"]; head = \"0.5 m\"; "
      "} "
      ");");
  march(&run, 0.04);
  const double inside = weight_along(&run.s, .5, .5);
  assert_true(fabs(weight_along(&run.s, .5, 0) / inside - 1) < .01);
  assert_true(fabs(weight_along(&run.s, .5, 1) / inside - 1) < .01);
  assert_true(fabs(weight_along(&run.s, .8, .1) / inside - 1) < .01);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_drain_takes_what_its_head_asks_for),
                                     cmocka_unit_test(a_drain_of_four_spacings_takes_as_much),
                                     cmocka_unit_test(a_well_takes_its_rate_and_draws_down),
                                     cmocka_unit_test(a_rate_that_soil_does_not_bring_is_told),
                                     cmocka_unit_test(a_drain_never_gives),
                                     cmocka_unit_test(threads_agree_and_a_state_comes_back),
                                     cmocka_unit_test(rows_at_sides_weigh_as_inside)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
