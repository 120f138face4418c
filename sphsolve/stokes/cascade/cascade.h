/* k from a cascade of lattices of one body, coarse ones first: each solve starts where the coarser
 * one has ended, and k with its error is estimated from all of them together. */
#ifndef TOSUI_SPHSOLVE_STOKES_CASCADE_H
#define TOSUI_SPHSOLVE_STOKES_CASCADE_H

#include "common/error.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/output/uncertainty.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/stokes/cascade/cascade_levels.h"
#include "sphsolve/stokes/step.h"

struct cascade {
  const struct scene *scene;
  const struct plan *plan;
  const struct lattice *base;  /* as the scene gives it */
  double wanted;               /* relative error of k to reach; 0: none, the base is the last */
  double seconds;              /* to spend, wall time; INFINITY */
  double started;              /* clock, s */
  double noise_scale;          /* cascade_noise_scale, m */
  double pores_across;         /* cascade_pores_across */
  int fixed;                   /* lattices of a cascade that ends with the base; 0: open */
  int tried;                   /* lattices so far, those without a flow included */
  int left, left_tried;        /* steps to the base from the lattice given last, and tried last */
  bool resumed;                /* the next lattice is that of a checkpoint */
  int counted;                 /* levels of the estimate before the last of them */
  const char *ended;           /* why it ends short of what was wanted, in words; NULL */
  bool model_parts;            /* the parts by void ratio and model voxels are found */
  double sides;                /* their share as one coarse lattice has it; NAN: not found */
  double mirrored;             /* m^2: k there with all axes mirrored, of cut ends; NAN */
  struct stokes_solver coarse; /* the last solution, stripped; grid.active 0: none */
  struct uncertainty uncertainty;
};

/* A cascade that ends with `base`, or, with plan->goal, when that is reached. Free with
 * cascade_end. */
void cascade_begin(const struct scene *scene, const struct plan *plan, const struct lattice *base,
                   struct cascade *cascade);
/* Its sites: base itself, not to be freed, where the spacing is its own. */
enum status cascade_lattice(const struct cascade *cascade, double spacing, struct lattice *lattice,
                            bool *own);
/* Its solver, started from the lattice before. */
enum status cascade_solver(struct cascade *cascade, const struct lattice *lattice,
                           struct stokes_solver *solver);
/* That of any lattice, from rest. */
enum status cascade_build(const struct cascade *cascade, const struct lattice *lattice,
                          enum wall_scheme wall, struct stokes_solver *solver);
/* When a solve is good enough: at stokes.tolerance where the scene gives one, else at
 * scene.steady_tolerance, or at what the wanted error leaves to the solver. */
struct stokes_goal cascade_goal(const struct cascade *cascade);
/* Takes the solved k of a lattice into the estimate; `seconds` of processor time went into it. The
 * solver is only looked at. */
enum status cascade_add(struct cascade *cascade, const struct lattice *lattice, double spacing,
                        const struct stokes_solver *solver, double seconds);
/* After the last lattice: the part of the sides, where a time was asked for, as it takes as long as
 * several coarse lattices, and they come first; the scan's, where the third was the last. */
enum status cascade_finish(struct cascade *cascade);
/* Keeps the solution of a solver, which is emptied, for the next to start from. */
void cascade_keep(struct cascade *cascade, struct stokes_solver *solver);
/* To and from a checkpoint. `solved`: it holds the solution of the last lattice added, which is the
 * next one for who reads it; else of one that is not added yet. */
enum status cascade_write(const struct cascade *cascade, bool solved, struct h5_file *file);
enum status cascade_read(struct cascade *cascade, struct h5_file *file);
void cascade_end(struct cascade *cascade);

/* The resolution of a run whose k was found otherwise, by another method or with other walls:
 * lattices up to `base` are solved with subvoxel walls. `found`: its intrinsic permeability, m^2.
 */
enum status cascade_measure(const struct scene *scene, const struct plan *plan,
                            const struct lattice *base, double found, struct uncertainty *u);

#endif
