/* Scene files: what a user writes is what the solver gets, and every mistake is named with its
 * line. */
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

#include "sphsolve/lattice.h"
#include "sphsolve/scene.h"

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
  assert_true(scene.method == METHOD_AUTO && scene.end_time == 1 && scene.steady_tolerance == 0);
  assert_int_equal(scene.region_count, 2);
  assert_true(scene.regions[1].porosity == 0.3 && scene.regions[1].alpha == 1000);
  assert_true(fabs(scene.regions[0].box[2] - 0.1) < 1e-15 && scene.driving[2] == -9.8);
  assert_true(isnan(scene.isph.dt) && scene.isph.tau == 0.1);
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

static void test_overrides(void **state) {
  (void)state;
  struct scene scene;
  const char *overrides[] = {"isph.tau=0.05 s", "regions.[1].porosity=0.5", "scene.method=isph",
                             "force.gravity=[\"0\",\"0\",\"-1.62 m/s^2\"]"};
  assert_int_equal(read_with(0, NULL, &scene), STATUS_OK);
  scene_free(&scene);
  assert_int_equal(scene_read(path, overrides, 4, &scene), STATUS_OK);
  assert_true(scene.isph.tau == 0.05 && scene.regions[1].porosity == 0.5);
  assert_true(scene.method == METHOD_ISPH && scene.gravity[2] == -1.62);
  assert_non_null(strstr(scene.text, "# --set isph.tau=0.05 s"));
  scene_free(&scene);
  const char *wrong[] = {"isph.tua=0.05 s"};
  assert_int_equal(scene_read(path, wrong, 1, &scene), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "did you mean 'tau'"));
  error_clear();
  const char *senseless[] = {"tau"};
  assert_int_equal(scene_read(path, senseless, 1, &scene), STATUS_USAGE);
  error_clear();
}

/* Line, its wrong text, and what the message must say beside file and line. */
static const struct {
  int line;
  const char *text, *says;
} mistakes[] = {
    {1, "scene = { name = \"tank\"; };", ""}, /* right: steady by default */
    {1, "scene = { end_time = 1; };", "has no unit"},
    {1, "scene = { end_time = \"1 m\"; };", "is in m, but s is wanted"},
    {1, "scene = { end_time = \"-1 s\"; };", "greater than 0"},
    {1, "scene = { end_time = \"1 s\"; metod = \"isph\"; };", "did you mean 'method'"},
    {1, "scene = { end_time = \"1 s\"; method = \"sph\"; };", "is none of"},
    {1, "scene = { steady_tolerance = 0.0; };", "end_time is missing"},
    {1, "scene = { end_time = \"1 s\"; steady_tolerance = 2.0; };", "below 1"},
    {1, "scene = { end_time = \"1 s\" ", "syntax error"},
    {2, "domain = { size = [\"0.2 m\"]; spacing = \"1 cm\"; };", "2 to 3 quantities"},
    {2, "domain = { spacing = \"1 cm\"; };", "size is missing"},
    {2, "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; };", "spacing is missing"},
    {2, "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; spacing = \"-1 cm\"; };",
     "greater than 0"},
    {2, "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; spacing = \"1 m\"; };",
     "at least one spacing"},
    {2,
     "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; spacing = \"1 cm\"; periodic = [true]; "
     "};",
     "times true or false"},
    {2,
     "domain = { size = [\"0.2 m\", \"0.2 m\", \"0.4 m\"]; spacing = \"1 cm\"; periodic = [1, 0, "
     "0]; };",
     "true or false is wanted"},
    {3, "fluids = ( { density = \"-1 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );", "greater than 0"},
    {3, "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"-1e-3 Pa s\"; } );",
     "must not be negative"},
    {3, "fluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1e-3 Pa\"; } );", "Pa s is wanted"},
    {3, "fluids = ( { density = \"1000 kg/m^3\"; viscosty = \"1e-3 Pa s\"; } );",
     "did you mean 'viscosity'"},
    {3, "fluids = ( { viscosity = \"1e-3 Pa s\"; } );", "density is missing"},
    {3, "fluids = { density = \"1000 kg/m^3\"; };", "a list"},
    {3, "fluids = ( 1 );", "a group"},
    {6,
     "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; porosity "
     "= 0.3; }",
     "needs its D50"},
    {6,
     "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; "
     "grain_size = \"1 mm\"; }",
     "porosity is missing"},
    {6,
     "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; porosity "
     "= 1.3; grain_size = \"1 mm\"; }",
     "at most 1"},
    {6,
     "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"0.3 m\", \"0.2 m\", \"10 cm\"]; porosity "
     "= 0.3; grain_size = \"1 mm\"; }",
     "outside the domain"},
    {6, "{ type = \"wall\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"0\"]; }",
     "greater than z0"},
    {6, "{ type = \"wall\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\"]; }", "6 quantities"},
    {6, "{ type = \"wall\"; }", "box is missing"},
    {6, "{ box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; }", "type is missing"},
    {6, "{ type = \"sand\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; }",
     "is none of"},
    {6,
     "{ type = \"wall\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; porosity = "
     "0.3; }",
     "unknown key"},
    {6, "{ type = \"inflow\"; box = [\"0\", \"0\", \"0\", \"0.2 m\", \"0.2 m\", \"10 cm\"]; }",
     "either head"},
    {8, "force = { gravity = [\"0\", \"0\", \"-9.8\"]; };", "has no unit"},
    {8, "force = { gravity = [\"0\", \"-9.8 m/s^2\"]; };", "3 quantities"},
    {8, "force = { gravity = \"9.8 m/s^2\"; };", "a list of"},
    {8, "forces = { gravity = [\"0\", \"0\", \"-9.8 m/s^2\"]; };", "did you mean 'force'"},
    {8, "isph = { alpha = 0.01; tau = \"0.1 s\"; };", "say the same"},
    {8, "isph = { tau = \"0 s\"; };", "greater than 0"},
    {8, "isph = { tolerance = 2.0; };", "below 0.1"},
    {8, "isph = { support_ratio = 0.5; };", "spacings are possible"},
    {8, "effects = { turbulance = \"on\"; };", "did you mean 'turbulence'"},
    {8, "effects = { turbulence = \"maybe\"; };", "is none of"},
    {8, "gauges = ( { at = [\"0\", \"0\"]; } );", "3 quantities"},
    {8, "planes = ( { x = \"1 cm\"; z = \"1 cm\"; } );", "one of x, y, z"},
    {8, "model = { file = \"nowhere.hdf\"; };", "cannot be read"},
    {8, "output = { interval = \"0 s\"; };", "greater than 0"},
    {8, "@include \"/etc/passwd\"", "not supported"},
};

static void test_mistakes(void **state) {
  (void)state;
  for (size_t i = 0; i < sizeof mistakes / sizeof *mistakes; i++) {
    struct scene scene;
    char place[96];
    enum status status = read_with(mistakes[i].line, mistakes[i].text, &scene);
    if (!*mistakes[i].says) {
      assert_int_equal(status, STATUS_OK);
      scene_free(&scene);
      continue;
    }
    if (status != STATUS_INPUT) fail_msg("accepted: %s", mistakes[i].text);
    snprintf(place, sizeof place, "%s:", path);
    if (strncmp(error_message(), place, strlen(place)) ||
        !strstr(error_message(), mistakes[i].says))
      fail_msg("%s\n-> %s", mistakes[i].text, error_message());
    /* The line is named wherever the mistake is in a line and not in a lack of one. */
    snprintf(place, sizeof place, "%s:%d:", path, mistakes[i].line);
    if (!strstr(mistakes[i].says, "syntax") && !strstr(mistakes[i].says, "not supported") &&
        strncmp(error_message(), place, strlen(place)))
      fail_msg("%s\n-> no line in: %s", mistakes[i].text, error_message());
    error_clear();
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_tank),           cmocka_unit_test(test_saturated_soil),
      cmocka_unit_test(test_two_dimensions), cmocka_unit_test(test_overrides),
      cmocka_unit_test(test_many_regions),   cmocka_unit_test(test_mistakes)};
  return cmocka_run_group_tests(tests, make_file, remove_file);
}
