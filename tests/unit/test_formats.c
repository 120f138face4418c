/* Every format of the interface, read from files that no image library wrote: write_scans.py makes
 * them byte by byte and says what they hold. */
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/error.h"
#include "common/log.h"
#include "ct2model/readers/stack.h"

enum { NX = 37, NY = 21, NZ = 3 };
static char folder[256];

static int group_setup(void **state) {
  (void)state;
  char command[700];
  const char *build = getenv("BUILD");
  log_start("test_formats", LOG_QUIET);
  snprintf(folder, sizeof folder, "%s/formats-XXXXXX", build != NULL ? build : "/tmp");
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(command, sizeof command,
           "python3 tests/unit/write_scans.py '%s' > '%s/list.txt' 2> /dev/null", folder, folder);
  return system(command);
}

static int group_teardown(void **state) {
  (void)state;
  char command[300];
  snprintf(command, sizeof command, "rm -rf '%s'", folder);
  return system(command);
}

static double pattern(size_t x, size_t y, size_t z) {
  return (double)((3 * x + 5 * y + 40 * z) % 200);
}

static const char *type_words(const char *type) {
  static const char *const WORDS[][2] = {
      {"u8", "8-bit unsigned"}, {"i8", "8-bit signed"},     {"u16", "16-bit unsigned"},
      {"i16", "16-bit signed"}, {"u32", "32-bit unsigned"}, {"i32", "32-bit signed"},
      {"f32", "32-bit float"},  {"f64", "64-bit float"},
  };
  for (size_t i = 0; i < sizeof WORDS / sizeof *WORDS; i++)
    if (strcmp(WORDS[i][0], type) == 0) return WORDS[i][1];
  return "";
}

static void check_voxel(const char *name, const char *axis, double found, double micrometres) {
  if (isnan(micrometres) ? isnan(found) : fabs(found / (micrometres * 1e-6) - 1.0) < 1e-4) return;
  fail_msg("%s: voxel size along %s is %g m, not %g um", name, axis, found, micrometres);
}

/* Where a stack has levels its slices come as stored as well, and are the same. */
static void check_stored(const char *name, const struct stack *stack) {
  float slice[NX * NY], again[NX * NY];
  unsigned char stored[NX * NY * 2];
  double low, high;
  const bool whole = strcmp(name, "palette_fractions.tif") != 0;
  if (stack->has_levels != (whole && pixel_levels(stack->type, &low, &high)))
    fail_msg("%s: comes %s", name, whole ? "as float alone" : "as whole numbers");
  for (size_t z = 0; z < stack->size[2] && stack->has_levels; z++) {
    assert_int_equal(stack_read(stack, z, slice), STATUS_OK);
    assert_int_equal(stack_read_stored(stack, z, stored), STATUS_OK);
    pixels_to_float(again, stored, NX * NY, stack->type);
    if (memcmp(slice, again, sizeof slice) != 0)
      fail_msg("%s: slice %zu as stored is another", name, z);
  }
}

/* The pattern may be told apart from its like by all 200 values: scaled, they must be exact. */
static void check_file(const char *name, const char *type, double factor, double offset,
                       const double voxel[2]) {
  char path[600];
  const char *paths[] = {path};
  struct stack stack;
  float slice[NX * NY];
  snprintf(path, sizeof path, "%s/%s", folder, name);
  if (stack_open(paths, 1, NULL, &stack) != STATUS_OK) fail_msg("%s", error_message());
  size_t slices = strstr(name, ".png") != NULL ? 1 : NZ;
  if (stack.size[0] != NX || stack.size[1] != NY || stack.size[2] != slices ||
      strcmp(pixel_name(stack.type), type_words(type)) != 0)
    fail_msg("%s: %zux%zux%zu, %s", name, stack.size[0], stack.size[1], stack.size[2],
             pixel_name(stack.type));
  check_voxel(name, "x", stack.voxel[0], voxel[0]);
  check_voxel(name, "z", stack.voxel[2], voxel[1]);
  for (size_t z = slices; z-- > 0;) { /* backwards: any slice must be reachable */
    if (stack_read(&stack, z, slice) != STATUS_OK) fail_msg("%s", error_message());
    for (size_t i = 0; i < NX * NY; i++) {
      double wanted = factor * pattern(i % NX, i / NX, z) + offset;
      if (slice[i] != (float)wanted)
        fail_msg("%s: %g at %zu,%zu,%zu, not %g", name, (double)slice[i], i % NX, i / NX, z,
                 wanted);
    }
  }
  check_stored(name, &stack);
  bool colour = strstr(name, "rgb") != NULL || strncmp(name, "palette", 7) == 0;
  if (colour != (strstr(stack.files[0].note, "colour") != NULL))
    fail_msg("%s: note '%s'", name, stack.files[0].note);
  stack_close(&stack);
}

static void test_every_format(void **state) {
  (void)state;
  char path[600], name[64], type[8];
  double factor, offset, voxel[2];
  size_t files = 0;
  snprintf(path, sizeof path, "%s/list.txt", folder);
  FILE *list = fopen(path, "r");
  assert_non_null(list);
  while (fscanf(list, "%63s %7s %lf %lf %lf %lf", name, type, &factor, &offset, &voxel[0],
                &voxel[1]) == 6) {
    files++;
    if (strncmp(name, "refuse", 6) != 0) check_file(name, type, factor, offset, voxel);
  }
  fclose(list);
  assert_true(files > 50);
}

static void test_channels_and_times_are_refused(void **state) {
  (void)state;
  const char *const names[][2] = {{"refuse_channels.tif", "3 channels"},
                                  {"refuse_frames.tif", "3 frames"},
                                  {"refuse_tifffile.tif", "3 channels"},
                                  {"refuse_shape.tif", "an array of 4 axes"}};
  for (size_t i = 0; i < 4; i++) {
    char path[600];
    const char *paths[] = {path};
    struct stack stack;
    snprintf(path, sizeof path, "%s/%s", folder, names[i][0]);
    assert_int_equal(stack_open(paths, 1, NULL, &stack), STATUS_INPUT);
    assert_non_null(strstr(error_message(), names[i][0]));
    assert_non_null(strstr(error_message(), names[i][1]));
    error_clear();
  }
}

/* 4.4 GB with one directory, a sparse file: slices beyond 2 and 4 GB are found. */
static void test_imagej_over_4_gb(void **state) {
  (void)state;
  char path[600];
  const char *paths[] = {path};
  const size_t side = 2048, slices[] = {0, 1, 519};
  struct stack stack;
  float *slice = malloc(side * side * sizeof *slice);
  snprintf(path, sizeof path, "%s/imagej_large.tif", folder);
  if (stack_open(paths, 1, NULL, &stack) != STATUS_OK) fail_msg("%s", error_message());
  assert_int_equal(stack.size[0], side);
  assert_int_equal(stack.size[2], 520);
  assert_true(fabs(stack.voxel[0] - 2e-6) < 1e-10 && fabs(stack.voxel[2] - 2.5e-6) < 1e-10);
  for (size_t i = 0; i < 3; i++) {
    assert_int_equal(stack_read(&stack, slices[i], slice), STATUS_OK);
    for (size_t x = 0; x < side; x++) assert_true((double)slice[x] == pattern(x, 0, slices[i]));
    assert_true(slice[side] == 0.0f);
  }
  stack_close(&stack);
  assert_int_equal(truncate(path, 1000000000), 0); /* cut short: what is there, and a note */
  if (stack_open(paths, 1, NULL, &stack) != STATUS_OK) fail_msg("%s", error_message());
  assert_int_equal(stack.size[2], (1000000000 - 4096) / (2 * side * side));
  assert_non_null(strstr(stack.files[0].note, "of 520 slices"));
  stack_close(&stack);
  free(slice);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_every_format),
      cmocka_unit_test(test_channels_and_times_are_refused),
      cmocka_unit_test(test_imagej_over_4_gb),
  };
  return cmocka_run_group_tests(tests, group_setup, group_teardown);
}
