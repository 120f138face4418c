/* D* / D at the Peclet numbers of a scene, with its error. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CURVE_H
#define TOSUI_SPHSOLVE_SOLUTE_CURVE_H

#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/result.h"
#include "sphsolve/solute/state.h"
#include "sphsolve/solute/walk.h"

/* Fewest cells along each axis (that has more than one) for which the flow is also solved on cells
 * twice as large. */
#define SOLUTE_CELLS_MIN 4

/* Curve from the closure problem: fills closure, formation, formation_error and tortuosity of the
 * result from its length, count and peclet. Solved on the flow's cells and on those coarsened once
 * and twice. The value is the extrapolated limit; the error of resolution is the difference of the
 * two finest or, if that is larger, a quarter of that of the next two. Results that `state` already
 * holds are not computed again. */
enum status solute_curve_by_closure(const struct solute_flow *flow, struct solute_state *state,
                                    struct solute_result *result);

/* Curve by random walk: fills walk and record from length, count, peclet and wanted (curve_walk.c).
 * Computed on the flow's cells and on half as many along each axis, and extrapolated. */
enum status solute_curve_by_walk(const struct solute_flow *flow, struct solute_state *state,
                                 struct solute_result *result);

/* Predicted pace of a walk through a flow; cell_peclet: the Peclet number of the first spacing. */
struct walk_pace solute_walk_pace(const struct solute_flow *flow, double cell_peclet, double peclet,
                                  double wanted);

/* Extrapolates two walks quadratically in the spacing; the coarse cells are `ratio` times as long.
 * Moves `fine` by the extrapolated difference, weighted by change^2 / (change^2 + its variance),
 * and adds the shift to its error. Sets resolution: the longitudinal and transverse shift,
 * relative; NAN, and no shift, where it cannot be determined. */
void solute_walk_limit(struct solute_estimate *fine, const struct solute_estimate *coarse,
                       double ratio, double resolution[2]);

#endif
