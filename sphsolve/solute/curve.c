#include "sphsolve/solute/curve.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"

/* Of the residual, relative: D* is then known to some 1e-4, far below what the lattice leaves. */
#define TOLERANCE 1e-4
/* `weight`: of one Peclet number, for the progress line. */
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
  TRY(solute_closure_build(flow, lattice == SOLUTE_COARSE, &closure));
  if (*count > 0) TRY(solute_state_take_closure(state, &closure));
  /* First without flow, for the formation factor; then from one Peclet number to the next. */
  while (*count <= r->count) {
    struct solute_solved *solved = &state->solved[lattice][*count];
    const double peclet = *count == 0 ? 0 : r->peclet[*count - 1];
    const double d = peclet > 0 ? flow->speed * r->length / peclet : INFINITY;
    const double started = clock_processor_seconds();
    TRY(solute_closure_solve(&closure, d, TOLERANCE, &solved->value));
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

static double share(double change, double value) {
  return value > 0 ? fabs(change) / value : 0;
}

/* Beyond SOLUTE_CELL_PECLET the order falls to some half (one sand at Pe 96 of a cell, the
 * physics page's), which leaves 1 / (sqrt(2) - 1) of the
 * difference of both lattices beyond the finer one, a third of which the limit has. */
#define LAYERS_SHARE (M_SQRT2 + 1.0 - 1.0 / 3.0)

/* The limit of both lattices, and its error. `coarse` NULL: one alone. */
static void take(const struct solute_flow *flow, double cell_peclet,
                 const struct solute_solved *fine, const struct solute_solved *coarse,
                 struct solute_closed *out) {
  struct solute_dispersion limit = fine->value;
  const double direction[3] = {flow->speed > 0 ? flow->mean_velocity[0] / flow->speed : 0,
                               flow->speed > 0 ? flow->mean_velocity[1] / flow->speed : 0,
                               flow->speed > 0 ? flow->mean_velocity[2] / flow->speed : 1};
  for (int p = 0; p < 3 && coarse != NULL; p++)
    for (int q = 0; q < 3; q++)
      limit.tensor[p][q] += (fine->value.tensor[p][q] - coarse->value.tensor[p][q]) / 3;
  solute_dispersion_parts(direction, flow->dimensions, &limit);
  memcpy(out->tensor, limit.tensor, sizeof out->tensor);
  const double value[2] = {limit.longitudinal, limit.transverse};
  const double ours[2] = {fine->value.longitudinal, fine->value.transverse};
  double error[2];
  for (int t = 0; t < 2; t++) {
    const double other = coarse == NULL ? NAN
                         : t            ? coarse->value.transverse
                                        : coarse->value.longitudinal;
    out->resolution[t] =
        share(ours[t] - other, value[t]) * (cell_peclet > SOLUTE_CELL_PECLET ? LAYERS_SHARE : 1.0);
    /* Of what the flow adds to conduction, as much as the projection changed the flow. */
    out->projection[t] = flow->correction * fmin(1, share(fmax(value[t] - 1, 0), value[t]));
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
  const struct solute_solved *fine = state->solved[SOLUTE_FINE],
                             *coarse = state->solved[SOLUTE_COARSE];
  struct progress progress;
  struct solute_closed still;
  bool twice = true;
  double done = 0;
  for (int a = 0; a < 3; a++)
    twice = twice && (flow->n[a] == 1 || flow->n[a] >= SOLUTE_CELLS_LEAST);
  solute_correlation_lengths(flow, r->correlation);
  progress_start(&progress, "closure", NULL, (r->count + 1.0) * (twice ? 9 : 8));
  if (twice) TRY(solve_lattice(flow, SOLUTE_COARSE, r, &progress, 1, &done, state));
  TRY(solve_lattice(flow, SOLUTE_FINE, r, &progress, 8, &done, state));
  r->by_closure = true;
  for (int i = 0; i < r->count; i++)
    take(flow, r->peclet[i] * flow->spacing[0] / r->length, &fine[i + 1],
         twice ? &coarse[i + 1] : NULL, &r->closure[i]);
  take(flow, 0.0, &fine[0], twice ? &coarse[0] : NULL, &still);
  r->tortuosity = 1 / still.value.longitudinal;
  r->formation = r->tortuosity / flow->porosity;
  r->formation_error = still.value.longitudinal_error;
  r->formation_sample = still.sample[0];
cleanup:
  progress_end(&progress);
  return status;
}
