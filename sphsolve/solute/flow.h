/* Where a flow that carries a solute comes from; what it is: volumes.h. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_FLOW_H
#define TOSUI_SPHSOLVE_SOLUTE_FLOW_H

#include "common/error.h"
#include "sphsolve/solute/volumes.h"

/* Of a run of method stokes: PREFIX.hdf and PREFIX-image.hdf beside it. Free with
 * solute_flow_free. Errors say which file lacks what. */
enum status solute_flow_read(const char *run_file, struct solute_flow *flow);

/* The same before anything is made of it, for a forecast: cells, means and grain size, but fluxes
 * that do not add up yet. */
enum status solute_flow_look(const char *run_file, struct solute_flow *flow);

/* Walls and velocities given as functions of the place x (m; the box reaches from 0 to n spacing):
 * for tests. `velocity` NULL: at rest. Fluxes are means of it over the open part of each face. */
enum status solute_flow_build(const int n[3], const double spacing[3],
                              double (*distance)(const void *context, const double x[3]),
                              void (*velocity)(const void *context, const double x[3], double u[3]),
                              const void *context, struct solute_flow *flow);

/* The same flow in half as many cells along each axis, rounded up, all of one length: volumes,
 * apertures and fluxes are sums, so that nothing is lost. */
enum status solute_flow_coarsen(const struct solute_flow *fine, struct solute_flow *coarse);

void solute_flow_free(struct solute_flow *flow);

#endif
