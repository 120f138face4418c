/* Rain that soil cannot take yet stands on it, up to the depth D that its region gives; above it
 * runs off. On each face under such rain the depth d is
 *   dd/dt = r - q(d, h),   0 <= d <= D,
 * r the rain, q Darcy's flux into the soil from the pressure head d outside, which takes no more
 * than there is. It is part of both stages of a step, implicitly, as h is. Water that stands does
 * not flow along the surface. Without such rain nothing is allocated. */
#ifndef TOSUI_SPHSOLVE_DARCY_POND_H
#define TOSUI_SPHSOLVE_DARCY_POND_H

#include "sphsolve/darcy/state.h"

enum status richards_pond_create(struct richards *s);
void richards_pond_free(struct richards *s);

/* Fluxes through the faces with ponds at a time, and in a stage the depths at its end. */
void richards_pond_fluxes(struct richards *s, double time);

/* A step of length dt begins; its second stage begins; it is taken back; it ends. */
void richards_pond_begin(struct richards *s, double dt);
void richards_pond_second(struct richards *s, double dt);
void richards_pond_back(struct richards *s);
void richards_pond_end(struct richards *s);
/* Largest difference between the rates of the depths in the two stages of a step, m/s. */
double richards_pond_difference(const struct richards *s);
/* Rise of the depth on an edge since the start of the step, m. */
double richards_pond_rise(const struct richards *s, size_t edge);
/* Volume that stands under a rain region, or with NULL under all, m^3. */
double richards_pond_volume(const struct richards *s, const struct region *rain);

#endif
