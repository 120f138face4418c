/* One step in time. */
#ifndef TOSUI_SPHSOLVE_ISPH_STEP_H
#define TOSUI_SPHSOLVE_ISPH_STEP_H

#include "sphsolve/isph/state.h"

/* The first part of a step of length dt, s, from a fresh state: its pressure and velocities.
 * Nothing has moved yet. Collective. */
enum status isph_project(struct isph *s, double dt);
/* One step of length dt, s, from a fresh state. */
enum status isph_advance(struct isph *s, double dt);

/* Whether each step of water in soil projects twice (isph/step.c, project_again). */
static inline bool isph_projects_twice(const struct isph *s) {
  return s->on.soil && !s->on.surface;
}

#endif
