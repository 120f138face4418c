/* Output of a run of method isph: history rows with water volumes, front, gauges and planes;
 * snapshots; checkpoints. */
#ifndef TOSUI_SPHSOLVE_ISPH_OUTPUT_H
#define TOSUI_SPHSOLVE_ISPH_OUTPUT_H

#include "common/error.h"
#include "sphsolve/isph/gauge.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* Adds the history's columns beyond those of every method; writes a row of the history, and a
 * checkpoint of the state. `dt` is the length of the last step, s.
 * Collective. */
enum status isph_add_columns(const struct isph *s, struct recorder *recorder);
enum status isph_write_row(const struct isph *s, struct recorder *recorder, double dt);
enum status isph_write_checkpoint(const struct isph *s, struct recorder *recorder);
/* Reads the state from a checkpoint; the file stays open. */
enum status isph_read_checkpoint(struct isph *s, struct h5_file *file);
/* Reynolds number in the soil with the largest grains (plan/reynolds.h); NAN without soil or
 * viscosity. */
double isph_reynolds(const struct isph *s, const double velocity[3]);
/* Volume integral of v_D over the bulk volume of the domain, m/s. */
void isph_darcy_velocity(const struct isph *s, double velocity[3]);

#endif
