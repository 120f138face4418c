#include "sphsolve/solute/curve.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "sphsolve/solute/constants.h"

/* Whether the coarsest cells are fine enough at this Peclet number to show the order of
 * convergence. */
static bool shows_order(const struct solute_flow *flow, const struct solute_result *r,
                        double peclet) {
  for (int a = 0; a < 3; a++)
    if (flow->n[a] > 1 && flow->n[a] < 4 * SOLUTE_CELLS_MIN) return false;
  return 4 * peclet * flow->spacing[0] / r->length <= SOLUTE_CELL_PECLET;
}

/* The coarsest lattice only improves the extrapolation: if it cannot be solved, two lattices are
 * used. */
static enum status solve(struct solute_closure *closure, int lattice, double diffusion,
                         struct solute_dispersion *value) {
  const enum status status = solute_closure_solve(closure, diffusion, CURVE_TOLERANCE, value);
  if (status != STATUS_NUMERIC || lattice != SOLUTE_COARSEST) return status;
  error_clear();
  value->longitudinal = value->transverse = NAN;
  return STATUS_OK;
}

/* Solves all cases on one lattice. `weight`: share of one case in the progress bar. */
static enum status solve_lattice(const struct solute_flow *flow, int lattice,
                                 const struct solute_result *r, struct progress *progress,
                                 double weight, double *done, struct solute_state *state) {
  enum status status = STATUS_OK;
  struct solute_closure closure = {0};
  char note[80];
  const double correlation = r->correlation[1];
  int *count = &state->solved_count[lattice];
  *done += weight * *count;
  if (*count > r->count) return STATUS_OK;
  TRY(solute_closure_build(flow, lattice, &closure));
  if (*count > 0) TRY(solute_state_restore_closure(state, &closure));
  /* The first case is without flow, for the formation factor; then the Peclet numbers in turn. */
  while (*count <= r->count) {
    struct solute_solved *solved = &state->solved[lattice][*count];
    const double peclet = *count == 0 ? 0 : r->peclet[*count - 1];
    const double d = peclet > 0 ? flow->speed * r->length / peclet : INFINITY;
    const double started = clock_processor_seconds();
    TRY(solve(&closure, lattice, d, &solved->value));
    if (lattice == SOLUTE_FINE)
      TRY(solute_sample_size(&closure, d, &solved->value, flow->image, correlation,
                             &solved->sample));
    solved->seconds = clock_processor_seconds() - started;
    *done += weight;
    ++*count;
    log_verbose("closure: cells of %.3g m, Pe %.3g: D_L/D %.5g, D_T/D %.5g; %d iterations, %.3g s",
                flow->spacing[0] * closure.spacing, peclet, solved->value.longitudinal,
                solved->value.transverse, solved->value.iterations, solved->seconds);
    snprintf(note, sizeof note, "Pe %.3g: D_L/D %.4g", peclet, solved->value.longitudinal);
    progress_update(progress, *done, note);
    if (solute_state_due(state)) TRY(solute_state_save(state, &closure, NULL));
  }
cleanup:
  solute_closure_free(&closure);
  return status;
}

static double relative_change(double change, double value) {
  return value > 0 ? fabs(change) / value : 0;
}

/* Above SOLUTE_CELL_PECLET the order falls to about one half (one sand at a cell Peclet number of
 * 96, the physics page's). The limit then lies 1 / (sqrt(2) - 1) times the difference of the two
 * lattices beyond the finer one, of which the extrapolation includes one third. */
#define UNRESOLVED_ERROR_FACTOR (M_SQRT2 + 1.0 - 1.0 / 3.0)

/* Distance of the limit from fine, over fine - coarse: 1 / (2^p - 1). The order p is estimated from
 * three lattices (Roache 1994), between 1, where cells at the contacts of grains dominate, and 2,
 * that of the scheme; 2 also if no order is seen. */
static double extrapolation_factor(double fine, double coarse, double coarsest) {
  const double ratio = (coarse - coarsest) / (fine - coarse);
  return ratio > 0 ? 1 / (fmin(fmax(ratio, 2), 4) - 1) : 1.0 / 3.0;
}

/* Extrapolated limit of the lattices. `coarsest` NULL: of two. */
static struct solute_dispersion limit_of(const struct solute_flow *flow,
                                         const struct solute_dispersion *fine,
                                         const struct solute_dispersion *coarse,
                                         const struct solute_dispersion *coarsest) {
  struct solute_dispersion limit = *fine;
  double n[3] = {0, 0, 1};
  for (int a = 0; a < 3 && flow->speed > 0; a++) n[a] = flow->mean_velocity[a] / flow->speed;
  double along = 1.0 / 3.0, across = 1.0 / 3.0;
  if (coarsest != NULL) {
    along = extrapolation_factor(fine->longitudinal, coarse->longitudinal, coarsest->longitudinal);
    across = extrapolation_factor(fine->transverse, coarse->transverse, coarsest->transverse);
  }
  /* The difference is extrapolated by `across`, its part along the flow by `along`. */
  const double extra = (along - across) * (fine->longitudinal - coarse->longitudinal);
  for (int p = 0; p < 3; p++)
    for (int q = 0; q < 3; q++)
      limit.tensor[p][q] +=
          across * (fine->tensor[p][q] - coarse->tensor[p][q]) + extra * n[p] * n[q];
  solute_dispersion_parts(n, flow->dimensions, &limit);
  return limit;
}

static double coefficient_of(const struct solute_solved *solved, int across) {
  if (solved == NULL) return NAN;
  return across ? solved->value.transverse : solved->value.longitudinal;
}

/* Sets the extrapolated limit of case `i` from `lattices` lattices, and its error. The error is the
 * difference of the two finest lattices, and at least a quarter of that of the next two: two
 * lattices, whose walls lie differently in their cells, may agree by chance. */
static void set_estimate(const struct solute_flow *flow, const struct solute_state *state, int i,
                         double peclet, int lattices, const struct solute_result *r,
                         struct solute_closed *out) {
  const struct solute_solved *fine = &state->solved[SOLUTE_FINE][i],
                             *coarse = lattices > 1 ? &state->solved[SOLUTE_COARSE][i] : NULL,
                             *coarsest = lattices > 2 ? &state->solved[SOLUTE_COARSEST][i] : NULL;
  const bool order = coarsest != NULL && shows_order(flow, r, peclet);
  const double cell_peclet = peclet * flow->spacing[0] / r->length;
  const struct solute_dispersion limit =
      coarse == NULL
          ? fine->value
          : limit_of(flow, &fine->value, &coarse->value, order ? &coarsest->value : NULL);
  memcpy(out->tensor, limit.tensor, sizeof out->tensor);
  const double value[2] = {limit.longitudinal, limit.transverse};
  double error[2] = {0};
  for (int t = 0; t < 2; t++) {
    double change = coefficient_of(fine, t) - coefficient_of(coarse, t);
    if (coarsest != NULL)
      change =
          fmax(fabs(change), 0.25 * fabs(coefficient_of(coarse, t) - coefficient_of(coarsest, t)));
    out->resolution[t] = relative_change(change, value[t]) *
                         (cell_peclet > SOLUTE_CELL_PECLET ? UNRESOLVED_ERROR_FACTOR : 1.0);
    /* For the part of the value in excess of conduction: the relative change by the projection. */
    out->projection[t] =
        flow->correction * fmin(1, relative_change(fmax(value[t] - 1, 0), value[t]));
    out->solver = fine->value.residual;
    out->sample[t] = fine->sample.error[t], out->repeats[t] = fine->sample.repeats[t];
    error[t] = sqrt(pow(out->resolution[t], 2) + pow(out->projection[t], 2) + pow(out->solver, 2));
  }
  out->value = (struct solute_estimate){value[0], value[1], error[0], error[1]};
  out->iterations = fine->value.iterations;
  out->seconds = fine->seconds + (coarse != NULL ? coarse->seconds : 0);
}

enum status solute_curve_by_closure(const struct solute_flow *flow, struct solute_state *state,
                                    struct solute_result *r) {
  enum status status = STATUS_OK;
  /* cells, relative to those of the coarse lattice */
  static const double weight[SOLUTE_LATTICES] = {8, 1, 1.0 / 8};
  struct progress progress;
  struct solute_closed no_flow;
  double done = 0, all = 0;
  int lattices = SOLUTE_LATTICES;
  for (int a = 0; a < 3; a++)
    while (flow->n[a] > 1 && lattices > 1 && flow->n[a] < SOLUTE_CELLS_MIN << (lattices - 2))
      lattices--;
  solute_correlation_lengths(flow, r->correlation);
  for (int l = 0; l < lattices; l++) all += weight[l] * (r->count + 1);
  progress_start(&progress, "closure", NULL, all);
  for (int l = lattices - 1; l >= 0; l--)
    TRY(solve_lattice(flow, l, r, &progress, weight[l], &done, state));
  r->by_closure = true;
  for (int i = 0; i < r->count; i++)
    set_estimate(flow, state, i + 1, r->peclet[i], lattices, r, &r->closure[i]);
  set_estimate(flow, state, 0, 0, lattices, r, &no_flow);
  r->tortuosity = 1 / no_flow.value.longitudinal;
  r->formation = r->tortuosity / flow->porosity;
  r->formation_error = no_flow.value.longitudinal_error;
  r->formation_sample = no_flow.sample[0];
cleanup:
  progress_end(&progress);
  return status;
}
