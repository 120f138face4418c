/* Sources of a flow that carries a solute; the flow itself: volumes.h. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_H

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

/* Reads the flow of a run of method stokes: PREFIX.hdf and PREFIX-image.hdf beside it. Free with
 * solute_flow_free. Errors name the file and what it lacks. */
enum status solute_flow_read(const char *run_file, struct solute_flow *flow);

/* The same without the final steps, for a forecast: cells, means and grain size are set, but the
 * fluxes are not yet divergence-free. */
enum status solute_flow_preview(const char *run_file, struct solute_flow *flow);

/* For tests: a flow from functions of the position x (m; the box extends from 0 to n spacing): wall
 * distance (m) and velocity (m/s; NULL: at rest). Fluxes are means of the velocity over the open
 * part of each face. */
enum status solute_flow_build(const int n[3], const double spacing[3],
                              double (*distance)(const void *context, const double x[3]),
                              void (*velocity)(const void *context, const double x[3], double u[3]),
                              const void *context, struct solute_flow *flow);

/* The same flow in half as many cells along each axis, rounded up, all of one length. Volumes,
 * apertures and fluxes are sums, so that the fluxes stay conservative. */
enum status solute_flow_coarsen(const struct solute_flow *fine, struct solute_flow *coarse);

void solute_flow_free(struct solute_flow *flow);

/* Steps on the way from wall distances and velocities to such a flow: */

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

/* Computes means, porosity and grain size from volume, aperture and velocity. */
void solute_flow_measure(struct solute_flow *flow);
/* Closes pores without flow, makes the fluxes divergence-free, and computes the means. */
enum status solute_flow_finish(struct solute_flow *flow);

#endif
