/* Finds that a march has left its bounds, and decides how to go on: back to the last good state
 * with half the step, three times at most. It sees how much of each bound is used, and no
 * particles: the method measures that at least every WATCH_STEPS steps, keeps the copy and goes
 * back to it. While no bound is left it changes no bit of the run. */
#ifndef TOSUI_SPHSOLVE_MARCH_WATCHDOG_H
#define TOSUI_SPHSOLVE_MARCH_WATCHDOG_H

#include <stdbool.h>
#include <stdint.h>

#include "common/error.h"

#define WATCH_STEPS 8    /* between checks: a trip is found within ten steps */
#define WATCH_HALVINGS 3 /* of the step, before a run is given up */

enum watch_bound { WATCH_DENSITY, WATCH_VELOCITY, WATCH_ENERGY, WATCH_RESIDUAL, WATCH_COUNT };

/* How much of each bound is used: 1 and more, or NaN, is out of bounds. */
struct watch_reading {
  double used[WATCH_COUNT];
};

struct watchdog {
  int halvings;          /* in force */
  double trip_time;      /* s: of the last trip */
  bool kept;             /* a good state is kept, of: */
  int64_t kept_step;     /* its step */
  double kept_used;      /* and how much of the bounds it used */
  bool seen;             /* the energy has been looked at: */
  double speed, seen_at; /* its root as a speed, m/s, and the time then, s */
};

/* How much of the energy's bound is used. The power of a force f and of walls is at most M v_rms f,
 * so that the root of the energy grows by no more than f dt (Cauchy, Schwarz) and what walls give;
 * the bound is twice that on twice what there was: an instability multiplies it. `floor`: a speed
 * below which nothing is dangerous. Updates what was seen. */
double watchdog_energy(struct watchdog *dog, double speed, double time, double force,
                       double wall_speed, double floor);
/* The bound used most, and how much of it is (INFINITY for NaN). */
enum watch_bound watchdog_worst(const struct watch_reading *reading, double *used);
/* Whether this state is worth keeping instead of the one there is: it has used no more of the
 * bounds, or the other is old. The caller copies, then calls watchdog_keep. */
bool watchdog_wants(const struct watchdog *dog, int64_t step, double used);
void watchdog_keep(struct watchdog *dog, int64_t step, double used);
/* Counts a trip. False: there is no good state, or three halvings have not helped. */
bool watchdog_trip(struct watchdog *dog, double time);
const char *watchdog_name(enum watch_bound bound);

#endif
