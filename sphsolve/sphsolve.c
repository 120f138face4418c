/* sphsolve: flow through pores and soil by smoothed particle hydrodynamics. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/interrupt.h"
#include "common/log.h"
#include "common/memory.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/output_guard.h"
#include "common/ranks.h"
#include "common/threads.h"
#include "sphsolve/plan/reynolds.h"
#include "sphsolve/explain.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/geometry/other_sides.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/output/recorder.h"
#include "sphsolve/output/run_print.h"
#include "sphsolve/output/tensor.h"
#include "sphsolve/scene/keys_print.h"
#include "sphsolve/scene/scene_read.h"
#include "sphsolve/error/cascade_add.h"

enum { RUN = 1u << 0, EXPLAIN = 1u << 1, KEYS = 1u << 2 };

static const struct option_entry entries[] = {
    {"output", 'o', "OUT", RUN, "OUT.hdf, OUT-NNNN.hdf (snapshots), OUT.ckpt.hdf"},
    {"set", 's', "PATH=VALUE", RUN | EXPLAIN, "overrides a key of the scene; may be repeated"},
    {"error", 0, "E", RUN | EXPLAIN,
     "wanted error of k, like 5%: lattices of its own choice, coarse ones first, until it is "
     "reached"},
    {"time", 0, "T", RUN, "the best k that this time allows, like 60s"},
    {"tensor", 0, NULL, RUN,
     "k along x, y and z: the tensor, with its principal axes (OUT-x.hdf, ... beside OUT.hdf)"},
    {"markdown", 0, NULL, KEYS, "as the page docs/reference/scene.md"},
    {"resume", 0, NULL, RUN, "go on from the last checkpoint, if there is one"},
    {0}};

static const struct option_command commands[] = {
    {"run", "SCENE.cfg -o OUT [--error E] [--time T] [--tensor] [--set path=value]... [--resume]",
     "runs a scene", "sphsolve run dense.cfg -o out/dense --set scene.end_time='0.3 s'", 1, 1},
    {"explain", "SCENE.cfg [--error E] [--set path=value]...",
     "says what a scene calls for, what it costs and how good it will be",
     "sphsolve explain dense.cfg", 1, 1},
    {"keys", "[--markdown]", "lists the keys of a scene file: unit, range, default, meaning",
     "sphsolve keys", 0, 0},
    {0}};

static const struct option_table table = {
    "sphsolve", "flow through pores and soil by smoothed particle hydrodynamics", commands,
    entries};

#define LONG_SECONDS 600.0 /* a predicted run time above this is announced */
#define OVERRIDES_MOST 256

struct job {
  bool tensor; /* one of three runs, along x, y and z */
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

/* Reads the scene with the overrides of --set, and one more unless `more` is NULL. */
static enum status read_scene(const struct options *options, const char *more,
                              struct scene *scene) {
  const char *overrides[OVERRIDES_MOST + 1], *override;
  size_t n = 0;
  while ((override = options_text_nth(options, "set", n)) != NULL) {
    if (n == OVERRIDES_MOST)
      return FAIL(STATUS_USAGE,
                  "--set: %d overrides are possible; write more of them into the scene",
                  OVERRIDES_MOST);
    overrides[n++] = override;
  }
  if (more != NULL) overrides[n++] = more;
  return scene_read(options_operand(options, 0), overrides, n, scene);
}

static enum status prepare(const struct options *options, const char *more, struct job *job) {
  enum status status = STATUS_OK;
  const struct method *method;
  char why[EFFECT_WHY];
  TRY(read_scene(options, more, &job->scene));
  job->scene.wants_slow_k = options_given(options, "error") || options_given(options, "time");
  TRY(lattice_build(&job->scene, plan_wall_layers(&job->scene), &job->lattice));
  if (job->tensor) TRY(lattice_mirror_flow(&job->scene, &job->lattice));
  TRY(lattice_apply_spacing(&job->scene, &job->lattice));
  TRY(plan_method(&job->scene, &job->lattice, &method, why));
  if (method->wall_layers != plan_wall_layers(&job->scene)) {
    /* A free surface, which is only found on the lattice, may require a method with other walls. */
    lattice_free(&job->lattice);
    TRY(lattice_build(&job->scene, method->wall_layers, &job->lattice));
    TRY(lattice_apply_spacing(&job->scene, &job->lattice));
  }
  if (method->walls_need_sites) TRY(thin_wall_fill(&job->lattice));
  TRY(plan_make(&job->scene, &job->lattice, method, why, thread_count(), &job->plan));
cleanup:
  return status;
}

/* Parses "5%" or 0.05. */
static enum status parse_wanted_error(const char *text, double *wanted) {
  char *end;
  *wanted = strtod(text, &end);
  if (end != text && *end == '%') {
    *wanted /= 100;
    end++;
  }
  if (end == text || *end != '\0' || !(*wanted > 0 && *wanted < 1))
    return FAIL(STATUS_USAGE, "--error %s: an error above 0 and below 100 %% is wanted, like 5%%%s",
                text, *end == ',' ? "; numbers take a point" : "");
  return STATUS_OK;
}

/* Whether --error and --time can choose the lattices of this run. */
static bool chooses_lattices(const struct job *job) {
  const struct method *method = job->plan.context.method;
  return method->solves_creeping && cascade_is_possible(&job->scene, &job->plan) &&
         method->wall(&job->scene) == WALL_SUBVOXEL && ranks_count() == 1;
}

/* Predicts the run time of the lattices that a goal is expected to need, in place of the scene's
 * own. */
static void predict_goal_seconds(struct plan *plan) {
  struct predicted_level levels[PREDICTED_LEVELS_MAX];
  const struct method *method = plan->context.method;
  const int count = method->levels != NULL ? method->levels(plan, PREDICTED_LEVELS_MAX, levels) : 0;
  if (count > 0) plan->seconds = PROGRAM_SECONDS + levels[count - 1].seconds / plan->threads;
  if (plan->goal.seconds > 0) plan->seconds = fmin(plan->seconds, plan->goal.seconds);
}

/* Reads the goals --error and --time into the plan. */
static enum status read_goal(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  struct accuracy_goal *goal = &job->plan.goal;
  const struct method *method = job->plan.context.method;
  if (options_given(options, "error"))
    TRY(parse_wanted_error(options_text(options, "error"), &goal->error));
  if (options_given(options, "time")) {
    TRY(options_quantity(options, "time", DIM_TIME, &goal->seconds));
    if (!(goal->seconds > 0)) TRY_FAIL(STATUS_USAGE, "--time: more than 0 s is wanted, like 60s");
    if (job->tensor) goal->seconds /= 3.0;
  }
  if (!(goal->error > 0 || goal->seconds > 0)) return STATUS_OK;
  if (!method->solves_creeping && method->resolves_pores)
    TRY(scene_error(
        &job->scene, AT_METHOD,
        "--error and --time are of method stokes, steady creeping flow; this scene runs by "
        "%s: %s; --set scene.method=stokes gives the k of slow flow",
        method->name, job->plan.method_why));
  if (!chooses_lattices(job))
    TRY_FAIL(STATUS_USAGE,
             "--error and --time choose lattices for steady creeping flow past resting subvoxel "
             "walls (method stokes) in one process; leave them out of this run");
  if (isfinite(job->scene.lattice_spacing))
    TRY(scene_error(&job->scene, AT_LATTICE,
                    "--error and --time choose the lattices; leave the spacing out"));
  predict_goal_seconds(&job->plan);
cleanup:
  return status;
}

/* Announces a long run before it begins, and a faster alternative if "auto" chose time integration
 * to a steady flow because inertia matters. */
static void announce_long_run(const struct job *job) {
  const struct method *method = job->plan.context.method;
  const bool chosen = job->scene.method == NULL && method->resolves_pores && method->marches &&
                      job->scene.steady_tolerance > 0 && job->plan.context.has_wall &&
                      !job->plan.context.has_moving_wall;
  char time[40];
  if (job->plan.goal.seconds > 0 || !(job->plan.seconds > LONG_SECONDS)) return;
  duration_format(job->plan.seconds, time, sizeof time);
  log_info("about %s by method %s%s%s%s", time, method->name, chosen ? ": " : "",
           chosen ? job->plan.method_why : "",
           chosen ? "; --set scene.method=stokes gives the k of slow flow, sooner" : "");
}

/* Refuses a run that is certain to exceed the memory limit before the coarser lattices are solved;
 * one that may fit is started. */
static enum status refuse_memory(const struct job *job) {
  enum status status = STATUS_OK;
  const struct plan *plan = &job->plan;
  const double most = plan->bytes_total - PROGRAM_BYTES, limit = memory_limit();
  const bool model = *job->scene.model_path;
  /* A coarser lattice keeps the wall distances of the model's own sites. */
  const double kept = sizeof(float) * (double)plan->context.lattice->model.count;
  double least = 0.0;
  char fits[120] = "a coarser spacing takes less";
  if (plan->context.method->bytes_least == NULL || ranks_count() > 1 || most <= limit ||
      plan->goal.error > 0 || plan->goal.seconds > 0)
    return STATUS_OK;
  TRY(plan->context.method->bytes_least(plan, &least));
  if (least <= limit) return STATUS_OK;
  /* Memory is proportional to the number of sites, except that the model is read as a whole. */
  if (model && MODEL_BYTES * (double)plan->context.lattice->model.count > limit)
    snprintf(fits, sizeof fits, "build the model with larger voxels (ct2model build --size)");
  else if (model)
    snprintf(fits, sizeof fits, "--set lattice.spacing='%.4g um' fits",
             1.001e6 * plan->context.spacing * cbrt(most / (limit - kept)));
  TRY_FAIL(STATUS_RUN,
           "%s: the run takes at least %.0f MB of memory (explain: %.0f MB at most), and %.0f MB "
           "are allowed; --max-memory sets that; %s",
           job->scene.path, least / 1e6, plan->bytes_total / 1e6, limit / 1e6, fits);
cleanup:
  return status;
}

/* The resolution error of a run that is not itself a cascade of lattices. */
static enum status finish_error(struct job *job, struct run_result *result) {
  return cascade_measure(
      &job->scene, &job->plan, &job->lattice,
      result->reynolds < REYNOLDS_CREEPING ? result->intrinsic_permeability : NAN, &result->error);
}

/* Runs a scene from its plan to its record. `tensor`: completed by this run and stored with it, or
 * NULL. */
static enum status run_scene(const struct options *options, struct job *job, const char *prefix,
                             struct tensor *tensor, int axis, struct run_result *result) {
  enum status status = STATUS_OK;
  struct recorder *recorder = NULL;
  *result = (struct run_result){.status = "failed",
                                .k = NAN,
                                .k_error = NAN,
                                .intrinsic_permeability = NAN,
                                .k_finest = NAN,
                                .inertia_from_gradient = NAN,
                                .error = uncertainty_none()};
  result->finer_by = chooses_lattices(job)    ? "--error"
                     : *job->scene.model_path ? "lattice.spacing"
                                              : "domain.spacing";
  TRY(read_goal(options, job));
  TRY(refuse_memory(job));
  TRY(recorder_open(prefix, &job->scene, &job->plan, &job->lattice, options_command_line(options),
                    options_given(options, "resume"), &recorder));
  log_verbose("method %s", job->plan.method_why);
  announce_long_run(job);
  double started = clock_seconds();
  const struct method *method = job->plan.context.method;
  status = method->run(&job->scene, &job->plan, &job->lattice, recorder, result);
  const bool cascade = job->plan.goal.error > 0 || job->plan.goal.seconds > 0;
  if (status == STATUS_OK && result->k > 0 && !cascade && result->error.level_count < 2)
    status = finish_error(job, result);
  if (status == STATUS_INTERRUPTED && strcmp(result->status, "interrupted") != 0)
    error_context(status, "k is found and kept, but not the error of its lattice");
  if (status == STATUS_OK && result->k > 0 && isnan(result->error.steadiness))
    log_warning("k: whether the flow has settled is not known, and not in its error: let "
                "scene.end_time be longer");
  result->wall_time = clock_seconds() - started;
  if (status == STATUS_OK && tensor != NULL) {
    tensor_set_column(&job->scene, result->darcy_velocity, &result->error,
                      result->k_finest / result->k, axis, prefix, tensor);
    if (tensor_complete(tensor)) result->tensor = tensor;
  }
  /* An interrupted run also leaves a record; the method gives its message. */
  if (status == STATUS_OK || status == STATUS_INTERRUPTED) {
    enum status written = recorder_finish(recorder, result);
    if (status == STATUS_OK) status = written;
    char history[4096];
    snprintf(history, sizeof history, "%s.history.csv", prefix);
    if (written == STATUS_RUN && access(history, F_OK) == 0)
      error_context(status, "the history of the run is kept in %s", history);
  }
  if (status == STATUS_RUN &&
      isfinite(result->k)) { /* the disk is full at the end: print k at least */
    error_context(status, "k = %.4g cm/s (%.4g m^2) was found, but not all of its record kept",
                  100 * result->k, result->intrinsic_permeability);
    if (options_json(options)) (void)run_print_json(result);
  }
cleanup:
  recorder_close(recorder);
  return status;
}

/* Runs x, y and z in turn with the strength of the scene's own force, whose direction comes last:
 * OUT.hdf is its record, with the tensor; OUT-x.hdf etc. are those of the others. */
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
  /* Unwritable outputs are reported before the first direction is computed. */
  char path[4104];
  output_protect(own.path);
  if (*own.model_path) output_protect(own.model_path);
  snprintf(path, sizeof path, "%s.hdf", prefix);
  TRY(output_allow_kind(path, "/model", "a model"));
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
    *job = (struct job){.tensor = true};
    TRY(prepare(options, force, job));
    if (!job->plan.context.method->resolves_pores)
      TRY_FAIL(STATUS_USAGE,
               "--tensor is of flow through pores (methods stokes and wcsph), and "
               "this scene runs by %s: leave it out",
               job->plan.context.method->name);
    tensor_find_mirror(&job->lattice, axis, tensor);
    if (options_given(options, "error"))
      TRY(parse_wanted_error(options_text(options, "error"), &wanted));
    if (options_given(options, "resume"))
      found = tensor_read_column(&job->scene, &job->lattice, wanted, path, axis, tensor);
    log_info("direction %c%s%s", "xyz"[axis],
             job -> lattice.model.mirrored[axis]
                        ? ", mirrored along it: pores do not meet where the model repeats itself"
                        : "",
             found ? ": its record is there already" : "");
    /* Signals are checked here, as the next run starts without a pending one. */
    TRY(interrupt_look());
    if (!found || turn == 3) TRY(run_scene(options, job, path, tensor, axis, result));
  }
cleanup:
  scene_free(&own);
  return status;
}

/* Reads a scene; *found: it uses a flow that is already solved. */
static enum status find_flow(const struct options *options, struct job *job, bool *found) {
  static const char *const others[] = {"time", "tensor"};
  enum status status = STATUS_OK;
  TRY(read_scene(options, NULL, &job->scene));
  *found = *job->scene.flow_path;
  for (size_t i = 0; i < sizeof others / sizeof *others && *found; i++)
    if (options_given(options, others[i]))
      TRY_FAIL(STATUS_USAGE,
               "--%s is of a scene that solves a flow; %s takes one that is solved: leave it out",
               others[i], job->scene.path);
  if (*found && options_given(options, "error"))
    TRY(parse_wanted_error(options_text(options, "error"), &job->scene.solute.error));
  if (!*found) scene_free(&job->scene);
cleanup:
  return status;
}

static enum status run(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  bool on_flow;
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
  const char *slash = strrchr(prefix, '/'), *name = slash != NULL ? slash + 1 : prefix;
  if (!*name || !strcmp(name, ".") || !strcmp(name, ".."))
    return FAIL(STATUS_USAGE,
                "run: -o '%s' is a folder: the name that the files begin with is wanted, like "
                "%.*sout",
                given, (int)(name - prefix), prefix);
  TRY(find_flow(options, job, &on_flow));
  if (on_flow)
    return job->scene.method->run_on_flow(&job->scene, prefix, options_given(options, "resume"),
                                          options_command_line(options), options_json(options));
  if (options_given(options, "tensor")) {
    TRY(run_tensor(options, job, prefix, &tensor, &result));
  } else {
    TRY(prepare(options, NULL, job));
    TRY(run_scene(options, job, prefix, NULL, 0, &result));
  }
  double wanted = INFINITY;
  if (options_given(options, "error"))
    TRY(parse_wanted_error(options_text(options, "error"), &wanted));
  if (options_json(options))
    TRY(run_print_json(&result));
  else if (log_level() > LOG_QUIET)
    run_print(&result, prefix, wanted, *job->scene.model_path);
cleanup:
  return status;
}

static enum status explain(const struct options *options, struct job *job) {
  enum status status = STATUS_OK;
  struct recommendation recommended = {0};
  bool wanted = options_given(options, "error"), on_flow;
  TRY(find_flow(options, job, &on_flow));
  if (on_flow)
    return job->scene.method->explain_on_flow(&job->scene, thread_count(), options_json(options));
  if (wanted) TRY(parse_wanted_error(options_text(options, "error"), &recommended.wanted));
  TRY(prepare(options, NULL, job));
  TRY(plan_find_path(&job->plan));
  wanted = wanted && !job->plan.blocked;
  job->plan.goal.error = recommended.wanted;
  if (wanted) TRY(recommend_find(&job->plan, &recommended));
  if (options_json(options)) {
    TRY(explain_print_json(&job->plan, wanted ? &recommended : NULL));
  } else {
    explain_print(&job->plan);
    if (wanted) recommend_print(&job->plan, &recommended);
  }
cleanup:
  return status;
}

static enum status keys(const struct options *options) {
  if (options_json(options)) return keys_print_json();
  if (options_given(options, "markdown"))
    keys_print_markdown(stdout);
  else
    keys_print(stdout);
  return STATUS_OK;
}

int main(int argc, char **argv) {
  threads_wait_asleep(argv);
  ranks_start(&argc, &argv);
  struct options *options = NULL;
  static struct job job;
  bool done;
  enum status status = options_parse(&table, argc, argv, &options, &done);
  if (ranks_own() > 0) log_start(log_program(), LOG_QUIET);
  if (status == STATUS_OK && !done) {
    const char *command = options_command(options);
    status = !strcmp(command, "run")       ? run(options, &job)
             : !strcmp(command, "explain") ? explain(options, &job)
                                           : keys(options);
  }
  if (status == STATUS_OK) status = output_flush();
  lattice_free(&job.lattice);
  scene_free(&job.scene);
  options_free(options);
  return ranks_end(status);
}
