/* Walls by their outline in soil without a surface. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/output.h"
#include "sphsolve/isph/wall.h"
#include "tests/unit/isph_scene.h"

static void assert_near(double measured, double reference, double bound) {
  if (!(fabs(measured - reference) <= bound)) fail_msg("%.9g for %.9g", measured, reference);
}

#define ARRAY(regions)                                                                             \
  "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"                                          \
  "domain = { size = [\"12 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"    \
  "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"12 cm\", \"12 cm\"]; porosity = 0.4; "  \
  "permeability = \"1e-3 m/s\"; }, " regions ");\n"                                                \
  "force = { body_acceleration = [\"9.80665 m/s^2\", \"0\"]; };\n"
#define ROUND(x, z) "{ type = \"wall\"; centre = [" x ", " z "]; radius = \"2 cm\"; }"

/* Velocity through a square array of impermeable cylinders that take f = .0873 of the plane, over
 * that through the soil: .8395 (Perrins, McKenzie, McPhedran 1979, Proc. R. Soc. A 369). Wherever
 * the cylinder is on the lattice, water and wall fill what is theirs. Made of boxes of sites, the
 * wall lets 5 % too little through in the second of these places. */
static void cylinders_are_round(void **state) {
  (void)state;
  static const char *const texts[] = {ARRAY(ROUND("\"6.5 cm\"", "\"6.5 cm\"")),
                                      ARRAY(ROUND("\"6.13 cm\"", "\"6.37 cm\"")),
                                      ARRAY(ROUND("\"6.25 cm\"", "\"6.25 cm\""))};
  for (int n = 0; n < 3; n++) {
    struct run run;
    double v[3], water = 0, wall = 0;
    start(&run, texts[n]);
    for (size_t i = 0; i < run.s.count; i++) water += run.s.volume[i];
    for (size_t j = 0; j < run.s.boundary_count; j++) wall += isph_wall_volume(&run.s, j);
    assert_near(wall, M_PI * 4e-4, 2e-5);
    assert_near(water + wall, .0144, 1e-9);
    for (int step = 0; step < 5; step++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
    isph_darcy_velocity(&run.s, v);
    assert_near(v[0], .83947e-3, .01 * .83947e-3);
    finish(&run);
  }
}

/* Distance and normal outside and inside, beside a corner, and across a periodic side. */
static void distances_are_those_of_the_polygon(void **state) {
  (void)state;
  struct run run;
  double n[3];
  start(&run,
        ARRAY("{ type = \"wall\"; corners = [\"1 cm\", \"4 cm\", \"4 cm\", \"4 cm\", \"4 cm\", "
              "\"8 cm\", \"1 cm\", \"8 cm\"]; }"));
  const struct isph_wall_box *box = &run.s.wall_boxes[1];
  assert_non_null(box->outline);
  assert_near(isph_outline_distance(&run.s, box, (double[3]){.05, 0, .06}, n), .01, 1e-12);
  assert_near(n[0], 1, 1e-12);
  assert_near(isph_outline_distance(&run.s, box, (double[3]){.035, 0, .06}, n), -.005, 1e-12);
  assert_near(n[0], 1, 1e-12);
  assert_near(isph_outline_distance(&run.s, box, (double[3]){.043, 0, .036}, n), .005, 1e-12);
  assert_near(n[0], .6, 1e-9);
  assert_near(n[2], -.8, 1e-9);
  assert_near(isph_outline_distance(&run.s, box, (double[3]){.119, 0, .06}, n), .011, 1e-12);
  assert_near(n[0], -1, 1e-12);
  assert_int_equal(isph_outline_facing(&run.s, (double[3]){.08, 0, .06}).box, 0);
  finish(&run);
}

/* In free water, and under a surface, walls are their boxes. */
static void others_are_boxes(void **state) {
  (void)state;
  struct run run;
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"12 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
        "false]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", \"12 cm\", \"8 cm\"]; "
        "porosity = 0.4; permeability = \"1e-3 m/s\"; }, { type = \"water\"; box = [\"0\", "
        "\"0\", \"12 cm\", \"10 cm\"]; }, " ROUND(
            "\"6.5 cm\"", "\"6.5 cm\"") ");\n"
                                        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  assert_true(run.s.on.surface);
  assert_false(run.s.on.outlines);
  assert_null(run.s.facing);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(cylinders_are_round),
      cmocka_unit_test(distances_are_those_of_the_polygon),
      cmocka_unit_test(others_are_boxes),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
