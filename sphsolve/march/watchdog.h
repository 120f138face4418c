/* Detects that a time integration has exceeded its bounds and decides how to continue: from the
 * last good state with half the step, three times at most in all of a run, with its restarts. It
 * knows the used fraction of each bound, not the particles: the method measures that at least every
 * WATCH_STEPS steps, keeps the copy of the state and restores it. While no bound is exceeded, the
 * run is bitwise unchanged. */
#ifndef TOSUI_SPHSOLVE_MARCH_WATCHDOG_H
#define TOSUI_SPHSOLVE_MARCH_WATCHDOG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "common/error.h"

#define WATCH_STEPS 8 /* between checks: a trip is found within ten steps */
#define WATCH_BACKS 3 /* steps back before a run is given up */

enum watch_bound { WATCH_DENSITY, WATCH_VELOCITY, WATCH_ENERGY, WATCH_RESIDUAL, WATCH_COUNT };

/* Used fraction of each bound: 1 or more, or NaN, is out of bounds. */
struct watch_reading {
  double used[WATCH_COUNT];
};

struct watchdog {
  int halvings;          /* current number of halvings */
  double trip_time;      /* s: of the last trip */
  bool kept;             /* a good state is kept, of: */
  int64_t kept_step;     /* its step */
  double kept_used;      /* and the used fraction of its bounds */
  bool seen;             /* a previous energy is known: */
  double speed, seen_at; /* rms speed (m/s) from it, and its time (s) */
};

/* Used fraction of the energy bound. The power of a force f and of walls is at most M v_rms f, so
 * that the square root of the energy grows by at most f dt (Cauchy-Schwarz) plus the contribution
 * of walls; the bound is twice the sum of this and the previous value, which an instability exceeds
 * quickly. `floor`: a speed below which nothing is critical. Updates the stored speed and time. */
double watchdog_energy(struct watchdog *dog, double speed, double time, double force,
                       double wall_speed, double floor);
/* The bound with the largest used fraction, and this fraction (INFINITY for NaN). */
enum watch_bound watchdog_worst(const struct watch_reading *reading, double *used);
/* Whether this state should replace the kept one: it uses no larger fraction of the bounds, or the
 * kept one is old. The caller then copies the state and calls watchdog_keep. */
bool watchdog_wants(const struct watchdog *dog, int64_t step, double used);
/* Records that the state of `step` was kept, with its used fraction of the bounds. */
void watchdog_keep(struct watchdog *dog, int64_t step, double used);
/* Counts a trip of a run that has had `backs` steps back (output/step_log.h). Returns false if
 * there is no good state, or if there were WATCH_BACKS already. */
bool watchdog_trip(struct watchdog *dog, double time, size_t backs);
const char *watchdog_name(enum watch_bound bound);

#endif
