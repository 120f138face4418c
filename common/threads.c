#include "common/threads.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <unistd.h>

void threads_wait_asleep(char **argv) {
  if (getenv("OMP_WAIT_POLICY") != NULL || getenv("GOMP_SPINCOUNT") != NULL) return;
  if (setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
  if (setenv("GOMP_SPINCOUNT", "1000", 1) != 0) return;
  execv("/proc/self/exe", argv);
  /* If the execution fails the program continues unchanged. */
}

static bool named;

int threads_for(double work, double each, int most) {
  return named ? most : (int)fmin(most, 1 + work / each);
}

void threads_use(int count) {
  named = count > 0;
  if (named) omp_set_num_threads(count);
}
