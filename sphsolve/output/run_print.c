#include "sphsolve/output/run_print.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/json_number.h"
#include "common/log.h"
#include "common/units.h"
#include "sphsolve/output/conservation.h"
#include "sphsolve/output/tensor.h"
#include "sphsolve/error/uncertainty.h"
#include "sphsolve/plan/reynolds.h"

static json_t *error_json(const struct uncertainty *u) {
  return json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, "
      "s:o, s:s, s:o}",
      "resolution", json_number(u->resolution), "scan", json_number(u->scan), "sides",
      json_number(u->sides), "void_ratio", json_number(u->void_ratio), "threshold",
      json_number(u->threshold), "micro", json_number(u->micro), "averaging",
      json_number(u->averaging), "steadiness", json_number(u->steadiness), "total",
      json_number(uncertainty_largest(u)), "model_voxels", json_number(u->model), "critical_width",
      json_number(u->critical_width), "observed_order", json_number(u->order),
      "extrapolated_permeability", json_number(u->extrapolated), "finest_permeability",
      json_number(u->finest), "dlnk_dvoid_ratio", json_number(u->slope_void_ratio),
      "dlnk_sides_closed", json_number(u->sides_closed), "dlnk_blurred_again",
      json_number(u->slope_blur), "dlnk_dthreshold", json_number(u->slope_threshold),
      "dlnk_dlnk_micro", json_number(u->slope_micro), "resolution_needs",
      resolution_needs_names[u->needs], "blur_assumed", json_number(u->blur_assumed));
}

/* Lattices of the cascade, coarsest first; `to_speed`: factor from m^2 to m/s. */
static json_t *levels_json(const struct uncertainty *u, double to_speed) {
  json_t *list = json_array();
  for (int i = 0; i < u->level_count; i++) {
    const struct error_level *l = &u->levels[i];
    json_array_append_new(
        list, json_pack("{s:f, s:f, s:f, s:o, s:o, s:f, s:I, s:f}", "spacing", l->spacing, "k",
                        to_speed * l->permeability, "estimate", to_speed * l->estimate, "low",
                        json_number(l->low), "high", json_number(l->high), "sites", l->sites,
                        "iterations", (json_int_t)l->iterations, "seconds", l->seconds));
  }
  return list;
}

/* Errors of the conservation budget; null if the method has no such budget. */
static json_t *conservation_json(const struct conservation *conservation) {
  double open[3] = {0}, energy_open, momentum = NAN, energy = NAN;
  if (conservation->budget.on != 0) {
    momentum = budget_momentum_open(&conservation->budget, open);
    energy = budget_energy_open(&conservation->budget, &energy_open);
  }
  return json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "particles_lost",
      json_number(conservation->known ? (double)conservation->lost : NAN), "particles_open",
      json_number(conservation->known ? (double)conservation_particles_open(conservation) : NAN),
      "mass_open", json_number(conservation->known ? conservation_mass_open(conservation) : NAN),
      "momentum_open_share", json_number(momentum), "energy_open_share", json_number(energy),
      "force_open", json_number(conservation->steady ? conservation->force_open : NAN),
      "power_open", json_number(conservation->steady ? conservation->power_open : NAN), "flux_open",
      json_number(conservation->steady ? conservation->flux_open : NAN));
}

enum status run_print_json(const struct run_result *result) {
  double low, high, low_image, high_image;
  uncertainty_total(&result->error, &low, &high);
  uncertainty_of_image(&result->error, &low_image, &high_image);
  json_t *object = json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:[o,o,o], s:o, s:I, s:f, s:o, s:o, "
      "s:s, s:o}",
      "k", json_number(result->k), "k_low", json_number(result->k * (1 - fmin(low, 1))), "k_high",
      json_number(result->k * (1 + high)), "k_low_image",
      json_number(result->k * (1 - fmin(low_image, 1))), "k_high_image",
      json_number(result->k * (1 + high_image)), "inertia_from_gradient",
      json_number(result->inertia_from_gradient), "k_finest", json_number(result->k_finest),
      "k_relative_error", json_number(fmax(low, high)), "error", error_json(&result->error),
      "levels", levels_json(&result->error, result->k / result->intrinsic_permeability),
      "intrinsic_permeability", json_number(result->intrinsic_permeability), "darcy_velocity",
      json_number(result->darcy_velocity[0]), json_number(result->darcy_velocity[1]),
      json_number(result->darcy_velocity[2]), "reynolds", json_number(result->reynolds), "steps",
      (json_int_t)result->steps, "wall_time", result->wall_time, "pair_interactions",
      json_number(result->pair_interactions), "pair_interactions_per_second",
      json_number(result->pair_interactions_per_second), "status", result->status, "ledger",
      conservation_json(&result->conservation));
  if (object == NULL) return FAIL(STATUS_RUN, "the JSON object cannot be made");
  if (result->tensor != NULL) json_object_set_new(object, "tensor", tensor_json(result->tensor));
  if (result->micropores.sites > 0)
    json_object_set_new(object, "micro", micropores_json(&result->micropores));
  json_dumpf(object, stdout, JSON_INDENT(2) | JSON_PRESERVE_ORDER);
  putchar('\n');
  json_decref(object);
  return STATUS_OK;
}

static void print_part(const char *what, double share) {
  char text[32];
  if (isfinite(share)) printf("%s %s %%", what, percent_format(share, text));
}

/* Prints the parts of the error, and how that of the resolution was found. */
static void print_uncertainty(const struct uncertainty *u, bool scanned) {
  printf("error     ");
  print_part(" resolution", u->resolution);
  if (!isfinite(u->resolution)) printf(" resolution not counted");
  print_part(", scan", u->scan);
  if (isfinite(u->blur_assumed)) printf(" (blur assumed)");
  if (scanned && isnan(u->scan)) printf(", scan not counted (unknown)");
  print_part(", sides", u->sides);
  if (u->sides_unknown > 0) printf(", sides not counted (unknown)");
  print_part(", averaging", u->averaging > 0 ? u->averaging : NAN);
  print_part(", steadiness", u->steadiness > 1e-5 ? u->steadiness : NAN);
  print_part(", void ratio", u->void_ratio > 1e-5 ? u->void_ratio : NAN);
  print_part(", threshold", u->threshold);
  print_part(", soil below the voxel", u->micro);
  putchar('\n');
  char text[32];
  if (u->level_count > 1) {
    const struct error_level *finest = &u->levels[u->level_count - 1];
    printf("           resolution: from %d lattices, the finest of %.4g um (%.3g M points), which "
           "alone "
           "says %.4g m^2",
           u->level_count, 1e6 * finest->spacing, 1e-6 * finest->sites, u->finest);
    print_part("; the model's voxels leave", u->model);
    print_part("; the narrowest ways leave", u->critical_width > 1e-3 ? u->critical_width : NAN);
    putchar('\n');
  }
  if (isfinite(u->blur_assumed))
    printf("           the scan told no blur, as no surface stands alone in it: one of %.3g um is "
           "assumed\n",
           1e6 * u->blur_assumed);
  if (isfinite(u->void_ratio) && isfinite(u->slope_void_ratio) && isnan(u->threshold))
    printf("           the void ratio was given without its +-: each 0.01 is %s %% of k, not "
           "counted\n",
           percent_format(0.01 * fabs(u->slope_void_ratio), text));
  if (isfinite(u->sides_closed) && log_level() >= LOG_VERBOSE)
    printf("           in a tube with the sample's sides k changes by %+.2g %% (solved)\n",
           100.0 * expm1(u->sides_closed));
  if (isfinite(u->slope_void_ratio) && log_level() >= LOG_VERBOSE) {
    printf("           0.01 of void ratio moves k by %s %% (solved)",
           percent_format(0.01 * u->slope_void_ratio, text));
    print_part(", one grey level of the threshold by", u->slope_threshold);
    putchar('\n');
  }
}

/* Prints the interval of k of the image by itself, where that with its sides is wider by this
 * factor. */
#define SIDES_TOLD 1.05
static void print_image(const struct run_result *result) {
  char text[32];
  double low, high;
  uncertainty_of_image(&result->error, &low, &high);
  if (!(uncertainty_largest(&result->error) > SIDES_TOLD * fmax(low, high))) return;
  printf(
      "image      %.4g cm/s +- %s %% (%.4g to %.4g): of this image by itself; as a sample of its "
      "material, sides included, as above\n",
      100 * result->k, percent_format(fmax(low, high), text), 100 * result->k * (1 - fmin(low, 1)),
      100 * result->k * (1 + high));
}

/* From which gradient on inertia takes a twentieth of k; said where the scene's is above it. */
static void print_inertia(const struct run_result *result, double gradient) {
  if (!(result->inertia_from_gradient > 0.0)) return;
  if (gradient > result->inertia_from_gradient || log_level() >= LOG_VERBOSE)
    printf("inertia    from a gradient of %.2g on it lowers the conductivity by over %g %% "
           "(estimated, Ergun 1952); k is that of slow flow\n",
           result->inertia_from_gradient, 100.0 * INERTIA_SHARE);
}

/* Errors below this are not printed as numbers. */
#define ERROR_NONE 1e-5
/* A finer lattice is recommended if it leaves at most this fraction of the error. */
#define LATTICE_HELPS 0.9

/* Prints the largest part of the error and its remedy. */
static void print_verdict(const struct uncertainty *u, const char *finer_by) {
  char lattice[80];
  snprintf(lattice, sizeof lattice, "a finer lattice lessens it (%s)", finer_by);
  const char *const finer[] = {[NEEDS_LATTICE] = lattice,
                               [NEEDS_MODEL] =
                                   "a model with smaller voxels lessens it (ct2model build --size)",
                               [NEEDS_SCAN] = "a scan with smaller voxels lessens it"};
  const bool measured = isfinite(u->void_ratio);
  const struct {
    double share;
    const char *what, *remedy;
  } parts[] = {{u->resolution, "resolution", finer[u->needs]},
               {u->scan, "the scan", "a finer or sharper scan lessens it"},
               {u->sides, "the sample's sides",
                "a larger sample lessens it; mirrored at its sides "
                "(ct2model build --sides mirrored) it has none"},
               {u->void_ratio, "the model's void ratio", "build it nearer to the measured one"},
               {u->threshold, measured ? "the measured void ratio" : "the threshold",
                measured ? "measure it more precisely" : "measure the void ratio"},
               {u->micro, "the permeability of soil below the voxel", "measure it more precisely"},
               {u->averaging, "averaging", "a longer run lessens it"},
               {u->steadiness, "what still changes", "a longer run lessens it"}};
  size_t most = 0;
  const double total = uncertainty_largest(u);
  for (size_t i = 1; i < sizeof parts / sizeof *parts; i++)
    if (parts[i].share > parts[most].share || isnan(parts[most].share)) most = i;
  if (!(parts[most].share > 0) || !(total > ERROR_NONE)) return;
  print_part("verdict    known to", total);
  printf("%s%s; most of it is %s: %s\n", isfinite(u->resolution) ? "" : ", resolution not counted",
         u->sides_unknown > 0 ? ", sides not counted" : "", parts[most].what, parts[most].remedy);
  /* The possible improvement by a finer lattice in spite of this part. */
  struct uncertainty rest = *u;
  rest.resolution = rest.resolution_low = rest.resolution_high = 0.0;
  const double left = uncertainty_largest(&rest);
  if (most > 0 && u->needs == NEEDS_LATTICE && left < LATTICE_HELPS * total) {
    printf("           a finer lattice (%s)", finer_by);
    print_part(" takes it to", left);
    printf(" at best, where %s binds\n", parts[most].what);
  }
}

void run_print(const struct run_result *result, const char *prefix, double wanted, bool scanned) {
  char error[120] = "", text[32];
  double low, high;
  uncertainty_total(&result->error, &low, &high);
  const double largest = fmax(low, high);
  const char *from = result->error.level_count > 1        ? ""
                     : isfinite(result->error.resolution) ? " (of one lattice alone)"
                                                          : " (resolution not counted)";
  if (isfinite(result->k) && largest > ERROR_NONE)
    snprintf(error, sizeof error, " +- %s %% (%.4g to %.4g)%s", percent_format(largest, text),
             100 * result->k * (1 - fmin(low, 1)), 100 * result->k * (1 + high), from);
  else if (isfinite(result->k) && largest > 0)
    snprintf(error, sizeof error, " +- under 0.001 %%%s", from);
  const bool budget = !strcmp(result->status, "budget") && result->ended != NULL;
  printf("status     %s%s%s%s after %lld %s, %.1f s\n", result->status, budget ? ": " : "",
         !budget            ? ""
         : isfinite(wanted) ? "short of the error asked for"
                            : result->ended,
         budget ? "," : "", (long long)result->steps, result->iterates ? "iterations" : "steps",
         result->wall_time);
  if (isfinite(result->k)) {
    printf("k          %.4g cm/s%s\n", 100 * result->k, error);
    print_image(result);
    print_uncertainty(&result->error, scanned);
    print_inertia(result, result->gradient);
    printf("           %.4g m/s, %.4g m^2\n", result->k, result->intrinsic_permeability);
  }
  if (isfinite(result->k) && log_level() >= LOG_VERBOSE) {
    printf("Darcy      %.4g, %.4g, %.4g m/s (superficial: volume-averaged over pores and grains)\n",
           result->darcy_velocity[0], result->darcy_velocity[1], result->darcy_velocity[2]);
    printf("Reynolds   %.3g\n", result->reynolds);
  }
  if (result->tensor != NULL) tensor_print(result->tensor);
  if (isfinite(result->k) && result->micropores.sites > 0) micropores_print(&result->micropores);
  if (isfinite(result->k)) print_verdict(&result->error, result->finer_by);
  if (result->k > 0 && largest > wanted) {
    char asked[32], reached[32];
    printf("           the error asked for, %s %%, was not reached", percent_format(wanted, asked));
    if (!strcmp(asked, percent_format(largest, reached))) printf(" (%.4g %%)", 100.0 * largest);
    printf(": %s\n", result->ended != NULL ? result->ended : "the parts named above are more");
  }
  if (result->pair_interactions_per_second > 0 && log_level() >= LOG_VERBOSE)
    printf("pairs      %.3g M per second\n", 1e-6 * result->pair_interactions_per_second);
  conservation_print(&result->conservation);
  printf("files      %s.hdf", prefix);
  for (int a = 0; a < 3 && result->tensor != NULL; a++) {
    const char *path = result->tensor->columns[a].path;
    if (path[strlen(prefix)] == '-') printf(", %s", path);
  }
  /* Quoted so that it can be copied into a shell. */
  const char *quote = strpbrk(prefix, " \t\"$`&;|()<>*?[!#~\\") != NULL ? "'" : "";
  printf("\nnext       analyze report %s%s.hdf%s -o %s%s.html%s\n", quote, prefix, quote, quote,
         prefix, quote);
}
