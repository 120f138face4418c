/* Tests named long_test_* run with LONG=1 (`make long`), alone, and are left out of `make check`
 * (LONG=0); a program started by hand runs all it has. */
#ifndef TOSUI_TESTS_UNIT_LONG_TESTS_H
#define TOSUI_TESTS_UNIT_LONG_TESTS_H

#include <stdlib.h>
#include <string.h>

/* Before cmocka_run_group_tests. */
static void long_tests_choose(void) {
  const char *asked = getenv("LONG");
  if (asked == NULL || strcmp(asked, "all") == 0) return;
  if (strcmp(asked, "1") == 0)
    cmocka_set_test_filter("long_test_*");
  else
    cmocka_set_skip_filter("long_test_*");
}

#endif
