/* Cells that walls cut: open shares of faces and cells, tightness, and what darcy and richards make
 * of them. verify_darcy has the exact solutions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <omp.h>

#include "tests/unit/richards_scene.h"

#define BOX                                                                                        \
  "scene = { end_time = \"1 h\"; };\n"                                                             \
  "domain = { size = [\"20 m\", \"10 m\"]; spacing = \"1 m\"; periodic = [false, false]; };\n"
#define SOIL(more)                                                                                 \
  "{ type = \"porous\"; box = [\"0\", \"0\", \"20 m\", \"10 m\"]; porosity = 0.4; permeability = " \
  "\"1 cm/s\"; " more " }, "
#define HEADS(left, right)                                                                         \
  "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 m\", \"10 m\"]; head = \"" left "\"; },"          \
  "{ type = \"inflow\"; box = [\"19 m\", \"0\", \"20 m\", \"10 m\"]; head = \"" right "\"; }"
#define CYLINDER "{ type = \"wall\"; centre = [\"9.63 m\", \"5.37 m\"]; radius = \"2.2 m\"; }, "
#define RETENTION "van_genuchten = { alpha = \"2 1/m\"; n = 2.0; theta_r = 0.05; }; "

static size_t site_at(size_t i, size_t k) {
  return k * 20 + i;
}

/* A wall whose faces lie between sites cuts nothing; one that does not leaves its share of faces
 * along it, and that of the cell, and closes those across. */
static void test_box(void **state) {
  struct run run;
  (void)state;
  start(&run, BOX "regions = ( " SOIL("") "{ type = \"wall\"; box = [\"4 m\", \"0\", \"7 m\", \"6 "
                                          "m\"]; }, " HEADS("9 m", "8 m") " );\n");
  assert_null(run.s.walls.face);
  finish(&run);
  start(&run, BOX "regions = ( " SOIL("") "{ type = \"wall\"; box = [\"4 m\", \"0\", \"7 m\", "
                                          "\"6.7 m\"]; }, " HEADS("9 m", "8 m") " );\n");
  const struct wall_cuts *cuts = &run.s.walls;
  assert_non_null(cuts->face);
  for (size_t i = 4; i < 7; i++) {
    assert_int_equal(run.lattice.kind[site_at(i, 6)], SITE_WALL);
    assert_true(fabs(wall_cuts_volume(cuts, site_at(i, 6)) - .3) < 1 / 32.);
    assert_true(fabs(wall_cuts_face(cuts, site_at(i, 6), 0, false) - .3) < 1e-6);
    assert_true(fabs(wall_cuts_face(cuts, site_at(i, 6), 0, true) - .3) < 1e-6);
    assert_true(wall_cuts_face(cuts, site_at(i, 6), 2, true) == 1);
    assert_true(wall_cuts_face(cuts, site_at(i, 6), 2, false) == 0);
    assert_int_equal(wall_cuts_site(cuts, &run.scene, &run.lattice, site_at(i, 6)), site_at(i, 7));
  }
  finish(&run);
}

/* Plates of any thickness at any slope part the soil: no way over open faces leads across. */
static void test_tight(void **state) {
  (void)state;
  for (int n = 0; n < 120; n++) {
    const double thick = .1 + .025 * n, left = 2 + .31 * (n % 7), rise = .5 * (n % 11) - 1.5;
    struct run run;
    start(&run,
          BOX "regions = ( " SOIL(
              "") "{ type = \"wall\"; corners = [\"0\", \"%.9g m\", \"20 m\", "
                  "\"%.9g m\", \"20 m\", \"%.9g m\", \"0\", \"%.9g m\"]; }, "
                  "{ type = \"inflow\"; box = [\"0\", \"0\", \"20 m\", \"1 m\"]; head = \"9 m\"; },"
                  "{ type = \"inflow\"; box = [\"0\", \"9 m\", \"20 m\", \"10 m\"]; head = \"8 "
                  "m\"; } );\n",
          left, left + rise, left + rise + thick, left + thick);
    for (size_t e = 0; e < run.s.edge_count; e++) assert_true(fabs(run.s.edge_flux[e].q) < 1e-12);
    finish(&run);
  }
}

/* The same on any number of threads, to the last bit. */
static void test_threads(void **state) {
  struct run run[2];
  (void)state;
  for (int n = 0; n < 2; n++) {
    omp_set_num_threads(n == 0 ? 1 : 3);
    start(&run[n], BOX "regions = ( " SOIL("") CYLINDER HEADS("9 m", "8 m") " );\n");
  }
  omp_set_num_threads(1);
  assert_int_equal(run[0].s.count, run[1].s.count);
  assert_memory_equal(run[0].s.walls.face, run[1].s.walls.face,
                      run[0].lattice.count * sizeof *run[0].s.walls.face);
  assert_memory_equal(run[0].s.h, run[1].s.h, run[0].s.count * sizeof *run[0].s.h);
  for (int n = 0; n < 2; n++) finish(&run[n]);
}

/* Full soil of richards lets through what darcy does; one that drains conserves its water. */
static void test_richards(void **state) {
  struct run full, wet;
  (void)state;
  start(&full, BOX "regions = ( " SOIL("") CYLINDER HEADS("19 m", "18 m") " );\n" GRAVITY);
  start(&wet, BOX "regions = ( " SOIL(RETENTION "head = \"19 m\";")
                  CYLINDER HEADS("19 m", "18 m") " );\n" GRAVITY);
  advance(&wet, 1e6);
  assert_int_equal(full.s.edge_count, wet.s.edge_count);
  for (size_t e = 0; e < full.s.edge_count; e++)
    assert_true(fabs(full.s.edge_flux[e].q / wet.s.edge_flux[e].q - 1) < 1e-7);
  assert_true(fabs(richards_water(&wet.s) / (.4 * (200 - M_PI * 2.2 * 2.2)) - 1) < 1e-3);
  assert_true(water_open(&wet.s) < 1e-9);
  finish(&full);
  finish(&wet);
  start(&wet, BOX "regions = ( " SOIL(RETENTION "head = \"10 m\";")
                  CYLINDER HEADS("3 m", "2 m") " );\n" GRAVITY);
  advance(&wet, 1e5);
  assert_true(water_open(&wet.s) < 1e-10);
  finish(&wet);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_box), cmocka_unit_test(test_tight),
                                     cmocka_unit_test(test_threads),
                                     cmocka_unit_test(test_richards)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
