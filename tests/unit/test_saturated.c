/* Soil that stays full of water (method darcy): Forchheimer's drag, tensors, wells, free water,
 * what is given in time, and which scenes are such. verify_darcy has the exact solutions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "common/units.h"
#include "tests/unit/richards_scene.h"

#define SIDES                                                                                      \
  "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", \"0.1 m\"]; head = \"0.3 m\"; },"           \
  "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; }"
#define TANK                                                                                       \
  "domain = { size = [\"0.4 m\", \"0.1 m\"]; spacing = \"1 cm\"; periodic = [false, false]; };\n"
#define SOIL(more)                                                                                 \
  "{ type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; porosity = 0.4; " more " }, "

static double flow_into(const struct richards *s, const char *name) {
  double sum = 0;
  for (size_t e = 0; e < s->edge_count; e++)
    if (s->edges[e].region != NULL && !strcmp(s->edges[e].region->name, name))
      sum -= s->edge_flux[e].q;
  return sum * s->spacing;
}

/* Water crosses the domain at the speed at which a v + b v^2 = g i, and leaves as it came. */
static void test_forchheimer(void **state) {
  struct run run;
  (void)state;
  start(&run, "scene = { end_time = \"10 s\"; };\n" TANK
              "regions = ( " SOIL("grain_size = \"5 mm\";") SIDES " );\n" GRAVITY);
  const double a = 225, b = 2062.5, f = GRAVITY_STANDARD * .25,
               v = 2 * f / (a + sqrt(a * a + 4 * b * f));
  for (size_t e = 0; e < run.s.edge_count; e++)
    assert_true(fabs(fabs(run.s.edge_flux[e].q) / v - 1) < 1e-8);
  advance(&run, 10);
  assert_true(fabs(run.s.in / (v * 10 * .1 * .01) - 1) < 1e-8 &&
              fabs(run.s.in / run.s.out - 1) < 1e-8);
  finish(&run);
}

/* Between impermeable sides beds at an angle have the head across that stops the flow there. */
static void test_tensor(void **state) {
  struct run run;
  double v[3], fall[3];
  (void)state;
  start(&run,
        "scene = { end_time = \"10 s\"; };\n" TANK
        "regions = ( " SOIL("permeability = [\"1e-3 m/s\", \"1e-4 m/s\"]; bedding = [1.0, -1.0];")
            SIDES " );\n" GRAVITY);
  for (size_t i = 0; i < run.s.count; i++)
    if (i % 40 == 20) {
      richards_velocity(&run.s, i, v), richards_fall(&run.s, i, fall);
      const double k = 5.5e-4, cross = -4.5e-4;
      assert_true(fabs(v[0] - k * fall[0] - cross * fall[2]) < 1e-12);
      assert_true(fabs(v[2] - k * fall[2] - cross * fall[0]) < 1e-12);
    }
  finish(&run);
}

/* Round a periodic box v = K i, exactly; with one number for all axes no corners are coupled. */
static void test_round(void **state) {
  static const char *const soils[] = {"\"5e-4 m/s\"", "[\"5e-4 m/s\", \"5e-4 m/s\"]",
                                      "[\"4e-4 m/s\", \"1e-4 m/s\"]",
                                      "[\"4e-4 m/s\", \"1e-4 m/s\"]; bedding = [1.0, 1.0]"};
  static const double along[] = {5e-5, 5e-5, 4e-5, 4e-5}, up[] = {5e-5, 5e-5, 1e-5, 4e-5};
  (void)state;
  for (int k = 0; k < 4; k++) {
    struct run run;
    double v[3];
    start(
        &run,
        "scene = { end_time = \"1 s\"; };\ndomain = { size = [\"0.2 m\", \"0.1 m\"]; spacing = \"1 "
        "cm\"; periodic = [true, true]; };\nregions = ( { type = \"porous\"; box = [\"0\", \"0\", "
        "\"0.2 m\", \"0.1 m\"]; porosity = 0.4; permeability = %s; } );\n"
        "force = { body_acceleration = [\"0.980665 m/s^2\", \"0.980665 m/s^2\"]; };\n",
        soils[k]);
    assert_true(run.s.turned == (k == 3) && (run.s.corners == NULL) == (k < 3));
    for (size_t i = 0; i < run.s.count; i++) {
      richards_velocity(&run.s, i, v);
      assert_true(fabs(v[0] / along[k] - 1) < 1e-9 && fabs(v[2] / up[k] - 1) < 1e-9);
    }
    finish(&run);
  }
}

/* Along three axes: the sides along y are walls. */
static void test_three_dimensions(void **state) {
  struct run run;
  double v[3];
  (void)state;
  start(
      &run,
      "scene = { end_time = \"1 s\"; };\ndomain = { size = [\"4 cm\", \"3 cm\", \"4 cm\"]; spacing "
      "= "
      "\"1 cm\"; periodic = [true, true, false]; };\nregions = ( { type = \"porous\"; box = "
      "[\"0\", "
      "\"0\", \"0\", \"4 cm\", \"3 cm\", \"4 cm\"]; porosity = 0.4; permeability = [\"1e-3 m/s\", "
      "\"5e-4 m/s\", \"1e-4 m/s\"]; bedding = [2.0, 0.0, -1.0]; } );\n"
      "force = { body_acceleration = [\"9.80665 m/s^2\", \"9.80665 m/s^2\", \"0\"]; };\n");
  for (size_t i = 0; i < run.s.count; i++) {
    richards_velocity(&run.s, i, v);
    assert_true(fabs(v[0] * (.8 / 1e-3 + .2 / 1e-4) - 1) < 1e-8);
    assert_true(fabs(v[1] / 5e-4 - 1) < 1e-8 && fabs(v[2]) < 1e-12);
  }
  finish(&run);
}

/* A well takes its rate; a drain above the head in the soil takes nothing. */
static void test_sinks(void **state) {
  struct run run;
  (void)state;
  start(&run, "scene = { end_time = \"10 s\"; };\n" TANK
              "regions = ( " SOIL("permeability = \"1e-3 m/s\";") SIDES
        ", { type = \"well\"; name = \"pump\"; box = [\"0.1 m\", \"0\", \"0.12 m\", "
        "\"0.1 m\"]; rate = \"1e-6 m^2/s\"; }, { type = \"drain\"; name = \"high\"; box = "
        "[\"0.3 m\", \"0\", \"0.32 m\", \"0.1 m\"]; head = \"0.4 m\"; } );\n" GRAVITY);
  assert_true(fabs(flow_into(&run.s, "pump") / 1e-6 - 1) < 1e-9);
  assert_true(flow_into(&run.s, "high") == 0);
  finish(&run);
}

/* Heads that rise in time: the flux goes with them, and what has come in is its integral. */
static void test_tables(void **state) {
  struct run run;
  (void)state;
  start(&run,
        "scene = { end_time = \"10 s\"; };\n" TANK "regions = ( " SOIL(
            "permeability = \"1e-3 m/s\";") "{ type = \"inflow\"; box = [\"0\", \"0\", \"1 cm\", "
                                            "\"0.1 m\"]; times = [\"0 s\", \"10 s\"]; head = "
                                            "[\"0.2 m\", \"0.4 m\"]; }, "
                                            "{ type = \"inflow\"; box = [\"0.39 m\", \"0\", \"0.4 "
                                            "m\", \"0.1 m\"]; head = "
                                            "\"0.2 m\"; } );\n" GRAVITY);
  assert_true(fabs(run.s.edge_flux[0].q) < 1e-12);
  advance(&run, 5);
  assert_true(fabs(run.s.edge_flux[0].q / (1e-3 * .1 / .4) - 1) < 1e-8);
  advance(&run, 10);
  assert_true(fabs(run.s.in / (1e-3 * .1 / .4 * 10 * .1 * .01) - 1) < 1e-8);
  finish(&run);
}

/* Auto takes it, with the reason; and leaves what it is not for. */
static void test_chosen(void **state) {
  static const struct {
    const char *regions, *end, *method, *why;
  } table[] = {
      {SOIL("grain_size = \"5 mm\";") SIDES, "10 s", "darcy", "soil stays full of water"},
      {SOIL("grain_size = \"5 mm\";") SIDES, "10 ms", "isph", ""},
      {SOIL("grain_size = \"5 mm\"; velocity = [\"1 mm/s\", \"0\"];") SIDES, "1 s", "isph", ""},
      /* free water before the soil, and beside it */
      {"{ type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; }, { type = \"porous\"; "
       "box = "
       "[\"0.1 m\", \"0\", \"0.3 m\", \"0.1 m\"]; porosity = 0.4; grain_size = \"5 mm\"; }, " SIDES,
       "10 s", "darcy", "no surface moves"},
      {"{ type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; }, { type = \"porous\"; "
       "box = "
       "[\"0.1 m\", \"0\", \"0.3 m\", \"0.05 m\"]; porosity = 0.4; grain_size = \"5 mm\"; "
       "}, " SIDES,
       "10 s", "isph", ""},
      /* free water in a layer that repeats itself across the flow */
      {"{ type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.1 m\"]; }, { type = \"porous\"; "
       "box = "
       "[\"0\", \"0.03 m\", \"0.4 m\", \"0.06 m\"]; porosity = 0.4; grain_size = \"5 mm\"; }, "
       "{ type = \"inflow\"; box = [\"0\", \"0\", \"0.4 m\", \"0.01 m\"]; head = \"0.3 m\"; }, "
       "{ type = \"inflow\"; box = [\"0\", \"0.09 m\", \"0.4 m\", \"0.1 m\"]; head = \"0.2 m\"; }",
       "10 s", "darcy", ""},
      /* a pond whose window holds its level, and one that is filled first */
      {"{ type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.05 m\"]; porosity = 0.4; "
       "grain_size = "
       "\"5 mm\"; }, { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.08 m\"]; }, { type = "
       "\"inflow\"; box = [\"0\", \"0.05 m\", \"1 cm\", \"0.1 m\"]; head = \"0.08 m\"; }",
       "10 s", "darcy", ""},
      {"{ type = \"porous\"; box = [\"0\", \"0\", \"0.4 m\", \"0.05 m\"]; porosity = 0.4; "
       "grain_size = "
       "\"5 mm\"; }, { type = \"water\"; box = [\"0\", \"0\", \"0.4 m\", \"0.06 m\"]; }, { type = "
       "\"inflow\"; box = [\"0\", \"0.05 m\", \"1 cm\", \"0.1 m\"]; head = \"0.08 m\"; }",
       "10 s", "isph", ""}};
  (void)state;
  for (size_t k = 0; k < sizeof table / sizeof *table; k++) {
    char path[] = "/tmp/test_saturated_XXXXXX", why[EFFECT_WHY];
    FILE *file = fdopen(mkstemp(path), "w");
    struct scene scene;
    struct lattice lattice;
    const struct method *method;
    fprintf(file,
            "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );\n"
            "scene = { end_time = \"%s\"; };\n" TANK "regions = ( %s );\n" GRAVITY,
            table[k].end, table[k].regions);
    fclose(file);
    must_be_well(scene_read(path, NULL, 0, &scene));
    unlink(path);
    must_be_well(lattice_build(&scene, plan_wall_layers(&scene), &lattice));
    must_be_well(plan_method(&scene, &lattice, &method, why));
    assert_string_equal(method->name, table[k].method);
    assert_non_null(strstr(why, table[k].why));
    lattice_free(&lattice);
    scene_free(&scene);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_forchheimer), cmocka_unit_test(test_tensor),
      cmocka_unit_test(test_round),       cmocka_unit_test(test_three_dimensions),
      cmocka_unit_test(test_sinks),       cmocka_unit_test(test_tables),
      cmocka_unit_test(test_chosen)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
