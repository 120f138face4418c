/* k from a cascade of lattices of one body, from coarse to fine: each solve starts from the
 * solution of the coarser lattice, and k and its error are estimated from all of them. Here: what
 * is known of it so far, and the solve of one lattice; cascade_add.h takes its result. */
#ifndef TOSUI_SPHSOLVE_ERROR_CASCADE_H
#define TOSUI_SPHSOLVE_ERROR_CASCADE_H

#include "common/error.h"
#include "sphsolve/error/cascade_levels.h"
#include "sphsolve/stokes/solver/step.h"

struct cascade {
  const struct scene *scene;
  const struct plan *plan;
  const struct lattice *base;  /* the scene's own lattice */
  double wanted;               /* relative error of k to reach; 0: none, base is the last */
  double seconds;              /* wall time to spend, s; INFINITY: no limit */
  double started;              /* clock at the start, s */
  double noise_scale;          /* cascade_noise_scale, m */
  bool varies[3];              /* cascade_walls_change */
  double pores_across;         /* cascade_pores_across */
  int fixed;                   /* number of lattices of a cascade that ends with base; 0: open */
  int tried;                   /* lattices so far, including those without flow */
  int left, left_tried;        /* steps to base from the lattice chosen last, and solved last */
  bool resumed;                /* the next lattice is that of a checkpoint */
  int counted;                 /* levels in the estimate before the last lattice was added */
  const char *ended;           /* why it ended before reaching the goal, in words; NULL */
  bool model_parts;            /* the parts by void ratio and model voxels have been computed */
  double sides;                /* share of the sides, on one coarse lattice; NAN: not computed */
  double mirrored;             /* k (m^2) there, mirrored along all axes, if ends are cut; NAN */
  struct stokes_solver coarse; /* last solution, stripped; grid.active 0: none */
  struct uncertainty uncertainty;
};

/* Starts a cascade that ends with `base` or, if plan->goal is given, when that goal is reached.
 * Free with cascade_end. */
void cascade_begin(const struct scene *scene, const struct plan *plan, const struct lattice *base,
                   struct cascade *cascade);
/* The lattice of the given spacing (m). *is_base: it is `base` itself, not to be freed. */
enum status cascade_lattice(const struct cascade *cascade, double spacing, struct lattice *lattice,
                            bool *is_base);
/* Builds the solver of a lattice of the cascade; in an open cascade it starts from the preceding
 * solution. */
enum status cascade_solver(struct cascade *cascade, const struct lattice *lattice,
                           struct stokes_solver *solver);
/* Builds the solver of any lattice, starting from rest. */
enum status cascade_build(const struct cascade *cascade, const struct lattice *lattice,
                          enum wall_scheme wall, struct stokes_solver *solver);
/* Convergence criterion: stokes.tolerance where the scene gives one, else scene.steady_tolerance or
 * the share of the wanted error that is allowed to the solver, whichever is larger. */
struct stokes_goal cascade_goal(const struct cascade *cascade);
/* Takes over the solution of a solver, which is emptied; the next solve starts from it. */
void cascade_keep(struct cascade *cascade, struct stokes_solver *solver);
void cascade_end(struct cascade *cascade);

/* Convergence criterion of a solve for a part of the error of k. */
extern const struct stokes_goal cascade_part_goal;

/* Intrinsic permeability along the force, m^2. */
double cascade_permeability(const struct stokes_solver *solver);
/* Critical width of the pores along the force, in spacings of a lattice (m); infinite without one.
 */
double cascade_critical_width(const struct cascade *cascade, double spacing);
/* stokes_solver_find_dissipating of a lattice on which the narrowest way is that wide: smooth walls
 * are of second order in the spacings across it. */
enum status cascade_find_dissipating(const struct cascade *cascade, struct stokes_solver *solver);
/* Whether every rank has enough memory to solve so many sites of a lattice. Collective. */
bool cascade_have_memory(const struct lattice *lattice, double sites);
/* Solves a lattice for its intrinsic permeability *k, m^2: 0 where nothing flows, NAN where the
 * solver fails. In that case the part of the error stays unknown, with a warning, and the run goes
 * on, except after an interrupt. With several ranks a failure in the middle of a solve ends the
 * run, as the others wait for the failing rank; free memory is therefore checked first. `from`:
 * solution to start from; with `keep` the cascade keeps the new solution. */
enum status cascade_solve(struct cascade *cascade, const struct lattice *lattice,
                          const struct stokes_solver *from, const struct stokes_goal *goal,
                          bool keep, double *k);

#endif
