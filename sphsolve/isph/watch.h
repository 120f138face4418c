/* Checks whether a step exceeded the bounds of what is physically possible, and decides how the run
 * continues. */
#ifndef TOSUI_SPHSOLVE_ISPH_WATCH_H
#define TOSUI_SPHSOLVE_ISPH_WATCH_H

#include "sphsolve/isph/copy.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* Which bound was exceeded, and where. */
struct isph_trip {
  char what[STEP_BACK_CAUSE];
  enum watch_bound bound;
  double position[3], kernel_sum; /* of the particle with the largest value; kernel_sum 0: none */
};

/* The largest speed, m/s, that walls, soil, fluxes or heads give the water; without the driving
 * force. */
double isph_given_speed(const struct isph *s);
/* Upper bound of the pore velocity that the driving forces can give the water, m/s; 0 if there are
 * none. */
double isph_speed_most(const struct isph *s);
/* Collective, after a step of length dt: the share `used` of the bounds that the state takes; from
 * 1 on they are exceeded. */
enum status isph_check_bounds(struct isph *s, double dt, double *used, struct isph_trip *trip);
/* Collective: returns to the last good state with half the time step; or ends the run, with that
 * state in the checkpoint. */
enum status isph_step_back(struct isph *s, const struct isph_copy *copy, double dt,
                           const struct isph_trip *trip, struct recorder *recorder);

#endif
