#include "sphsolve/error/cascade_next.h"

#include <math.h>

#include "common/convergence.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/error/cascade_parts.h"

/* Factors on the error of the limit by the number of lattices. From 14 bodies of overlapping
 * spheres (docs/physics/error-of-k.md). */
const double cascade_few_lattices[CASCADE_LATTICES_FEW_PORES] = {1.0, 1.0, 3.8, 2.38, 1.8};
/* The factors also apply to a fixed cascade if a mean pore of the scene has fewer sites across than
 * this. */
#define PORE_SITES_COARSE 4.5

/* Lists spacing and k of the lattices so far, the finest first. */
static size_t list_values(const struct uncertainty *u, double *h, double *k) {
  const int n = u->level_count;
  for (int i = 0; i < n; i++) {
    h[i] = u->levels[n - 1 - i].spacing;
    k[i] = u->levels[n - 1 - i].permeability;
  }
  return (size_t)n;
}

/* Whether k [n] at h [n], the finest first, does not yet converge: its changes from lattice to
 * lattice alternate in sign, or decrease by less than first order would make them, and at first
 * order more than the wanted error remains. The coarsest lattices then miss throats that the finer
 * ones have, and four lattices do not show how k continues: in sandstones the limit estimated from
 * them is off by up to twice its error (docs/physics/error-of-k.md). */
static bool is_not_converging(const struct cascade *c, const double *h, const double *k, size_t n) {
  for (size_t i = 0; i + 2 < n; i++) {
    const double now = log(k[i] / k[i + 1]), before = log(k[i + 1] / k[i + 2]);
    const double shrinks = h[i + 1] / h[i];
    if (fmax(fabs(now), fabs(before)) > c->wanted * (shrinks - 1.0) &&
        !(now / before > 0.0 && now / before < 1.0 / shrinks))
      return true;
  }
  return false;
}

/* Number of lattices needed for an estimate from k [n] at h [n], the finest first. */
static size_t lattices_wanted(const struct cascade *c, const double *h, const double *k, size_t n) {
  const size_t enough = (size_t)cascade_lattices_needed(c->pores_across);
  return n == CASCADE_LATTICES_MIN && c->fixed == 0 && is_not_converging(c, h, k, n)
             ? CASCADE_LATTICES_FEW_PORES
             : enough;
}

static bool is_enough(const struct cascade *c) {
  double h[ERROR_LEVELS_MAX], k[ERROR_LEVELS_MAX];
  const size_t n = list_values(&c->uncertainty, h, k);
  return n >= lattices_wanted(c, h, k, n);
}

/* Estimate of the limit of k [n] at h [n], the finest first. */
static struct limit_estimate limit_of(const struct cascade *c, const double *h, const double *k,
                                      size_t n) {
  struct limit_estimate limit;
  converge_limit(h, k, n, c->noise_scale, c->pores_across, &limit);
  /* Between flat walls the position of the sites does not matter, and the finest value is nearly
   * exact. */
  if (n > 1 && c->plan->shape.flat)
    limit = (struct limit_estimate){k[0], fabs(k[1] / k[0] - 1.0), fabs(k[1] / k[0] - 1.0), NAN};
  const bool few = c->fixed == 0 || c->plan->shape.width < PORE_SITES_COARSE;
  if (few && n < lattices_wanted(c, h, k, n) && !c->plan->shape.flat) {
    limit.low *= cascade_few_lattices[n];
    limit.high *= cascade_few_lattices[n];
  }
  return limit;
}

/* Sets the error of resolution from those of the limit, of the narrowest ways and of the model's
 * voxels. */
static void set_resolution(const struct limit_estimate *limit, struct uncertainty *u) {
  const double model = hypot(isfinite(u->model) ? u->model : 0.0, u->critical_width);
  u->resolution_low = fmin(hypot(limit->low, model), 1.0); /* k is above 0 */
  u->resolution_high = hypot(limit->high, model);
  u->resolution = fmax(u->resolution_low, u->resolution_high);
}

/* Grains cut by the ends meet there in slits, through which a coarse lattice lets too much flow; it
 * represents the wider pores of the mirrored sample nearly correctly. If ends are cut, the effect
 * of the sides is therefore at least the difference between k of the mirrored sample and the best
 * k. */
static void set_sides(const struct cascade *c, struct uncertainty *u) {
  u->sides = fmax(c->sides, fabs(c->mirrored / u->extrapolated - 1.0));
}

void cascade_estimate(struct cascade *c) {
  struct uncertainty *u = &c->uncertainty;
  double h[ERROR_LEVELS_MAX] = {0}, k[ERROR_LEVELS_MAX] = {0};
  const size_t n = list_values(u, h, k);
  struct limit_estimate limit = limit_of(c, h, k, n);
  struct error_level *level = &u->levels[n - 1];
  level->estimate = limit.value;
  level->low = limit.low, level->high = limit.high;
  /* The error from a single lattice is the one predicted for its pores. */
  if (n == 1 && c->fixed != 1)
    limit.low = limit.high = error_forecast_of(&c->plan->shape, c->plan->context.method,
                                               WALL_SUBVOXEL, c->plan->context.spacing / h[0])
                                 .pores;
  u->needs = cascade_needs(c->plan, h[0]);
  u->extrapolated = limit.value;
  u->finest = k[0];
  u->order = limit.order;
  u->critical_width = level->critical;
  set_resolution(&limit, u);
  set_sides(c, u);
}

/* Whether the other parts of the error, which no lattice can reduce, exceed the goal and are at
 * least twice the error of resolution. */
static bool refinement_is_useless(const struct cascade *c, const struct uncertainty *u) {
  struct uncertainty rest = *u;
  rest.resolution = rest.resolution_low = rest.resolution_high = NAN;
  const double left = uncertainty_largest(&rest);
  return c->plan->goal.error > 0.0 && left > c->wanted && u->resolution < 0.5 * left;
}

/* Predicted uncertainty with one more lattice, `steps` steps finer, if its k follows the fit of the
 * preceding ones. The stated error will be within some per cent of this: it depends on how far
 * apart the lattices' values are, and hardly on their noise. */
#define PREDICTION_MARGIN 1.02
static struct uncertainty predicted_uncertainty(const struct cascade *c, int steps) {
  struct uncertainty u = c->uncertainty;
  double h[ERROR_LEVELS_MAX + 1] = {0}, k[ERROR_LEVELS_MAX + 1] = {0};
  const size_t n = list_values(&u, h + 1, k + 1);
  h[0] = h[1] / cascade_step_ratio(steps);
  k[0] = u.extrapolated + (k[1] - u.extrapolated) * pow(h[0] / h[1], u.order);
  struct limit_estimate limit = limit_of(c, h, k, n + 1);
  limit.low *= PREDICTION_MARGIN;
  limit.high *= PREDICTION_MARGIN;
  if (u.critical_width < 1.0) u.critical_width *= h[0] / h[1];
  set_resolution(&limit, &u);
  return u;
}

/* Steps to the coarsest lattice that is expected to meet the goal and end the cascade; 0: none. */
static int steps_to_end(const struct cascade *c) {
  const struct uncertainty *u = &c->uncertainty;
  /* If the estimate is the finest value itself there is no fit to predict from. */
  if (!is_enough(c) || u->extrapolated == u->finest) return 0;
  for (int steps = 1; steps <= CASCADE_STEPS_MAX && steps <= c->left; steps++) {
    const struct uncertainty then = predicted_uncertainty(c, steps);
    if (uncertainty_largest(&then) <= c->wanted || refinement_is_useless(c, &then)) return steps;
  }
  return 0;
}

/* Processor seconds of a lattice `steps` steps finer than the last; twice as many if the effect of
 * the scan is to be solved on it. */
static double lattice_seconds(const struct cascade *c, int steps) {
  const int n = c->uncertainty.level_count;
  return n > 0 ? (cascade_scan_grows(c) ? 2.0 : 1.0) * c->uncertainty.levels[n - 1].seconds *
                     pow(cascade_step_ratio(steps), 3.2)
               : 0.0;
}

double cascade_next_seconds(const struct cascade *c) {
  const int end = steps_to_end(c);
  return lattice_seconds(c, end > 0 ? end : CASCADE_STEPS);
}

/* Processor seconds of the effect of the sides if it is still to be computed, from the time per
 * site of the last lattice. */
static double sides_seconds(const struct cascade *c) {
  const int n = c->uncertainty.level_count;
  size_t size[3], count;
  if (n == 0 || !cascade_sides_wait(c)) return 0.0;
  const double spacing = cascade_sides_spacing(c->plan, c->base);
  if (lattice_resampled_size(c->base, spacing, size, &count) != STATUS_OK) {
    error_clear();
    return 0.0;
  }
  const struct error_level *l = &c->uncertainty.levels[n - 1];
  return l->seconds * cascade_sides_times(c->base, true) * (double)count / l->sites;
}

/* Whether the time limit allows so many processor seconds, and the effect of the sides after
 * them. */
static bool has_time(const struct cascade *c, double seconds) {
  /* One thread does one processor second per second; several threads are less efficient. */
  const double next = (seconds + sides_seconds(c)) / fmax(1.0, 0.85 * c->plan->threads);
  return clock_seconds() - c->started + next <= c->seconds;
}

/* Steps to the next lattice: those to the last lattice if one is foreseen, else the usual number;
 * if after a usual step the time limit would allow no further lattice, those to the finest lattice
 * that fits. 0: none fits. */
static int steps_to_next(const struct cascade *c) {
  const int end = steps_to_end(c), usual = c->left < CASCADE_STEPS ? c->left : CASCADE_STEPS;
  /* A single lattice gives no error of k; a second one is always solved. */
  if (c->resumed || c->uncertainty.level_count < 2) return usual;
  if (end > 0 && has_time(c, lattice_seconds(c, end))) return end;
  if (!is_enough(c)) return has_time(c, lattice_seconds(c, usual)) ? usual : 0;
  if (has_time(c, lattice_seconds(c, usual) + lattice_seconds(c, usual + 1))) return usual;
  int steps = c->left < CASCADE_STEPS_MAX ? c->left : CASCADE_STEPS_MAX;
  while (steps > 0 && !has_time(c, lattice_seconds(c, steps))) steps--;
  return steps;
}

static bool has_memory(const struct cascade *c, double spacing) {
  size_t size[3], count;
  if (lattice_resampled_size(c->base, spacing, size, &count) != STATUS_OK) {
    error_clear();
    return false;
  }
  const double share = (double)c->base->fluid_count / (double)c->base->count;
  return stokes_solver_bytes((double)count, share * (double)count,
                             c->base->micro_porosity != NULL) < memory_available();
}

bool cascade_next(struct cascade *c, double *spacing, const char **why) {
  const double h = c->plan->context.spacing;
  const struct uncertainty *u = &c->uncertainty;
  *why = "converged";
  if (c->fixed > 0) {
    if (c->tried == c->fixed) return false;
    *spacing = h * cascade_fixed_ratios[CASCADE_FIXED - c->fixed + c->tried];
    return true;
  }
  const bool last = c->left == 0 || c->tried == ERROR_LEVELS_MAX;
  /* The lattice of a checkpoint is always completed, even if less accuracy is asked for now than
   * the preceding lattices have: their solutions are gone, and the last one is the run's. */
  const bool enough = !c->resumed && (is_enough(c) || last);
  if (enough && uncertainty_largest(u) <= c->wanted) return false;
  *why = "budget";
  c->ended = "what no lattice lessens is more than that alone";
  if (enough && refinement_is_useless(c, u)) return false;
  c->ended = "the last lattice has the model's own points, and a finer one tells nothing new";
  if (last) return false;
  c->ended = "the next lattice would take longer than --time";
  int steps = steps_to_next(c);
  if (steps == 0) return false;
  c->ended = "the next lattice would take more memory than there is";
  while (steps > 0 && !has_memory(c, h * cascade_step_ratio(c->left - steps))) steps--;
  if (steps == 0) return false;
  *spacing = h * cascade_step_ratio(c->left - steps);
  c->left -= steps;
  c->resumed = false;
  return true;
}
