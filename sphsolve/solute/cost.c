#include "sphsolve/solute/cost.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>

#include "common/json_number.h"
#include "common/units.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/curve.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/walk.h"

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

enum status solute_add_location(const struct scene *scene, enum status status) {
  if (status == STATUS_INPUT && scene->line_of[AT_FLOW] > 0)
    error_context(status, "%s:%d: flow.file", scene->path, scene->line_of[AT_FLOW]);
  return status;
}

enum status solute_explain(const struct scene *scene, int threads, bool json) {
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
