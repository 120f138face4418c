/* Ranks that wait for each other poll, and yield between two looks (mpi_yield_when_idle); where
 * ranks are more than cores a yield comes back at once, and they spin half of the processor away.
 * Loaded before the C library (LD_PRELOAD) this one sleeps. */
#include <sched.h>
#include <time.h>

int sched_yield(void) {
  const struct timespec short_while = {.tv_nsec = 20000};
  return nanosleep(&short_while, NULL);
}
