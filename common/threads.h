/* Number of OpenMP threads, and how they wait for each other. */
#ifndef TOSUI_COMMON_THREADS_H
#define TOSUI_COMMON_THREADS_H

#include "common/error.h"

/* Makes OpenMP threads sleep after some microseconds of waiting instead of spinning, unless the
 * user's environment sets the policy. libgomp reads the policy before main and has no call to
 * change it, so the program executes itself again with OMP_WAIT_POLICY=passive. On a busy machine a
 * spinning thread keeps the thread that it waits for from running: with ten other processes on two
 * cores a stokes run of 212,400 sites took 59 s with spinning threads and 5 s with sleeping ones.
 * The thousand spins that are kept (GOMP_SPINCOUNT) bridge the gaps between small loops: alone on
 * two cores the same run took 3.5 s instead of 5.4 s, with two other processes 6.8 s instead of 6.3
 * s. A low limit of the stack is raised on the way. To be called first in main. */
void threads_wait_asleep(char **argv);

/* Number of threads, at most `most`, that `work` keeps busy with `each` units of work per thread;
 * with more threads the waiting would outweigh the gain. Always `most` if the user has set the
 * number of threads. */
int threads_for(double work, double each, int most);

/* Sets the number of threads given by the user; 0 if none is given. */
void threads_use(int count);
/* Refuses more threads than can be started, and a stack too small for them; warns of so many that
 * they are in each other's way. */
enum status threads_check(void);

#endif
