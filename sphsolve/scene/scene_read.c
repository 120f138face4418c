#include "sphsolve/scene/scene_read.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/text.h"
#include "common/ranks.h"
#include "common/units.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_names.h"
#include "sphsolve/scene/scene_parts.h"
#include "sphsolve/scene/scene_regions.h"
#include "common/config.h"
#include "sphsolve/scene/scene.h"
#include "sphsolve/scene/scene_geometry.h"

/* Gauges and planes, at which a run is recorded. */

static enum status read_gauges(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config_root(config), "gauges");
  scene->gauge_count = config_count(list);
  TRY(memory_allocate(&scene->gauges, scene->gauge_count, sizeof *scene->gauges, "gauges"));
  for (size_t i = 0; i < scene->gauge_count; i++) {
    struct gauge *gauge = &scene->gauges[i];
    config_node *group = config_item(list, i);
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { at = [x, y, z]; } is wanted"));
    TRY(scene_read_name(config, group, "gauge", i + 1, gauge->name, sizeof gauge->name));
    TRY(keys_read(config, group, "gauges[]", 0, scene, gauge));
    for (int a = 0; a < 3; a++)
      if (gauge->at[a] < 0 || gauge->at[a] > scene->domain_size[a])
        TRY(config_error(config, config_child(group, "at"),
                         "%g m in %c lies outside the domain (0 to %g m)", gauge->at[a], 'x' + a,
                         scene->domain_size[a]));
    if (scene_in_wall(scene, gauge->at))
      TRY(config_error(config, config_child(group, "at"),
                       "lies inside a wall, where there is no pressure; move it into the water"));
    for (size_t k = 0; k < i; k++)
      if (!strcmp(scene->gauges[k].name, gauge->name))
        TRY(config_error(config, group, "a gauge before is called '%s' too; rename one",
                         gauge->name));
  }
cleanup:
  return status;
}

static enum status read_planes(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config_root(config), "planes");
  scene->plane_count = config_count(list);
  TRY(memory_allocate(&scene->planes, scene->plane_count, sizeof *scene->planes, "planes"));
  for (size_t i = 0; i < scene->plane_count; i++) {
    struct flux_plane *plane = &scene->planes[i];
    config_node *group = config_item(list, i);
    int axes_given = 0;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { z = \"0.2 m\"; } is wanted"));
    TRY(scene_read_name(config, group, "plane", i + 1, plane->name, sizeof plane->name));
    for (int a = 0; a < 3; a++) {
      bool given;
      TRY(config_quantity(config, group, scene_axis_names[a], DIM_LENGTH, &plane->position,
                          &given));
      if (given) plane->axis = a, axes_given++;
    }
    if (axes_given != 1)
      TRY(config_error(config, group, "one of x, y, z is wanted: the plane's position"));
    if (scene->dimensions == 2 && plane->axis == 1)
      TRY(config_error(config, config_child(group, "y"),
                       "a 2-D scene lives in x and z: give x or z"));
    if (plane->position < 0 || plane->position > scene->domain_size[plane->axis])
      TRY(config_error(config, config_child(group, scene_axis_names[plane->axis]),
                       "%g m lies outside the domain (0 to %g m)", plane->position,
                       scene->domain_size[plane->axis]));
    for (size_t k = 0; k < i; k++)
      if (!strcmp(scene->planes[k].name, plane->name))
        TRY(config_error(config, group, "a plane before is called '%s' too; rename one",
                         plane->name));
  }
cleanup:
  return status;
}

static enum status scene_read_probes(struct config *config, struct scene *scene) {
  enum status status = read_gauges(config, scene);
  return status == STATUS_OK ? read_planes(config, scene) : status;
}

/* A scene with a solute in a flow that is already solved. */

/* Rejects settings that are part of the solved flow: all groups but its own. */
static enum status refuse_other_groups(struct config *config) {
  static const char *const own[] = {"scene", "flow", "solute", "checkpoint"};
  for (size_t i = 0; i < config_count(config_root(config)); i++) {
    config_node *node = config_item(config_root(config), i);
    bool found = false;
    for (size_t k = 0; k < sizeof own / sizeof *own; k++)
      found = found || !strcmp(config_name(node), own[k]);
    if (!found)
      return config_error(config, node,
                          "a scene with flow = { file = ...; } takes a flow that is solved "
                          "already, with all of its settings; leave '%s' out",
                          config_name(node));
  }
  static const char *const times[] = {"end_time", "steady_tolerance"};
  config_node *scene = config_child(config_root(config), "scene");
  for (size_t i = 0; i < sizeof times / sizeof *times; i++)
    if (config_child(scene, times[i]) != NULL)
      return config_error(config, config_child(scene, times[i]),
                          "is of a scene that solves a flow; leave it out: a solute is followed "
                          "until its coefficients are known");
  return STATUS_OK;
}

static enum status read_peclet(struct config *config, config_node *group, struct scene *scene) {
  static const double decades[] = {0.1, 0.3, 1, 3, 10, 30, 100, 300, 1000};
  enum status status = STATUS_OK;
  bool given;
  TRY(config_quantities(config, group, "peclet", DIM_NONE, 1, SOLUTE_PECLET_MAX,
                        scene->solute.peclet, &scene->solute.peclet_count, &given));
  for (int i = 0; i < scene->solute.peclet_count; i++)
    if (!(scene->solute.peclet[i] >= 0 && scene->solute.peclet[i] <= 1e6))
      TRY(config_error(config, config_child(group, "peclet"),
                       "Peclet numbers from 0 (no flow) to 1e6 are possible, like [0.1, 1.0, "
                       "10.0]"));
  if (given || !isnan(scene->solute.diffusion)) goto cleanup;
  scene->solute.peclet_count = sizeof decades / sizeof *decades;
  memcpy(scene->solute.peclet, decades, sizeof decades);
cleanup:
  return status;
}

/* Reads the groups flow and solute; nothing where the scene has neither. */
static enum status scene_read_solute(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config);
  config_node *flow = config_child(root, "flow");
  config_node *group = config_child(root, "solute");
  if (flow == NULL && (group != NULL || scene->method == &method_solute))
    return config_error(config, group,
                        "a solute needs a flow that is solved already; write flow = { file = "
                        "\"run.hdf\"; }, the OUT.hdf of a run of method stokes");
  if (flow == NULL) return STATUS_OK;
  if (scene->method != NULL && scene->method != &method_solute)
    return config_error(config, config_child(config_child(root, "scene"), "method"),
                        "solves a flow, and this scene takes one that is solved already; leave it "
                        "out");
  if (group == NULL)
    return config_error(config, flow,
                        "the group 'solute' is missing: what the flow carries; write solute = { "
                        "peclet = [0.1, 1.0, 10.0]; };");
  scene->method = &method_solute;
  TRY(refuse_other_groups(config));
  TRY(scene_file_find(config, flow, "file", "\"run.hdf\"", "sphsolve run ... -o",
                      scene->flow_path));
  TRY(keys_read(config, group, "solute", 0, scene, scene));
  TRY(read_peclet(config, group, scene));
  scene->solute.error = NAN;
  TRY(keys_read(config, config_child(root, "checkpoint"), "checkpoint", 0, scene, scene));
cleanup:
  return status;
}

static const struct method *const methods[] = {
    NULL,
#define METHOD(name) &method_##name,
#include "sphsolve/scene/methods.def"
#undef METHOD
};

static enum status read_scene_group(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config_root(config), "scene");
  int method = 0;
  if (group == NULL)
    return config_error(config, NULL,
                        "the group 'scene' is missing; write scene = { name = \"my-sand\"; };");
  TRY(keys_read(config, group, "scene", 0, scene, scene));
  if (!text_is_plain(scene->name))
    TRY(config_error(config, config_child(group, "name"),
                     "holds a line break or another character that is not shown; leave it out"));
  TRY(config_choice(config, group, "method", scene_method_names, &method, NULL));
  scene->method = methods[method];
  if (isnan(scene->steady_tolerance))
    scene->steady_tolerance = isfinite(scene->end_time) ? 0 : 1e-4;
  if (!isfinite(scene->end_time) && scene->steady_tolerance == 0)
    TRY(config_error(config, group,
                     "end_time is missing: with steady_tolerance = 0 the run would never end"));
cleanup:
  return status;
}

/* The model, and the spacing of the sites in it; those of a domain have the domain's spacing. */
static enum status read_model(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *model = config_child(config_root(config), "model");
  config_node *lattice = config_child(config_root(config), "lattice");
  if (model != NULL)
    TRY(scene_file_find(config, model, "file", "\"dense.hdf\"", "ct2model build ... -o",
                        scene->model_path));
  if (lattice != NULL && !*scene->model_path)
    TRY(config_error(config, lattice,
                     "a domain has its own spacing; leave it out, or write model = { ... }"));
  TRY(keys_read(config, lattice, "lattice", 0, scene, scene));
cleanup:
  return status;
}

static enum status read_domain(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config_root(config), "domain");
  scene->dimensions = 3;
  if (group == NULL && !*scene->model_path)
    return config_error(config, NULL,
                        "model or domain is missing: model = { file = \"dense.hdf\"; }; or domain "
                        "= { size = ...; spacing = ...; };");
  if (group == NULL) return STATUS_OK;
  if (*scene->model_path)
    return config_error(config, group, "a scene has either a model or a domain, not both");
  int count = 0;
  bool given;
  TRY(config_quantities(config, group, "size", DIM_LENGTH, 2, 3, scene->domain_size, &count,
                        &given));
  if (!given)
    TRY(config_error(config, group,
                     "size is missing, like size = [\"0.2 m\", \"0.2 m\", \"0.6 m\"]"));
  TRY(keys_read(config, group, "domain", 0, scene, scene));
  scene->dimensions = count;
  for (int a = 0; a < count; a++)
    if (!(scene->domain_size[a] >= 0.999 * scene->spacing))
      TRY(config_error(config, config_child(group, "size"),
                       "each length must be at least one spacing (%g m)", scene->spacing));
  keys_spread(scene, count, scene->domain_size);
  if (count == 2) {
    scene->domain_size[1] = scene->spacing;
    scene->periodic[1] = true;
  }
  config_node *periodic = config_child(group, "periodic");
  if (periodic != NULL) {
    size_t n = config_count(periodic);
    if (!config_is_list(periodic) || (n != 3 && n != (size_t)count))
      TRY(config_error(config, periodic,
                       "%d times true or false is wanted, like [true, true, false]", count));
    for (size_t i = 0; i < n; i++) {
      config_node *item = config_item(periodic, i);
      if (config_is_number(item) || config_is_text(item) || config_is_list(item) ||
          config_is_group(item))
        TRY(config_error(config, item, "true or false is wanted"));
      bool value = config_boolean_value(item);
      if (n == 2)
        scene->periodic[i == 0 ? 0 : 2] = value;
      else
        scene->periodic[i] = value;
    }
    if (scene->dimensions == 2) scene->periodic[1] = true;
  }
cleanup:
  return status;
}

static enum status read_fluid(struct config *config, struct scene *scene) {
  config_node *list = config_child(config_root(config), "fluids");
  if (config_count(list) == 0)
    return config_error(config, list,
                        "fluids is missing; write fluids = ( { name = \"water\"; density = "
                        "\"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );");
  if (config_count(list) > 1)
    return config_error(config, config_item(list, 1), "one fluid is supported, %zu are given",
                        config_count(list));
  config_node *group = config_item(list, 0);
  if (!config_is_group(group))
    return config_error(config, group, "a group { name = ...; } is wanted");
  return keys_read(config, group, "fluids[]", 0, scene, scene);
}

static enum status read_force(struct config *config, struct scene *scene) {
  const enum status status =
      keys_read(config, config_child(config_root(config), "force"), "force", 0, scene, scene);
  for (int a = 0; a < 3; a++)
    scene->driving[a] = scene->gravity[a] + scene->body_acceleration[a] -
                        scene->pressure_gradient[a] / scene->fluid.density;
  return status;
}

static enum status read_isph(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config_root(config), "isph");
  TRY(keys_read(config, group, "isph", 0, scene, scene));
  TRY(keys_read(config, config_child(group, "wall"), "isph.wall", 0, scene, scene));
  if (!RANKS && scene->isph.solver == SOLVER_PETSC)
    TRY(config_error(config, config_child(group, "solver"),
                     "PETSc is part of sphsolve-mpi (make MPI=1)"));
  if (!isnan(scene->isph.alpha) && config_child(group, "tau") != NULL)
    TRY(config_error(config, group, "alpha and tau say the same (alpha = dt / tau); give one"));
cleanup:
  return status;
}

/* output.fields: names of any method's snapshots. */
static enum status read_fields(struct config *config, struct scene *scene) {
  static const char *const known_names[] = {"velocity",   "pressure",      "density", "id",
                                            "porosity",   "volume",        "surface", "head",
                                            "saturation", "water_content", NULL};
  enum status status = STATUS_OK;
  config_node *fields = config_child(config_child(config_root(config), "output"), "fields");
  if (fields != NULL && !config_is_list(fields))
    TRY(config_error(config, fields, "a list is wanted, like [\"velocity\", \"pressure\"]"));
  scene->output_field_count = config_count(fields);
  TRY(memory_allocate(&scene->output_fields, scene->output_field_count,
                      sizeof *scene->output_fields, "output fields"));
  for (size_t i = 0; i < scene->output_field_count; i++) {
    config_node *item = config_item(fields, i);
    if (!config_is_text(item))
      TRY(config_error(config, item, "the name of a field in quotes is wanted"));
    bool known = false;
    for (size_t k = 0; known_names[k] != NULL; k++)
      known = known || !strcmp(known_names[k], config_text_value(item));
    if (!known)
      TRY(config_error(config, item,
                       "there is no field \"%s\"; there are velocity, pressure, "
                       "density, id, with isph porosity, volume and surface, with "
                       "richards head, saturation and water_content",
                       config_text_value(item)));
    for (size_t k = 0; k < i; k++)
      if (!strcmp(scene->output_fields[k], config_text_value(item)))
        TRY(config_error(config, item, "\"%s\" stands here twice; leave one out",
                         config_text_value(item)));
    snprintf(scene->output_fields[i], sizeof *scene->output_fields, "%s", config_text_value(item));
  }
cleanup:
  return status;
}

/* Settings of soil with pores smaller than the voxel. */
static enum status read_micro(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config_root(config), "micro");
  if (group != NULL && !*scene->model_path)
    TRY(config_error(config, group,
                     "is of soil with pores below the voxels of a model, and the "
                     "scene has none; leave it out"));
  TRY(config_quantities(config, group, "factors", DIM_NONE, 1, MICRO_FACTORS_MOST,
                        scene->micro.factors, &scene->micro.factor_count, NULL));
  qsort(scene->micro.factors, (size_t)scene->micro.factor_count, sizeof(double),
        scene_parts_by_value);
  for (int i = 0; i < scene->micro.factor_count; i++)
    if (!(scene->micro.factors[i] > 0) ||
        (i > 0 && scene->micro.factors[i] == scene->micro.factors[i - 1]))
      TRY(config_error(config, config_child(group, "factors"),
                       "factors of the soil's permeability are wanted, above 0 and none twice, "
                       "like [0.1, 10.0]"));
  TRY(keys_read(config, group, "micro", 0, scene, scene));
cleanup:
  return status;
}

/* Settings that are all plain keys. */
static enum status read_plain_groups(struct config *config, struct scene *scene) {
  static const char *const groups[] = {"wcsph", "stokes", "effects", "output", "checkpoint"};
  enum status status = STATUS_OK;
  for (size_t i = 0; i < sizeof groups / sizeof *groups; i++)
    TRY(keys_read(config, config_child(config_root(config), groups[i]), groups[i], 0, scene,
                  scene));
cleanup:
  return status;
}

static enum status check_whole(struct config *config, const struct scene *scene) {
  config_node *root = config_root(config);
  bool driven = scene->driving[0] != 0 || scene->driving[1] != 0 || scene->driving[2] != 0;
  if (!*scene->model_path && scene->region_count == 0)
    return config_error(config, config_child(root, "domain"),
                        "regions are missing: nothing fills the domain; write regions = ( { type = "
                        "\"water\"; box = [...]; } );");
  if (*scene->model_path && !driven)
    return config_error(config, config_child(root, "force"),
                        "nothing drives the flow: give force.body_acceleration, like [\"0\", "
                        "\"0\", \"-9.8 m/s^2\"]");
  return STATUS_OK;
}

/* Stores the lines of the settings that later errors may refer to. */
static void note_places(struct config *config, struct scene *scene) {
  config_node *root = config_root(config);
  for (int i = 0; i < SCENE_PLACE_COUNT; i++) {
    config_node *node = config_child(root, scene_places[i].group);
    config_node *key = *scene_places[i].key ? config_child(node, scene_places[i].key) : NULL;
    if (key != NULL) node = key;
    if (node == NULL) node = config_child(root, "scene");
    scene->line_of[i] = config_line(node);
  }
}

static enum status read_flow_to_solve(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  TRY(read_model(config, scene));
  TRY(read_domain(config, scene));
  TRY(read_fluid(config, scene));
  TRY(scene_read_regions(config, scene));
  TRY(read_force(config, scene));
  TRY(read_micro(config, scene));
  TRY(read_isph(config, scene));
  TRY(read_plain_groups(config, scene));
  TRY(read_fields(config, scene));
  TRY(scene_read_probes(config, scene));
cleanup:
  return status;
}

enum status scene_read(const char *path, const char *const *overrides, size_t override_count,
                       struct scene *scene) {
  enum status status = STATUS_OK;
  struct config *config = NULL;
  *scene = (struct scene){0};
  snprintf(scene->path, sizeof scene->path, "%s", path);
  TRY(config_open(path, overrides, override_count, &config));
  TRY(keys_check_names(config, true));
  TRY(read_scene_group(config, scene));
  TRY(scene_read_solute(config, scene));
  if (!*scene->flow_path) TRY(read_flow_to_solve(config, scene));
  TRY(keys_check_names(config, false));
  if (!*scene->flow_path) TRY(check_whole(config, scene));
  note_places(config, scene);
  TRY(memory_copy_text(config_text(config), strlen(config_text(config)), &scene->text));
cleanup:
  config_close(config);
  if (status != STATUS_OK) scene_free(scene);
  return status;
}
