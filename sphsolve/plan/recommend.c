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
static double refinement(const struct pore_shape *shape, const struct method *method,
                         enum wall_scheme wall, double wanted) {
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

static enum status add_candidate(const struct scene *scene, const struct lattice *lattice,
                                 const struct method *method, enum wall_scheme wall, int threads,
                                 struct recommendation *recommended) {
  enum status status = STATUS_OK;
  struct scene other = *scene;
  struct plan plan;
  struct candidate *c = &recommended->candidates[recommended->count];
  other.wcsph.wall = other.stokes.wall = wall;
  if (plan_make(&other, lattice, method, "", threads, &plan) != STATUS_OK) {
    error_clear(); /* this method cannot run the scene */
    return STATUS_OK;
  }
  double refined = refinement(&plan.shape, method, wall, recommended->wanted / ERROR_SAFETY_FACTOR);
  if (isnan(refined)) return STATUS_OK;
  size_t body[3];
  for (int a = 0; a < 3; a++)
    body[a] = *scene->model_path
                  ? lattice->size[a]
                  : (size_t)fmax(1.0, round(scene->domain_size[a] / lattice->spacing[a]));
  refined = whole_sites(scene, body, refined);
  *c = (struct candidate){.method = method, .wall = wall, .refined = refined};
  for (int a = 0; a < 3; a++)
    c->size[a] = body[a] == 1 ? 1 : (size_t)fmax(1.0, round(refined * (double)body[a]));
  c->spacing = plan.context.spacing / refined;
  c->support = plan.context.support / refined;
  c->error = error_forecast_of(&plan.shape, method, wall, refined).error;
  const double more = pow(refined, lattice->dimensions);
  /* Sound speed and steps of wcsph at that spacing: viscosity limits dt by the square of the
   * spacing, sound by the spacing; the time for a pore to become steady does not depend on it. */
  double steps = 1.0;
  if (plan.context.sound_speed > 0) {
    steps = plan.dt_power > 1 ? refined * refined : refined;
    c->sound_speed = plan.context.sound_speed;
    /* auto: at least 2 nu / h */
    const double creep = 2.0 * plan.context.kinematic_viscosity / plan.context.smoothing_length;
    if (isnan(scene->wcsph.sound_speed)) c->sound_speed = fmax(c->sound_speed, creep * refined);
  }
  c->seconds = PROGRAM_SECONDS + (plan.seconds - PROGRAM_SECONDS) * more * steps;
  c->bytes = PROGRAM_BYTES + (plan.bytes_total - PROGRAM_BYTES) * more;
  recommended->count++;
  return status;
}

enum status recommend_find(const struct scene *scene, const struct lattice *lattice,
                           const struct plan *plan, int threads,
                           struct recommendation *recommended) {
  enum status status = STATUS_OK;
  recommended->count = 0;
  if (!plan->context.method->resolves_pores || !isfinite(plan->expected.error))
    TRY_FAIL(STATUS_INPUT, "%s: --error: the error of this scene cannot be predicted: %s",
             scene->path, *plan->expected.why ? plan->expected.why : "it has no permeability");
  for (int wall = WALL_FROZEN; wall <= WALL_SUBVOXEL; wall++) {
    /* A method without inertia only where "auto" or the scene selected it. */
    for (size_t m = 0; methods_all[m] != NULL; m++)
      if (methods_all[m]->resolves_pores &&
          (!methods_all[m]->solves_creeping || methods_all[m] == plan->context.method))
        TRY(add_candidate(scene, lattice, methods_all[m], (enum wall_scheme)wall, threads,
                          recommended));
  }
  for (size_t i = 1; i < recommended->count; i++) {
    struct candidate moved = recommended->candidates[i];
    size_t j = i;
    for (; j > 0 && recommended->candidates[j - 1].seconds > moved.seconds; j--)
      recommended->candidates[j] = recommended->candidates[j - 1];
    recommended->candidates[j] = moved;
  }
cleanup:
  return status;
}

static void print_candidate(const struct candidate *c) {
  char spacing[40], support[40], time[40], error[32];
  quantity_format(c->spacing, "m", spacing, sizeof spacing);
  quantity_format(c->support, "m", support, sizeof support);
  duration_format(c->seconds, time, sizeof time);
  printf("%s, %s walls, spacing %s (%zu x %zu x %zu points), support %s", c->method->name,
         wall_scheme_names[c->wall], spacing, c->size[0], c->size[1], c->size[2], support);
  if (c->sound_speed > 0) printf(", sound %.4g m/s", c->sound_speed);
  printf(": error about %s %%, %s, %.0f MB\n", percent_format(c->error, error), time,
         c->bytes / 1e6);
}

/* Longest acceptable time, s. */
#define SECONDS_MAX (30.0 * 86400.0)
#define BEYOND_TEXT ": over 30 days, or over the %.0f MB of memory here"

static bool is_within_reach(const struct candidate *c) {
  return c->seconds <= SECONDS_MAX && c->bytes <= memory_limit();
}

void recommend_print(const struct plan *plan, const struct recommendation *recommended) {
  const struct scene *scene = plan->context.scene;
  printf(
      "\nwanted     %.3g %%: by settings from which half of it is expected, for expectations are "
      "good to a factor %g\n",
      100 * recommended->wanted, ERROR_SAFETY_FACTOR);
  if (recommended->count == 0) {
    printf("cheapest   none: no setting up to %g times finer reaches it; extrapolate with analyze "
           "converge\n",
           REFINEMENT_MAX);
    return;
  }
  const struct candidate *best = &recommended->candidates[0];
  size_t beyond = 0;
  printf("cheapest   ");
  print_candidate(best);
  if (!is_within_reach(best))
    printf("           not within reach" BEYOND_TEXT "; lattices and their errors above are\n",
           1e-6 * memory_limit());
  for (size_t i = 1; i < recommended->count; i++) {
    if (!is_within_reach(&recommended->candidates[i])) {
      beyond++;
      continue;
    }
    printf("      then ");
    print_candidate(&recommended->candidates[i]);
  }
  if (beyond > 0 && is_within_reach(best))
    printf("           %zu more not within reach" BEYOND_TEXT "\n", beyond, 1e-6 * memory_limit());
  printf("write      --set scene.method=%s --set %s.wall=%s", best->method->name,
         best->method->name, wall_scheme_names[best->wall]);
  if (*scene->model_path)
    printf(", with a model of %zu x %zu x %zu points (ct2model build --size; a mirrored axis takes "
           "(n + 1) / 2)\n",
           best->size[0], best->size[1], best->size[2]);
  else
    printf(" --set domain.spacing='%.6g m'\n", best->spacing);
}

json_t *recommend_json(const struct recommendation *recommended) {
  json_t *list = json_array();
  for (size_t i = 0; i < recommended->count; i++) {
    const struct candidate *c = &recommended->candidates[i];
    json_array_append_new(list, json_pack("{s:s, s:s, s:f, s:f, s:[I,I,I], s:f, s:f, s:f, s:f}",
                                          "method", c->method->name, "wall",
                                          wall_scheme_names[c->wall], "spacing", c->spacing,
                                          "support", c->support, "size", (json_int_t)c->size[0],
                                          (json_int_t)c->size[1], (json_int_t)c->size[2],
                                          "sound_speed", c->sound_speed, "expected_error", c->error,
                                          "seconds", c->seconds, "memory_bytes", c->bytes));
  }
  return json_pack("{s:f, s:o}", "wanted", recommended->wanted, "settings", list);
}
