#include "sphsolve/plan/recommend.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"

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

#define SECONDS_MAX (30.0 * 86400.0) /* longest acceptable time, s */

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

json_t *recommend_json(const struct plan *plan, const struct recommendation *r) {
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
