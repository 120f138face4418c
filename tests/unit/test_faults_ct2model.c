/* Every allocation and every write of ct2model fails once, on a small stack. */
#include "faults.h"
#include "long_tests.h"

int ct2model_main(int argc, char **argv);
#define main ct2model_main
#include "ct2model/ct2model.c"
#undef main

static char slices[400];

/* Eight raw slices of a grain in a pore, with noise that is the same everywhere. */
static int write_stack(void **state) {
  if (faults_start(state) != 0) return 1;
  FILE *file = fopen("stack.mhd", "w");
  if (file == NULL) return 1;
  fprintf(file, "NDims = 3\nDimSize = 24 24 8\nElementType = MET_UCHAR\n"
                "CompressedData = False\nElementDataFile = stack.raw\n");
  fclose(file);
  file = fopen("stack.raw", "wb");
  if (file == NULL) return 1;
  for (int z = 0; z < 8; z++)
    for (int y = 0; y < 24; y++)
      for (int x = 0; x < 24; x++) {
        int r = (x - 12) * (x - 12) + (y - 12) * (y - 12) + (z - 4) * (z - 4);
        fputc((r < 90 ? 150 : 60) + (x * 7 + y * 13 + z * 29) % 23, file);
      }
  fclose(file);
  snprintf(slices, sizeof slices,
           "stack.mhd --void-ratio 0.8 --voxel-size 5um --threads 1 --quiet");
  char command[600];
  snprintf(command, sizeof command, "ct2model build %s --size 12x12x4 -o m.hdf", slices);
  return faults_run(ct2model_main, command);
}

static void long_test_build(void **state) {
  (void)state;
  char command[600];
  snprintf(command, sizeof command, "ct2model build %s --size 12x12x4 -o out.hdf", slices);
  faults_both(ct2model_main, NULL, command);
}
static void long_test_build_of_large_voxels(void **state) {
  (void)state;
  char command[600];
  snprintf(command, sizeof command, "ct2model build %s --size 3x3x1 -o out.hdf", slices);
  faults_both(ct2model_main, NULL, command);
}
static void long_test_sweep(void **state) {
  (void)state;
  char command[600];
  snprintf(command, sizeof command, "ct2model sweep %s -o out.csv --filter none --json", slices);
  faults_both(ct2model_main, NULL, command);
}
static void test_info(void **state) {
  (void)state;
  faults_both(ct2model_main, NULL, "ct2model info stack.mhd --json");
}

static void test_levels(void **state) {
  (void)state;
  char command[600];
  snprintf(command, sizeof command,
           "ct2model build %s --size 12x12x4 --levels 2 --denoise median --grain bright -o out.hdf",
           slices);
  faults_both(ct2model_main, NULL, command);
}
static void test_export(void **state) {
  (void)state;
  faults_both(ct2model_main, NULL, "ct2model export m.hdf -o out.tif --quiet");
}
static void test_tiff(void **state) {
  (void)state;
  assert_int_equal(faults_run(ct2model_main, "ct2model export m.hdf -o pages.tif --quiet"), 0);
  faults_both(ct2model_main, NULL,
              "ct2model sweep pages.tif --void-ratio 0.8 --voxel-size 5um --size 6x6x3 --threads 1 "
              "-o out.csv --quiet");
}
static void long_test_info_model(void **state) {
  (void)state;
  faults_both(ct2model_main, NULL, "ct2model info m.hdf");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(long_test_build), cmocka_unit_test(long_test_build_of_large_voxels),
      cmocka_unit_test(long_test_sweep), cmocka_unit_test(test_info),
      cmocka_unit_test(test_levels),     cmocka_unit_test(test_export),
      cmocka_unit_test(test_tiff),       cmocka_unit_test(long_test_info_model)};
  long_tests_choose();
  return cmocka_run_group_tests(tests, write_stack, faults_end);
}
