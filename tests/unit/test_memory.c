/* What a plan says of memory, for a model too large to be run here. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene_read.h"

/* The scan of S06 at its own resolution, mirrored: 480 x 480 x 511 voxels. */
static void test_full_scan_fits(void **state) {
  (void)state;
  char path[] = "/tmp/tosui-memory-XXXXXX";
  int handle = mkstemp(path);
  const char *text = "scene = { name = \"scan\"; method = \"wcsph\"; end_time = \"1 s\"; };\n"
                     "model = { file = \"scan.hdf\"; };\n"
                     "fluids = ( { name = \"water\"; density = \"1000 kg/m^3\"; viscosity = \"1e-3 "
                     "Pa s\"; } );\n"
                     "force = { body_acceleration = [\"0\", \"0\", \"-9.8 m/s^2\"]; };\n";
  assert_true(handle >= 0 && write(handle, text, strlen(text)) == (ssize_t)strlen(text));
  close(handle);
  struct scene scene;
  char file[64];
  snprintf(file, sizeof file, "model.file=%s", path); /* any that is there: it is not read */
  const char *set = file;
  assert_int_equal(scene_read(path, &set, 1, &scene), STATUS_OK);
  unlink(path);

  struct lattice lattice = {.dimensions = 3,
                            .size = {480, 480, 511},
                            .spacing = {5.83e-6, 5.83e-6, 5.83e-6},
                            .count = (size_t)480 * 480 * 511};
  lattice.kind = malloc(lattice.count);
  lattice.wall_distance = calloc(lattice.count, sizeof *lattice.wall_distance); /* never written */
  assert_true(lattice.kind != NULL && lattice.wall_distance != NULL);
  /* Cubes of 16 voxels in one of which a grain of 13 stands: porosity 0.46. */
  for (size_t i = 0; i < lattice.count; i++) {
    size_t x = i % 480 % 16, y = i / 480 % 480 % 16, z = i / (480 * 480) % 16;
    lattice.kind[i] = x < 13 && y < 13 && z < 13 ? SITE_WALL : SITE_FLUID;
    lattice.fluid_count += lattice.kind[i] == SITE_FLUID;
  }
  lattice.bulk_count = (double)lattice.count;
  lattice.wall_count = lattice.count - lattice.fluid_count;
  struct plan plan;
  assert_int_equal(plan_make(&scene, &lattice, &method_wcsph, "test", 2, &plan), STATUS_OK);
  print_message("%zu sites: %.2f GB: %.2f GB, then %.2f GB, and %.2f GB of disk; %.1f and %.1f "
                "bytes a site\n",
                lattice.count, 1e-9 * plan.bytes_total, 1e-9 * plan.bytes_method,
                1e-9 * plan.bytes_split, 1e-9 * plan.bytes_disk, plan.bytes_fluid, plan.bytes_wall);
  assert_true(plan.bytes_disk > 0 && plan.bytes_split > 0);
  assert_true(plan.bytes_total >= plan.bytes_method);
  assert_true(plan.bytes_total >= plan.bytes_split);
  assert_true(plan.bytes_fluid <= 100 && plan.bytes_wall <= 16);
  assert_true(plan.bytes_total >= 5.0 * (double)lattice.count && plan.bytes_total < 20e9);
  free(lattice.kind);
  free(lattice.wall_distance);
  scene_free(&scene);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_full_scan_fits)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
