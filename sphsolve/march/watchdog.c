#include "sphsolve/march/watchdog.h"

#include <math.h>

#define KEEP_SHARE 0.5  /* of the bounds: a state that uses less is good enough to be kept, */
#define KEEP_STEPS 1000 /* also in place of a better one that is so many steps old */
#define KEEP_CALM 0.2   /* a state that uses less is kept whatever there is */

double watchdog_energy(struct watchdog *dog, double speed, double time, double force,
                       double wall_speed, double floor) {
  double most = 2 * (dog->speed + force * (time - dog->seen_at) + wall_speed);
  bool seen = dog->seen;
  dog->seen = true;
  dog->speed = speed;
  dog->seen_at = time;
  return seen ? speed / fmax(most, floor) : 0;
}

enum watch_bound watchdog_worst(const struct watch_reading *reading, double *share) {
  enum watch_bound worst = WATCH_DENSITY;
  *share = 0;
  for (int b = 0; b < WATCH_COUNT; b++) {
    double used = isnan(reading->share[b]) ? INFINITY : reading->share[b];
    if (used > *share) {
      *share = used;
      worst = (enum watch_bound)b;
    }
  }
  return worst;
}

bool watchdog_wants(const struct watchdog *dog, int64_t step, double share) {
  if (!(share < 1)) return false;
  if (!dog->kept || share < KEEP_CALM) return true;
  return share <= 1.1 * dog->kept_share ||
         (share < KEEP_SHARE && step - dog->kept_step >= KEEP_STEPS);
}

void watchdog_keep(struct watchdog *dog, int64_t step, double share) {
  dog->kept = true;
  dog->kept_step = step;
  dog->kept_share = share;
}

bool watchdog_trip(struct watchdog *dog, double time) {
  dog->trip_time = time;
  dog->seen = false; /* nothing yet of the state gone back to */
  if (!dog->kept || dog->halvings == WATCH_HALVINGS) return false;
  dog->halvings++;
  return true;
}

const char *watchdog_name(enum watch_bound bound) {
  static const char *const names[] = {"density", "velocity", "energy", "residual"};
  return names[bound];
}
