/* Which lattices a cascade solves, and what they will cost, before any is solved. Spacings in m. */
#ifndef TOSUI_SPHSOLVE_STOKES_CASCADE_LEVELS_H
#define TOSUI_SPHSOLVE_STOKES_CASCADE_LEVELS_H

#include <stdbool.h>

#include "sphsolve/geometry/lattice.h"
#include "sphsolve/output/uncertainty.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/stokes/step.h"

/* From one lattice to the next of an open cascade the spacing shrinks by the square root of 2, and
 * by one to four steps of its own root to one with which the cascade is to end. */
#define CASCADE_SHRINKS 1.4142135623730951
#define CASCADE_STEPS 2
#define CASCADE_STEPS_MOST 4
/* From so many on, from the coarsest, an open cascade has an estimate that it may end with: fewer
 * have seen little of how k scatters from lattice to lattice. A body of few pores, whose lattices
 * are small and scatter more, takes one more. */
#define CASCADE_ENOUGH 4
#define CASCADE_ENOUGH_MOST 5
/* Lattices of a cascade that ends with the scene's own, and their spacings over its. */
#define CASCADE_FIXED 3
/* The effect of the sides is solved on a lattice as it is, mirrored in z (where its ends are cut),
 * in y and in x, one after the other, up to so many copies of it; 1: there is none. */
double cascade_sides_copies(const struct lattice *base);
/* And closed; all on so many times its sites. An open cascade solves what is mirrored in z or y by
 * half. */
double cascade_sides_times(const struct lattice *base, bool open);
/* Other sides change k by per cents, on four times the sites. */
extern const struct stokes_goal cascade_sides_goal;
extern const double cascade_fixed_ratios[CASCADE_FIXED];
/* Fewer coarse lattices than are enough err by more than their fits say, by up to so many times. */
extern const double cascade_few_lattices[CASCADE_ENOUGH_MOST];

/* Whether the flow is one that coarser lattices can be solved for: past resting walls, driven. */
bool cascade_is_possible(const struct scene *scene, const struct plan *plan);

/* The spacing with few sites across a mean pore, where an open cascade may begin. */
double cascade_first_spacing(const struct plan *plan, const struct lattice *base);
/* The spacing at which where the sites happen to lie scatters k by all that converge_limit expects:
 * the same, but an axis along which no wall changes may be as short as one likes. */
double cascade_noise_scale(const struct plan *plan, const struct lattice *base);
/* Mean pores along the shortest axis along which walls change. */
double cascade_pores_across(const struct plan *plan, const struct lattice *base);
/* Lattices that are enough for a body of so many pores across. */
int cascade_enough(double pores_across);
/* Steps from the first of its lattices to the last, the scene's own sites. */
int cascade_open_steps(const struct plan *plan, const struct lattice *base);
/* The spacing so many steps before the scene's own, over that. */
double cascade_step_ratio(int left);
/* What would lessen the error of resolution once a lattice of that spacing has been solved. */
enum resolution_needs cascade_needs(const struct plan *plan, double spacing);
/* Where the effect of the sides is solved. */
double cascade_sides_spacing(const struct plan *plan, const struct lattice *base);
/* The finer lattice after one of that spacing, on which a large effect is sought, and its sites
 * with all copies; false: there is none, or it is too large. */
bool cascade_sides_finer(const struct lattice *base, double *spacing, double *sites);
/* Processor seconds of all of them; of an `open` cascade. */
double cascade_sides_finer_seconds(const struct plan *plan, bool open);

/* What an open cascade of a planned scene will solve (struct method, levels): with plan->goal.error
 * up to the lattice that is expected to reach it. */
int cascade_levels(const struct plan *plan, int most, struct predicted_level *levels);
/* Sites of the largest lattice that is solved for the effect of the sides; 0: none is. */
double cascade_sides_sites(const struct plan *plan);
/* Processor seconds of cascade_measure, or of the lattices of a stokes run below its own. */
double cascade_seconds(const struct scene *scene, const struct plan *plan, bool own);

#endif
