/* Method isph: pressures that one can read. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "sphsolve/isph/output.h"
#include "tests/unit/isph_scene.h"

/* Tanks side by side, one full to its lid: it has no surface, and its pressure begins at nothing
 * under the lid; and one that wants four particles to be full, which no surface particle that comes
 * and goes turns into megapascals. */
static void full_water_is_still(void **state) {
  (void)state;
  static const char settings[] =
      "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n"
      "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
      "domain = { size = [\"20 cm\", \"10 cm\"]; spacing = \"1 cm\"; periodic = [false, false]; "
      "};\n";
  static const struct {
    const char *regions;
    double foot[3];
    double swing; /* of its pressure, over rho g H */
  } cases[] = {{"regions = ( { type = \"wall\"; box = [\"10 cm\", \"0\", \"13 cm\", \"10 cm\"]; }, "
                "{ type = \"water\"; box = [\"0\", \"0\", \"10 cm\", \"5 cm\"]; }, "
                "{ type = \"water\"; box = [\"13 cm\", \"0\", \"20 cm\", \"10 cm\"]; } );\n",
                {.165, 0, 0},
                .01},
               {"regions = ( { type = \"water\"; box = [\"0\", \"0\", \"20 cm\", \"10 cm\"]; }, "
                "{ type = \"empty\"; box = [\"0\", \"8 cm\", \"2 cm\", \"10 cm\"]; } );\n",
                {.1, 0, 0},
                .02}};
  for (int k = 0; k < 2; k++) {
    struct run run;
    char text[1200];
    snprintf(text, sizeof text, "%s%s", settings, cases[k].regions);
    start(&run, text);
    assert_int_equal(run.s.enclosed_count, k == 0);
    for (int step = 0; step < 200; step++) {
      assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
      double head = pressure_at(&run.s, cases[k].foot) / (1000 * 9.81 * .1);
      assert_true(head < 10); /* 4.3 in the step in which the void falls shut */
      if (step >= 150) assert_true(fabs(head - 1) <= cases[k].swing);
    }
    double squares = 0;
    for (size_t i = 0; i < run.s.count; i++)
      for (int a = 0; a < 3; a++) squares += pow(run.s.velocity[i][a], 2) / (double)run.s.count;
    print_message("rms velocity %g m/s\n", sqrt(squares));
    assert_true(sqrt(squares) < (k == 0 ? .001 : .04));
    assert_int_equal(run.s.enclosed_count, 1);
    finish(&run);
  }
}

/* A column that collapses, at the step the program chooses: from one step to the next its pressure
 * changes as the flow does, by less than 2 % (by a third when shifting turned particles over). */
static void pressure_does_not_alternate(void **state) {
  (void)state;
  struct run run;
  static const double at[3] = {.07, 0, .05};
  start(&run, "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "domain = { size = [\"50 cm\", \"30 cm\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"15 cm\", \"28 cm\"]; } );\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  double before = 0, worst = 0;
  while (run.s.time < 0.16) {
    const char *limit;
    assert_int_equal(isph_advance(&run.s, isph_stable_dt(&run.s, &limit)), STATUS_OK);
    double now = pressure_at(&run.s, at);
    if (run.s.time > 0.07) worst = fmax(worst, fabs(now / before - 1));
    before = now;
  }
  print_message("largest change of pressure in a step %.2g %%\n", 100 * worst);
  assert_true(worst < 0.02);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(full_water_is_still),
      cmocka_unit_test(pressure_does_not_alternate),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
