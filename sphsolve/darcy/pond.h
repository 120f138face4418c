/* Free water that stands on soil and beside it, with a level that follows from what enters and
 * leaves: rain that soil cannot take yet, on the one face where it falls, up to the depth that its
 * region gives; and bodies of water, each in its basin (darcy/basin.h). With the volume V of a pool
 * up to its level z,
 *   dV/dt = r - sum A q(z, h),   V <= V_most,
 * r what it catches, q Darcy's flux into the soil through its faces: from the pressure head of the
 * water where the level is above a face, else as on a face to the air. What is more than V_most
 * runs off. The level is an unknown of both stages of a step, as h is: for given h it is found
 * exactly, and the matrix of Newton's method has a row for its change. Where a level lies in a face
 * that takes all that there is, a share of the face is wet. Without such water nothing is
 * allocated. */
#ifndef TOSUI_SPHSOLVE_DARCY_POND_H
#define TOSUI_SPHSOLVE_DARCY_POND_H

#include "sphsolve/darcy/state.h"

/* Finds the pools of the edges, and sets their initial volumes; each pool will have a row of the
 * matrix after those of the sites. */
enum status richards_pond_create(struct richards *s);
void richards_pond_free(struct richards *s);
/* Fluxes through the faces of pools at a time, and in a stage the volumes at its end. */
void richards_pond_fluxes(struct richards *s, double time);
/* Adds the rows of the levels, and what they change in those of sites, to Newton's matrix. */
void richards_pond_assemble(struct richards *s);

/* A step of length dt begins; its second stage begins; it is taken back; it ends. */
void richards_pond_begin(struct richards *s, double dt);
void richards_pond_second(struct richards *s, double dt);
void richards_pond_back(struct richards *s);
void richards_pond_end(struct richards *s);
/* Adds what pools have caught and lost in a step to the balance; `weight` of its two stages, at
 * times `time`, m^2 s. */
void richards_pond_balance(struct richards *s, const double weight[2], const double time[2]);
/* Largest difference between the rates of levels in the two stages of a step; largest rate in it,
 * m/s. */
double richards_pond_difference(const struct richards *s);
double richards_pond_rate(const struct richards *s, double dt);
/* Volume of the water of a region, m^3; NULL: of all. */
double richards_pond_volume(const struct richards *s, const struct region *region);
/* Level of the body of water of a region, m. */
double richards_pond_level(const struct richards *s, const struct region *region);

#endif
