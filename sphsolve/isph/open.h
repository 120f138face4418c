/* Sides of given head or flux: the columns of particles behind their windows. */
#ifndef TOSUI_SPHSOLVE_ISPH_OPEN_H
#define TOSUI_SPHSOLVE_ISPH_OPEN_H

#include "sphsolve/isph/state.h"

/* Finds the windows of the scene, and their columns. */
enum status isph_open_create(struct isph *s);
/* Adds the boundary particles of the columns. */
enum status isph_open_fill(struct isph *s, size_t *capacity);
/* Applies tables of time for a step from s->time to s->time + dt: walls' mean velocities, heads and
 * fluxes at its end; and the heads of sides that let waves out. Does nothing without either. */
void isph_apply_tables(struct isph *s, double dt);
/* At the end of a step: columns above a head that varies become dry, those below wet. Without
 * `place` the columns are already in their places. */
void isph_open_update_dry(struct isph *s, bool place);
/* Between predictor and pressure: makes the flow at windows normal and uniform. */
void isph_open_straighten(struct isph *s);
/* Finds the speed of the water at each column; needs sorted particles. */
enum status isph_open_measure(struct isph *s);
/* Moves the columns and adds the particles that cross the side; leaves the particles unsorted. */
enum status isph_open_move(struct isph *s, double dt);

#endif
