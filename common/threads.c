#include "common/threads.h"

#include <math.h>
#include <omp.h>
#include <stdbool.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <unistd.h>

#include "common/log.h"

/* The stack that a program takes as it pleases, and the least one, in bytes. */
#define STACK_USUAL ((rlim_t)8 << 20)
#define STACK_LEAST ((rlim_t)1 << 20)
#define THREADS_MOST 4096
/* Threads a processor from which most of the time goes into waiting. */
#define THREADS_CROWD 4

/* Allows a larger stack from the next execution on, where the present limit is low and may be
 * raised. */
static bool raise_stack(void) {
  struct rlimit stack;
  if (getrlimit(RLIMIT_STACK, &stack) != 0) return false;
  const rlim_t wanted = stack.rlim_max < STACK_USUAL ? stack.rlim_max : STACK_USUAL;
  if (stack.rlim_cur >= wanted) return false;
  stack.rlim_cur = wanted;
  return setrlimit(RLIMIT_STACK, &stack) == 0;
}

void threads_wait_asleep(char **argv) {
  bool again = raise_stack();
  if (getenv("OMP_WAIT_POLICY") == NULL && getenv("GOMP_SPINCOUNT") == NULL)
    again = (setenv("OMP_WAIT_POLICY", "passive", 1) == 0 &&
             setenv("GOMP_SPINCOUNT", "1000", 1) == 0) ||
            again;
  if (again) execv("/proc/self/exe", argv);
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

enum status threads_check(void) {
  struct rlimit stack;
  const int threads = omp_get_max_threads(), processors = omp_get_num_procs();
  if (getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < STACK_LEAST)
    return FAIL(STATUS_RUN, "the stack may hold %.0f kB only; %.0f kB are wanted (ulimit -s)",
                (double)stack.rlim_cur / 1024.0, (double)STACK_LEAST / 1024.0);
  if (threads > THREADS_MOST)
    return FAIL(STATUS_USAGE, "OMP_NUM_THREADS asks for %d threads; %d at most", threads,
                THREADS_MOST);
  if (threads > THREADS_CROWD * processors)
    log_warning(
        "%d threads on %d processor%s wait for each other most of the time: --threads %d is "
        "faster",
        threads, processors, processors > 1 ? "s" : "", processors);
  return STATUS_OK;
}
