/* Whether a step left the bounds of what is physically possible, and how the run goes on. */
#ifndef TOSUI_SPHSOLVE_ISPH_WATCH_H
#define TOSUI_SPHSOLVE_ISPH_WATCH_H

#include "sphsolve/isph/copy.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* Which bound was left, and where. */
struct isph_trip {
  char what[STEP_BACK_CAUSE];
  enum watch_bound bound;
  double position[3], kernel_sum; /* of the particle that leads; kernel_sum 0: none does */
};

/* The largest speed, m/s, that walls, soil, fluxes or heads give the water; without the force. */
double isph_given_speed(const struct isph *s);
/* The most that all that drives the water can give it in its pores, m/s; 0 where nothing does. */
double isph_speed_most(const struct isph *s);
/* Collective, after a step of length dt: how much of the bounds its state uses, 1: out of them. */
enum status isph_check_bounds(struct isph *s, double dt, double *used, struct isph_trip *trip);
/* Collective: back to the last good state with half the step, or the end with that state in the
 * checkpoint. */
enum status isph_step_back(struct isph *s, const struct isph_copy *copy, double dt,
                           const struct isph_trip *trip, struct recorder *recorder);

#endif
