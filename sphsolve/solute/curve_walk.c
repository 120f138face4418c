/* D* / D over the Peclet numbers of a scene by random walk. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "common/units.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/curve.h"
#include "sphsolve/solute/flow.h"

#define SEED 20230723u
#define FIRST_EVALUATION 64u /* intervals before the first evaluation */

struct walk_pace solute_walk_pace(const struct solute_flow *flow, double cell_peclet, double peclet,
                                  double wanted) {
  double widest = 0;
  for (int a = 0; a < 3; a++)
    if ((flow->dimensions == 3 || a != 1) &&
        !(fabs(flow->mean_velocity[a]) >= ALONG_COSINE * flow->speed && flow->speed > 0))
      widest = fmax(widest, flow->n[a] * flow->spacing[a] / flow->spacing[0]);
  return walk_pace(cell_peclet, widest, TRANSVERSE_NO_FLOW + TRANSVERSE_PER_PECLET * peclet,
                   wanted);
}

/* Walks at one Peclet number until done. `expected`: number of steps, for the progress bar. */
static enum status walk_once(const struct walk_cells *cells, const struct walk_settings *settings,
                             double peclet, double expected, struct progress *progress, double done,
                             double weight, struct solute_state *state,
                             struct walk_record *record) {
  enum status status = STATUS_OK;
  static struct walk walk; /* too large for a small stack */
  struct walk_verdict verdict;
  uint64_t next = FIRST_EVALUATION;
  char note[80], error[32];
  bool found;
  memset(&walk, 0, sizeof walk);
  snprintf(note, sizeof note, "Pe %.3g", peclet);
  TRY(solute_state_restore_walk(state, cells, &walk, &found));
  if (!found) TRY(walk_begin(cells, settings, &walk));
  while (next <= walk.moments.intervals) next += next / 4;
  for (;;) {
    if (solute_state_due(state)) TRY(solute_state_save(state, NULL, &walk));
    TRY(walk_advance(&walk));
    const double steps = (double)walk.steps;
    progress_update(progress, done + weight * steps / fmax(expected, PROGRESS_MARGIN * steps),
                    note);
    if (walk.moments.intervals < next) continue;
    if (walk_done(&walk, &verdict)) break;
    if (verdict.lag >= 0)
      snprintf(note, sizeof note, "Pe %.3g: D_L/D %.4g +- %s %%", peclet, verdict.longitudinal,
               percent_format(verdict.longitudinal_error, error));
    next += next / 4;
  }
  TRY(walk_record(&walk, record));
cleanup:
  walk_end(&walk);
  return status;
}

static void set_estimate(const struct walk_record *record, struct solute_walked *out) {
  const struct walk_verdict *v = &record->verdict;
  *out = (struct solute_walked){.value = {NAN, NAN, NAN, NAN},
                                .settled = record->settled,
                                .steps = record->steps,
                                .walkers = record->walkers};
  if (v->lag < 0) return;
  /* The errors of very small coefficients refer to a larger unit (walk_error_unit); here they are
   * converted to errors relative to the coefficients. */
  const double along = walk_error_unit(v->longitudinal) / fabs(v->longitudinal);
  const double across = walk_error_unit(v->transverse) / fabs(v->transverse);
  out->value = (struct solute_estimate){
      v->longitudinal, v->transverse, along * v->longitudinal_error, across * v->transverse_error};
  out->statistics[0] = along * v->longitudinal_statistics;
  out->statistics[1] = across * v->transverse_statistics;
  out->asymptotics[0] = along * v->longitudinal_drift;
  out->asymptotics[1] = across * v->transverse_drift;
}

/* Extrapolates one coefficient; returns the relative shift. A difference within its standard error
 * is given little weight. */
static double move_to_limit(double *value, double *error, double coarse, double coarse_error,
                            double ratio) {
  const double change = coarse / *value - 1;
  const double variance = 0.25 * (pow(*error, 2) + pow(coarse_error * coarse / *value, 2));
  const double weight = change * change / (change * change + variance);
  if (!isfinite(change) || !isfinite(weight)) return NAN;
  const double move = -weight * change / (ratio * ratio - 1);
  *value *= 1 + move;
  *error = hypot(*error, move);
  return fabs(move);
}

void solute_walk_limit(struct solute_estimate *fine, const struct solute_estimate *coarse,
                       double ratio, double resolution[2]) {
  resolution[0] = move_to_limit(&fine->longitudinal, &fine->longitudinal_error,
                                coarse->longitudinal, coarse->longitudinal_error, ratio);
  resolution[1] = move_to_limit(&fine->transverse, &fine->transverse_error, coarse->transverse,
                                coarse->transverse_error, ratio);
}

/* Walks on one lattice at all Peclet numbers. `weight`: share of one of them in the progress
 * bar. */
static enum status walk_lattice(const struct solute_flow *flow, int lattice,
                                const struct solute_result *r, struct progress *progress,
                                double weight, double *done, struct solute_state *state) {
  enum status status = STATUS_OK;
  struct walk_cells cells = {0};
  int *count = &state->walked_count[lattice];
  *done += weight * *count;
  if (*count == r->count) return STATUS_OK;
  TRY(walk_cells_make(flow, &cells));
  for (; *count < r->count; *done += weight) {
    const int i = *count;
    char along[32], across[32];
    const double started = clock_processor_seconds();
    struct walk_settings settings = {.peclet = r->peclet[i] * flow->spacing[0] / r->length,
                                     .direction = {0, 0, 1},
                                     .tolerance = r->wanted,
                                     .most_steps = WALK_STEPS_MAX,
                                     .seed = SEED + (uint32_t)i};
    for (int a = 0; a < 3 && flow->speed > 0; a++)
      settings.direction[a] = flow->mean_velocity[a] / flow->speed;
    if (!(flow->speed > 0)) settings.peclet = 0;
    struct walk_record *record = &state->record[lattice][i];
    const double expected = solute_walk_pace(flow, settings.peclet, r->peclet[i], r->wanted).steps;
    TRY(walk_once(&cells, &settings, r->peclet[i], expected, progress, *done, weight, state,
                  record));
    struct solute_walked *w = &state->walked[lattice][i];
    set_estimate(record, w);
    ++*count;
    w->seconds = clock_processor_seconds() - started;
    log_verbose("walk: cells of %.3g m, Pe %.3g: D_L/D %.4g +- %s %%, D_T/D %.4g +- %s %%; "
                "%.0f walkers, %.0f steps, %.3g s, %.3g M steps a second",
                flow->spacing[0], r->peclet[i], w->value.longitudinal,
                percent_format(w->value.longitudinal_error, along), w->value.transverse,
                percent_format(w->value.transverse_error, across), w->walkers, w->steps, w->seconds,
                1e-6 * w->walkers * w->steps / w->seconds);
  }
cleanup:
  walk_cells_free(&cells);
  return status;
}

enum status solute_curve_by_walk(const struct solute_flow *flow, struct solute_state *state,
                                 struct solute_result *r) {
  enum status status = STATUS_OK;
  struct solute_flow coarse_flow = {0};
  struct progress progress;
  bool has_coarse = true;
  double done = 0;
  for (int a = 0; a < 3; a++)
    has_coarse = has_coarse && (flow->n[a] == 1 || flow->n[a] >= SOLUTE_CELLS_MIN);
  progress_start(&progress, "walk", NULL, r->count * (has_coarse ? 5.0 / 4 : 1));
  if (has_coarse) {
    TRY(solute_flow_coarsen(flow, &coarse_flow));
    TRY(walk_lattice(&coarse_flow, SOLUTE_COARSE, r, &progress, 0.25, &done, state));
  }
  TRY(walk_lattice(flow, SOLUTE_FINE, r, &progress, 1, &done, state));
  r->by_walk = true;
  const double ratio =
      has_coarse ? pow((double)flow->count / (double)coarse_flow.count, 1.0 / flow->dimensions)
                 : NAN;
  r->record = state->record[SOLUTE_FINE];
  for (int i = 0; i < r->count; i++) {
    const struct solute_walked *coarse = &state->walked[SOLUTE_COARSE][i];
    r->walk[i] = state->walked[SOLUTE_FINE][i];
    if (!r->walk[i].settled) r->status = "steps";
    if (!has_coarse) { /* no error of resolution */
      r->walk[i].resolution[0] = r->walk[i].resolution[1] = NAN;
      continue;
    }
    solute_walk_limit(&r->walk[i].value, &coarse->value, ratio, r->walk[i].resolution);
    r->walk[i].seconds += coarse->seconds;
  }
cleanup:
  progress_end(&progress);
  solute_flow_free(&coarse_flow);
  return status;
}
