/* A folder of its own for a test of files: made and removed by the group of tests. */
#ifndef TOSUI_TESTS_FOLDER_RIG_H
#define TOSUI_TESTS_FOLDER_RIG_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "common/log.h"

static char folder[] = "/tmp/tosui-test-XXXXXX";

static inline int make_folder(void **state) {
  (void)state;
  log_start("test", LOG_QUIET);
  return mkdtemp(folder) == NULL;
}
static inline int remove_folder(void **state) {
  (void)state;
  char command[64];
  snprintf(command, sizeof command, "rm -rf %s", folder);
  return system(command);
}

/* The path of a file in it; the last four are kept. */
static inline const char *in_folder(const char *name) {
  static char path[4][200];
  static int turn;
  turn = (turn + 1) % 4;
  snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
  return path[turn];
}

#endif
