/* Method solute: transport of a solute by a flow that is already solved. */
#include <math.h>
#include <stdio.h>

#include "common/interrupt.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/units.h"
#include "sphsolve/output/checkpoint_file.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/solute/closure.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/cost.h"
#include "sphsolve/solute/curve.h"
#include "sphsolve/solute/result.h"

/* Sets the Peclet numbers: those of the scene, or that of the flow as it is. */
static enum status set_peclet(const struct scene *scene, const struct solute_flow *flow,
                              struct solute_result *result) {
  const double d = scene->solute.diffusion;
  result->length = scene->solute.length;
  if (isnan(result->length)) result->length = flow->grain_size;
  if (!(result->length > 0))
    return scene_error(scene, AT_SOLUTE,
                       "this flow passes no grains whose size the Peclet number could have; give "
                       "length, like length = \"0.2 mm\"");
  result->diffusion = d;
  result->count = scene->solute.peclet_count;
  for (int i = 0; i < result->count; i++) result->peclet[i] = scene->solute.peclet[i];
  if (result->count == 0) {
    result->count = 1;
    result->peclet[0] = flow->speed * result->length / d;
  }
  return STATUS_OK;
}

/* Reports the estimate with the smaller error where both methods give a coefficient. */
static void choose_best(struct solute_result *r) {
  for (int i = 0; i < r->count; i++) {
    struct solute_estimate *best = &r->best[i];
    const struct solute_estimate *walk = &r->walk[i].value;
    *best = r->by_closure ? r->closure[i].value : *walk;
    if (!r->by_closure || !r->by_walk) continue;
    if (walk->longitudinal_error * fabs(walk->longitudinal) <
        best->longitudinal_error * fabs(best->longitudinal))
      best->longitudinal = walk->longitudinal, best->longitudinal_error = walk->longitudinal_error;
    if (walk->transverse_error * fabs(walk->transverse) <
        best->transverse_error * fabs(best->transverse))
      best->transverse = walk->transverse, best->transverse_error = walk->transverse_error;
  }
}

/* Warns if an error was asked for and not reached. */
static void warn_of_missed_error(const struct scene *scene, const struct solute_result *r) {
  const double wanted = scene->solute.error;
  int missed = 0, worst = 0;
  double most = 0;
  char text[32];
  for (int i = 0; i < r->count; i++) {
    const double error = fmax(r->best[i].longitudinal_error,
                              walk_error_unit(r->best[i].transverse) > r->best[i].transverse
                                  ? 0 /* practically 0, as across a slit */
                                  : r->best[i].transverse_error);
    missed += error > wanted;
    if (error > most) most = error, worst = i;
  }
  if (missed > 0)
    log_warning("--error: %d of %d Peclet numbers are known less well than %.3g %%, Pe %.4g to "
                "%s %%; a flow on a finer lattice, or solute.way = \"both\", brings it down",
                missed, r->count, 100 * wanted, r->peclet[worst], percent_format(most, text));
}

/* Warns if the cells are too large for the closure problem. */
static void warn_of_large_cells(const struct scene *scene, const struct solute_flow *flow,
                                const struct solute_result *r) {
  for (int i = 0; i < r->count && scene->solute.way == SOLUTE_CLOSURE; i++) {
    const double cell = r->peclet[i] * flow->spacing[0] / r->length;
    if (cell <= SOLUTE_CELL_PECLET) continue;
    log_warning("%s: Pe %.4g is %.3g of a cell, too much for the closure problem on this lattice: "
                "solute.way = \"walk\" is surer",
                scene->path, r->peclet[i], cell);
    return;
  }
}

static enum status run_on_flow(const struct scene *scene, const char *prefix, bool resume,
                               const char *command_line, bool json) {
  enum status status = STATUS_OK;
  struct solute_state *state = NULL;
  struct solute_flow flow = {0};
  struct solute_result result = {.status = "converged",
                                 .formation = NAN,
                                 .formation_error = NAN,
                                 .formation_sample = NAN,
                                 .correlation = {NAN, NAN},
                                 .tortuosity = NAN,
                                 .wanted = isnan(scene->solute.error) ? SOLUTE_WALK_ERROR
                                                                      : scene->solute.error};
  char path[4200];
  output_protect(scene->path);
  output_protect(scene->flow_path);
  snprintf(path, sizeof path, "%s.hdf", prefix);
  TRY(output_allow(path));
  for (int i = 0; i < SOLUTE_PECLET_MAX && scene->solute.way != SOLUTE_CLOSURE; i++) {
    snprintf(path, sizeof path, "%s-tracks-%d.hdf", prefix, i);
    TRY(output_allow(path));
  }
  TRY(memory_allocate(&state, 1, sizeof *state, "what is found so far"));
  TRY(solute_state_begin(scene, prefix, resume, state));
  interrupt_start("what was done is kept, and --resume goes on from it; once more ends at once");
  TRY(solute_add_location(scene, solute_flow_read(scene->flow_path, &flow)));
  if (flow.thin_walls && scene->solute.way != SOLUTE_CLOSURE)
    TRY_FAIL(
        STATUS_INPUT,
        "%s: the flow's lattice has walls thinner than its spacing, through which walkers would "
        "go; write solute.way = \"closure\", or run the flow on the model's own voxels",
        scene->path);
  TRY(set_peclet(scene, &flow, &result));
  if (flow.mirrored)
    log_warning("%s: the sample is its own mirror image along the flow, which brings every "
                "streamline back to its place: above Pe of some 10, D_L is more than the soil's; "
                "take a flow along an axis that is not mirrored",
                scene->path);
  log_verbose("flow: %d x %d x %d cells, porosity %.4f, U = %.3g m/s, grains of %.3g m, changed "
              "by %.2g to be free of divergence",
              flow.n[0], flow.n[1], flow.n[2], flow.porosity, flow.speed, flow.grain_size,
              flow.correction);
  if (scene->solute.way != SOLUTE_WALK) TRY(solute_curve_by_closure(&flow, state, &result));
  if (scene->solute.way != SOLUTE_CLOSURE) TRY(solute_curve_by_walk(&flow, state, &result));
  choose_best(&result);
  warn_of_large_cells(scene, &flow, &result);
  warn_of_missed_error(scene, &result);
  result.wall_time = clock_seconds() - state->started;
  TRY(solute_result_write(scene, &flow, &result, prefix, command_line));
  checkpoint_remove(prefix);
  if (json)
    TRY(solute_result_print_json(scene, &flow, &result));
  else if (log_level() > LOG_QUIET)
    solute_result_print(scene, &flow, &result, prefix);
cleanup:
  if (state != NULL) solute_state_free(state);
  memory_free(&state);
  solute_flow_free(&flow);
  return status;
}

/* Never chosen automatically: it is selected by name, or by a scene that names a flow. */
static bool takes(const struct effect_context *context, char why[EFFECT_WHY]) {
  (void)context, (void)why;
  return false;
}

static const struct effect *const no_effects[] = {NULL};

const struct method method_solute = {.name = "solute",
                                     .effects = no_effects,
                                     .constants = solute_constants,
                                     .takes = takes,
                                     .run_on_flow = run_on_flow,
                                     .explain_on_flow = solute_explain};
