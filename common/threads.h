/* How many threads work, and how they wait for each other. */
#ifndef TOSUI_COMMON_THREADS_H
#define TOSUI_COMMON_THREADS_H

/* Makes OpenMP threads sleep, not spin, once they have waited some microseconds, unless the user's
 * environment says otherwise. libgomp reads its policy before main and offers no call to change it,
 * so the program starts itself once more with OMP_WAIT_POLICY=passive. On a machine with other work
 * a spinning thread keeps from its core the very thread it waits for: beside ten other processes on
 * two cores a stokes run of 212,400 sites took 59 s with spinning threads, 5 s with sleeping ones.
 * The thousand turns that are left (GOMP_SPINCOUNT) span the gaps between small loops: alone on two
 * cores the same run took 3.5 s instead of 5.4, beside two other processes 6.8 instead of 6.3. Call
 * first in main. */
void threads_wait_asleep(char **argv);

/* How many of `most` threads `work` keeps busy, at `each` of its units a thread: more of them wait
 * for each other longer than they help. All of them once the user named a number. */
int threads_for(double work, double each, int most);

/* The user names a number of threads; 0: none any more. */
void threads_use(int count);

#endif
