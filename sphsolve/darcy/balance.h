/* States and fluxes of the present heads, and the water that they make. */
#ifndef TOSUI_SPHSOLVE_DARCY_BALANCE_H
#define TOSUI_SPHSOLVE_DARCY_BALANCE_H

#include "sphsolve/darcy/state.h"

/* Centre of a site, m. */
void richards_place(const struct richards *s, size_t i, double x[3]);
/* Darcy velocity of a cell, walls in it included: the mean of the fluxes through both faces along
 * each axis, m/s. */
void richards_flow(const struct richards *s, size_t i, double v[3]);
/* That of its open part, in proportion to what is open of the faces: exact for uniform flow along a
 * plane wall. */
void richards_velocity(const struct richards *s, size_t i, double v[3]);
/* The fall of head there that drives it, A v + b |v| v along each axis. */
void richards_fall(const struct richards *s, size_t i, double fall[3]);
/* Evaluates states and all fluxes at a time, for the present heads. */
void richards_evaluate(struct richards *s, double time);
/* Volume of water in the soil from its heads, m^3; and net inflow since the start, m^3. */
double richards_water(const struct richards *s);
double richards_net_inflow(const struct richards *s);

#endif
