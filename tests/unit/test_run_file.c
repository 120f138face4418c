/* Reading runs: what is written is read, what is wrong is named, what may not be mixed is apart. */
#include "analyze/run_file.h"

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

#include "common/memory.h"
#include "tests/unit/nth_fails.h"

static char folder[] = "/tmp/tosui-run-XXXXXX";
static char path[64];

static void write_number(struct h5_file *file, const char *name, double value) {
  assert_int_equal(h5_write_attribute(file, "/run", name, H5_F64, 1, &value), STATUS_OK);
}

static void write_run(const char *hash, const char *wall, double force, double viscosity) {
  struct h5_file *file = NULL;
  const double spacing[3] = {1e-5, 1e-5, 1e-5}, driving[3] = {0, 0, -force};
  const uint64_t size[3] = {2, 3, 4};
  const double time[3] = {0, 1, 2};
  double velocity[9] = {0};
  uint8_t solid[24] = {1};
  const size_t shape[3] = {4, 3, 2}, rows[2] = {3, 3};
  for (int i = 0; i < 3; i++) velocity[3 * i + 2] = -0.5 * i;
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/run"), STATUS_OK);
  h5_write_attribute_text(file, "/run", "method", "wcsph");
  h5_write_attribute_text(file, "/run", "wall", wall);
  h5_write_attribute_text(file, "/run", "model_hash", hash);
  h5_write_attribute_text(file, "/run", "model_path", "somewhere/dense.hdf");
  write_number(file, "density", 1000);
  write_number(file, "viscosity", viscosity);
  write_number(file, "hydraulic_gradient", force / 9.80665);
  h5_write_attribute(file, "/run", "spacing", H5_F64, 3, spacing);
  h5_write_attribute(file, "/run", "driving", H5_F64, 3, driving);
  h5_write_attribute(file, "/run", "size", H5_U64, 3, size);
  h5_write(file, "/run/solid", H5_U8, 3, shape, solid, false);
  h5_write(file, "/history/time", H5_F64, 1, rows, time, false);
  h5_write(file, "/history/darcy_velocity", H5_F64, 2, rows, velocity, false);
  h5_write_attribute_text(file, "/history/time", "unit", "s");
  assert_int_equal(h5_commit(file), STATUS_OK);
}

static void test_round_trip(void **state) {
  (void)state;
  struct run run;
  double *times, *values;
  size_t rows;
  char name[200];
  write_run("00000000000000ab", "frozen", 9.80665, 1e-3);
  assert_int_equal(run_read(path, &run), STATUS_OK);
  assert_string_equal(run.name, "run"); /* no scene name: that of the file */
  assert_true(run.size[0] == 2 && run.size[1] == 3 && run.size[2] == 4 && run.solid[0] == 1);
  assert_true(run.direction[2] == -1.0 && fabs(run.hydraulic_gradient - 1.0) < 1e-12);
  assert_true(isnan(run.k) && run.column_count == 2);
  assert_string_equal(run_column(&run, "time", 1)->unit, "s");
  assert_null(run_column(&run, "time", 3));
  assert_int_equal(run_darcy_series(&run, &rows, &times, &values), STATUS_OK);
  assert_true(rows == 3 && values[2] == 1.0); /* along the force */
  run_group_name(&run, name, sizeof name);
  assert_string_equal(name, "dense (wcsph, frozen walls)");
  assert_false(run_is_companion(path));
  memory_free(&times);
  memory_free(&values);
  run_free(&run);
}

static void test_what_may_not_be_mixed(void **state) {
  (void)state;
  struct run runs[6];
  size_t group[6];
  const struct {
    const char *hash, *wall;
    double force, viscosity;
  } cases[6] = {{"ab", "frozen", 9.8, 1e-3}, {"ab", "frozen", 49, 1e-3},
                {"cd", "frozen", 9.8, 1e-3}, {"ab", "adami", 9.8, 1e-3},
                {"ab", "frozen", 9.8, 2e-3}, {"cd", "frozen", 98, 1e-3}};
  for (int i = 0; i < 6; i++) {
    write_run(cases[i].hash, cases[i].wall, cases[i].force, cases[i].viscosity);
    assert_int_equal(run_read(path, &runs[i]), STATUS_OK);
  }
  assert_int_equal(runs_group(runs, 6, group), 4);
  assert_true(group[0] == group[1] && group[2] == group[5] && group[0] != group[2]);
  assert_true(group[3] != group[0] && group[4] != group[0] && group[3] != group[4]);
  for (int i = 0; i < 6; i++) run_free(&runs[i]);
}

static void test_wrong_files_are_named(void **state) {
  (void)state;
  struct run run;
  struct h5_file *file = NULL;
  write_run("ab", "frozen", 9.8, 0.0); /* no viscosity */
  assert_int_equal(run_read(path, &run), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "viscosity"));
  assert_non_null(strstr(error_message(), path));
  error_clear();
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(h5_make_group(file, "/model"), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(run_read(path, &run), STATUS_INPUT);
  assert_non_null(strstr(error_message(), "a model of ct2model"));
  error_clear();
}

/* Every allocation that fails gives an error and no leak (a leak shows under make asan). */
static void test_out_of_memory(void **state) {
  (void)state;
  struct run run;
  write_run("ab", "frozen", 9.8, 1e-3);
  long n = 1;
  for (; n < 200; n++) {
    nth_fails_left = n;
    memory_ask_fails(nth_fails);
    enum status status = run_read(path, &run);
    memory_ask_fails(NULL);
    if (status == STATUS_OK) break;
    assert_int_equal(status, STATUS_RUN);
    error_clear();
  }
  assert_in_range(n, 10, 199);
  run_free(&run);
}

static int start(void **state) {
  (void)state;
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(path, sizeof path, "%s/run.hdf", folder);
  return 0;
}

static int end(void **state) {
  (void)state;
  unlink(path);
  return rmdir(folder);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(test_round_trip), cmocka_unit_test(test_what_may_not_be_mixed),
      cmocka_unit_test(test_wrong_files_are_named), cmocka_unit_test(test_out_of_memory)};
  return cmocka_run_group_tests(tests, start, end);
}
