#include "sphsolve/explain.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/json_number.h"
#include "common/units.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"
#include "common/memory.h"

/* Factor within which expected errors are known (docs/errors.md): settings are recommended if their
 * expected error is below the requested one by this factor. */
#define ERROR_SAFETY_FACTOR 2.0

/* Smallest refinement with an error of at most `wanted`, NAN if there is none; the error decreases
 * with refinement. */
static double refinement(const struct plan *plan, double wanted) {
  const struct pore_shape *shape = &plan->shape;
  const struct method *method = plan->context.method;
  const enum wall_scheme wall = method->wall(plan->context.scene);
  double low = REFINEMENT_MIN, high = REFINEMENT_MAX;
  if (!(error_forecast_of(shape, method, wall, high).error <= wanted)) return NAN;
  if (error_forecast_of(shape, method, wall, low).error <= wanted) high = low;
  for (int i = 0; i < 60 && high > low; i++) {
    const double middle = sqrt(low * high);
    if (error_forecast_of(shape, method, wall, middle).error <= wanted)
      high = middle;
    else
      low = middle;
  }
  /* At least two sites across a mean pore, as there is no flow with fewer, and across a mean grain,
   * as water on both sides of a thinner one would interact. */
  return fmax(high, 2.0 / fmin(shape->width, shape->grain));
}

/* Increases `refined` until the longest side has a whole number of sites, and in a domain every
 * periodic side. */
static double whole_sites(const struct scene *scene, const size_t body[3], double refined) {
  size_t longest = 0;
  for (int a = 0; a < 3; a++)
    if (body[a] > longest) longest = body[a];
  const double least = ceil(refined * (double)longest - 1e-6);
  for (double n = least; n <= 2.0 * least; n++) { // NOLINT: whole numbers are exact
    bool whole = true;
    for (int a = 0; a < 3 && !*scene->model_path; a++) {
      const double sites = (double)body[a] * n / (double)longest;
      const bool counts = scene->periodic[a] && !(scene->dimensions == 2 && a == 1);
      whole = whole && !(counts && (sites < 0.5 || fabs(sites - round(sites)) > 1e-4));
    }
    if (whole) return n / (double)longest;
  }
  return least / (double)longest;
}

enum status recommend_find(const struct plan *plan, struct recommendation *r) {
  enum status status = STATUS_OK;
  const struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  const struct lattice *lattice = context->lattice;
  const struct method *method = context->method;
  size_t body[3];
  if (!method->resolves_pores || !isfinite(plan->expected.error))
    TRY_FAIL(STATUS_INPUT, "%s: --error: the error of this scene cannot be predicted: %s",
             scene->path, *plan->expected.why ? plan->expected.why : "it has no permeability");
  double refined = refinement(plan, r->wanted / ERROR_SAFETY_FACTOR);
  r->found = !isnan(refined);
  if (!r->found) return STATUS_OK;
  for (int a = 0; a < 3; a++)
    body[a] = *scene->model_path
                  ? lattice->size[a]
                  : (size_t)fmax(1.0, round(scene->domain_size[a] / lattice->spacing[a]));
  refined = whole_sites(scene, body, refined);
  for (int a = 0; a < 3; a++)
    r->size[a] = body[a] == 1 ? 1 : (size_t)fmax(1.0, round(refined * (double)body[a]));
  r->spacing = context->spacing / refined;
  r->support = context->support / refined;
  r->error = error_forecast_of(&plan->shape, method, method->wall(scene), refined).error;
  const double more = pow(refined, lattice->dimensions);
  /* Sound speed and steps of wcsph at that spacing: viscosity limits dt by the square of the
   * spacing, sound by the spacing; the time for a pore to become steady does not depend on it. */
  double steps = 1.0;
  if (context->sound_speed > 0) {
    steps = plan->dt_power > 1 ? refined * refined : refined;
    r->sound_speed = context->sound_speed;
    /* auto: at least 2 nu / h */
    const double creep = 2.0 * context->kinematic_viscosity / context->smoothing_length;
    if (isnan(scene->wcsph.sound_speed)) r->sound_speed = fmax(r->sound_speed, creep * refined);
  }
  r->seconds = PROGRAM_SECONDS + (plan->seconds - PROGRAM_SECONDS) * more * steps;
  r->bytes = PROGRAM_BYTES + (plan->bytes_total - PROGRAM_BYTES) * more;
cleanup:
  return status;
}

void recommend_print(const struct plan *plan, const struct recommendation *r) {
  const struct scene *scene = plan->context.scene;
  const char *method = plan->context.method->name;
  const char *wall = wall_scheme_names[plan->context.method->wall(scene)];
  char spacing[40], support[40], time[40], error[32];
  printf(
      "\nwanted     %.3g %%: by a spacing from which half of it is expected, for expectations are "
      "good to a factor %g\n",
      100 * r->wanted, ERROR_SAFETY_FACTOR);
  if (!r->found) {
    printf("cheapest   none: no spacing up to %g times finer reaches it; extrapolate with analyze "
           "converge\n",
           REFINEMENT_MAX);
    return;
  }
  quantity_format(r->spacing, "m", spacing, sizeof spacing);
  quantity_format(r->support, "m", support, sizeof support);
  duration_format(r->seconds, time, sizeof time);
  printf("cheapest   %s, %s walls, spacing %s (%zu x %zu x %zu points), support %s", method, wall,
         spacing, r->size[0], r->size[1], r->size[2], support);
  if (r->sound_speed > 0) printf(", sound %.4g m/s", r->sound_speed);
  printf(": error about %s %%, %s, %.0f MB\n", percent_format(r->error, error), time,
         r->bytes / 1e6);
  if (!(r->seconds <= SECONDS_MAX && r->bytes <= memory_limit()))
    printf(
        "           not within reach: over 30 days, or over the %.0f MB of memory here; lattices "
        "and their errors above are\n",
        1e-6 * memory_limit());
  if (*scene->model_path)
    printf("write      a model of %zu x %zu x %zu points (ct2model build --size; a mirrored axis "
           "takes "
           "(n + 1) / 2)\n",
           r->size[0], r->size[1], r->size[2]);
  else
    printf("write      --set domain.spacing='%.6g m'\n", r->spacing);
}

static json_t *recommend_json(const struct plan *plan, const struct recommendation *r) {
  const struct method *method = plan->context.method;
  json_t *list = json_array();
  if (r->found)
    json_array_append_new(
        list,
        json_pack("{s:s, s:s, s:f, s:f, s:[I,I,I], s:f, s:f, s:f, s:f}", "method", method->name,
                  "wall", wall_scheme_names[method->wall(plan->context.scene)], "spacing",
                  r->spacing, "support", r->support, "size", (json_int_t)r->size[0],
                  (json_int_t)r->size[1], (json_int_t)r->size[2], "sound_speed", r->sound_speed,
                  "expected_error", r->error, "seconds", r->seconds, "memory_bytes", r->bytes));
  return json_pack("{s:f, s:o}", "wanted", r->wanted, "settings", list);
}

/* Total error including those of scan and threshold, which no lattice reduces. */
static double with_scan(const struct plan *plan, double resolution) {
  return hypot(resolution, error_expected_rest(plan));
}

/* The effect of the sides is not predictable (cascade_add_sides). */
#define SIDES_LARGE ", if the sample's sides turn out to change k by over a fifth"

/* Predicted cost of each attainable error, before anything is solved. */
static void print_levels(const struct plan *plan) {
  struct predicted_level levels[PREDICTED_LEVELS_MAX];
  const struct method *method = plan->context.method;
  const int count = method->levels != NULL ? method->levels(plan, PREDICTED_LEVELS_MAX, levels) : 0;
  char spacing[64], time[64], error[32];
  if (count == 0) return;
  if (plan->goal.error > 0)
    printf("\nrun with --error %.3g%%", 100 * plan->goal.error);
  else
    printf("\nrun with --error or --time");
  printf(", %d %s: what it will state of resolution%s, to a factor of two\n", plan->threads,
         plan->threads == 1 ? "thread" : "threads",
         plan->expected_threshold > 0.0  ? ", scan and threshold"
         : isfinite(plan->expected_scan) ? " and scan"
                                         : "");
  for (int i = 0; i < count; i++) {
    quantity_format(levels[i].spacing, "m", spacing, sizeof spacing);
    duration_format(levels[i].seconds / plan->threads, time, sizeof time);
    printf("  k to about %s %% after %s, lattices down to %s (%.3g M points), %.0f MB%s\n",
           percent_format(with_scan(plan, levels[i].error), error), time, spacing,
           1e-6 * levels[i].sites, 1e-6 * levels[i].bytes,
           levels[i].few ? "; with --time alone" : "");
  }
  if (levels[0].seconds_sides / plan->threads >= 1) {
    duration_format(levels[0].seconds_sides / plan->threads, time, sizeof time);
    printf("  and up to about %s more" SIDES_LARGE "\n", time);
  }
}

/* Polygons, circles and bodies, and the number of boxes that represent them. */
static void print_regions(const struct scene *scene) {
  size_t regions = 0, shapes = 0, boxes = 0, bodies = 0, of_bodies = 0;
  for (size_t k = 0; k < scene->region_count; k = scene->regions[k].end, regions++)
    if (scene->regions[k].polygon != NULL)
      shapes++, boxes += scene->regions[k].end - scene->regions[k].first;
    else if (scene->regions[k].is_part)
      bodies++, of_bodies += scene->regions[k].end - scene->regions[k].first;
  if (shapes > 0)
    printf("regions    %zu; %zu polygon%s and circles as %zu boxes, in rows of a spacing\n",
           regions, shapes, shapes == 1 ? "" : "s", boxes);
  if (bodies > 0)
    printf("regions    %zu; %zu STL bod%s as %zu boxes\n", regions, bodies,
           bodies == 1 ? "y" : "ies", of_bodies);
}

/* Predicted iterations or steps, time and error. */
static void print_outcome(const struct plan *plan) {
  char text[512];
  if (plan->blocked) {
    printf("blocked    %s\n", plan->expected.why);
    return;
  }
  duration_format(plan->seconds, text, sizeof text);
  if (isnan(plan->steps))
    printf("steps      not known before the run, nor its time\n");
  else
    printf("%s about %.3g\ntime       %s%s\n", plan->dt == 0 ? "iterations" : "steps     ",
           plan->steps, strncmp(text, "under", 5) ? "about " : "", text);
  if (plan->seconds_sides >= 1) {
    duration_format(plan->seconds_sides, text, sizeof text);
    printf("           and up to about %s more" SIDES_LARGE "\n", text);
  }
  const struct error_forecast *e = &plan->expected;
  if (isfinite(e->error))
    printf("error      %s %s %%: %s\n", e->least > 0 ? "about" : "at most",
           percent_format(e->error, text), e->why);
  else
    printf("error      not predicted%s%s\n", *e->why ? ": " : "", e->why);
  if (isfinite(plan->expected_scan))
    printf("           and about %s %% by the scan itself: its voxels, blur and noise\n",
           percent_format(plan->expected_scan, text));
  print_levels(plan);
}

void explain_print(const struct plan *plan) {
  const struct effect_context *context = &plan->context;
  const struct lattice *lattice = context->lattice;
  char text[512], more[64];
  printf("scene      %s\n", context->scene->name);
  printf("method     %s: %s\n", context->method->name, plan->method_why);
  printf("points     %zu x %zu x %zu (x, y, z): %zu fluid, %zu wall, %zu empty\n", lattice->size[0],
         lattice->size[1], lattice->size[2], lattice->fluid_count, lattice->wall_count,
         lattice->count - lattice->fluid_count - lattice->wall_count);
  print_regions(context->scene);
  quantity_format(context->spacing, "m", text, sizeof text);
  quantity_format(context->support, "m", more, sizeof more);
  if (context->support > 0)
    printf("spacing    %s, support %s (%.2f spacings), kernel %s\n", text, more,
           context->support / context->spacing, kernel_names[context->kernel]);
  else
    printf("spacing    %s\n", text);
  if (context->sound_speed > 0)
    printf("sound      %.4g m/s: %s\n", context->sound_speed, context->sound_why);
  if (context->reynolds > 0)
    printf("Reynolds   about %.2g (%s)\n", context->reynolds,
           context->inertia > INERTIA_TOLD ? "Ergun" : "Kozeny-Carman");
  printf("\neffects\n");
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    printf("  %-3s  %-24s %s\n", planned->on ? "on" : "off", planned->effect->name, planned->why);
    if (!planned->on) continue;
    printf("       %-24s %s [%s]\n", "", planned->effect->model, planned->effect->citation);
    if (isfinite(planned->dt_max)) {
      quantity_format(planned->dt_max, "s", text, sizeof text);
      printf("       %-24s dt at most %s\n", "", text);
    }
  }
  printf(
      "\nmemory     %.1f MB at most: the method %.1f MB, %.0f bytes per fluid site, %.0f per wall "
      "site\n",
      plan->bytes_total / 1e6, plan->bytes_method / 1e6, plan->bytes_fluid, plan->bytes_wall);
  if (plan->bytes_copy > 0)
    printf("           %.1f MB beside it while a state to go back to is kept\n",
           plan->bytes_copy / 1e6);
  if (plan->bytes_disk > 0)
    printf("           on disk, beside the results, up to %.1f MB while it runs\n",
           plan->bytes_disk / 1e6);
  if (plan->bytes_sides > 0)
    printf("           up to %.1f MB" SIDES_LARGE "\n", plan->bytes_sides / 1e6);
  if (plan->bytes_split > 0)
    printf("           %.1f MB after it to split the error of k\n", plan->bytes_split / 1e6);
  if (plan->dt > 0) {
    quantity_format(plan->dt, "s", text, sizeof text);
    quantity_format(plan->dt_limit, "s", more, sizeof more);
    const char *limit = plan->dt_limited_by ? plan->dt_limited_by : "nothing";
    printf("time step  %s (limit %s by %s", text, more, limit);
    if (plan->dt_by && strcmp(plan->dt_by, limit)) printf("; decided by %s", plan->dt_by);
    printf(")\n");
  } else if (isnan(plan->dt)) {
    printf("time step  chosen each step from %s\n",
           plan->dt_by ? plan->dt_by : "the effects' limits");
  }
  print_outcome(plan);
}

static json_t *levels_json(const struct plan *plan) {
  struct predicted_level levels[PREDICTED_LEVELS_MAX];
  const struct method *method = plan->context.method;
  const int count = method->levels != NULL && !plan->blocked
                        ? method->levels(plan, PREDICTED_LEVELS_MAX, levels)
                        : 0;
  json_t *list = json_array();
  for (int i = 0; i < count; i++)
    json_array_append_new(
        list, json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "spacing", levels[i].spacing,
                        "sites", levels[i].sites, "expected_error", levels[i].error,
                        "expected_error_with_scan", with_scan(plan, levels[i].error), "seconds",
                        levels[i].seconds / plan->threads, "seconds_sides",
                        levels[i].seconds_sides / plan->threads, "memory_bytes", levels[i].bytes));
  return list;
}

static json_t *plan_pores_json(const struct plan *plan) {
  const struct pore_shape *shape = &plan->shape;
  if (!(shape->slope > 0)) return json_null();
  return json_pack("{s:f, s:f, s:f, s:f}", "width", shape->width, "slope", shape->slope,
                   "frozen_shift", shape->outer, "adami_shift", shape->middle);
}

enum status explain_print_json(const struct plan *plan, const struct recommendation *recommended) {
  const struct effect_context *context = &plan->context;
  const struct lattice *lattice = context->lattice;
  json_t *effects = json_array();
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    json_array_append_new(
        effects, json_pack("{s:s, s:s, s:s, s:s, s:s, s:o}", "name", planned->effect->name, "state",
                           planned->on ? "on" : "off", "reason", planned->why, "model",
                           planned->effect->model, "citation", planned->effect->citation, "dt_max",
                           json_number(planned->dt_max)));
  }
  json_t *object = json_pack(
      "{s:s, s:s, s:s, s:[I,I,I], s:I, s:I, s:f, s:f, s:s, s:o, s:s, s:o, s:f, s:f, s:f, s:f, s:f, "
      "s:f, s:f, s:f, s:o, s:o, s:s?, s:o, s:o, s:o, s:b, s:o, s:o, s:s, s:o, s:f, s:o}",
      "scene", context->scene->name, "method", context->method->name, "method_reason",
      plan->method_why, "size", (json_int_t)lattice->size[0], (json_int_t)lattice->size[1],
      (json_int_t)lattice->size[2], "fluid_sites", (json_int_t)lattice->fluid_count, "wall_sites",
      (json_int_t)lattice->wall_count, "spacing", context->spacing, "support", context->support,
      "kernel", kernel_names[context->kernel], "sound_speed",
      json_number(context->sound_speed > 0 ? context->sound_speed : NAN), "sound_speed_reason",
      context->sound_why, "effects", effects, "bytes_per_fluid_site", plan->bytes_fluid,
      "bytes_per_wall_site", plan->bytes_wall, "memory_bytes", plan->bytes_total,
      "memory_method_bytes", plan->bytes_method, "memory_copy_bytes", plan->bytes_copy,
      "memory_error_split_bytes", plan->bytes_split, "memory_sides_bytes", plan->bytes_sides,
      "disk_bytes", plan->bytes_disk, "dt", json_number(plan->dt), "dt_limit",
      json_number(plan->dt_limit), "dt_limited_by", plan->dt_limited_by, "steps",
      json_number(plan->steps), "seconds", json_number(plan->seconds), "seconds_sides",
      json_number(plan->seconds_sides), "blocked", plan->blocked, "expected_error",
      json_number(plan->expected.error), "expected_error_least", json_number(plan->expected.least),
      "expected_error_reason", plan->expected.why, "expected_error_scan",
      json_number(plan->expected_scan), "expected_error_threshold", plan->expected_threshold,
      "pores", plan_pores_json(plan));
  if (object == NULL) return FAIL(STATUS_RUN, "the JSON object cannot be made");
  json_object_set_new(object, "levels", levels_json(plan));
  if (recommended != NULL)
    json_object_set_new(object, "cheapest", recommend_json(plan, recommended));
  json_dumpf(object, stdout, JSON_INDENT(2));
  putchar('\n');
  json_decref(object);
  return STATUS_OK;
}
