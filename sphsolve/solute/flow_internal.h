/* Steps from wall distances and velocities to a flow in finite volumes. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_INTERNAL_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_INTERNAL_H

#include <stdint.h>

#include "sphsolve/solute/flow.h"

/* Sets n, count, spacing and dimensions and allocates the arrays, initialised to 0. */
enum status solute_flow_allocate(const int n[3], const double spacing[3], struct solute_flow *flow);

/* Index of the cell (i, j, k); each index may exceed the periodic box by one. */
static inline size_t solute_flow_at(const struct solute_flow *f, int i, int j, int k) {
  const int *n = f->n;
  i = i < 0 ? i + n[0] : i >= n[0] ? i - n[0] : i;
  j = j < 0 ? j + n[1] : j >= n[1] ? j - n[1] : j;
  k = k < 0 ? k + n[2] : k >= n[2] ? k - n[2] : k;
  return ((size_t)k * (size_t)n[1] + (size_t)j) * (size_t)n[0] + (size_t)i;
}

/* Sets volume and aperture from distance: the wall as a plane normal to its gradient
 * (flow_cells.c). */
void solute_flow_cut(struct solute_flow *flow);

/* Open area of a face, and the integral of the distance over it, for a wall plane at the signed
 * distance d (m) from the centre of the face; m0, m1: the two components of the normal along the
 * face times the spacings (m, of any sign). Both are relative to the area of the face. */
void solute_face_open(double d, double m0, double m1, double *area, double *moment);

/* Sets the face fluxes from site velocities, [nz][ny][nx][3], m/s, 0 in walls (flow_faces.c). */
void solute_flow_fluxes(struct solute_flow *flow, const float *sites);

/* Computes means, porosity and grain size from volume, aperture and velocity. */
void solute_flow_measure(struct solute_flow *flow);
/* Closes pores without flow, makes the fluxes divergence-free, and computes the means. */
enum status solute_flow_finish(struct solute_flow *flow);

#endif
