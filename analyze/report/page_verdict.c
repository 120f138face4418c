#include "analyze/report/page_verdict.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include "analyze/compatible_runs.h"
#include "analyze/product.h"
#include "common/hdf5_file.h"
#include "common/units.h"

static const double error_wanted = 0.05; /* relative error that the advice aims at */

static const char *string(const json_t *object, const char *key) {
  const char *text = json_string_value(json_object_get(object, key));
  return text != NULL ? text : "";
}

static const struct run *run_of(const struct run *runs, size_t n, const json_t *row) {
  const char *path = string(row, "path");
  for (size_t i = 0; i < n; i++)
    if (strcmp(runs[i].path, path) == 0) return &runs[i];
  return NULL;
}

/* Adds a result from a group of `darcy` or a series of `converge`; the spacing is that of its first
 * run. */
static void add_result(json_t *results, const struct run *runs, size_t n, const json_t *fit,
                       const char *name, const char *from) {
  const json_t *rows = json_object_get(fit, "runs");
  const struct run *run = run_of(runs, n, json_array_get(rows, 0));
  double k = json_number_or_nan(fit, "k_m_per_s"),
         relative = json_number_or_nan(fit, "k_relative_error");
  double low = k * fmax(0.0, 1.0 - relative), high = k * (1.0 + relative);
  double permeability = json_number_or_nan(fit, "intrinsic_permeability_m2");
  if (!isfinite(k) || run == NULL) return;
  if (json_array_size(rows) == 1 && isfinite(run->k_low) && isfinite(run->k_high)) {
    if (k != 0) permeability *= run->k / k; /* the best estimate and interval of the run itself */
    k = run->k;
    /* The error of the fit also includes what the history of the run shows. */
    const double own = fmax(run->k_high - k, k - run->k_low) / k;
    low = run->k_low;
    high = run->k_high;
    if (relative > 1.001 * own) {
      low = fmin(low, k * fmax(0.0, 1.0 - relative));
      high = fmax(high, k * (1.0 + relative));
    }
    relative = k > 0.0 ? fmax(high - k, k - low) / k : NAN;
  }
  json_t *result = json_pack(
      "{s:o,s:s,s:o,s:o,s:o,s:o,s:o,s:o,s:o,s:O?,s:O?}", "name", json_text(name), "from", from,
      "path", json_text(run->path), "k_m_per_s", json_number(k), "k_low_m_per_s", json_number(low),
      "k_high_m_per_s", json_number(high), "k_relative_error", json_number(relative),
      "intrinsic_permeability_m2", json_number(permeability), "spacing_m",
      json_number(run->spacing[0]), "error_budget", json_object_get(fit, "error_budget"),
      "dlnk_dvoid_ratio", json_object_get(fit, "dlnk_dvoid_ratio"));
  json_array_append_new(results, result);
  if (json_array_size(rows) == 1 && run->k_high_image > 0.0) {
    json_put_number(result, "k_low_image_m_per_s", run->k_low_image);
    json_put_number(result, "k_high_image_m_per_s", run->k_high_image);
  }
}

static bool contains_run(const json_t *fit, const json_t *row) {
  size_t i;
  const json_t *other;
  json_array_foreach(json_object_get(fit, "runs"), i, other) {
    if (strcmp(string(other, "path"), string(row, "path")) == 0) return true;
  }
  return false;
}

/* The group that is nothing but the run of a series whose own lattices give k with a smaller error
 * than the extrapolation over all spacings; NULL if there is none. */
static const json_t *better_single_run(const json_t *series, const json_t *groups) {
  const json_t *better = json_object_get(series, "better_run"), *group;
  size_t i;
  json_array_foreach(groups, i, group) {
    if (better != NULL && json_array_size(json_object_get(group, "runs")) == 1 &&
        contains_run(group, better))
      return group;
  }
  return NULL;
}

/* Whether all runs of a group are in a series that has a k. */
static bool covered(const json_t *group, const json_t *series) {
  size_t g, s;
  const json_t *row, *one;
  json_array_foreach(json_object_get(group, "runs"), g, row) {
    bool found = false;
    json_array_foreach(series, s, one) {
      found |= isfinite(json_number_or_nan(one, "k_m_per_s")) && contains_run(one, row);
    }
    if (!found) return false;
  }
  return true;
}

bool verdict_one_body(const struct run *a, const struct run *b) {
  int axis;
  return a->dimensions == b->dimensions && compatible_runs_same_body(a, b, &axis) &&
         fabs(b->fluid_count / b->bulk_count * a->bulk_count / a->fluid_count - 1.0) < 0.03;
}

/* Moves the result with the smallest error to the front, among those of the same body as the
 * first. */
static void put_best_first(json_t *results, const struct run *runs, size_t n) {
  const struct run *own = run_of(runs, n, json_array_get(results, 0));
  size_t i, best = 0;
  const json_t *result;
  double least = json_number_or_nan(json_array_get(results, 0), "k_relative_error");
  json_array_foreach(results, i, result) {
    const double error = json_number_or_nan(result, "k_relative_error");
    if (!isfinite(error) || error >= least || !verdict_one_body(own, run_of(runs, n, result)))
      continue;
    least = error;
    best = i;
  }
  if (best == 0) return;
  json_t *first = json_incref(json_array_get(results, best));
  json_array_remove(results, best);
  json_array_insert_new(results, 0, first);
}

json_t *verdict_results(const struct run *runs, size_t n, const json_t *darcy,
                        const json_t *converge) {
  json_t *results = json_array();
  const json_t *series = json_object_get(converge, "series"), *fit;
  const json_t *groups = json_object_get(darcy, "groups");
  size_t i;
  json_array_foreach(series, i, fit) {
    char name[300];
    const json_t *alone = better_single_run(fit, groups);
    if (alone != NULL) {
      add_result(results, runs, n, alone, string(alone, "name"), "lattices");
      continue;
    }
    const bool extrapolated = json_is_true(json_object_get(fit, "extrapolated"));
    snprintf(
        name, sizeof name, "%s of %zu (%.60s, %.60s walls)",
        extrapolated ? "Extrapolated to spacing 0, from the spacings" : "At the finest spacing",
        json_array_size(json_object_get(fit, "runs")), string(fit, "method"), string(fit, "wall"));
    add_result(results, runs, n, fit, name,
               extrapolated                                              ? "extrapolated"
               : json_is_true(json_object_get(fit, "spacings_too_near")) ? "too_near"
                                                                         : "scattered");
  }
  json_array_foreach(groups, i, fit) {
    if (!covered(fit, series))
      add_result(results, runs, n, fit, string(fit, "name"),
                 json_array_size(json_object_get(fit, "runs")) > 1 ? "gradients" : "");
  }
  if (json_array_size(results) > 1) put_best_first(results, runs, n);
  return results;
}

/* ---- assessment ---- */

static const char *good_for(double k, double relative) {
  if (k == 0)
    return "nothing leads through: at these voxels no pore joins the ends along the force";
  if (!(relative >= 0.0)) return "its error is not known";
  if (relative <= error_wanted) return "good enough to compare with a test on the specimen";
  if (relative <= 0.25) return "good enough to compare specimens, and to choose among formulas";
  if (relative < 1.0) return "good enough for its class and its order of magnitude";
  return "no more than an order of magnitude: do not publish it";
}

/* What k is good for; as that of this image and as that of its material, where these differ. */
static void judge_use(json_t *result) {
  const double k = json_number_or_nan(result, "k_m_per_s");
  const double low = json_number_or_nan(result, "k_low_image_m_per_s");
  const double high = json_number_or_nan(result, "k_high_image_m_per_s");
  const json_t *budget = json_object_get(result, "error_budget");
  /* A soil that the scene describes has no error but that of its lattice. */
  const bool known = isfinite(json_number_or_nan(budget, "resolution"));
  const char *material =
      good_for(k, known || k == 0 ? json_number_or_nan(result, "k_relative_error") : NAN);
  const char *image = known && low <= high ? good_for(k, fmax(high - k, k - low) / k) : material;
  char text[300];
  snprintf(text, sizeof text,
           strcmp(image, material) == 0 ? "%s" : "of this image: %s; of the material: %s", image,
           material);
  json_object_set_new(result, "good_for", json_string(text));
}

/* The parts of the error, and what reduces each of them. */
static const struct {
  const char *part, *remedy;
} remedies[] = {
    {"resolution", ""},
    {"scan", "a finer or sharper scan is needed"},
    {"sides", "a larger sample is needed, or one mirrored at its sides by ct2model build --sides "
              "mirrored"},
    {"void_ratio", "build the model nearer to the measured void ratio"},
    {"threshold", "measure the void ratio"},
    {"micro", "measure the permeability of the soil below the voxel more precisely"},
    {"averaging", "run longer"},
    {"steadiness", "run longer"}};

/* If the other parts reach this share of the wanted error, no affordable lattice can meet it. */
#define OTHER_PARTS_MAX 0.97

/* Advice for a run that was stopped: it has to be completed first. */
static bool judge_interrupted(json_t *result, const struct run *run) {
  if (run->status == NULL || strcmp(run->status, "interrupted") != 0 ||
      strcmp(run->path, string(result, "path")) != 0)
    return false;
  json_object_set_new(
      result, "advice",
      json_string("The run was interrupted: sphsolve run --resume goes on with it."));
  return true;
}

static void judge_advice(json_t *result, double scanned) {
  const json_t *parts = json_object_get(result, "error_budget");
  const char *needs = string(parts, "resolution_needs");
  const bool model = strcmp(needs, "model") == 0, scan = strcmp(needs, "scan") == 0;
  double resolution = json_number_or_nan(parts, "resolution"), rest = 0.0, most = 0.0;
  size_t largest = 0;
  char text[300] = "", one[32], all[32];
  if (json_number_or_nan(result, "k_m_per_s") == 0) {
    json_object_set_new(result, "advice",
                        json_string("Resolve the throats with smaller voxels, or look at the "
                                    "threshold."));
    return;
  }
  for (size_t i = 1; i < sizeof remedies / sizeof *remedies; i++) {
    const double part = json_number_or_nan(parts, remedies[i].part);
    if (!isfinite(part)) continue;
    rest += part * part;
    if (part > most) most = part, largest = i;
  }
  rest = sqrt(rest);
  const char *part = largest == 3 ? "void ratio" : remedies[largest].part;
  const bool more = largest == 4 && isfinite(json_number_or_nan(parts, "void_ratio"));
  if (isnan(resolution))
    snprintf(text, sizeof text,
             "The error of resolution is not known: run two more spacings and analyze converge.");
  else if (hypot(resolution, rest) <= error_wanted)
    text[0] = '\0';
  else if (rest >= OTHER_PARTS_MAX * error_wanted && rest < error_wanted && !scan)
    snprintf(
        text, sizeof text,
        "For 5 %%: %s%s; %s alone takes it only just below, to %s %% at best, where the %s binds.",
        remedies[largest].remedy, more ? " more precisely" : "",
        model ? "a model with smaller voxels" : "a finer lattice", percent_format(rest, all), part);
  else if (rest >= OTHER_PARTS_MAX * error_wanted)
    snprintf(text, sizeof text,
             most > 0.95 * rest ? "For 5 %%: %s%s%s (%s %% by the %s alone)."
                                : "For 5 %%: %s%s%s (%s %% by the %s, %s %% by all that no finer "
                                  "lattice lessens).",
             resolution <= rest ? ""
             : model            ? "a model with smaller voxels, and "
             : scan             ? "a scan with smaller voxels, and "
                                : "a finer lattice, and ",
             remedies[largest].remedy, more ? " more precisely" : "", percent_format(most, one),
             part, percent_format(rest, all));
  else {
    /* The index is proportional to the spacing squared. */
    const double finer = sqrt(resolution / sqrt(error_wanted * error_wanted - rest * rest));
    const double spacing = 1e6 * json_number_or_nan(result, "spacing_m");
    const int fine_digits = finer < 1.05 ? 3 : 2;
    char fine[32], own[32];
    if (!scan && spacing / finer < 0.99e6 * scanned)
      snprintf(text, sizeof text,
               "For 5 %%: a scan with voxels of about %s um; its own are %.4g um, the %s's %.4g.",
               short_number(spacing / finer, fine_digits, fine), 1e6 * scanned,
               model ? "model" : "lattice", spacing);
    else if (model || scan)
      snprintf(text, sizeof text, "For 5 %%: a %s with voxels of about %s um instead of %s.", needs,
               short_number(spacing / finer, fine_digits, fine), short_number(spacing, 3, own));
    else
      snprintf(text, sizeof text,
               "For 5 %%: refine the lattice from %s to about %s um, some %.*f times as many "
               "points.",
               short_number(spacing, 3, own), short_number(spacing / finer, fine_digits, fine),
               finer < 2 ? 1 : 0, finer * finer * finer);
  }
  json_object_set_new(result, "advice", json_string(text));
}

double verdict_scanned_voxel(const struct run *run) {
  struct h5_file *file = NULL;
  double voxel = NAN;
  if (run->model_file[0] != '\0' && h5_open(run->model_file, &file) == STATUS_OK)
    voxel = h5_attribute_or_nan(file, "/model", "voxel_scanned");
  error_clear();
  h5_close(file);
  return voxel;
}

void verdict_judge(json_t *results, const struct run *run, double scanned) {
  json_t *result = json_array_get(results, 0);
  if (result == NULL) return;
  judge_use(result);
  if (!judge_interrupted(result, run)) judge_advice(result, scanned);
}
