#include "sphsolve/output/recorder_state.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "common/constants.h"
#include "common/hdf5_table.h"
#include "common/memory.h"
#include "common/provenance.h"
#include "common/ranks.h"
#include "common/snapshot_file.h"
#include "common/units.h"
#include "sphsolve/output/checkpoint_file.h"
#include "sphsolve/output/tensor.h"
#include "sphsolve/plan/constants.h"
#include "sphsolve/plan/method.h"

static enum status write_history(struct recorder *recorder, struct h5_file *file) {
  enum status status = STATUS_OK;
  double *values = NULL;
  TRY(memory_allocate(&values, recorder->row_count * 3, sizeof *values, "the history"));
  TRY(h5_make_group(file, "/history"));
  for (size_t c = 0; c < recorder->column_count; c++) {
    const struct column *column = &recorder->columns[c];
    size_t shape[2] = {recorder->row_count, (size_t)column->components};
    char name[64];
    for (size_t r = 0; r < recorder->row_count; r++)
      memcpy(values + r * shape[1], recorder->rows + r * (size_t)recorder->width + column->first,
             shape[1] * sizeof *values);
    snprintf(name, sizeof name, "/history/%s", column->name);
    TRY(h5_write(file, name, H5_F64, column->components > 1 ? 2 : 1, shape, values, true));
    TRY(h5_write_attribute_text(file, name, "unit", column->unit));
  }
cleanup:
  memory_free(&values);
  return status;
}

/* Writes the effects, and in /run/timing all measured times and all results that depend on threads:
 * besides the time in /provenance nothing else differs between two runs of the same inputs. */
static enum status write_effects(struct recorder *recorder, const struct run_result *result,
                                 struct h5_file *file) {
  enum status status = STATUS_OK;
  const struct plan *plan = recorder->plan;
  const size_t count = plan->effect_count, timings = recorder->timing_count;
  const struct named_value *timing = recorder->timings;
  struct effect_row {
    const char *name, *state, *reason, *model, *citation;
  } rows[EFFECT_MAX];
  for (size_t i = 0; i < count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    const struct effect *effect = planned->effect;
    rows[i] = (struct effect_row){effect->name, planned->on ? "on" : "off", planned->why,
                                  effect->model, effect->citation};
  }
  const struct h5_column columns[] = {{"name", 0, H5_TEXT_AT, &rows->name},
                                      {"state", 0, H5_TEXT_AT, &rows->state},
                                      {"reason", 0, H5_TEXT_AT, &rows->reason},
                                      {"model", 0, H5_TEXT_AT, &rows->model},
                                      {"citation", 0, H5_TEXT_AT, &rows->citation}};
  const struct h5_column passes[] = {{"name", 0, H5_TEXT, &timing->name},
                                     {"seconds", H5_F64, 1, &timing->value}};
  TRY(h5_write_columns(file, "/run/effects", count, sizeof *rows, 5, columns));
  TRY(h5_make_group(file, "/run/timing"));
  TRY(h5_write_columns(file, "/run/timing", timings, sizeof *timing, 2, passes));
  TRY(h5_write_attribute(file, "/run/timing", "wall_time", H5_F64, 1, &result->wall_time));
  TRY(h5_write_attribute(file, "/run/timing", "pair_interactions_per_second", H5_F64, 1,
                         &result->pair_interactions_per_second));
  int threads = 1;
#ifdef _OPENMP
  threads = omp_get_max_threads();
#endif
  TRY(h5_write_attribute(file, "/run/timing", "threads", H5_I32, 1, &threads));
  TRY(h5_write_attribute(file, "/run/timing", "predicted_seconds", H5_F64, 1,
                         &recorder->plan->seconds));
  /* The peak depends on the threads, as these decide which lists are long at the same time. */
  const double peak = (double)memory_peak();
  TRY(h5_write_attribute(file, "/run/timing", "memory_peak_bytes", H5_F64, 1, &peak));
  for (size_t i = 0; i < recorder->measured_count; i++)
    TRY(h5_write_attribute(file, "/run/timing", recorder->measured[i].name, H5_F64, 1,
                           &recorder->measured[i].value));
cleanup:
  return status;
}

static enum status write_number(struct h5_file *file, const char *name, double value) {
  return h5_write_attribute(file, "/run", name, H5_F64, 1, &value);
}

static enum status write_count(struct h5_file *file, const char *name, uint64_t value) {
  return h5_write_attribute(file, "/run", name, H5_U64, 1, &value);
}

/* Coefficients of the steady flow law along x and z: permeabilities in m/s, and b of i = v / K + b
 * v |v| (Darcy, Forchheimer); NAN for soil that does not follow such a law along the axes. */
static void find_flow_law(const struct scene *scene, const struct region *region,
                          double permeability, double law[3]) {
  const double e = region->porosity, *v = region->soil_velocity;
  const bool turned = region->anisotropic && region->anisotropy[2] != 0;
  const bool moves = v[0] != 0 || v[1] != 0 || v[2] != 0;
  law[0] = law[1] = law[2] = NAN;
  if (turned || moves || scene->isph.form == FORM_M15) return;
  law[0] = permeability * (region->anisotropic ? region->anisotropy[0] : 1);
  law[1] = permeability * (region->anisotropic ? region->anisotropy[5] : 1);
  law[2] = region->beta > 0
               ? region->beta * (1 - e) / (e * e * e * region->grain_size * GRAVITY_STANDARD)
               : 0;
}

/* Writes the regions of the scene, for the analysis of flow in soil and at walls. */
static enum status write_regions(const struct scene *scene, struct h5_file *file) {
  enum status status = STATUS_OK;
  const size_t n = scene->region_count;
  const double nu = scene->fluid.viscosity / scene->fluid.density;
  struct {
    const char *type, *name;
    uint64_t number;
    double box[6], porosity, permeability, law[3], head;
  } *rows = NULL;
  if (n == 0) return STATUS_OK;
  TRY(memory_allocate(&rows, n, sizeof *rows, "the regions"));
  for (size_t k = 0; k < n; k++) {
    const struct region *region = &scene->regions[k];
    const double e = region->porosity, d = region->grain_size;
    const bool soil = region->type == REGION_POROUS;
    rows[k].type = region_type_names[region->type];
    rows[k].name = region->name;
    rows[k].number = region->number;
    memcpy(rows[k].box, region->box, sizeof region->box);
    rows[k].porosity = soil ? e : NAN;
    rows[k].permeability =
        soil ? GRAVITY_STANDARD * e * e * e * d * d / (region->alpha * nu * (1 - e) * (1 - e))
             : NAN;
    for (int a = 0; a < 3; a++) rows[k].law[a] = NAN;
    if (soil) find_flow_law(scene, region, rows[k].permeability, rows[k].law);
    const bool held = (region->type == REGION_INFLOW && region->boundary == BOUNDARY_HEAD) ||
                      region->type == REGION_DRAIN;
    rows[k].head = held && region->table.count == 0 ? region->head : NAN;
  }
  const struct h5_column columns[] = {{"type", 0, H5_TEXT_AT, &rows->type},
                                      {"name", 0, H5_TEXT_AT, &rows->name},
                                      {"number", H5_U64, 1, &rows->number},
                                      {"box", H5_F64, 6, rows->box},
                                      {"porosity", H5_F64, 1, &rows->porosity},
                                      {"permeability", H5_F64, 1, &rows->permeability},
                                      {"darcy_x_z_forchheimer", H5_F64, 3, rows->law},
                                      {"head", H5_F64, 1, &rows->head}};
  TRY(h5_write_columns(file, "/run/regions", n, sizeof *rows, 8, columns));
  TRY(h5_write_attribute(file, "/run/regions", "domain", H5_F64, 3, scene->domain_size));
  TRY(h5_write_attribute(file, "/run/regions", "gravity", H5_F64, 3, scene->gravity));
cleanup:
  memory_free(&rows);
  return status;
}

/* Writes the positions of the gauges, and of the planes whose fluxes are in the history. */
static enum status write_places(const struct scene *scene, struct h5_file *file) {
  enum status status = STATUS_OK;
  struct {
    const char *name;
    double at[2]; /* axis, position */
  } *planes = NULL;
  const struct gauge *gauges = scene->gauges;
  TRY(memory_allocate(&planes, scene->plane_count, sizeof *planes, "the places"));
  for (size_t k = 0; k < scene->plane_count; k++) {
    planes[k].name = scene->planes[k].name;
    planes[k].at[0] = scene->planes[k].axis, planes[k].at[1] = scene->planes[k].position;
  }
  if (scene->gauge_count > 0) {
    const struct h5_column columns[] = {{"name", 0, H5_TEXT, gauges->name},
                                        {"position", H5_F64, 3, gauges->at}};
    TRY(h5_write_columns(file, "/run/gauges", scene->gauge_count, sizeof *gauges, 2, columns));
  }
  if (scene->plane_count > 0) {
    const struct h5_column columns[] = {{"name", 0, H5_TEXT_AT, &planes->name},
                                        {"axis_position", H5_F64, 2, planes->at}};
    TRY(h5_write_columns(file, "/run/planes", scene->plane_count, sizeof *planes, 2, columns));
  }
cleanup:
  memory_free(&planes);
  return status;
}

static enum status write_run(struct recorder *recorder, const struct run_result *result,
                             struct h5_file *file) {
  enum status status = STATUS_OK;
  const struct scene *scene = recorder->scene;
  const struct lattice *lattice = recorder->lattice;
  const struct effect_context *context = &recorder->plan->context;
  char hash[17];
  snprintf(hash, sizeof hash, "%016llx", (unsigned long long)lattice->model.hash);
  int dimensions = lattice->dimensions;
  const bool *by_run = lattice->model.mirrored;
  const int mirrored[3] = {by_run[0], by_run[1], by_run[2]};
  uint64_t size[3] = {lattice->size[0], lattice->size[1], lattice->size[2]};
  /* The driving force of k: the body force, or the gradient between two heads. */
  const double *g = scene->gravity, *f = result->hydraulic_gradient;
  const double fall = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  const double strength = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  double driving[3];
  for (int a = 0; a < 3; a++)
    driving[a] = fall > 0 ? f[a] * (strength > 0 ? strength : GRAVITY_STANDARD) : scene->driving[a];
  TRY(h5_make_group(file, "/run"));
  TRY(h5_write_attribute_text(file, "/run", "method", context->method->name));
  TRY(h5_write_attribute_text(file, "/run", "status", result->status));
  TRY(h5_write_attribute_text(file, "/run", "scene_name", scene->name));
  TRY(h5_write_attribute_text(file, "/run", "wall", context->method->wall_name(scene)));
  TRY(h5_write_attribute_text(file, "/run", "kernel", kernel_names[context->kernel]));
  TRY(h5_write_attribute_text(file, "/run", "model_path", scene->model_path));
  TRY(h5_write_attribute_text(file, "/run", "model_hash", hash));
  TRY(flow_hash_write(file, "/run", recorder->flow_hash));
  double low, high;
  uncertainty_total(&result->error, &low, &high);
  TRY(write_number(file, "k", result->k));
  TRY(write_number(file, "k_low", result->k * (1 - fmin(low, 1))));
  TRY(write_number(file, "k_high", result->k * (1 + high)));
  uncertainty_of_image(&result->error, &low, &high);
  TRY(write_number(file, "k_low_image", result->k * (1 - fmin(low, 1))));
  TRY(write_number(file, "k_high_image", result->k * (1 + high)));
  uncertainty_total(&result->error, &low, &high);
  TRY(write_number(file, "inertia_from_gradient", result->inertia_from_gradient));
  TRY(write_number(file, "k_finest", result->k_finest));
  TRY(write_number(file, "k_error", fmax(low, high)));
  TRY(write_number(file, "k_solver_error", result->k_error));
  TRY(write_number(file, "intrinsic_permeability", result->intrinsic_permeability));
  TRY(write_number(file, "reynolds", result->reynolds));
  TRY(write_number(file, "hydraulic_gradient", fall > 0 ? fall : scene_hydraulic_gradient(scene)));
  TRY(write_number(file, "density", scene->fluid.density));
  TRY(write_number(file, "viscosity", scene->fluid.viscosity));
  TRY(write_number(file, "sound_speed", context->sound_speed));
  TRY(write_number(file, "support", context->support));
  TRY(write_number(file, "smoothing_length", context->smoothing_length));
  TRY(write_number(file, "predicted_error", recorder->plan->expected.error));
  TRY(write_number(file, "pair_interactions", result->pair_interactions));
  TRY(h5_write_attribute(file, "/run", "darcy_velocity", H5_F64, 3, result->darcy_velocity));
  TRY(h5_write_attribute(file, "/run", "driving", H5_F64, 3, driving));
  TRY(h5_write_attribute(file, "/run", "spacing", H5_F64, 3, lattice->spacing));
  TRY(h5_write_attribute(file, "/run", "origin", H5_F64, 3, lattice->origin));
  TRY(h5_write_attribute(file, "/run", "size", H5_U64, 3, size));
  TRY(h5_write_attribute(file, "/run", "dimensions", H5_I32, 1, &dimensions));
  TRY(h5_write_attribute(file, "/run", "mirrored", H5_I32, 3, mirrored));
  TRY(write_count(file, "steps", (uint64_t)result->steps));
  TRY(write_count(file, "bulk_count", (uint64_t)round(lattice->bulk_count)));
  TRY(write_count(file, "fluid_count", lattice->fluid_count));
  TRY(write_count(file, "wall_count", lattice->wall_count));
  for (size_t i = 0; i < recorder->fact_count; i++)
    TRY(write_number(file, recorder->facts[i].name, recorder->facts[i].value));
  TRY(write_effects(recorder, result, file));
  TRY(step_log_write(&recorder->step_log, file, "/run"));
  TRY(h5_write_text(file, "/run/scene", scene->text));
  const struct constant *tables[] = {common_constants, plan_constants,
                                     recorder->plan->context.method->constants};
  TRY(constants_write(file, sizeof tables / sizeof *tables, tables));
  TRY(write_regions(scene, file));
  TRY(write_places(scene, file));
  TRY(h5_write_texts(file, "/run/snapshots/name", recorder->snapshot_count,
                     (const char *const *)recorder->snapshot_names));
  TRY(h5_write(file, "/run/snapshots/time", H5_F64, 1, &recorder->snapshot_count,
               recorder->snapshot_times, false));
cleanup:
  return status;
}

static enum status write_solid(struct recorder *recorder, struct h5_file *file) {
  enum status status = STATUS_OK;
  const struct lattice *lattice = recorder->lattice;
  size_t shape[3] = {lattice->size[2], lattice->size[1], lattice->size[0]};
  uint8_t *solid = NULL;
  TRY(memory_allocate(&solid, lattice->count, 1, "the solid sites"));
  for (size_t i = 0; i < lattice->count; i++) solid[i] = lattice->kind[i] == SITE_WALL;
  TRY(h5_write(file, "/run/solid", H5_U8, 3, shape, solid, true));
cleanup:
  memory_free(&solid);
  return status;
}

static enum status integrate_history(const struct recorder *recorder,
                                     struct conservation *conservation) {
  enum status status = STATUS_OK;
  struct conservation_row *rows = NULL;
  const int mass = recorder_first_of(recorder, "mass"), p = recorder_first_of(recorder, "momentum"),
            energy = recorder_first_of(recorder, "kinetic_energy");
  TRY(memory_allocate(&rows, recorder->row_count, sizeof *rows, "the conservation budget"));
  for (size_t i = 0; i < recorder->row_count; i++) {
    const double *row = recorder->rows + i * (size_t)recorder->width;
    rows[i] =
        (struct conservation_row){row[0], row[mass], {row[p], row[p + 1], row[p + 2]}, row[energy]};
  }
  conservation_integrate(conservation, recorder->row_count, rows, recorder->scene->driving);
cleanup:
  memory_free(&rows);
  return status;
}

/* Whether the run cannot be continued; one that ended by its end time or budget can. */
static bool run_is_over(const struct run_result *result) {
  static const char *const over[] = {"steady", "converged", "blocked", "budget"};
  for (size_t i = 0; i < sizeof over / sizeof *over; i++)
    if (!strcmp(result->status, over[i])) return true;
  return false;
}

/* Removes the output of a run without a record: the single snapshot of its end and its companion
 * files, which would look like a complete run. Files needed by --resume stay, and so do snapshots
 * of several times. */
static void remove_orphan_snapshot(struct recorder *recorder) {
  static const char *const endings[] = {"-0000.hdf", "-image.hdf", ".hdf.series"};
  char path[4096];
  if (ranks_own() > 0 || recorder->snapshot_count != 1 ||
      access(recorder_checkpoint_name(recorder), F_OK) == 0)
    return;
  for (size_t i = 0; i < sizeof endings / sizeof *endings; i++) {
    snprintf(path, sizeof path, "%s%s", recorder->prefix, endings[i]);
    unlink(path);
  }
  if (!recorder->plan->context.method->marches) history_file_close(&recorder->history, true);
}

enum status recorder_finish(struct recorder *recorder, struct run_result *result) {
  enum status status = STATUS_OK;
  struct h5_file *file = NULL;
  char path[4096];
  const char *inputs[2] = {recorder->scene->path, recorder->scene->model_path};
  uint64_t hashes[2];
  progress_end(&recorder->progress);
  hashes[0] = hash_bytes(recorder->scene->text, strlen(recorder->scene->text));
  hashes[1] = recorder->lattice->model.hash;
  TRY(integrate_history(recorder, &result->conservation));
  snprintf(path, sizeof path, "%s.hdf", recorder->prefix);
  TRY(h5_create(path, &file));
  TRY(write_history(recorder, file));
  TRY(write_run(recorder, result, file));
  TRY(uncertainty_write(&result->error, result->k / result->intrinsic_permeability, file));
  TRY(conservation_write(&result->conservation, file));
  if (result->tensor != NULL) TRY(tensor_write(result->tensor, file));
  if (result->micropores.sites > 0) TRY(micropores_write(&result->micropores, file));
  TRY(write_solid(recorder, file));
  TRY(provenance_write(file, "sphsolve", recorder->command_line, *inputs[1] ? 2 : 1, inputs,
                       hashes));
  status = h5_commit(file);
  file = NULL;
  if (status != STATUS_OK) goto cleanup;
  history_file_close(&recorder->history, true);
  if (run_is_over(result)) checkpoint_remove(recorder->prefix);
cleanup:
  h5_close(file);
  if (status == STATUS_RUN) remove_orphan_snapshot(recorder);
  return status;
}
