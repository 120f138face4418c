/* What a run of method isph leaves: history rows with water volumes, front, gauges and planes;
 * snapshots; checkpoints. */
#ifndef TOSUI_SPHSOLVE_ISPH_OUTPUT_H
#define TOSUI_SPHSOLVE_ISPH_OUTPUT_H

#include "common/error.h"
#include "sphsolve/isph/gauge.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/output/recorder.h"

/* The columns of the history beyond those of every method; a row; the particles; the state. `dt` is
 * the last step's, s. Collective. */
enum status isph_add_columns(const struct isph *s, struct recorder *recorder);
enum status isph_write_row(const struct isph *s, struct recorder *recorder, double dt);
enum status isph_write_snapshot(const struct isph *s, struct recorder *recorder);
enum status isph_write_checkpoint(const struct isph *s, struct recorder *recorder);
/* Takes the state out of a checkpoint; the file stays open. */
enum status isph_read_checkpoint(struct isph *s, struct h5_file *file);
/* Of the soil with the largest grains (plan/reynolds.h); NAN without soil or viscosity. */
double isph_reynolds(const struct isph *s, const double velocity[3]);
/* Volume integral of v_D over the bulk volume of the domain, m/s. */
void isph_darcy_velocity(const struct isph *s, double velocity[3]);
/* Water passing a plane, m^3/s, positive along the axis. */
double isph_plane_flux(const struct isph *s, int axis, double position);

#endif
