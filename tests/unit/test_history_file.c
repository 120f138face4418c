/* OUT.history.csv: a value that is none has one spelling, and a row that holds one is kept. */
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

#include "sphsolve/output/history_file.h"

static void none_has_one_spelling(void **state) {
  (void)state;
  char path[] = "/tmp/tosui-history-XXXXXX", line[200];
  const int handle = mkstemp(path);
  const double row[3] = {copysign(NAN, -1), NAN, -0.5};
  struct history_file history = {0};
  assert_true(handle >= 0);
  close(handle);
  assert_int_equal(history_file_open(&history, path, "a,b,c", 3, 0, NULL, false), STATUS_OK);
  assert_int_equal(history_file_row(&history, 0, row), STATUS_OK);
  history_file_close(&history, false);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  assert_non_null(fgets(line, sizeof line, file));
  fclose(file);
  assert_memory_equal(line, "nan,nan,-0.5,", 13);
  assert_int_equal(history_file_open(&history, path, "a,b,c", 3, 0, NULL, true), STATUS_OK);
  assert_int_equal(history.count, 1);
  history_file_close(&history, true);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(none_has_one_spelling)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
