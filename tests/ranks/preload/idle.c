/* What ranks on fewer cores than ranks do without end, done with less of the processor; loaded
 * before the libraries (LD_PRELOAD). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <sched.h>
#include <time.h>

/* Ranks that wait for each other poll, and yield between two looks (mpi_yield_when_idle); where
 * ranks are more than cores a yield comes back at once, and they spin half of the processor away.
 * This one sleeps. */
int sched_yield(void) {
  const struct timespec short_while = {.tv_nsec = 20000};
  return nanosleep(&short_while, NULL);
}

/* GNU's OpenMP wakes the other threads of a team of one, too: two calls of the kernel for each
 * loop, of which a run of particles has half a million. Here one thread does the loop and nothing
 * else. */
extern int omp_get_max_threads(void)
    __attribute__((weak)); /* what is no program of ours has none */
void GOMP_parallel(void (*loop)(void *), void *data, unsigned threads, unsigned flags);
void GOMP_parallel(void (*loop)(void *), void *data, unsigned threads, unsigned flags) {
  static void (*usual)(void (*)(void *), void *, unsigned, unsigned);
  if (threads == 1 || (threads == 0 && omp_get_max_threads && omp_get_max_threads() == 1)) {
    loop(data);
    return;
  }
  if (!usual) *(void **)&usual = dlsym(RTLD_NEXT, "GOMP_parallel");
  usual(loop, data, threads, flags);
}
