#include "sphsolve/scene/scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/memory.h"
#include "common/text.h"
#include "common/units.h"
#include "sphsolve/scene/scene_internal.h"

static const char *const method_names[] = {"auto",
#define METHOD(name) #name,
#include "sphsolve/scene/methods.def"
#undef METHOD
                                           NULL};
static const struct method *const methods[] = {
    NULL,
#define METHOD(name) &method_##name,
#include "sphsolve/scene/methods.def"
#undef METHOD
};

enum status scene_positive(struct config *config, config_node *group, const char *name,
                           struct dimension dimension, double *value) {
  bool automatic;
  *value = NAN;
  enum status status =
      config_auto_quantity(config, group, name, dimension, value, &automatic, NULL);
  if (status == STATUS_OK && !automatic && !(*value > 0))
    return config_error(config, config_child(config, group, name),
                        "must be greater than 0, like \"%s\"", dimension_example(dimension));
  return status;
}

void scene_spread(const struct scene *scene, int count, double vector[3]) {
  if (scene->dimensions == 2 && count == 2) {
    vector[2] = vector[1];
    vector[1] = 0;
  }
}

enum status scene_vector(struct config *config, config_node *group, const char *name,
                         const struct scene *scene, struct dimension dimension, double vector[3]) {
  int count = 3;
  bool given;
  int least = scene->dimensions == 2 ? 2 : 3;
  enum status status =
      config_quantities(config, group, name, dimension, least, 3, vector, &count, &given);
  if (status == STATUS_OK && given) {
    scene_spread(scene, count, vector);
    if (scene->dimensions == 2 && vector[1] != 0)
      return config_error(config, config_child(config, group, name),
                          "a 2-D scene lives in x and z: the y component must be 0");
  }
  return status;
}

static enum status read_scene_group(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "scene");
  const char *name = "unnamed";
  int method = 0;
  bool end_given, tolerance_given;
  if (group == NULL)
    return config_error(config, NULL,
                        "the group 'scene' is missing; write scene = { name = \"my-sand\"; };");
  TRY(config_string(config, group, "name", &name, NULL));
  if (!text_is_plain(name))
    TRY(config_error(config, config_child(config, group, "name"),
                     "holds a line break or another character that is not shown; leave it out"));
  snprintf(scene->name, sizeof scene->name, "%s", name);
  TRY(config_choice(config, group, "method", method_names, &method, NULL));
  scene->method = methods[method];
  scene->end_time = INFINITY;
  TRY(config_quantity(config, group, "end_time", DIM_TIME, &scene->end_time, &end_given));
  if (end_given && !(scene->end_time > 0))
    TRY(config_error(config, config_child(config, group, "end_time"), "must be greater than 0"));
  TRY(config_number(config, group, "steady_tolerance", &scene->steady_tolerance, &tolerance_given));
  if (tolerance_given && !(scene->steady_tolerance >= 0 && scene->steady_tolerance < 1))
    TRY(config_error(config, config_child(config, group, "steady_tolerance"),
                     "a number from 0 (run to end_time) to below 1 is wanted, like 1e-4"));
  if (!tolerance_given) scene->steady_tolerance = end_given ? 0 : 1e-4;
  if (!end_given && scene->steady_tolerance == 0)
    TRY(config_error(config, group,
                     "end_time is missing: with steady_tolerance = 0 the run would never end"));
cleanup:
  return status;
}

/* Checks the types of the groups and lists of a scene. This comes first, so that a misspelt name is
 * reported as unknown. */
static enum status check_roots(struct config *config) {
  static const char *const groups[] = {"scene",      "model",  "lattice", "domain",  "force",
                                       "wcsph",      "stokes", "isph",    "effects", "output",
                                       "checkpoint", "flow",   "solute",  "micro"};
  static const char *const lists[] = {"fluids", "regions", "gauges", "planes"};
  config_node *root = config_root(config);
  for (size_t i = 0; i < sizeof groups / sizeof *groups; i++) {
    config_node *node = config_child(config, root, groups[i]);
    if (node != NULL && !config_is_group(node))
      return config_error(config, node, "a group is wanted, like %s = { ... };", groups[i]);
  }
  for (size_t i = 0; i < sizeof lists / sizeof *lists; i++) {
    config_node *node = config_child(config, root, lists[i]);
    if (node != NULL && !config_is_list(node))
      return config_error(config, node, "a list is wanted, like %s = ( { ... }, { ... } );",
                          lists[i]);
  }
  return STATUS_OK;
}

/* Reads the spacing of the sites in a model; those of a domain have the domain's spacing. */
static enum status read_lattice(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "lattice");
  scene->lattice_spacing = NAN;
  if (group != NULL && !*scene->model_path)
    TRY(config_error(config, group,
                     "a domain has its own spacing; leave it out, or write model = { ... }"));
  TRY(scene_positive(config, group, "spacing", DIM_LENGTH, &scene->lattice_spacing));
cleanup:
  return status;
}

enum status scene_file(struct config *config, config_node *group, const char *name,
                       const char *example, const char *made, char *path) {
  enum status status = STATUS_OK;
  const char *file = NULL;
  TRY(config_string(config, group, "file", &file, NULL));
  if (file == NULL || !*file)
    return config_error(config, group, "file is missing; write %s = { file = \"%s\"; };", name,
                        example);
  /* Relative to the scene first, then to the working directory. */
  const char *folder = file[0] == '/' ? "" : config_folder(config);
  if (snprintf(path, 4096, "%s%s", folder, file) >= 4096)
    TRY(config_error(config, group, "the path is too long"));
  if (access(path, R_OK) != 0 && access(file, R_OK) == 0) snprintf(path, 4096, "%s", file);
  if (access(path, R_OK) != 0)
    TRY(config_error(config, config_child(config, group, "file"),
                     "%s cannot be read; make it with %s %s", path, made, file));
cleanup:
  return status;
}

static enum status read_model(struct config *config, struct scene *scene) {
  config_node *group = config_child(config, config_root(config), "model");
  if (group == NULL) return STATUS_OK;
  return scene_file(config, group, "model", "dense.hdf", "ct2model build ... -o",
                    scene->model_path);
}

static enum status read_domain(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "domain");
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
  TRY(scene_positive(config, group, "spacing", DIM_LENGTH, &scene->spacing));
  if (!(scene->spacing > 0))
    TRY(config_error(config, group, "spacing is missing, like spacing = \"1 cm\""));
  scene->dimensions = count;
  for (int a = 0; a < count; a++)
    if (!(scene->domain_size[a] >= 0.999 * scene->spacing))
      TRY(config_error(config, config_child(config, group, "size"),
                       "each length must be at least one spacing (%g m)", scene->spacing));
  scene_spread(scene, count, scene->domain_size);
  if (count == 2) {
    scene->domain_size[1] = scene->spacing;
    scene->periodic[1] = true;
  }
  config_node *periodic = config_child(config, group, "periodic");
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
  enum status status = STATUS_OK;
  config_node *list = config_child(config, config_root(config), "fluids");
  const char *name = "fluid";
  bool density_given, viscosity_given;
  if (config_count(list) == 0)
    return config_error(config, list,
                        "fluids is missing; write fluids = ( { name = \"water\"; density = "
                        "\"1000 kg/m^3\"; viscosity = \"1e-3 Pa s\"; } );");
  if (config_count(list) > 1)
    TRY(config_error(config, config_item(list, 1), "one fluid is supported, %zu are given",
                     config_count(list)));
  config_node *group = config_item(list, 0);
  if (!config_is_group(group))
    TRY(config_error(config, group, "a group { name = ...; } is wanted"));
  TRY(config_string(config, group, "name", &name, NULL));
  snprintf(scene->fluid.name, sizeof scene->fluid.name, "%s", name);
  TRY(config_quantity(config, group, "density", DIM_DENSITY, &scene->fluid.density,
                      &density_given));
  TRY(config_quantity(config, group, "viscosity", DIM_VISCOSITY, &scene->fluid.viscosity,
                      &viscosity_given));
  if (!density_given)
    TRY(config_error(config, group, "density is missing, like density = \"1000 kg/m^3\""));
  if (!viscosity_given)
    TRY(config_error(config, group, "viscosity is missing, like viscosity = \"1e-3 Pa s\""));
  if (!(scene->fluid.density > 0))
    TRY(config_error(config, config_child(config, group, "density"), "must be greater than 0"));
  if (!(scene->fluid.viscosity >= 0))
    TRY(config_error(config, config_child(config, group, "viscosity"), "must not be negative"));
  TRY(config_quantity(config, group, "surface_tension", (struct dimension){0, 1, -2},
                      &scene->fluid.surface_tension, NULL));
  if (!(scene->fluid.surface_tension >= 0))
    TRY(config_error(config, config_child(config, group, "surface_tension"),
                     "must not be negative"));
cleanup:
  return status;
}

static enum status read_force(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "force");
  bool given;
  scene->hydraulic_gradient = NAN;
  TRY(scene_vector(config, group, "gravity", scene, DIM_ACCELERATION, scene->gravity));
  TRY(scene_vector(config, group, "body_acceleration", scene, DIM_ACCELERATION,
                   scene->body_acceleration));
  TRY(scene_vector(config, group, "pressure_gradient", scene, DIM_PRESSURE_GRADIENT,
                   scene->pressure_gradient));
  TRY(config_number(config, group, "hydraulic_gradient", &scene->hydraulic_gradient, &given));
  if (given && !(scene->hydraulic_gradient > 0))
    TRY(config_error(config, config_child(config, group, "hydraulic_gradient"),
                     "must be greater than 0"));
  for (int a = 0; a < 3; a++)
    scene->driving[a] = scene->gravity[a] + scene->body_acceleration[a] -
                        scene->pressure_gradient[a] / scene->fluid.density;
cleanup:
  return status;
}

static enum status check_whole(struct config *config, const struct scene *scene) {
  config_node *root = config_root(config);
  bool driven = scene->driving[0] != 0 || scene->driving[1] != 0 || scene->driving[2] != 0;
  if (!*scene->model_path && scene->region_count == 0)
    return config_error(config, config_child(config, root, "domain"),
                        "regions are missing: nothing fills the domain; write regions = ( { type = "
                        "\"water\"; box = [...]; } );");
  if (*scene->model_path && !driven)
    return config_error(config, config_child(config, root, "force"),
                        "nothing drives the flow: give force.body_acceleration, like [\"0\", "
                        "\"0\", \"-9.8 m/s^2\"]");
  return STATUS_OK;
}

static const struct {
  const char *group, *key;
} places[SCENE_PLACE_COUNT] = {
#define X(symbol, group, key) {group, key},
    SCENE_PLACES(X)
#undef X
};

/* Stores the lines of the settings that later errors may refer to. */
static void note_places(struct config *config, struct scene *scene) {
  config_node *root = config_root(config);
  for (int i = 0; i < SCENE_PLACE_COUNT; i++) {
    config_node *node = config_child(config, root, places[i].group);
    config_node *key = *places[i].key ? config_child(config, node, places[i].key) : NULL;
    if (key != NULL) node = key;
    if (node == NULL) node = config_child(config, root, "scene");
    scene->line_of[i] = config_line(node);
  }
}

enum status scene_error(const struct scene *scene, enum scene_place place, const char *format,
                        ...) {
  char message[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  int line = scene->line_of[place];
  if (line == 0) /* set by --set */
    return FAIL(STATUS_INPUT, "%s: %s%s%s: %s", scene->path, places[place].group,
                *places[place].key ? "." : "", places[place].key, message);
  return FAIL(STATUS_INPUT, "%s:%d: %s%s%s: %s", scene->path, line, places[place].group,
              *places[place].key ? "." : "", places[place].key, message);
}

static enum status read_flow_to_solve(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  TRY(read_model(config, scene));
  TRY(read_lattice(config, scene));
  TRY(read_domain(config, scene));
  TRY(read_fluid(config, scene));
  TRY(scene_read_regions(config, scene));
  TRY(read_force(config, scene));
  TRY(scene_read_settings(config, scene));
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
  TRY(check_roots(config));
  TRY(read_scene_group(config, scene));
  TRY(scene_read_solute(config, scene));
  if (!*scene->flow_path) TRY(read_flow_to_solve(config, scene));
  TRY(config_refuse_unknown(config));
  if (!*scene->flow_path) TRY(check_whole(config, scene));
  note_places(config, scene);
  TRY(memory_allocate(&scene->text, strlen(config_text(config)) + 1, 1, "the scene's text"));
  strcpy(scene->text, config_text(config));
cleanup:
  if (status == STATUS_INPUT && config != NULL) status = config_explain_failure(config, status);
  config_close(config);
  if (status != STATUS_OK) scene_free(scene);
  return status;
}

void scene_free(struct scene *scene) {
  for (size_t k = 0; scene->regions != NULL && k < scene->region_count; k++) {
    if (scene->regions[k].first != k) continue;
    if (scene->regions[k].polygon != NULL) memory_free(&scene->regions[k].polygon->corner);
    memory_free(&scene->regions[k].polygon);
    scene_free_stl(&scene->regions[k]);
    memory_free(&scene->regions[k].table.time);
    memory_free(&scene->regions[k].table.value);
  }
  memory_free(&scene->regions);
  memory_free(&scene->gauges);
  memory_free(&scene->planes);
  memory_free(&scene->output_fields);
  memory_free(&scene->text);
}

int scene_axis_along(const double vector[3]) {
  int axis = 0;
  for (int a = 1; a < 3; a++)
    if (fabs(vector[a]) > fabs(vector[axis])) axis = a;
  return axis;
}

double scene_hydraulic_gradient(const struct scene *scene) {
  if (!isnan(scene->hydraulic_gradient)) return scene->hydraulic_gradient;
  double square = 0;
  for (int a = 0; a < 3; a++) square += scene->driving[a] * scene->driving[a];
  return sqrt(square) / GRAVITY_STANDARD;
}
