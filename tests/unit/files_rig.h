/* A folder of its own for a test of files, and what is refused in it. */
#ifndef TOSUI_TESTS_FILES_RIG_H
#define TOSUI_TESTS_FILES_RIG_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "common/error.h"

static char folder[] = "/tmp/tosui-files-XXXXXX";
static char path[64];

static int make_folder(void **state) {
  (void)state;
  if (mkdtemp(folder) == NULL) return 1;
  snprintf(path, sizeof path, "%s/a.hdf", folder);
  return 0;
}
static int remove_folder(void **state) {
  (void)state;
  char command[128];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command);
}

static void refused(enum status status, const char *because) {
  assert_int_equal(status, STATUS_INPUT);
  if (!strstr(error_message(), because)) fail_msg("%s", error_message());
  error_clear();
}

#endif
