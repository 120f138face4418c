#include "sphsolve/error/cascade.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/stokes/solver/start.h"

/* Share of the wanted error of k that is allowed to the solver of each lattice, and bounds of the
 * resulting tolerance. The extrapolation to spacing 0 amplifies the solver's error about
 * threefold. */
#define SOLVER_SHARE 0.02
#define TOLERANCE_MIN 3e-4
#define TOLERANCE_MAX 1e-3

const struct stokes_goal cascade_part_goal = {.mean = 3e-4};

void cascade_begin(const struct scene *scene, const struct plan *plan, const struct lattice *base,
                   struct cascade *c) {
  const bool possible =
      cascade_is_possible(scene, plan) && plan->context.method->wall(scene) == WALL_SUBVOXEL;
  *c = (struct cascade){.scene = scene, .plan = plan, .base = base, .seconds = INFINITY};
  c->uncertainty = uncertainty_none();
  c->sides = c->mirrored = NAN;
  c->started = clock_seconds();
  if (cascade_is_possible(scene, plan)) {
    c->noise_scale = cascade_noise_scale(plan, base);
    c->pores_across = cascade_pores_across(plan, base);
    for (int a = 0; a < 3; a++) c->varies[a] = base->size[a] > 1 && cascade_walls_change(base, a);
  }
  if (possible && (plan->goal.error > 0.0 || plan->goal.seconds > 0.0)) {
    c->wanted = fmax(plan->goal.error, 1e-12);
    if (plan->goal.seconds > 0.0) c->seconds = plan->goal.seconds;
    c->left = cascade_open_steps(plan, base) + CASCADE_STEPS;
  } else {
    c->fixed = possible ? CASCADE_FIXED : 1;
  }
}

struct stokes_goal cascade_goal(const struct cascade *c) {
  struct stokes_goal goal = stokes_goal_of(c->scene);
  if (goal.residual == 0.0 && c->fixed == 0)
    goal.mean = fmax(goal.mean, fmin(fmax(SOLVER_SHARE * c->wanted, TOLERANCE_MIN), TOLERANCE_MAX));
  return goal;
}

enum status cascade_lattice(const struct cascade *c, double spacing, struct lattice *lattice,
                            bool *is_base) {
  *is_base = fabs(spacing / c->plan->context.spacing - 1.0) < 1e-9;
  if (*is_base) {
    *lattice = *c->base;
    return STATUS_OK;
  }
  return lattice_resample(c->base, spacing, 0.0, lattice);
}

enum status cascade_build(const struct cascade *c, const struct lattice *lattice,
                          enum wall_scheme wall, struct stokes_solver *s) {
  const struct effect_context *context = &c->plan->context;
  const double spacing =
      lattice->dimensions == 2
          ? sqrt(lattice->spacing[0] * lattice->spacing[2])
          : cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
  /* Ranks do not solve half lattices; a fixed cascade does not either, so that its results are
   * identical on any number of ranks. */
  return (c->fixed > 0 ? stokes_solver_build : stokes_solver_build_half)(
      lattice, c->scene, stokes_support(c->scene, context->spacing) * spacing, wall,
      context->kinematic_viscosity, c->scene->driving, s);
}

enum status cascade_solver(struct cascade *c, const struct lattice *lattice,
                           struct stokes_solver *s) {
  enum status status = STATUS_OK;
  TRY(cascade_build(c, lattice, c->plan->context.method->wall(c->scene), s));
  if (c->fixed == 0 && c->coarse.grid.active > 0 && s->grid.active > 0)
    TRY(stokes_solver_start(s, &c->coarse));
cleanup:
  return status;
}

void cascade_keep(struct cascade *c, struct stokes_solver *s) {
  stokes_solver_free(&c->coarse);
  c->coarse = *s;
  *s = (struct stokes_solver){0};
  stokes_solver_strip(&c->coarse);
  c->coarse.operator.grid = NULL;
}

void cascade_end(struct cascade *c) {
  stokes_solver_free(&c->coarse);
}

double cascade_permeability(const struct stokes_solver *s) {
  double k = 0.0;
  for (int a = 0; a < 3; a++) k += s->mean[a] * s->force[a] * s->stencil.unit * s->stencil.unit;
  return k;
}

/* Whether every rank has enough memory for its part of a solve: an even share, and
 * RANK_MEMORY_FACTOR as much to allow for uneven parts and ghosts. */
#define RANK_MEMORY_FACTOR 1.3
bool cascade_have_memory(const struct lattice *lattice, double sites) {
  const double share = sites / (double)lattice->count;
  const double bytes = stokes_solver_bytes(sites, share * (double)lattice->fluid_count,
                                           lattice->micro_porosity != NULL);
  return !ranks_any(!memory_has_room((size_t)(RANK_MEMORY_FACTOR * bytes / ranks_count()), 1));
}

double cascade_critical_width(const struct cascade *c, double spacing) {
  return c->plan->shape.throat * c->plan->context.spacing / spacing;
}

enum status cascade_find_dissipating(const struct cascade *c, struct stokes_solver *s) {
  const double width = cascade_critical_width(c, s->stencil.unit);
  return stokes_solver_find_dissipating(s, fmin(1.0, CRITICAL_WIDTH_SMOOTH / width));
}

enum status cascade_solve(struct cascade *c, const struct lattice *lattice,
                          const struct stokes_solver *from, const struct stokes_goal *goal,
                          bool keep, double *k) {
  enum status status = STATUS_OK;
  struct stokes_solver s = {0};
  *k = NAN;
  if (ranks_count() > 1 && lattice->fluid_count > 0 &&
      !cascade_have_memory(lattice, (double)lattice->count)) {
    log_warning("a part of the error of k is not known: memory is short for a solve of its own");
    return STATUS_OK;
  }
  if (lattice->fluid_count > 0) status = cascade_build(c, lattice, WALL_SUBVOXEL, &s);
  if (status != STATUS_OK && ranks_count() > 1) return status;
  if (status == STATUS_OK && s.grid.active_all == 0) *k = 0.0;
  if (status == STATUS_OK && s.grid.active_all > 0) {
    if (c->fixed == 0 && from->grid.active > 0 && stokes_solver_start(&s, from) != STATUS_OK)
      error_clear();
    status = stokes_solver_run(&s, goal);
    if (status == STATUS_OK) *k = cascade_permeability(&s);
    if (status == STATUS_OK && keep) status = cascade_find_dissipating(c, &s);
  }
  if (status != STATUS_OK && status != STATUS_INTERRUPTED) {
    log_warning("a part of the error of k is not known: %s", error_message());
    error_clear();
    status = STATUS_OK;
  }
  if (keep && *k > 0.0)
    cascade_keep(c, &s);
  else
    stokes_solver_free(&s);
  return status;
}
