/* Method solute: transport of a solute by a flow that is already solved. */

#include <jansson.h>
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
#include "sphsolve/solute/curve.h"
#include "sphsolve/solute/result.h"
#include "common/json_number.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/walk.h"

/* Predicted cost and error of method solute. */

/* Processor seconds of the walks at one Peclet number, on the flow's cells and on those twice as
 * large. */
static double walk_seconds(const struct solute_flow *flow, double cell_peclet, double peclet,
                           double wanted) {
  const struct walk_pace pace = solute_walk_pace(flow, cell_peclet, peclet, wanted);
  const double advection = cell_peclet > 0 ? pace.dt : 0;
  return 5.0 / 4 * pace.steps * (double)walk_walkers(wanted) * SECONDS_STEP *
         (1 + STEP_ADVECTION_FACTOR * advection);
}

static double iterations(double cell_peclet) {
  return ITERATIONS_NO_FLOW + ITERATIONS_PECLET * pow(cell_peclet, ITERATIONS_POWER);
}

/* Prefixes an input error of the flow with the line of flow.file; returns the status. */
static enum status solute_add_location(const struct scene *scene, enum status status) {
  if (status == STATUS_INPUT && scene->line_of[AT_FLOW] > 0)
    error_context(status, "%s:%d: flow.file", scene->path, scene->line_of[AT_FLOW]);
  return status;
}

/* Reads the flow's walls and prints predicted time, memory and error. */
static enum status solute_explain(const struct scene *scene, int threads, bool json) {
  enum status status = STATUS_OK;
  struct solute_flow flow = {0};
  TRY(solute_add_location(scene, solute_flow_preview(scene->flow_path, &flow)));
  const double spacing = cbrt(flow.spacing[0] * flow.spacing[1] * flow.spacing[2]);
  const double given = scene->solute.length;
  const double length = isnan(given) ? flow.grain_size : given;
  const int count = scene->solute.peclet_count > 0 ? scene->solute.peclet_count : 1;
  const bool walks = scene->solute.way != SOLUTE_CLOSURE;
  const bool closes = scene->solute.way != SOLUTE_WALK;
  const double wanted = isnan(scene->solute.error) ? SOLUTE_WALK_ERROR : scene->solute.error;
  double all = iterations(0), largest = 0, walking = 0;
  for (int i = 0; i < count; i++) {
    const double peclet = scene->solute.peclet_count > 0
                              ? scene->solute.peclet[i]
                              : flow.speed * length / scene->solute.diffusion;
    all += iterations(peclet * spacing / length);
    walking += walk_seconds(&flow, peclet * flow.spacing[0] / length, peclet, wanted);
    largest = fmax(largest, peclet);
  }
  double padded = 1;
  for (int a = 0; a < 3; a++) padded *= flow.n[a] + 2;
  const double seconds = ((closes ? SECONDS_ITERATION * padded * all * 9 / 8 : 0) +
                          (walks ? walking : 0) + SECONDS_READ * padded) /
                         threads;
  const size_t walkers = walks ? walk_walkers(wanted) : 0;
  const double sites = (double)flow.count;
  const double by_closure = (BYTES_SOLVER + BYTES_CLOSURE) * padded;
  const double by_walk =
      walks ? walk_bytes(walkers) + walk_cells_bytes(flow.count, (size_t)(flow.porosity * sites))
            : 0;
  /* The projection needs as much as the closure problem except for its variables. */
  const double bytes = PROGRAM_BYTES + BYTES_FLOW * sites +
                       fmax(closes ? by_closure : BYTES_SOLVER * padded, by_walk);
  const double no_flow_error = ERROR_RESOLUTION * pow(spacing / flow.grain_size, 2);
  const double error = no_flow_error * hypot(1, largest * spacing / length / ERROR_PECLET);
  if (json) {
    json_t *object =
        json_pack("{s:s, s:s, s:s, s:[i,i,i], s:f, s:f, s:f, s:f, s:i, s:f}", "scene", scene->name,
                  "method", "solute", "flow", scene->flow_path, "size", flow.n[0], flow.n[1],
                  flow.n[2], "spacing", spacing, "porosity", flow.porosity, "mean_velocity",
                  flow.speed, "length", length, "peclet_numbers", count, "memory_bytes", bytes);
    if (object == NULL) TRY_FAIL(STATUS_RUN, "the JSON object cannot be made");
    json_put_number(object, "seconds", seconds);
    json_put_number(object, "expected_error", closes ? error : wanted);
    if (walks) json_object_set_new(object, "walkers", json_integer((json_int_t)walkers));
    json_dumpf(object, stdout, JSON_INDENT(2));
    putchar('\n');
    json_decref(object);
    goto cleanup;
  }
  char text[32], moving[32];
  printf("scene      %s (%s)\n", scene->name, scene->path);
  printf("method     solute: the scene names a flow that is solved already\n");
  printf("flow       %s: %d x %d x %d cells of %.4g m, porosity %.4f, U about %.2g m/s\n",
         scene->flow_path, flow.n[0], flow.n[1], flow.n[2], spacing, flow.porosity, flow.speed);
  printf("length     %.4g m%s, of Pe = U length / D\n", length,
         isnan(given) ? " (6 grain volume / grain surface)" : "");
  if (walks)
    printf("walk       %zu walkers at each Peclet number, to %s %%, in about %.2g s\n", walkers,
           percent_format(wanted, text), walking / threads);
  if (closes)
    printf(
        "closure    on the flow's cells and on those twice as large, %d Peclet number%s and none\n",
        count, count == 1 ? "" : "s");
  printf("memory     %.3g MB\n", 1e-6 * bytes);
  printf("time       about %.2g s on %d thread%s\n", seconds, threads, threads == 1 ? "" : "s");
  if (closes && isfinite(error))
    printf("error      about %s %% of D* without flow, %s %% of D_L at Pe %.3g: %.3g cells across "
           "a grain; the flow's own is not in it\n",
           percent_format(no_flow_error, text), percent_format(error, moving), largest,
           flow.grain_size / spacing);
cleanup:
  solute_flow_free(&flow);
  return status;
}

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
