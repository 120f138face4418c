/* A file in a folder of its own, and what is refused of it. */
#ifndef TOSUI_TESTS_FILES_RIG_H
#define TOSUI_TESTS_FILES_RIG_H

#include <string.h>

#include "common/error.h"
#include "tests/unit/folder_rig.h"

static char path[64];

static int make_file(void **state) {
  if (make_folder(state) != 0) return 1;
  snprintf(path, sizeof path, "%s/a.hdf", folder);
  return 0;
}

static void refused(enum status status, const char *because) {
  assert_int_equal(status, STATUS_INPUT);
  if (!strstr(error_message(), because)) fail_msg("%s", error_message());
  error_clear();
}

#endif
