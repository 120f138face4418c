/* Every allocation and every write of sphsolve fails once, in small runs of the three methods. */
#include "faults.h"
#include "long_tests.h"

int sphsolve_main(int argc, char **argv);
#define main sphsolve_main
#include "sphsolve/sphsolve.c"
#undef main

static void write_scene(const char *name, const char *head, const char *tail) {
  FILE *file = fopen(name, "w");
  fprintf(file,
          "%s\nfluids = ( { density = \"1000 kg/m^3\"; viscosity = \"1 Pa s\"; } );\n%s\n"
          "checkpoint = { interval = \"1 us\"; };\n",
          head, tail);
  fclose(file);
}

static int write_scenes(void **state) {
  if (faults_start(state) != 0) return 1;
  const char *slit =
      "domain = { size = [\"6 cm\", \"6 cm\"]; spacing = \"1 cm\"; periodic = [true, "
      "false]; };\nregions = ( { type = \"water\"; box = [\"0\", \"0\", \"6 cm\", "
      "\"6 cm\"]; } );\nforce = { body_acceleration = [\"1 mm/s^2\", \"0\"]; };\n"
      "output = { interval = \"0.02 s\"; };";
  write_scene("wcsph.cfg", "scene = { method = \"wcsph\"; end_time = \"0.1 s\"; };", slit);
  write_scene("stokes.cfg", "scene = { method = \"stokes\"; };", slit);
  write_scene("isph.cfg",
              "scene = { method = \"isph\"; end_time = \"3 ms\"; };\n"
              "domain = { size = [\"6 cm\", \"6 cm\"]; spacing = \"1 cm\"; };",
              "regions = ( { type = \"water\"; box = [\"0\", \"0\", \"3 cm\", \"4 cm\"]; },"
              "{ type = \"porous\"; box = [\"3 cm\", \"0\", \"6 cm\", \"2 cm\"]; porosity = 0.4; "
              "grain_size = \"1 cm\"; } );\nforce = { gravity = [\"0\", \"-9.8 m/s^2\"]; };\n"
              "isph = { dt = \"1 ms\"; }; gauges = ( { at = [\"1 cm\", \"1 cm\"]; } );");
  return 0;
}

static void long_test_wcsph(void **state) {
  (void)state;
  faults_both(sphsolve_main, NULL, "sphsolve run wcsph.cfg -o out --threads 1 --quiet");
}
static void long_test_wcsph_near_its_limit(void **state) {
  (void)state;
  /* So near its limit that a state to go back to is kept. */
  faults_both(sphsolve_main, NULL,
              "sphsolve run wcsph.cfg -o out --threads 1 --quiet --set wcsph.dt=43ms "
              "--set scene.end_time=43ms --set checkpoint.interval=1h --set output.interval=1s");
}
static void long_test_wcsph_resumed(void **state) {
  (void)state;
  faults_both(sphsolve_main,
              "sphsolve run wcsph.cfg -o out --threads 1 --quiet --set scene.end_time=0.05s",
              "sphsolve run wcsph.cfg -o out --threads 1 --quiet --resume");
}
static void test_stokes(void **state) {
  (void)state;
  faults_both(sphsolve_main, NULL, "sphsolve run stokes.cfg -o out --threads 1 --quiet");
}
static void test_isph(void **state) {
  (void)state;
  faults_both(sphsolve_main, NULL, "sphsolve run isph.cfg -o out --threads 1 --quiet");
}
/* Checkpoints at every step, and a run taken up from the last of them. */
static void long_test_stokes_resumed(void **state) {
  (void)state;
  faults_both(sphsolve_main,
              "sphsolve run stokes.cfg -o out --threads 1 --quiet --set checkpoint.interval=1us "
              "--set stokes.tolerance=0.01",
              "sphsolve run stokes.cfg -o out --threads 1 --quiet --set checkpoint.interval=1us "
              "--resume");
}
static void long_test_isph_resumed(void **state) {
  (void)state;
  faults_both(sphsolve_main,
              "sphsolve run isph.cfg -o out --threads 1 --quiet --set scene.end_time=1ms",
              "sphsolve run isph.cfg -o out --threads 1 --quiet --set scene.end_time=2ms --set "
              "checkpoint.interval=1us --resume");
}
static void test_explain(void **state) {
  (void)state;
  faults_both(sphsolve_main, NULL, "sphsolve explain isph.cfg --json");
}
static void long_test_explain(void **state) {
  (void)state;
  faults_both(sphsolve_main, NULL, "sphsolve explain wcsph.cfg --error 5%");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(long_test_wcsph),
                                     cmocka_unit_test(long_test_wcsph_near_its_limit),
                                     cmocka_unit_test(test_explain),
                                     cmocka_unit_test(long_test_explain),
                                     cmocka_unit_test(long_test_wcsph_resumed),
                                     cmocka_unit_test(test_stokes),
                                     cmocka_unit_test(test_isph),
                                     cmocka_unit_test(long_test_stokes_resumed),
                                     cmocka_unit_test(long_test_isph_resumed)};
  long_tests_choose();
  return cmocka_run_group_tests(tests, write_scenes, faults_end);
}
