/* k from a cascade of lattices of one body, from coarse to fine: each solve starts from the
 * solution of the coarser lattice, and k and its error are estimated from all of them. */
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
/* Adds the solved k of a lattice to the estimate. `seconds`: processor time of the solve. The
 * solution is not changed. */
enum status cascade_add(struct cascade *cascade, const struct lattice *lattice, double spacing,
                        struct stokes_solver *solver, double seconds);
/* To be called after the last lattice. Computes the effect of the sides if a time limit was given
 * (it takes as long as several coarse lattices, which are solved first), and the effect of the scan
 * if the third lattice was the last. */
enum status cascade_finish(struct cascade *cascade);
/* Takes over the solution of a solver, which is emptied; the next solve starts from it. */
void cascade_keep(struct cascade *cascade, struct stokes_solver *solver);
/* Write and read a checkpoint. `solved`: the checkpoint holds the completed solution of the last
 * lattice added, and a run that resumes adds that lattice again; otherwise the solution is of a
 * lattice not yet added. */
enum status cascade_write(const struct cascade *cascade, bool solved, struct h5_file *file);
enum status cascade_read(struct cascade *cascade, struct h5_file *file);
void cascade_end(struct cascade *cascade);

/* Error of resolution of a run whose k was computed differently, by another method or with other
 * walls: lattices up to `base` are solved with subvoxel walls. `found`: intrinsic permeability of
 * the run, m^2. Fills *u. */
enum status cascade_measure(const struct scene *scene, const struct plan *plan,
                            const struct lattice *base, double found, struct uncertainty *u);

#endif
