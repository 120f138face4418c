/* Volumes and open areas of the cells that walls cut. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_CELLS_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_CELLS_H

#include "sphsolve/solute/flow.h"

/* Sets volume and aperture from distance: the wall as a plane normal to its gradient. */
void solute_flow_cut(struct solute_flow *flow);

/* Open area of a face, and the integral of the distance over it, for a wall plane at the signed
 * distance d (m) from the centre of the face; m0, m1: the two components of the normal along the
 * face times the spacings (m, of any sign). Both are relative to the area of the face. */
void solute_face_open(double d, double m0, double m1, double *area, double *moment);

#endif
