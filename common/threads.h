/* How threads wait for each other. */
#ifndef TOSUI_COMMON_THREADS_H
#define TOSUI_COMMON_THREADS_H

/* Makes OpenMP threads sleep, not spin, once they have waited some microseconds, unless the user's
 * environment says otherwise. libgomp reads its policy before main and offers no call to change it,
 * so the program starts itself once more with OMP_WAIT_POLICY=passive. On a machine with other work
 * a spinning thread keeps from the core the very thread it waits for: a stokes run of 212,400 sites
 * took 59 s (32 s of processor time) spinning and 5 s (2.3 s) sleeping with ten other processes on
 * two cores. A thousand turns before it sleeps (GOMP_SPINCOUNT) span the gaps between small loops:
 * on two quiet cores 3.5 s instead of 5.4 (3.0 with ten thousand), beside two other processes 6.8
 * instead of 6.3 (8.2 with three thousand). Call first in main. */
void threads_wait_asleep(char **argv);

#endif
