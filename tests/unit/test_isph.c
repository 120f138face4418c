/* Method isph: kernels against the common ones, water at rest as an exact state, Darcy's law in
 * saturated soil, the rule for what starts wet, and the same bits for any number of threads. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/kernel.h"
#include "sphsolve/isph/isph_kernel.h"
#include "sphsolve/isph/isph_output.h"
#include "sphsolve/methods/isph.h"

static void assert_near(double value, double expected, double tolerance) {
  assert_true(fabs(value - expected) <= tolerance);
}

struct run {
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
  struct isph s;
};

static void start(struct run *run, const char *text) {
  char path[] = "/tmp/test_isph_XXXXXX";
  int handle = mkstemp(path);
  assert_true(handle >= 0);
  FILE *file = fdopen(handle, "w");
  assert_non_null(file);
  fprintf(file,
          "fluids = ( { name = \"water\"; density = \"1000 kg/m^3\"; "
          "viscosity = \"1e-3 Pa s\"; } );\n%s",
          text);
  fclose(file);
  struct isph_switches on;
  memset(run, 0, sizeof *run);
  assert_int_equal(scene_read(path, NULL, 0, &run->scene), STATUS_OK);
  unlink(path);
  assert_int_equal(lattice_build(&run->scene, 0, &run->lattice), STATUS_OK);
  assert_int_equal(plan_make(&run->scene, &run->lattice, METHOD_ISPH, "test", 1, &run->plan),
                   STATUS_OK);
  isph_switches_of(&run->plan, &on);
  assert_int_equal(isph_create(&run->scene, &run->lattice, &on, &run->s), STATUS_OK);
}

static void finish(struct run *run) {
  isph_free(&run->s);
  lattice_free(&run->lattice);
  scene_free(&run->scene);
}

static void kernels_agree(void **state) {
  (void)state;
  for (int dimensions = 2; dimensions <= 3; dimensions++)
    for (int k = 0; k < 2; k++) {
      enum kernel kernel = k ? KERNEL_QUINTIC : KERNEL_CUBIC;
      for (double r = 0.05; r < 1; r += 0.09) {
        double w, slope, h = 1 / kernel_support_ratio(kernel);
        isph_kernel(kernel, dimensions, r, 1, &w, &slope);
        assert_near(w, kernel_w(kernel, dimensions, r, h), 1e-9);
        assert_near(slope, -kernel_dw(kernel, dimensions, r, h) / r, 1e-6);
      }
    }
}

static const char tank[] =
    "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
    "domain = { size = [\"8 cm\", \"6 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
    "false, false]; };\n"
    "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"0\", \"8 cm\", \"6 cm\", \"8 cm\"]; "
    "},\n"
    "{ type = \"porous\"; box = [\"0\", \"0\", \"0\", \"8 cm\", \"6 cm\", \"4 cm\"]; porosity = "
    "0.4; "
    "grain_size = \"5 mm\"; } );\n"
    "force = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n";

/* P = rho g (z_s - z) solves the discrete equations on the lattice, and nothing moves but for what
 * the filling does at the soil's edge. */
static void rest_is_exact(void **state) {
  (void)state;
  struct run run;
  char text[sizeof tank];
  strcpy(text, tank);
  *strstr(text, "},\n{ type = \"porous\"") = '\0';
  strcat(text, "} );\nforce = { gravity = [\"0\", \"0\", \"-9.81 m/s^2\"]; };\n"
               "isph = { dt = \"1 ms\"; tolerance = 1e-9; };\n");
  start(&run, text);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  double fastest = 0;
  for (size_t i = 0; i < run.s.count; i++) {
    double expected = 1000 * 9.81 * (0.08 - run.s.position[i][2]);
    assert_near(run.s.pressure[i], expected, 0.02 * 785);
    for (int a = 0; a < 3; a++) fastest = fmax(fastest, fabs(run.s.velocity[i][a]));
  }
  /* A step of free fall is g dt = 1e-2 m/s; the edge where surface meets wall is not exact. */
  print_message("fastest %g m/s\n", fastest);
  assert_true(fastest < 1e-3);
  finish(&run);
}

static void soil_is_wet_where_water_is(void **state) {
  (void)state;
  struct run run;
  start(&run, tank);
  double mass = 0;
  for (size_t i = 0; i < run.s.count; i++) mass += run.s.mass[i];
  assert_int_equal(run.s.count, 8 * 6 * 8);
  assert_near(mass, 1e-3 * (8 * 6 * 4 + 0.4 * 8 * 6 * 4), 1e-9);
  finish(&run);
  start(&run, "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
              "domain = { size = [\"8 cm\", \"12 cm\"]; spacing = \"1 cm\"; periodic = [false, "
              "false]; };\n"
              "regions = ( { type = \"water\"; box = [\"0\", \"4 cm\", \"8 cm\", \"8 cm\"]; },\n"
              "{ type = \"porous\"; box = [\"0\", \"0\", \"8 cm\", \"4 cm\"]; porosity = 0.4; "
              "grain_size = \"5 mm\"; } );\n"
              "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\n");
  assert_int_equal(run.s.count, 8 * 4); /* the block below starts dry */
  finish(&run);
}

/* v_D = 2 g / (a + sqrt(a^2 + 4 b g)), grains of 0.1 mm at 1 ms: 300 times the explicit limit. */
static void saturated_soil_obeys_darcy(void **state) {
  (void)state;
  struct run run;
  double v[3];
  start(&run,
        "scene = { method = \"isph\"; end_time = \"1 s\"; };\n"
        "domain = { size = [\"4 cm\", \"4 cm\"]; spacing = \"1 cm\"; periodic = [true, true]; };\n"
        "regions = ( { type = \"porous\"; box = [\"0\", \"0\", \"4 cm\", \"4 cm\"]; porosity = "
        "0.3; grain_size = \"0.1 mm\"; alpha = 1000.0; beta = 1.1; } );\n"
        "force = { gravity = [\"0\", \"-9.81 m/s^2\"]; };\nisph = { dt = \"1 ms\"; };\n");
  for (int k = 0; k < 50; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  isph_darcy_velocity(&run.s, v);
  assert_near(v[2], -5.4055e-6, 5e-10);
  finish(&run);
}

static void threads_agree(void **state) {
  (void)state;
#ifdef _OPENMP
  int before = omp_get_max_threads();
  struct run one, three;
  omp_set_num_threads(1);
  start(&one, tank);
  for (int k = 0; k < 20; k++) assert_int_equal(isph_advance(&one.s, 1e-3), STATUS_OK);
  omp_set_num_threads(3);
  start(&three, tank);
  for (int k = 0; k < 20; k++) assert_int_equal(isph_advance(&three.s, 1e-3), STATUS_OK);
  omp_set_num_threads(before);
  assert_int_equal(one.s.count, three.s.count);
  assert_memory_equal(one.s.position, three.s.position, one.s.count * sizeof *one.s.position);
  assert_memory_equal(one.s.velocity, three.s.velocity, one.s.count * sizeof *one.s.velocity);
  assert_memory_equal(one.s.pressure, three.s.pressure, one.s.count * sizeof *one.s.pressure);
  finish(&one);
  finish(&three);
#endif
}

/* Few iterations, and fewer from the last step's pressure than from nothing. */
static void warm_start_saves(void **state) {
  (void)state;
  struct run run;
  start(&run, tank);
  assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  int cold = run.s.solve.iterations;
  for (int k = 0; k < 5; k++) assert_int_equal(isph_advance(&run.s, 1e-3), STATUS_OK);
  assert_in_range(cold, 2, 25);
  assert_true(run.s.solve.iterations < cold);
  finish(&run);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(kernels_agree),
      cmocka_unit_test(rest_is_exact),
      cmocka_unit_test(soil_is_wet_where_water_is),
      cmocka_unit_test(saturated_soil_obeys_darcy),
      cmocka_unit_test(threads_agree),
      cmocka_unit_test(warm_start_saves),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
