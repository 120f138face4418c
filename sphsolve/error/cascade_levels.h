/* Choice of the lattices of a cascade, and their predicted cost. Spacings in m. */
#ifndef TOSUI_SPHSOLVE_ERROR_CASCADE_LEVELS_H
#define TOSUI_SPHSOLVE_ERROR_CASCADE_LEVELS_H

#include <stdbool.h>

#include "sphsolve/error/uncertainty.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/stokes/solver/step.h"

/* Ratio of the spacings of successive lattices of an open cascade, which is CASCADE_STEPS steps of
 * its square root. The last lattice may be one to CASCADE_STEPS_MAX steps from the one before. */
#define CASCADE_RATIO 1.4142135623730951
#define CASCADE_STEPS 2
#define CASCADE_STEPS_MAX 4
/* Fewest lattices, counted from the coarsest, with which an open cascade may end: fewer do not show
 * how k scatters from lattice to lattice. A body of few pores, whose lattices are small and scatter
 * more, needs one more. */
#define CASCADE_LATTICES_MIN 4
#define CASCADE_LATTICES_FEW_PORES 5
/* Lattices of a cascade that ends with the scene's own; ratios of their spacings to the scene's. */
#define CASCADE_FIXED 3
/* Number of copies of the body in the largest lattice solved for the effect of the sides; 1: none
 * is solved. The body is solved as it is and mirrored in z (where its ends are cut), in y and in x,
 * one after the other. */
double cascade_sides_copies(const struct lattice *base);
/* Number of sites, over those of one copy, of all lattices solved for the sides, including the one
 * with closed sides. An open cascade solves only half of what is mirrored in z or y. */
double cascade_sides_times(const struct lattice *base, bool open);
/* Goal of these solves. The sides change k by per cents, and the lattices have four times the
 * sites. */
extern const struct stokes_goal cascade_sides_goal;
extern const double cascade_fixed_ratios[CASCADE_FIXED];
/* Factors on the error for fewer lattices than are enough: it exceeds what their fits say by up to
 * so much. */
extern const double cascade_few_lattices[CASCADE_LATTICES_FEW_PORES];

/* Whether the flow can also be solved on coarser lattices: pore flow past resting walls, driven by
 * a force. */
bool cascade_is_possible(const struct scene *scene, const struct plan *plan);

/* Spacing with few sites across a mean pore, with which an open cascade may begin. */
double cascade_first_spacing(const struct plan *plan, const struct lattice *base);
/* Spacing at which k scatters with the position of the sites by the full amount that converge_limit
 * assumes: as cascade_first_spacing, but without regard to axes along which the walls do not
 * change. */
double cascade_noise_scale(const struct plan *plan, const struct lattice *base);
/* Whether the walls change along an axis; they do not along a duct or a cylinder. */
bool cascade_walls_change(const struct lattice *base, int axis);
/* Length, in mean pores, of the shortest axis along which the walls change. */
double cascade_pores_across(const struct plan *plan, const struct lattice *base);
/* Number of lattices that is enough for a body that is so many pores across. */
int cascade_lattices_needed(double pores_across);
/* Steps from the first lattice of an open cascade to the last, the scene's own. */
int cascade_open_steps(const struct plan *plan, const struct lattice *base);
/* Ratio of the spacing `left` steps before the scene's own to the scene's own. */
double cascade_step_ratio(int left);
/* What would reduce the error of resolution after a lattice of that spacing has been solved. */
enum resolution_needs cascade_needs(const struct plan *plan, double spacing);
/* Spacing of the lattice on which the effect of the sides is solved, m. */
double cascade_sides_spacing(const struct plan *plan, const struct lattice *base);
/* The next finer lattice for an effect of the sides that is large: replaces *spacing, and sets
 * *sites to the number of its sites with all copies. False if there is none, or it is too large. */
bool cascade_sides_finer(const struct lattice *base, double *spacing, double *sites);
/* Processor seconds of all these finer lattices; `open`: in an open cascade. */
double cascade_sides_finer_seconds(const struct plan *plan, bool open);

/* Predicted lattices of an open cascade (struct method, levels), at most `most`; with
 * plan->goal.error up to the lattice that is expected to reach it. Returns their number. */
int cascade_levels(const struct plan *plan, int most, struct predicted_level *levels);
/* Sites of the largest lattice solved for the effect of the sides; 0: none is solved. */
double cascade_sides_sites(const struct plan *plan);
/* Processor seconds of cascade_measure (`with_base`: including the scene's own lattice), or of the
 * coarser lattices of a stokes run. */
double cascade_seconds(const struct scene *scene, const struct plan *plan, bool with_base);

#endif
