#include "common/threads.h"

#include <stdlib.h>
#include <unistd.h>

void threads_wait_asleep(char **argv) {
  if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) return;
  if (setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  if (setenv("GOMP_SPINCOUNT", "1000", 1) != 0) return;
  execv("/proc/self/exe", argv);
  /* Where that is not possible the program runs on as it is. */
}
