#include "sphsolve/march/watchdog.h"

#include <math.h>

#define KEEP_USED 0.5   /* fraction of the bounds below which a state is good enough to be kept, */
#define KEEP_STEPS 1000 /* and may replace a better one that is this many steps old */
#define KEEP_ALWAYS 0.2 /* a state below this fraction is always kept */

double watchdog_energy(struct watchdog *dog, double speed, double time, double force,
                       double wall_speed, double floor) {
  double most = 2 * (dog->speed + force * (time - dog->seen_at) + wall_speed);
  bool seen = dog->seen;
  dog->seen = true;
  dog->speed = speed;
  dog->seen_at = time;
  return seen ? speed / fmax(most, floor) : 0;
}

enum watch_bound watchdog_worst(const struct watch_reading *reading, double *used) {
  enum watch_bound worst = WATCH_DENSITY;
  *used = 0;
  for (int b = 0; b < WATCH_COUNT; b++) {
    double own = isnan(reading->used[b]) ? INFINITY : reading->used[b];
    if (own > *used) {
      *used = own;
      worst = (enum watch_bound)b;
    }
  }
  return worst;
}

bool watchdog_wants(const struct watchdog *dog, int64_t step, double used) {
  if (!(used < 1)) return false;
  if (!dog->kept || used < KEEP_ALWAYS) return true;
  return used <= 1.1 * dog->kept_used || (used < KEEP_USED && step - dog->kept_step >= KEEP_STEPS);
}

void watchdog_keep(struct watchdog *dog, int64_t step, double used) {
  dog->kept = true;
  dog->kept_step = step;
  dog->kept_used = used;
}

bool watchdog_trip(struct watchdog *dog, double time, size_t backs) {
  dog->trip_time = time;
  dog->seen = false; /* no energy is known for the restored state */
  if (!dog->kept || backs >= WATCH_BACKS) return false;
  dog->halvings++;
  return true;
}

const char *watchdog_name(enum watch_bound bound) {
  static const char *const names[] = {"density", "velocity", "energy", "residual"};
  return names[bound];
}
