/* The steps from distances and velocities to a flow in finite volumes. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_INTERNAL_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_INTERNAL_H

#include <stdint.h>

#include "sphsolve/solute/flow.h"

/* Sets n, count, spacing and dimensions and allocates the arrays, all 0. */
enum status solute_flow_allocate(const int n[3], const double spacing[3], struct solute_flow *flow);

/* Index of the cell (i, j, k); each may lie one beyond the box, which is periodic. */
static inline size_t solute_flow_at(const struct solute_flow *f, int i, int j, int k) {
  const int *n = f->n;
  i = i < 0 ? i + n[0] : i >= n[0] ? i - n[0] : i;
  j = j < 0 ? j + n[1] : j >= n[1] ? j - n[1] : j;
  k = k < 0 ? k + n[2] : k >= n[2] ? k - n[2] : k;
  return ((size_t)k * (size_t)n[1] + (size_t)j) * (size_t)n[0] + (size_t)i;
}

/* volume and aperture from distance: planes normal to its gradient (flow_cells.c). */
void solute_flow_cut(struct solute_flow *flow);

/* What the cut of a face leaves open, and the integral of the distance over it, for a plane at the
 * signed distance d (m) from the face's centre; m0 and m1: the normal's two components along the
 * face times the spacings (m, of any sign). Shares of the face's area. */
void solute_face_open(double d, double m0, double m1, double *area, double *moment);

/* velocity from those of the sites, [nz][ny][nx][3], m/s, 0 in walls (flow_faces.c). */
void solute_flow_fluxes(struct solute_flow *flow, const float *sites);

/* Means, porosity and grain size, from volume, aperture and velocity. */
void solute_flow_measure(struct solute_flow *flow);
/* Closes what no flow passes, makes the fluxes free of divergence, and finds the means. */
enum status solute_flow_finish(struct solute_flow *flow);

#endif
