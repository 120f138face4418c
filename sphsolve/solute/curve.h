/* D* / D over the Peclet numbers of a scene, with its error. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_CURVE_H
#define TOSUI_SPHSOLVE_SOLUTE_CURVE_H

#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/result.h"
#include "sphsolve/solute/state.h"
#include "sphsolve/solute/walk.h"

/* Cells along each axis (that has more than one) from which the flow is taken on cells twice as
 * large too. */
#define SOLUTE_CELLS_LEAST 4
/* Beyond this Peclet number of a cell, U h / D, cells do not hold the layers in which a solute
 * leaves its streamline, and the closure problem is known less well. */
#define SOLUTE_CELL_PECLET 50.0
#define SOLUTE_WALK_ERROR 0.03 /* of a walk, where the user says nothing */

/* By the closure problem: fills closure, formation, formation_error and tortuosity of the result
 * from its length, count and peclet. Solved on the flow's cells and on those taken two by two by
 * two, once and twice: the limit is the value, all of the difference of the two finest, or a
 * quarter of that of the next two, the error of resolution. What `state` holds already is not solved
 * again. */
enum status solute_curve_by_closure(const struct solute_flow *flow, struct solute_state *state,
                                    struct solute_result *result);

/* By random walk: fills walk and record from length, count, peclet and wanted (curve_walk.c).
 * Walked on the flow's cells, and on half as many along each axis, towards the limit of both. */
enum status solute_curve_by_walk(const struct solute_flow *flow, struct solute_state *state,
                                 struct solute_result *result);

/* Of a walk to come through a flow, with cells of a Peclet number of their own. */
struct walk_pace solute_walk_pace(const struct solute_flow *flow, double cell_peclet, double peclet,
                                  double wanted);

/* The limit of two walks by the square of the spacing, on cells `ratio` times as long: moves `fine`
 * by what the two differ by, times change^2 / (change^2 + its variance), and adds that to its
 * error. Returns it, longitudinal and transverse, relative; nothing moves where it is not known
 * (NAN). */
void solute_walk_limit(struct solute_estimate *fine, const struct solute_estimate *coarse,
                       double ratio, double resolution[2]);

#endif
