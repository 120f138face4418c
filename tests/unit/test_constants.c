/* Tables of constants: each line says where its number is from, and the run file holds them. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "common/constants.h"
#include "common/memory.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"

static const struct constant ct2model_constants[] = {
#define CONSTANT CONSTANT_ROW
#include "ct2model/constants.def"
#include "ct2model/readers/constants.def"
#include "ct2model/scan/constants.def"
#undef CONSTANT
    {0}};

static void check_table(const struct constant *table) {
  static const char *const origins[] = {"derived",  "cited",  "fitted",
                                        "measured", "chosen", "unknown"};
  for (const struct constant *c = table; c != NULL && c->name != NULL; c++) {
    bool known = false;
    for (size_t i = 0; i < sizeof origins / sizeof *origins; i++)
      known = known || strncmp(c->origin, origins[i], strlen(origins[i])) == 0;
    if (!known) fail_msg("%s: origin '%s'", c->name, c->origin);
    /* What is cited, fitted, measured or derived says by whom, on what or from what. */
    if (strncmp(c->origin, "chosen", 6) != 0 && strncmp(c->origin, "unknown", 7) != 0 &&
        strchr(c->origin, ':') == NULL && strchr(c->origin, ' ') == NULL)
      fail_msg("%s: '%s' of what?", c->name, c->origin);
    if (c->text[0] == 0) fail_msg("%s has no sentence", c->name);
    for (const struct constant *other = table; other < c; other++)
      if (strcmp(other->name, c->name) == 0) fail_msg("%s stands twice", c->name);
  }
}

#define CONSTANT CONSTANT_ROW
#define WHOLE CONSTANT_ROW
static const struct constant scanner_constants[] = {
#include "ct2model/scanner/constants.def"
    {0}};
#undef CONSTANT
#undef WHOLE

static void test_origins(void **state) {
  (void)state;
  check_table(scanner_constants);
  check_table(common_constants);
  check_table(plan_constants);
  check_table(ct2model_constants);
  for (size_t m = 0; methods_all[m] != NULL; m++) check_table(methods_all[m]->constants);
}

static void test_file(void **state) {
  (void)state;
  static const struct constant own[] = {{"FACTOR", 1.5, "m", "chosen", "a factor"}, {0}};
  const struct constant *const tables[] = {own, NULL, common_constants};
  char path[] = "/tmp/tosui-constants-XXXXXX", **names;
  struct h5_file *file;
  double *values;
  size_t n, rows = 0;
  const int handle = mkstemp(path);
  assert_true(handle >= 0);
  close(handle);
  unlink(path);
  assert_int_equal(h5_create(path, &file), STATUS_OK);
  assert_int_equal(constants_write(file, 3, tables), STATUS_OK);
  assert_int_equal(h5_commit(file), STATUS_OK);
  assert_int_equal(h5_open(path, &file), STATUS_OK);
  assert_int_equal(h5_read_texts(file, "/run/constants/name", &n, &names), STATUS_OK);
  assert_int_equal(h5_read(file, "/run/constants/value", H5_F64, 1, &rows, &values), STATUS_OK);
  assert_true(n == rows && n > 1);
  assert_string_equal(names[0], "FACTOR");
  assert_true(values[0] == 1.5 && values[n - 1] == DEFLATE_RATIO_MAX);
  h5_free_texts(n, &names);
  memory_free(&values);
  h5_close(file);
  unlink(path);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_origins), cmocka_unit_test(test_file)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
