/* Cells that walls cut: open shares of faces and cells, tightness, and what darcy and richards make
 * of them. verify_darcy has the exact solutions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include <omp.h>

#include "sphsolve/geometry/thin_wall.h"
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

/* Pseudo-random numbers from 0 to 1. */
static double draw(void) {
  static unsigned long long state = 20261130;
  state = state * 6364136223846793005ULL + 1442695040888963407ULL;
  return (double)(state >> 11) / 9007199254740992.0;
}

/* Whether sites at the left and right end are connected over faces. */
static bool leads_through(const struct lattice *l) {
  size_t *stack = calloc(l->count, sizeof *stack), depth = 0;
  bool *seen = calloc(l->count, sizeof *seen), through = false;
  const size_t nx = l->size[0], first = nx / 2 - 10, last = first + 19;
  for (size_t k = 0; k < l->size[2]; k++)
    if (l->kind[k * nx + first] != SITE_WALL)
      seen[k * nx + first] = true, stack[depth++] = k * nx + first;
  while (depth > 0 && !through) {
    const size_t at = stack[--depth];
    through = at % nx == last;
    for (int f = 0; f < 4; f++) {
      const int axis = f < 2 ? 0 : 2;
      const size_t stride = axis == 0 ? 1 : nx, next = f % 2 ? at + stride : at - stride;
      if (next >= l->count || seen[next] || l->kind[next] == SITE_WALL ||
          thin_wall_on_face(l, f % 2 ? at : next, axis))
        continue;
      seen[next] = true, stack[depth++] = next;
    }
  }
  free(stack), free(seen);
  return through;
}

/* Writes a wall between two places, c at the lower one: a strip with level ends, or a post and a
 * beam. */
static int add_wall(char *text, size_t room, const double c[2], const double d[2], double thick) {
  const double t = .5 * thick, low = fmax(0, d[1] - t), high = fmin(10, d[1] + t);
  if (draw() < .6)
    return snprintf(text, room,
                    "{ type = \"wall\"; corners = [\"%.9g m\", \"%.9g m\", \"%.9g m\", \"%.9g m\", "
                    "\"%.9g m\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; }, ",
                    c[0] - t, c[1], c[0] + t, c[1], d[0] + t, d[1], d[0] - t, d[1]);
  return snprintf(text, room,
                  "{ type = \"wall\"; box = [\"%.9g m\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; }, "
                  "{ type = \"wall\"; box = [\"%.9g m\", \"%.9g m\", \"%.9g m\", \"%.9g m\"]; }, ",
                  c[0] - t, c[1], c[0] + t, d[1], fmin(c[0], d[0]) - t, low, fmax(c[0], d[0]) + t,
                  high);
}

/* Chains of walls of any thickness that meet end to end from floor to top, each with its own kind
 * and thickness: nothing passes, neither through cut cells nor on the lattices of other methods,
 * whose sites they part, or which walls take up. */
static void test_chains(void **state) {
  (void)state;
  for (int n = 0; n < 200; n++) {
    const int pieces = 1 + n % 4;
    char walls[4096] = "";
    int used = 0;
    double from[2] = {5 + 10 * draw(), 0}, to[2];
    for (int k = 0; k < pieces; k++) {
      to[0] = 5 + 10 * draw();
      to[1] = k + 1 < pieces ? 10. * (k + 1) / pieces + draw() - .5 : 10;
      used += add_wall(walls + used, sizeof walls - (size_t)used, from, to,
                       exp(log(.02) + log(100) * draw()));
      memcpy(from, to, sizeof from);
    }
    struct run run;
    struct lattice lattice;
    start(&run, BOX "regions = ( " SOIL("") "%s" HEADS("9 m", "8 m") " );\n", walls);
    for (size_t e = 0; e < run.s.edge_count; e++) assert_true(fabs(run.s.edge_flux[e].q) < 1e-12);
    assert_int_equal(lattice_build(&run.scene, 4, &lattice), STATUS_OK);
    assert_false(leads_through(&lattice));
    assert_int_equal(thin_wall_fill(&lattice), STATUS_OK);
    assert_false(leads_through(&lattice));
    lattice_free(&lattice);
    finish(&run);
  }
}

/* A membrane along the flow takes only its own area from it, wherever in the cells it lies; of what
 * it leaves between itself and a face, less than half a cube does not count. */
static void test_membrane(void **state) {
  (void)state;
  for (int n = 0; n < 20; n++) {
    const double low = 3 + .05 * n, thick = .03;
    double q = 0;
    struct run run;
    start(&run,
          BOX "regions = ( " SOIL("") "{ type = \"wall\"; box = [\"0\", \"%.9g m\", \"20 m\", "
                                      "\"%.9g m\"]; }, " HEADS("9 m", "8 m") " );\n",
          low, low + thick);
    for (size_t e = 0; e < run.s.edge_count; e++) q += fmax(0, run.s.edge_flux[e].q);
    assert_true(fabs(q / (.01 / 20 * (10 - thick)) - 1) < 1 / 320.);
    assert_true(fabs(richards_water(&run.s) / (.4 * 20 * (10 - thick)) - 1) < 1e-5);
    finish(&run);
  }
}

/* The same of two that are polygons, whose rows of sites they take up between them. */
static void test_two_membranes(void **state) {
  (void)state;
  for (int n = 0; n < 24; n++) {
    const double low = 3 + .131 * (n % 8), high = low + 1.17 + .33 * (n / 8.), thick = .03;
    double q = 0;
    struct run run;
    start(
        &run,
        BOX "regions = ( " SOIL(
            "") "{ type = \"wall\"; corners = [\"0\", \"%.9g m\", \"20 m\", \"%.9g m\", \"20 m\", "
                "\"%.9g m\", \"0\", \"%.9g m\"]; }, "
                "{ type = \"wall\"; corners = [\"0\", \"%.9g m\", \"20 m\", \"%.9g m\", \"20 m\", "
                "\"%.9g m\", \"0\", \"%.9g m\"]; }, " HEADS("9 m", "8 m") " );\n",
        low, low, low + thick, low + thick, high, high, high + thick, high + thick);
    for (size_t e = 0; e < run.s.edge_count; e++) q += fmax(0, run.s.edge_flux[e].q);
    assert_true(fabs(q / (.01 / 20 * (10 - 2 * thick)) - 1) < 2 / 340.);
    finish(&run);
  }
}

/* A membrane anywhere between two rows of sites, or on one, parts these two rows alone. */
static void test_membrane_on_lattice(void **state) {
  static const double places[] = {5.02, 5.3, 5.49, 5.499, 5.5, 5.501, 5.51, 5.53, 5.7, 5.98, 6};
  (void)state;
  for (size_t n = 0; n < sizeof places / sizeof *places; n++) {
    struct run run;
    struct lattice lattice;
    size_t cut = 0, row = 0;
    start(&run,
          BOX "regions = ( " SOIL("") "{ type = \"wall\"; box = [\"0\", \"%.9g m\", \"20 m\", "
                                      "\"%.9g m\"]; }, " HEADS("9 m", "8 m") " );\n",
          places[n], places[n] + .0099);
    assert_int_equal(lattice_build(&run.scene, 4, &lattice), STATUS_OK);
    if (run.lattice.wall_count > 0) { /* a row of sites lies in it */
      for (size_t s = 0; s < lattice.count; s++)
        assert_true(lattice.cut == NULL || !lattice.cut[s]);
    } else {
      assert_non_null(lattice.cut);
      for (size_t s = 0; s < lattice.count; s++) {
        if (lattice.cut[s] == 0) continue;
        assert_int_equal(lattice.cut[s], 4);
        assert_true(cut == 0 || row == s / lattice.size[0]);
        row = s / lattice.size[0], cut++;
      }
      assert_int_equal(cut, 20);
    }
    lattice_free(&lattice);
    finish(&run);
  }
}

/* More regions than a cell has room for are refused with their place. */
static void test_crowded(void **state) {
  char walls[16384] = "", path[] = "/tmp/test_crowded_XXXXXX";
  struct run run;
  int used = 0;
  FILE *file = fdopen(mkstemp(path), "w");
  (void)state;
  for (int n = 0; n < 140; n++)
    used += snprintf(walls + used, sizeof walls - (size_t)used,
                     "{ type = \"wall\"; centre = [\"%g m\", \"5 m\"]; radius = \"2.2 m\"; }, ",
                     9 + .003 * n);
  assert_non_null(file);
  fprintf(file,
          "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n" BOX
          "regions = ( " SOIL("") "%s" HEADS("9 m", "8 m") " );\n",
          walls);
  fclose(file);
  must_be_well(scene_read(path, NULL, 0, &run.scene));
  unlink(path);
  assert_int_equal(lattice_build(&run.scene, 0, &run.lattice), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "cut by more than 128 regions"));
  scene_free(&run.scene);
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
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_box),           cmocka_unit_test(test_tight),
      cmocka_unit_test(test_chains),        cmocka_unit_test(test_membrane),
      cmocka_unit_test(test_two_membranes), cmocka_unit_test(test_membrane_on_lattice),
      cmocka_unit_test(test_crowded),       cmocka_unit_test(test_threads),
      cmocka_unit_test(test_richards)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
