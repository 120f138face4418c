/* Scene files: what a user writes is what the solver gets. Mistakes: test_bad_scenes.c. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/scene/scene_read.h"
#include "sphsolve/scene/scene_compare.h"

static char path[] = "/tmp/tosui-scene-XXXXXX";

static int make_file(void **state) {
  (void)state;
  int descriptor = mkstemp(path);
  return descriptor < 0 ? 1 : close(descriptor);
}
static int remove_file(void **state) {
  (void)state;
  return unlink(path);
}

static const char *const tank[] = {
    "scene = { name = \"tank\"; end_time = \"1 s\"; };",
    "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; spacing = \"1 cm\"; };",
    "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );",
    "regions = (",
    "  { type = \"water\"; box = [\"0\", \"0\", \"10 cm\", \"0.2 m\", \"0.2 m\", \"20 cm\"]; },",
    "  { type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; porosity "
    "= 0.3; grain_size = \"1 cm\"; }",
    ");",
    "force = { gravity = [\"0\", \"0\", \"-9.8 m/s^2\"]; };"};
enum { LINES = sizeof tank / sizeof *tank };

/* Reads the tank with line `line` (from 1; 0: none) replaced. */
static enum status read_with(int line, const char *text, struct scene *scene) {
  FILE *file = fopen(path, "w");
  for (int i = 0; i < LINES; i++) fprintf(file, "%s\n", i + 1 == line ? text : tank[i]);
  fclose(file);
  return scene_read(path, NULL, 0, scene);
}

static void test_tank(void **state) {
  (void)state;
  struct scene scene;
  struct lattice lattice;
  assert_int_equal(read_with(0, NULL, &scene), STATUS_OK);
  assert_true(scene.method == NULL && scene.end_time == 1 && scene.steady_tolerance == 0);
  assert_int_equal(scene.region_count, 2);
  assert_true(scene.regions[1].porosity == 0.3 && scene.regions[1].alpha == 1000);
  assert_true(fabs(scene.regions[0].box[2] - 0.1) < 1e-15 && scene.driving[2] == -9.8);
  assert_true(isnan(scene.isph.dt) && scene.isph.relaxation_time == 0.1);
  /* Dry soil below, water above, air on top. */
  assert_int_equal(lattice_build(&scene, 0, &lattice), STATUS_OK);
  assert_int_equal(lattice.count, 20 * 20 * 40);
  assert_int_equal(lattice.fluid_count, 20 * 20 * 10);
  assert_int_equal(lattice.wall_count, 0);
  lattice_free(&lattice);
  assert_int_equal(lattice_build(&scene, 4, &lattice), STATUS_OK);
  assert_int_equal(lattice.count, 28 * 28 * 48);
  /* The first site inside the corner lies half a spacing from each wall. */
  size_t corner = (4 * 28 + 4) * 28 + 4;
  assert_true(fabs((double)lattice.wall_distance[corner] - 0.005) < 1e-9);
  assert_true(fabs((double)lattice.wall_distance[corner - 1] + 0.005) < 1e-9);
  lattice_free(&lattice);
  scene_free(&scene);
}

static void test_saturated_soil(void **state) {
  (void)state;
  struct scene scene;
  struct lattice lattice;
  assert_int_equal(read_with(5, "", &scene), STATUS_OK);
  assert_int_equal(lattice_build(&scene, 0, &lattice), STATUS_OK);
  assert_int_equal(lattice.fluid_count, 20 * 20 * 10);
  lattice_free(&lattice);
  scene_free(&scene);
}

static void test_two_dimensions(void **state) {
  (void)state;
  struct scene scene;
  FILE *file = fopen(path, "w");
  fputs("scene = { end_time = \"1 s\"; };\n"
        "domain = { size = [\"1 m\", \"2 m\"]; spacing = \"0.1 m\"; periodic = [true, false]; };\n"
        "fluids = ( { density = \"1 kg/m^3\"; viscosity = \"1 Pa s\"; } );\n"
        "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"1 m\", \"2 m\"]; } );\n"
        "force = { body_acceleration = [\"1 m/s^2\", \"2 m/s^2\"]; };\n",
        file);
  fclose(file);
  assert_int_equal(scene_read(path, NULL, 0, &scene), STATUS_OK);
  assert_true(scene.dimensions == 2 && scene.domain_size[0] == 1 && scene.domain_size[2] == 2);
  assert_true(scene.periodic[0] && scene.periodic[1] && !scene.periodic[2]);
  assert_true(scene.driving[0] == 1 && scene.driving[1] == 0 && scene.driving[2] == 2);
  scene_free(&scene);
}

static void test_many_regions(void **state) {
  (void)state;
  struct scene scene;
  FILE *file = fopen(path, "w");
  for (int i = 0; i < 3; i++) fprintf(file, "%s\n", tank[i]);
  fputs("regions = (\n", file);
  for (int i = 0; i < 3000; i++)
    fprintf(
        file,
        "  %s{ type = \"water\"; box = [\"0\", \"0\", \"0\", \"1 cm\", \"1 cm\", \"1 cm\"]; }\n",
        i > 0 ? ", " : "");
  fputs(");\nforce = { gravity = [\"0\", \"0\", \"-9.8 m/s^2\"]; };\n", file);
  fclose(file);
  assert_int_equal(scene_read(path, NULL, 0, &scene), STATUS_OK);
  assert_int_equal(scene.region_count, 3000);
  scene_free(&scene);
}

/* Area of the boxes of region `number` in the plane of axes a and b, and their number. */
static double area_of(const struct scene *scene, size_t number, int a, int b, size_t *count) {
  double area = 0;
  *count = 0;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    if (r->number != number) continue;
    assert_true(r->first <= k && k < r->end);
    area += (r->box[a + 3] - r->box[a]) * (r->box[b + 3] - r->box[b]);
    (*count)++;
  }
  return area;
}

/* A polygon of soil keeps its area; a cylinder of wall takes the sites whose centres it covers. */
static void test_shapes(void **state) {
  (void)state;
  struct scene scene;
  struct lattice lattice;
  size_t count, sites = 0;
  const char *regions =
      "{ type = \"porous\"; corners = [\"1 cm\", \"0\", \"0.2 m\", \"0\", \"14 cm\", \"33 mm\", "
      "\"7 cm\", \"52 mm\"]; along = [\"0\", \"0.1 m\"]; porosity = 0.3; grain_size = \"1 cm\"; }, "
      "{ type = \"porous\"; axis = \"x\"; centre = [\"0.1 m\", \"0.3 m\"]; radius = \"5 cm\"; "
      "porosity = 0.3; grain_size = \"1 cm\"; }, "
      "{ type = \"wall\"; axis = \"z\"; centre = [\"0.1 m\", \"0.1 m\"]; radius = \"6 cm\"; }";
  assert_int_equal(read_with(6, regions, &scene), STATUS_OK);
  /* Shoelace formula, in cm^2. */
  const double exact =
      0.5e-4 * (1 * 0 - 20 * 0 + 20 * 3.3 - 14 * 0 + 14 * 5.2 - 7 * 3.3 + 7 * 0 - 1 * 5.2);
  assert_true(fabs(area_of(&scene, 1, 0, 2, &count) / exact - 1) < 0.002);
  assert_true(count > 5 && count < 40);
  assert_float_equal(scene.regions[1].extent[2], 0, 1e-12);
  assert_float_equal(scene.regions[1].extent[5], 0.052, 1e-12);
  assert_float_equal(scene.regions[1].box[4], 0.1, 1e-12);
  assert_true(fabs(area_of(&scene, 2, 1, 2, &count) / (M_PI * 25e-4) - 1) < 0.002);
  assert_int_equal(lattice_build(&scene, 0, &lattice), STATUS_OK);
  for (int j = 0; j < 20; j++)
    for (int i = 0; i < 20; i++) sites += hypot(i - 9.5, j - 9.5) < 6;
  assert_int_equal(lattice.wall_count, 40 * sites);
  lattice_free(&lattice);
  scene_free(&scene);
}

static void test_overrides(void **state) {
  (void)state;
  struct scene scene;
  const char *overrides[] = {"isph.tau=0.05 s", "regions.[1].porosity=0.5", "scene.method=isph",
                             "force.gravity=[\"0\",\"0\",\"-1.62 m/s^2\"]"};
  assert_int_equal(read_with(0, NULL, &scene), STATUS_OK);
  scene_free(&scene);
  assert_int_equal(scene_read(path, overrides, 4, &scene), STATUS_OK);
  assert_true(scene.isph.relaxation_time == 0.05 && scene.regions[1].porosity == 0.5);
  assert_true(scene.method == &method_isph && scene.gravity[2] == -1.62);
  assert_non_null(strstr(scene.text, "# --set isph.tau=0.05 s"));
  scene_free(&scene);
  const char *indexed[] = {"regions[1].porosity=0.6", "fluids.0.viscosity=2 mPa s"};
  assert_int_equal(scene_read(path, indexed, 2, &scene), STATUS_OK);
  assert_true(scene.regions[1].porosity == 0.6 && scene.fluid.viscosity == 2e-3);
  scene_free(&scene);
  const char *const nowhere[] = {"regions[9].porosity=0.6",
                                 "regions[1.porosity=0.6",
                                 "regions.9.x=1",
                                 "[0].x=1",
                                 "regions[]=1",
                                 "regions.[1]=1",
                                 ".x=1",
                                 "scene..x=1"};
  for (size_t i = 0; i < sizeof nowhere / sizeof *nowhere; i++) {
    assert_int_equal(scene_read(path, &nowhere[i], 1, &scene),
                     i == 3 ? STATUS_INPUT : STATUS_USAGE);
    error_clear();
  }
  const char *wrong[] = {"isph.tua=0.05 s"};
  assert_int_equal(scene_read(path, wrong, 1, &scene), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "did you mean 'tau'"));
  error_clear();
  const char *senseless[] = {"tau"};
  assert_int_equal(scene_read(path, senseless, 1, &scene), STATUS_USAGE);
  error_clear();
}

/* Without end_time a run goes on until the flow is steady. */
static void test_steady_by_default(void **state) {
  (void)state;
  struct scene scene;
  assert_int_equal(read_with(1, "scene = { name = \"tank\"; };", &scene), STATUS_OK);
  assert_true(isinf(scene.end_time) && scene.steady_tolerance == 1e-4);
  scene_free(&scene);
}

/* What a resumed run may change, and what not: a gauge that moves would have two meanings in one
 * column of the history. */
static void test_compared(void **state) {
  (void)state;
  struct scene scene;
  char *then, *now;
  const char *const gauges[] = {"gauges=({name=\"a\"; at=[\"1 cm\",\"1 cm\",\"12 cm\"];})",
                                "gauges=({name=\"a\"; at=[\"1 cm\",\"1 cm\",\"13 cm\"];})"};
  assert_int_equal(read_with(0, "", &scene), STATUS_OK);
  scene_free(&scene);
  for (int moved = 0; moved < 2; moved++) {
    assert_int_equal(scene_read(path, &gauges[0], 1, &scene), STATUS_OK);
    assert_int_equal(scene_describe(&scene, &then), STATUS_OK);
    scene_free(&scene);
    const char *const overrides[] = {gauges[moved], "scene.end_time=2 s"};
    assert_int_equal(scene_read(path, overrides, 2, &scene), STATUS_OK);
    assert_int_equal(scene_describe(&scene, &now), STATUS_OK);
    scene_free(&scene);
    assert_int_equal(scene_compare(then, now, "x.ckpt.hdf"), moved ? STATUS_INPUT : STATUS_OK);
    free(then);
    free(now);
  }
  assert_non_null(
      strstr(error_message(), "gauges[0] was a 0.01 0.01 0.12 and is a 0.01 0.01 0.13"));
  error_clear();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_compared),       cmocka_unit_test(test_tank),
      cmocka_unit_test(test_saturated_soil), cmocka_unit_test(test_two_dimensions),
      cmocka_unit_test(test_overrides),      cmocka_unit_test(test_many_regions),
      cmocka_unit_test(test_shapes),         cmocka_unit_test(test_steady_by_default)};
  return cmocka_run_group_tests(tests, make_file, remove_file);
}
