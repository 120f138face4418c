/* sphsolve: flow through pores and soil by smoothed particle hydrodynamics. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/log.h"
#include "common/memory.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/ranks.h"
#include "common/threads.h"
#include "sphsolve/plan/recommend.h"
#include "sphsolve/plan/explain.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/output/tensor.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/stokes/cascade.h"

enum { RUN = 1u << 0, EXPLAIN = 1u << 1 };

static const struct option_entry entries[] = {
    {"output", 'o', "OUT", RUN, "OUT.hdf, OUT-NNNN.hdf (snapshots), OUT.ckpt.hdf"},
    {"set", 's', "PATH=VALUE", RUN | EXPLAIN, "overrides a key of the scene; may be repeated"},
    {"error", 0, "E", RUN | EXPLAIN,
     "wanted error of k, like 5%: lattices of its own choice, coarse ones first, until it is "
     "reached"},
    {"time", 0, "T", RUN, "the best k that this time allows, like 60s"},
    {"tensor", 0, NULL, RUN,
     "k along x, y and z: the tensor, with its principal axes (OUT-x.hdf, ... beside OUT.hdf)"},
    {"ranks", 0, "N", EXPLAIN, "predicts memory and time on N ranks of --threads each"},
    {"resume", 0, NULL, RUN, "go on from the last checkpoint, if there is one"},
    {0}};

static const struct option_command commands[] = {
    {"run", "SCENE.cfg -o OUT [--error E] [--time T] [--tensor] [--set path=value]... [--resume]",
     "runs a scene", "sphsolve run dense.cfg -o out/dense --set scene.end_time='0.3 s'", 1, 1},
    {"explain", "SCENE.cfg [--error E] [--ranks N] [--set path=value]...",
     "says what a scene calls for, what it costs and how good it will be",
     "sphsolve explain dense.cfg", 1, 1},
    {0}};

static const struct option_table table = {
    "sphsolve", "flow through pores and soil by smoothed particle hydrodynamics", commands,
    entries};

/* Below it inertia changes k by less than a thousandth (its share goes with the square). */
#define REYNOLDS_CREEPING 0.1

#define RANKS_MOST 10000000

struct job {
  int directions; /* that --time is shared by; 0: one */
  struct scene scene;
  struct lattice lattice;
  struct plan plan;
};

static int thread_count(void) {
#ifdef _OPENMP
  return omp_get_max_threads();
#else
  return 1;
#endif
}

/* The scene with --set, and with one more override unless that is NULL. */
static enum status read_scene(const struct options *options, const char *more,
                              struct scene *scene) {
  const char *overrides[257];
  size_t n = 0;
  while (n < 256 && options_text_nth(options, "set", n) != NULL) {
    overrides[n] = options_text_nth(options, "set", n);
    n++;
  }
  if (more != NULL) overrides[n++] = more;
  return scene_read(options_operand(options, 0), overrides, n, scene);
}

static enum status prepare(const struct options *options, const char *more, struct job *job) {
  enum status status = STATUS_OK;
  const struct method *method;
  char why[EFFECT_WHY];
  TRY(read_scene(options, more, &job->scene));
  TRY(lattice_build(&job->scene, plan_wall_layers(&job->scene), &job->lattice));
  TRY(lattice_take_spacing(&job->scene, &job->lattice));
  TRY(plan_method(&job->scene, &job->lattice, &method, why));
  if (method->wall_layers != plan_wall_layers(&job->scene)) {
    /* A free surface, seen only on the lattice, may call for a method with other walls. */
    lattice_free(&job->lattice);
    TRY(lattice_build(&job->scene, method->wall_layers, &job->lattice));
    TRY(lattice_take_spacing(&job->scene, &job->lattice));
  }
  TRY(plan_make(&job->scene, &job->lattice, method, why, thread_count(), &job->plan));
cleanup:
  return status;
}

static json_t *number_or_null(double value) {
  return isfinite(value) ? json_real(value) : json_null();
}

static json_t *error_json(const struct uncertainty *b) {
  return json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:s}",
      "resolution", number_or_null(b->resolution), "scan", number_or_null(b->scan), "sides",
      number_or_null(b->sides), "void_ratio", number_or_null(b->void_ratio), "threshold",
      number_or_null(b->threshold), "averaging", number_or_null(b->averaging), "steadiness",
      number_or_null(b->steadiness), "total", number_or_null(uncertainty_largest(b)),
      "model_voxels", number_or_null(b->model), "observed_order", number_or_null(b->order),
      "extrapolated_permeability", number_or_null(b->extrapolated), "finest_permeability",
      number_or_null(b->finest), "dlnk_dvoid_ratio", number_or_null(b->slope_void_ratio),
      "dlnk_sides_closed", number_or_null(b->sides_closed), "dlnk_blurred_again",
      number_or_null(b->slope_blur), "dlnk_dthreshold", number_or_null(b->slope_threshold),
      "resolution_needs", resolution_needs_names[b->needs]);
}

/* Of the cascade, coarsest first; k in m/s by the factor from m^2. */
static json_t *levels_json(const struct uncertainty *b, double to_speed) {
  json_t *list = json_array();
  for (int i = 0; i < b->level_count; i++) {
    const struct error_level *l = &b->levels[i];
    json_array_append_new(
        list, json_pack("{s:f, s:f, s:f, s:o, s:o, s:f, s:I, s:f}", "spacing", l->spacing, "k",
                        to_speed * l->permeability, "estimate", to_speed * l->estimate, "low",
                        number_or_null(l->low), "high", number_or_null(l->high), "sites", l->sites,
                        "iterations", (json_int_t)l->iterations, "seconds", l->seconds));
  }
  return list;
}

/* How far the conservation budget does not close; null where a method keeps no such budget. */
static json_t *conservation_json(const struct conservation *conservation) {
  double open[3] = {0}, energy_open, momentum = NAN, energy = NAN;
  if (conservation->budget.on != 0) {
    momentum = budget_momentum_open(&conservation->budget, open);
    energy = budget_energy_open(&conservation->budget, &energy_open);
  }
  return json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "particles_lost",
      number_or_null(conservation->known ? (double)conservation->lost : NAN), "particles_open",
      number_or_null(conservation->known ? (double)conservation_particles_open(conservation) : NAN),
      "mass_open", number_or_null(conservation->known ? conservation_mass_open(conservation) : NAN),
      "momentum_open_share", number_or_null(momentum), "energy_open_share", number_or_null(energy),
      "force_open", number_or_null(conservation->steady ? conservation->force_open : NAN),
      "power_open", number_or_null(conservation->steady ? conservation->power_open : NAN),
      "flux_open", number_or_null(conservation->steady ? conservation->flux_open : NAN));
}

static enum status print_json(const struct run_result *result) {
  double low, high;
  uncertainty_total(&result->error, &low, &high);
  json_t *object = json_pack(
      "{s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:[o,o,o], s:o, s:I, s:f, s:o, s:o, s:s, s:o}", "k",
      number_or_null(result->k), "k_low", number_or_null(result->k * (1 - fmin(low, 1))), "k_high",
      number_or_null(result->k * (1 + high)), "k_finest", number_or_null(result->k_finest),
      "k_relative_error", number_or_null(fmax(low, high)), "error", error_json(&result->error),
      "levels", levels_json(&result->error, result->k / result->intrinsic_permeability),
      "intrinsic_permeability", number_or_null(result->intrinsic_permeability), "darcy_velocity",
      number_or_null(result->darcy_velocity[0]), number_or_null(result->darcy_velocity[1]),
      number_or_null(result->darcy_velocity[2]), "reynolds", number_or_null(result->reynolds),
      "steps", (json_int_t)result->steps, "wall_time", result->wall_time, "pair_interactions",
      number_or_null(result->pair_interactions), "pair_interactions_per_second",
      number_or_null(result->pair_interactions_per_second), "status", result->status, "ledger",
      conservation_json(&result->conservation));
  if (object == NULL) return FAIL(STATUS_RUN, "the JSON object cannot be made");
  if (result->tensor != NULL) json_object_set_new(object, "tensor", tensor_json(result->tensor));
  json_dumpf(object, stdout, JSON_INDENT(2) | JSON_PRESERVE_ORDER);
  putchar('\n');
  json_decref(object);
  return STATUS_OK;
}

static void print_part(const char *what, double share) {
  if (isfinite(share)) printf("%s %.*g %%", what, share < 1 ? 2 : 3, 100 * share);
}

/* The parts of the error, and how the resolution's was found. */
static void print_uncertainty(const struct uncertainty *b) {
  printf("error     ");
  print_part(" resolution", b->resolution);
  if (!isfinite(b->resolution)) printf(" resolution not counted");
  print_part(", scan", b->scan);
  print_part(", sides", b->sides);
  print_part(", averaging", b->averaging > 0 ? b->averaging : NAN);
  print_part(", steadiness", b->steadiness > 1e-5 ? b->steadiness : NAN);
  print_part(", void ratio", b->void_ratio > 1e-5 ? b->void_ratio : NAN);
  print_part(", threshold", b->threshold);
  putchar('\n');
  if (b->level_count > 1) {
    const struct error_level *finest = &b->levels[b->level_count - 1];
    printf("           resolution: from %d lattices, the finest of %.4g um (%.3g M sites), which "
           "alone "
           "says %.4g m^2",
           b->level_count, 1e6 * finest->spacing, 1e-6 * finest->sites, b->finest);
    print_part("; the model's voxels leave", b->model);
    putchar('\n');
  }
  if (isfinite(b->sides_closed) && log_level() >= LOG_VERBOSE)
    printf("           in a tube with the sample's sides k is %.2g times as large (solved)\n",
           exp(b->sides_closed));
  if (isfinite(b->slope_void_ratio) && log_level() >= LOG_VERBOSE) {
    printf("           0.01 of void ratio moves k by %.2g %% (solved)", b->slope_void_ratio);
    print_part(", one grey level of the threshold by", b->slope_threshold);
    putchar('\n');
  }
}

/* What takes most of the error, and what lessens it. */
static void print_verdict(const struct uncertainty *b) {
  static const char *const finer[] = {
      [NEEDS_LATTICE] = "a finer lattice lessens it (--error)",
      [NEEDS_MODEL] = "a model with smaller voxels lessens it (ct2model build --size)",
      [NEEDS_SCAN] = "a scan with smaller voxels lessens it"};
  const struct {
    double share;
    const char *what, *remedy;
  } parts[] = {{b->resolution, "resolution", finer[b->needs]},
               {b->scan, "the scan", "a sharper scan lessens it"},
               {b->sides, "the sample's sides", "a larger sample lessens it"},
               {b->void_ratio, "the model's void ratio", "build it nearer to the measured one"},
               {b->threshold, "the measured void ratio", "measure it more precisely"},
               {b->averaging, "averaging", "a longer run lessens it"},
               {b->steadiness, "what still changes", "a longer run lessens it"}};
  size_t most = 0;
  const double total = uncertainty_largest(b);
  for (size_t i = 1; i < sizeof parts / sizeof *parts; i++)
    if (parts[i].share > parts[most].share || isnan(parts[most].share)) most = i;
  if (!(parts[most].share > 0) || !(total > 0)) return;
  printf("verdict    known to %.2g %%; most of it is %s: %s\n", 100 * total, parts[most].what,
         parts[most].remedy);
}

static void print_result(const struct run_result *result, const char *prefix) {
  char error[120] = "";
  double low, high;
  uncertainty_total(&result->error, &low, &high);
  const double largest = fmax(low, high);
  const char *from = result->error.level_count > 1        ? ""
                     : isfinite(result->error.resolution) ? " (resolution as expected beforehand)"
                                                          : " (resolution not counted)";
  if (isfinite(result->k) && largest > 1e-5)
    snprintf(error, sizeof error, " +- %.*g %% (%.4g to %.4g)%s", largest < 1 ? 2 : 3,
             100 * largest, 100 * result->k * (1 - fmin(low, 1)), 100 * result->k * (1 + high),
             from);
  else if (isfinite(result->k) && largest > 0)
    snprintf(error, sizeof error, " +- under 0.001 %%%s", from);
  printf("status     %s after %lld steps, %.1f s\n", result->status, (long long)result->steps,
         result->wall_time);
  if (isfinite(result->k)) {
    printf("k          %.4g cm/s%s\n", 100 * result->k, error);
    print_uncertainty(&result->error);
    printf("           %.4g m/s, %.4g m^2\n", result->k, result->intrinsic_permeability);
  }
  if (isfinite(result->k) && log_level() >= LOG_VERBOSE) {
    printf("Darcy      %.4g, %.4g, %.4g m/s (superficial: volume-averaged over pores and grains)\n",
           result->darcy_velocity[0], result->darcy_velocity[1], result->darcy_velocity[2]);
    printf("Reynolds   %.3g\n", result->reynolds);
  }
  if (result->tensor != NULL) tensor_print(result->tensor);
  if (isfinite(result->k)) print_verdict(&result->error);
  if (result->pair_interactions_per_second > 0 && log_level() >= LOG_VERBOSE)
    printf("pairs      %.3g M per second\n", 1e-6 * result->pair_interactions_per_second);
  conservation_print(&result->conservation);
  printf("files      %s.hdf", prefix);
  for (int a = 0; a < 3 && result->tensor != NULL; a++) {
    const char *path = result->tensor->columns[a].path;
    if (path[strlen(prefix)] == '-') printf(", %s", path);
  }
  printf("\nnext       analyze report %s.hdf -o %s.html\n", prefix, prefix);
}

/* "5%" or 0.05. */
static enum status parse_error(const char *text, double *wanted) {
  char *end;
  *wanted = strtod(text, &end);
  if (end != text && *end == '%') {
    *wanted /= 100;
    end++;
  }
  if (end == text || *end != '\0' || !(*wanted > 0 && *wanted < 1))
    return FAIL(STATUS_USAGE, "--error %s: an error above 0 and below 100 %% is wanted, like 5%%",
                text);
  return STATUS_OK;
}

/* --error and --time, into the plan. */
static enum status take_goal(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  struct accuracy_goal *goal = &job->plan.goal;
  const struct method *method = job->plan.context.method;
  if (options_given(options, "error"))
    TRY(parse_error(options_text(options, "error"), &goal->error));
  if (options_given(options, "time")) {
    TRY(options_quantity(options, "time", DIM_TIME, &goal->seconds));
    if (!(goal->seconds > 0)) TRY_FAIL(STATUS_USAGE, "--time: more than 0 s is wanted, like 60s");
    if (job->directions > 0) goal->seconds /= job->directions;
  }
  if (!(goal->error > 0 || goal->seconds > 0)) return STATUS_OK;
  if (!method->solves_creeping && method->resolves_pores)
    TRY(scene_error(
        &job->scene, AT_METHOD,
        "--error and --time are of method stokes, steady creeping flow; this scene runs by "
        "%s: %s; --set scene.method=stokes gives the k of slow flow",
        method->name, job->plan.method_why));
  if (!method->solves_creeping || !cascade_is_possible(&job->scene, &job->plan) ||
      method->wall(&job->scene) != WALL_SUBVOXEL || ranks_count() > 1)
    TRY_FAIL(STATUS_USAGE,
             "--error and --time choose lattices for steady creeping flow past resting subvoxel "
             "walls (method stokes) in one process; leave them out of this run");
  if (isfinite(job->scene.lattice_spacing))
    TRY(scene_error(&job->scene, AT_LATTICE,
                    "--error and --time choose the lattices; leave the spacing out"));
cleanup:
  return status;
}

/* The resolution of a run that is no cascade of lattices itself. */
static enum status finish_error(struct job *job, struct run_result *result) {
  return cascade_measure(
      &job->scene, &job->plan, &job->lattice,
      result->reynolds < REYNOLDS_CREEPING ? result->intrinsic_permeability : NAN, &result->error);
}

/* A scene from its plan to its record. `tensor`: to be completed by this run, and kept with it. */
static enum status run_scene(const struct options *options, struct job *job, const char *prefix,
                             struct tensor *tensor, int axis, struct run_result *result) {
  enum status status = STATUS_OK;
  struct recorder *recorder = NULL;
  *result = (struct run_result){.status = "failed",
                                .k = NAN,
                                .k_error = NAN,
                                .intrinsic_permeability = NAN,
                                .k_finest = NAN,
                                .error = uncertainty_none()};
  TRY(take_goal(options, job));
  TRY(recorder_open(prefix, &job->scene, &job->plan, &job->lattice, options_command_line(options),
                    options_given(options, "resume"), &recorder));
  log_verbose("method %s", job->plan.method_why);
  double started = clock_seconds();
  const struct method *method = job->plan.context.method;
  status = method->run(&job->scene, &job->plan, &job->lattice, recorder, result);
  if (status == STATUS_OK && result->k > 0 && result->error.level_count < 2)
    status = finish_error(job, result);
  result->wall_time = clock_seconds() - started;
  if (status == STATUS_OK && tensor != NULL) {
    tensor_take(&job->scene, result->darcy_velocity, &result->error, result->k_finest / result->k,
                axis, prefix, tensor);
    if (tensor_complete(tensor)) result->tensor = tensor;
  }
  /* An interrupted run leaves its record too; its message is the method's. */
  if (status == STATUS_OK || status == STATUS_INTERRUPTED) {
    enum status written = recorder_finish(recorder, result);
    if (status == STATUS_OK) status = written;
  }
  if (status == STATUS_RUN &&
      isfinite(result->k)) { /* a full disk at the end: k is worth keeping */
    error_context(status, "k = %.4g cm/s (%.4g m^2) was found, but not all of its record kept",
                  100 * result->k, result->intrinsic_permeability);
    if (options_json(options)) (void)print_json(result);
  }
cleanup:
  recorder_close(recorder);
  return status;
}

/* x, y and z in turn, by the strength of the scene's own force, which comes last: OUT.hdf is its
 * record, with the tensor; OUT-x.hdf and the like are those of the others. */
static enum status run_tensor(const struct options *options, struct job *job, const char *prefix,
                              struct tensor *tensor, struct run_result *result) {
  enum status status = STATUS_OK;
  struct scene own = {0};
  int last = 0;
  double strength = 0, wanted = 0;
  TRY(read_scene(options, NULL, &own));
  for (int a = 0; a < 3; a++) {
    strength = hypot(strength, own.driving[a]);
    if (fabs(own.driving[a]) >= fabs(own.driving[last])) last = a;
  }
  if (own.dimensions != 3)
    TRY_FAIL(STATUS_USAGE, "--tensor: this scene has two dimensions; three directions are wanted");
  if (!(strength > 0))
    TRY_FAIL(STATUS_USAGE, "--tensor: nothing drives the flow; give force.body_acceleration, whose "
                           "strength is taken along x, y and z");
  /* What may not be written is found before the first direction is paid for. */
  char path[4104];
  output_protect(own.path);
  if (*own.model_path) output_protect(own.model_path);
  snprintf(path, sizeof path, "%s.hdf", prefix);
  TRY(output_allow(path));
  for (int turn = 1; turn <= 3; turn++) {
    const int axis = (last + turn) % 3;
    char force[200], part[3][40] = {"\"0\"", "\"0\"", "\"0\""};
    bool found = false;
    snprintf(part[axis], sizeof part[axis], "\"%.10g m/s^2\"",
             axis == last ? copysign(strength, own.driving[axis]) : strength);
    snprintf(force, sizeof force, "force={body_acceleration=[%s,%s,%s];}", part[0], part[1],
             part[2]);
    snprintf(path, sizeof path, axis == last ? "%s" : "%s-%c", prefix, "xyz"[axis]);
    lattice_free(&job->lattice);
    scene_free(&job->scene);
    *job = (struct job){0};
    TRY(prepare(options, force, job));
    if (!job->plan.context.method->resolves_pores)
      TRY_FAIL(STATUS_USAGE,
               "--tensor is of flow through pores (methods stokes and wcsph), and "
               "this scene runs by %s: leave it out",
               job->plan.context.method->name);
    if (turn == 1) tensor_look(&job->lattice, tensor);
    job->directions = 3;
    if (options_given(options, "error")) TRY(parse_error(options_text(options, "error"), &wanted));
    if (options_given(options, "resume"))
      found = tensor_find(&job->scene, &job->lattice, wanted, path, axis, tensor);
    log_info("direction %c%s", "xyz"[axis], found ? ": its record is there already" : "");
    if (!found || turn == 3) TRY(run_scene(options, job, path, tensor, axis, result));
  }
cleanup:
  scene_free(&own);
  return status;
}

static enum status run(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  struct run_result result;
  static struct tensor tensor;
  char prefix[4096];
  const char *given = options_text(options, "output");
  if (given == NULL) return FAIL(STATUS_USAGE, "run: -o OUT is missing: where the results go");
  /* "-o out.hdf" means the same as "-o out". */
  const size_t length = strlen(given);
  const bool ending = length > 4 && !strcmp(given + length - 4, ".hdf");
  if (length >= sizeof prefix)
    return FAIL(STATUS_USAGE, "-o: the name of the output files is too long");
  snprintf(prefix, sizeof prefix, "%.*s", (int)(ending ? length - 4 : length), given);
  if (options_given(options, "tensor")) {
    TRY(run_tensor(options, job, prefix, &tensor, &result));
  } else {
    TRY(prepare(options, NULL, job));
    TRY(run_scene(options, job, prefix, NULL, 0, &result));
  }
  if (options_json(options))
    TRY(print_json(&result));
  else if (log_level() > LOG_QUIET)
    print_result(&result, prefix);
cleanup:
  return status;
}

static enum status explain(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  struct recommendation recommended = {0};
  struct ranks_forecast forecast, *ranks = NULL;
  long long count = 0;
  bool wanted = options_given(options, "error");
  if (wanted) TRY(parse_error(options_text(options, "error"), &recommended.wanted));
  TRY(prepare(options, NULL, job));
  if (options_given(options, "ranks")) {
    TRY(options_integers(options, "ranks", ',', 1, &count));
    if (count < 1 || count > RANKS_MOST)
      TRY_FAIL(STATUS_USAGE, "--ranks %lld: 1 to %d are possible", count, RANKS_MOST);
    ranks = &forecast;
    ranks_forecast(&job->plan, (int)count, thread_count(), ranks);
  }
  if (wanted)
    TRY(recommend_find(&job->scene, &job->lattice, &job->plan, thread_count(), &recommended));
  if (options_json(options)) {
    TRY(explain_print_json(&job->plan, ranks, wanted ? &recommended : NULL));
  } else {
    explain_print(&job->plan, ranks);
    if (wanted) recommend_print(&job->plan, &recommended);
  }
cleanup:
  return status;
}

int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  ranks_start(&argc, &argv);
  struct options *options = NULL;
  static struct job job;
  bool done;
  enum status status = options_parse(&table, argc, argv, &options, &done);
  if (ranks_own() > 0) log_start(log_program(), LOG_QUIET);
  if (status == STATUS_OK && !done)
    status = !strcmp(options_command(options), "run") ? run(options, &job) : explain(options, &job);
  if (status == STATUS_OK) status = output_flush();
  lattice_free(&job.lattice);
  scene_free(&job.scene);
  options_free(options);
  return ranks_end(status);
}
