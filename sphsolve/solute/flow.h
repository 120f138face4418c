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

#endif
