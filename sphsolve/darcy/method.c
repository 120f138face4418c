/* Method richards: water in variably saturated soil (docs/physics/richards.md). */

#include "sphsolve/darcy/method.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/log.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/output/step_log.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/edges.h"
#include "sphsolve/darcy/output.h"
#include "sphsolve/darcy/sites.h"
#include "sphsolve/darcy/step.h"
#include "sphsolve/darcy/state.h"
#include "common/units.h"
#include "sphsolve/plan/reynolds.h"
#include "sphsolve/darcy/balance.h"

/* Hydraulic conductivity k of soil that is full of water: where the force drives water round a
 * periodic box, or two heads drive it along a column of soil. */

/* Number of layers of sites across an axis that are all soil; those between them are free water. -1
 * if a layer is of both, or a site is neither. */
static long soil_layers(const struct richards *s, int axis) {
  const struct lattice *l = s->lattice;
  const size_t stride[3] = {1, l->size[0], l->size[0] * l->size[1]}, n = l->size[axis];
  const size_t across = l->count / n;
  long layers = 0;
  if (s->count < l->count) return -1;
  for (size_t layer = 0; layer < n; layer++) {
    size_t soil = 0;
    for (size_t i = 0; i < s->count; i++)
      soil += i / stride[axis] % n == layer && s->soil[i] + 1u < s->soil_count;
    if (soil != 0 && soil != across) return -1;
    layers += soil == across;
  }
  return layers;
}

/* A head at each of two opposite sides, all over them, and no other way in or out: the fall of head
 * along the axis, m; NAN if it is not so. */
static double fall_along(const struct richards *s, int *axis) {
  const struct richards_edge *first = s->edges;
  double head[2] = {NAN, NAN};
  if (s->edge_count == 0 || s->changes) return NAN;
  *axis = first->axis;
  const size_t across = s->lattice->count / s->lattice->size[*axis];
  if (s->edge_count != 2 * across) return NAN;
  for (size_t e = 0; e < s->edge_count; e++) {
    const struct richards_edge *edge = &s->edges[e];
    double *side = &head[edge->low ? 0 : 1];
    const bool given = edge->kind == EDGE_HEAD || edge->kind == EDGE_PRESSURE;
    if (!given || edge->axis != *axis || edge->kind != first->kind || s->limited[e] > 0 ||
        (*side != edge->region->head && !isnan(*side)))
      return NAN;
    *side = edge->region->head;
  }
  return head[0] - head[1];
}

/* One soil, in layers between sites, has its k to the tolerance of the solution, unless walls cut
 * its cells. */
static void set_errors(const struct richards *s, struct run_result *result) {
  result->k_error = 0; /* no mean over time */
  result->error.steadiness = SATURATED_TOLERANCE;
  const bool exact = s->soil_count <= 2 && s->walls.face == NULL;
  result->error.resolution = exact ? SATURATED_TOLERANCE : NAN;
}

/* Sets Darcy velocity and k in `result`; NAN if there is no k. */
static void richards_find_k(const struct richards *s, struct run_result *result) {
  const double *drive = s->scene->driving, *g = s->scene->gravity;
  const double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  double mean[3] = {0};
  bool round = s->edge_count == 0;
  int axis = 0;
  for (size_t i = 0; i < s->count; i++) {
    double v[3];
    richards_flow(s, i, v);
    for (int a = 0; a < 3; a++) mean[a] += v[a] / s->lattice->bulk_count;
  }
  for (int a = 0; a < 3; a++) round = round && (drive[a] == 0 || s->scene->periodic[a]);
  result_from_darcy(s->scene, mean, result);
  result->reynolds =
      reynolds_of_soil(s->scene, s->scene->fluid.viscosity / s->scene->fluid.density, mean);
  if (round) {
    set_errors(s, result);
    for (size_t i = 0; i < s->count; i++)
      if (s->soil[i] + 1u == s->soil_count) result->error.resolution = NAN; /* free water */
    return;
  }
  result->k = result->intrinsic_permeability = NAN;
  const double fall = fall_along(s, &axis);
  if (!(fabs(fall) > 0)) return;
  const long layers = soil_layers(s, axis);
  if (layers <= 0) return;
  const double gradient = fall / ((double)layers * s->spacing);
  memset(result->darcy_velocity, 0, sizeof result->darcy_velocity);
  result->darcy_velocity[axis] = mean[axis];
  result->hydraulic_gradient[axis] = gradient;
  result->k = mean[axis] / gradient;
  set_errors(s, result);
  const double water = (double)s->lattice->size[axis] / (double)layers; /* at most that much */
  if (water > 1) result->error.resolution += water / WATER_CONDUCTIVITY;
  result->intrinsic_permeability = result->k * s->scene->fluid.viscosity / s->scene->fluid.density /
                                   (strength > 0 ? strength : GRAVITY_STANDARD);
}

/* The next time at which a step has to end: where a table has a point, a snapshot is due, or the
 * run ends; and where a row is due, if no other step ends before it. */
static double next_instant(const struct richards *s, const struct recorder *recorder, double row) {
  const struct scene *scene = s->scene;
  double next = fmin(scene->end_time, recorder_next_snapshot(recorder));
  for (size_t r = 0; r < scene->region_count; r++)
    for (size_t k = 0; k < scene->regions[r].table.count; k++) {
      const double time = scene->regions[r].table.time[k];
      if (time > s->time * (1 + 1e-12)) next = fmin(next, time);
    }
  if (s->full && row > s->time) next = fmin(next, row);
  return next > s->time ? next : scene->end_time;
}

/* Whether the flow is steady: tables have ended, the rate of change is below the tolerance times
 * its largest value so far, and over another period as long as the run so far no water content
 * would change by more than the tolerance. Or nothing has moved. */
static bool is_steady(const struct richards *s) {
  const struct scene *scene = s->scene;
  if (s->full && !isfinite(scene->end_time)) return s->step > 0;
  if (!(scene->steady_tolerance > 0) || s->step == 0) return false;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct time_table *table = &scene->regions[r].table;
    if (table->count > 0 && s->time < table->time[table->count - 1]) return false;
  }
  if (s->rate_most < RATE_ROUNDING * s->fastest) return true;
  return s->rate * s->time < scene->steady_tolerance &&
         s->rate < scene->steady_tolerance * s->rate_most;
}

/* The first multiple of the interval after a time; for an interval of 0 it is 0, which is always
 * due. */
static double row_after(double time, double interval) {
  return interval > 0 ? (floor(time / interval * (1 + 1e-12)) + 1) * interval : 0;
}

/* Warns, once, of a well whose rate the soil does not yield, or yields by suction alone. */
static void warn_of_wells(const struct richards *s, bool *warned) {
  for (size_t r = 0; r < s->scene->region_count && !*warned; r++) {
    const struct region *well = &s->scene->regions[r];
    double asked = 0, given = 0, least = INFINITY;
    if (well->type != REGION_WELL || well->first != r) continue;
    for (size_t e = 0; e < s->edge_count; e++)
      if (s->edges[e].region == well)
        asked += richards_well_at(s, &s->edges[e], s->time), given -= s->edge_flux[e].q,
            least = fmin(least, s->h[s->edges[e].site]);
    *warned = s->full ? least < 0 : given < WELL_RATE_SHARE * asked;
    if (*warned && s->full)
      log_warning("%s:%d: t = %.4g s: the pressure head in this well is %.3g m: air would come in, "
                  "and the soil not stay full; give a lower rate, or a drain of a head",
                  s->scene->path, well->line, s->time, least);
    else if (*warned)
      log_warning("%s:%d: t = %.4g s: the soil brings %.0f %% of this well's rate: the water table "
                  "has come down to it; give a lower one, or a drain of a head",
                  s->scene->path, well->line, s->time, 100 * given / asked);
  }
}

static enum status march(struct richards *s, struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  double interval = recorder_row_interval(recorder), dt = 0;
  bool warned = false;
  bool resumed = s->step > 0; /* row and snapshot of this step were there before the checkpoint */
  if (isnan(interval) && s->full && !s->changes) interval = scene->end_time;
  if (isnan(interval)) interval = isfinite(scene->end_time) ? scene->end_time / 500 : 0;
  double next_row = resumed ? row_after(s->time, interval) : 0;
  result->status = "end_time";
  for (;;) {
    bool last = s->time >= scene->end_time * (1 - 1e-12);
    if (!last && is_steady(s)) last = true, result->status = "steady";
    const bool stopped = recorder_interrupted(recorder);
    if (stopped) result->status = "interrupted";
    if (!resumed && (s->time >= next_row * (1 - 1e-12) || last)) {
      TRY(richards_write_row(s, recorder, dt));
      next_row = row_after(s->time, interval);
    }
    if (!resumed && (s->time >= recorder_next_snapshot(recorder) * (1 - 1e-12) || last))
      TRY(richards_write_snapshot(s, recorder));
    if ((stopped || recorder_checkpoint_due(recorder)) && s->step > 0)
      TRY(richards_write_checkpoint(s, recorder));
    resumed = false;
    if (stopped)
      TRY_FAIL(STATUS_INTERRUPTED, "interrupted at t = %.4g s; go on with --resume", s->time);
    if (last) break;
    TRY(richards_advance(s, next_instant(s, recorder, next_row), &dt));
    step_log_limit(recorder_step_log(recorder), "water content");
    warn_of_wells(s, &warned);
    char note[96];
    snprintf(note, sizeof note, "t %.4g s, dt %.3g s", s->time, dt);
    recorder_progress(recorder, s->time / scene->end_time, note);
  }
cleanup:
  if (status == STATUS_NUMERIC) result->status = "failed";
  return status;
}

static enum status run(const struct scene *scene, const struct plan *plan, struct lattice *lattice,
                       struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  struct richards state = {0}, *s = &state;
  struct h5_file *file = NULL;
  (void)plan;
  TRY(richards_create(scene, lattice, s));
  TRY(richards_add_columns(s, recorder));
  TRY(recorder_resume(recorder, &file));
  if (file != NULL) TRY(richards_read_checkpoint(s, file));
  TRY(march(s, recorder, result));
cleanup:
  if (status == STATUS_OK || status == STATUS_INTERRUPTED) {
    const double density = scene->fluid.density;
    result->reynolds = NAN;
    result->steps = s->step;
    result->conservation =
        (struct conservation){.known = true,
                              .no_particles = true,
                              .passed = {.entered = density * s->in, .left = density * s->out}};
    if (s->full) richards_find_k(s, result);
    recorder_set_fact(recorder, "newton_iterations", (double)s->iterations_total);
    recorder_set_fact(recorder, "linear_iterations", (double)s->linear_total);
    recorder_set_fact(recorder, "steps_refused", (double)s->refused);
  }
  h5_close(file);
  richards_free(s);
  return status;
}

/* Whether a soil of the scene can hold air. */
static bool takes_curves(const struct effect_context *context, char why[EFFECT_WHY]) {
  for (size_t r = 0; r < context->scene->region_count; r++)
    if (context->scene->regions[r].retention.given) {
      snprintf(why, EFFECT_WHY, "soil has %s: it need not be full of water",
               retention_name(&context->scene->regions[r].retention));
      return true;
    }
  return false;
}

/* Whether soil stays full of water, and nothing else moves. */
static bool takes_full(const struct effect_context *context, char why[EFFECT_WHY]) {
  bool confined = false;
  if (context->lattice == NULL) return false;
  if (richards_confined(context, &confined, why) == STATUS_OK) return confined;
  error_clear(); /* without memory to look: the run asks for it again */
  return false;
}

static const char *wall_name(const struct scene *scene) {
  (void)scene;
  return "closed";
}

static const char *const fields[] = {"head", "saturation", "water_content", NULL};

const struct method method_richards = {.name = "richards",
                                       .effects = richards_effects,
                                       .constants = richards_constants,
                                       .marches = true,
                                       .fields = fields,
                                       .takes = takes_curves,
                                       .scales = richards_scales,
                                       .cost = richards_cost,
                                       .wall_name = wall_name,
                                       .run = run};

static const char *const fields_full[] = {"head", "porosity", NULL};

/* The same for soil that stays full (darcy/saturated.h). */
const struct method method_darcy = {.name = "darcy",
                                    .effects = richards_effects,
                                    .constants = richards_constants,
                                    .marches = true,
                                    .fields = fields_full,
                                    .takes = takes_full,
                                    .scales = richards_scales,
                                    .cost = richards_cost,
                                    .wall_name = wall_name,
                                    .run = run};
