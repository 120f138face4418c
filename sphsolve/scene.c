#include "sphsolve/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "common/config.h"
#include "common/memory.h"
#include "common/units.h"

static const char *const method_names[] = {"auto", "wcsph", "stokes", "isph", NULL};
static const char *const wall_names[] = {"frozen", "adami", "subvoxel", NULL};
static const char *const eos_names[] = {"gauge", "absolute", NULL};
static const char *const kernel_names[] = {"quintic", "cubic", NULL};
static const char *const form_names[] = {"akbari", "m15", NULL};
static const char *const switch_names[] = {"auto", "on", "off", NULL};
static const char *const region_names[] = {"water", "porous", "wall", "inflow", "empty", NULL};
static const char *const porosity_names[] = {"clamp", "m15", NULL};

/* A positive quantity, or NAN when missing or "auto". */
static enum status read_positive(struct config *config, config_node *group, const char *name,
                                 struct dimension dimension, double *value) {
  bool automatic;
  *value = NAN;
  enum status status =
      config_auto_quantity(config, group, name, dimension, value, &automatic, NULL);
  if (status == STATUS_OK && !automatic && !(*value > 0))
    return config_error(config, config_child(config, group, name), "must be greater than 0");
  return status;
}

static enum status read_scene_group(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "scene");
  const char *name = "unnamed";
  int method = METHOD_AUTO;
  bool end_given, tolerance_given;
  if (group == NULL)
    return config_error(config, NULL,
                        "the group 'scene' is missing; write scene = { name = \"my-sand\"; };");
  TRY(config_string(config, group, "name", &name, NULL));
  snprintf(scene->name, sizeof scene->name, "%s", name);
  TRY(config_choice(config, group, "method", method_names, &method, NULL));
  scene->method = (enum method)method;
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

static enum status read_model(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "model");
  const char *file = NULL;
  if (group == NULL) return STATUS_OK;
  TRY(config_string(config, group, "file", &file, NULL));
  if (file == NULL || !*file)
    TRY(config_error(config, group, "file is missing; write model = { file = \"dense.hdf\"; };"));
  /* Beside the scene first, then from where the program runs. */
  const char *folder = file[0] == '/' ? "" : config_folder(config);
  if ((size_t)snprintf(scene->model_path, sizeof scene->model_path, "%s%s", folder, file) >=
      sizeof scene->model_path)
    TRY(config_error(config, group, "the path is too long"));
  if (access(scene->model_path, R_OK) != 0 && access(file, R_OK) == 0)
    snprintf(scene->model_path, sizeof scene->model_path, "%s", file);
  if (access(scene->model_path, R_OK) != 0)
    TRY(config_error(config, config_child(config, group, "file"),
                     "%s cannot be read; make it with ct2model build ... -o %s", scene->model_path,
                     file));
cleanup:
  return status;
}

/* Spreads the two values of a 2-D vector to x and z. */
static void spread_vector(const struct scene *scene, int count, double vector[3]) {
  if (scene->dimensions == 2 && count == 2) {
    vector[2] = vector[1];
    vector[1] = 0;
  }
}

static enum status read_vector(struct config *config, config_node *group, const char *name,
                               const struct scene *scene, struct dimension dimension,
                               double vector[3]) {
  int count = 3;
  bool given;
  int least = scene->dimensions == 2 ? 2 : 3;
  enum status status =
      config_quantities(config, group, name, dimension, least, 3, vector, &count, &given);
  if (status == STATUS_OK && given) {
    spread_vector(scene, count, vector);
    if (scene->dimensions == 2 && vector[1] != 0)
      return config_error(config, config_child(config, group, name),
                          "a 2-D scene lives in x and z: the y component must be 0");
  }
  return status;
}

static enum status read_domain(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "domain");
  scene->dimensions = 3;
  if (group == NULL) return STATUS_OK;
  int count = 0;
  bool given;
  TRY(config_quantities(config, group, "size", DIM_LENGTH, 2, 3, scene->domain_size, &count,
                        &given));
  if (!given)
    TRY(config_error(config, group,
                     "size is missing, like size = [\"0.2 m\", \"0.2 m\", \"0.6 m\"]"));
  TRY(read_positive(config, group, "spacing", DIM_LENGTH, &scene->spacing));
  if (!(scene->spacing > 0))
    TRY(config_error(config, group, "spacing is missing, like spacing = \"1 cm\""));
  scene->dimensions = count;
  for (int a = 0; a < count; a++)
    if (!(scene->domain_size[a] >= 0.999 * scene->spacing))
      TRY(config_error(config, config_child(config, group, "size"),
                       "each length must be at least one spacing (%g m)", scene->spacing));
  spread_vector(scene, count, scene->domain_size);
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
  if (!config_is_list(list)) TRY(config_error(config, list, "a list ( { ... } ) is wanted"));
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
cleanup:
  return status;
}

static enum status read_box(struct config *config, config_node *group, const struct scene *scene,
                            double box[6]) {
  int count = 6, least = scene->dimensions == 2 ? 4 : 6;
  bool given;
  enum status status =
      config_quantities(config, group, "box", DIM_LENGTH, least, 6, box, &count, &given);
  if (status != STATUS_OK) return status;
  if (!given) return config_error(config, group, "box is missing: [x0, y0, z0, x1, y1, z1]");
  config_node *node = config_child(config, group, "box");
  if (count == 5) return config_error(config, node, "4 or 6 lengths are wanted");
  if (count == 4) {
    double x0 = box[0], z0 = box[1], x1 = box[2], z1 = box[3];
    box[0] = x0, box[2] = z0, box[3] = x1, box[5] = z1;
  }
  if (scene->dimensions == 2) box[1] = 0, box[4] = scene->spacing;
  for (int a = 0; a < 3; a++) {
    if (!(box[a + 3] > box[a]))
      return config_error(config, node, "%c1 = %g m must be greater than %c0 = %g m", 'x' + a,
                          box[a + 3], 'x' + a, box[a]);
    double slack = 1e-6 * scene->spacing;
    if (box[a] < -slack || box[a + 3] > scene->domain_size[a] + slack)
      return config_error(config, node, "%g to %g m in %c lies outside the domain (0 to %g m)",
                          box[a], box[a + 3], 'x' + a, scene->domain_size[a]);
  }
  return STATUS_OK;
}

static enum status read_porous(struct config *config, config_node *group, struct scene *scene,
                               struct region *region) {
  enum status status = STATUS_OK;
  bool porosity_given;
  region->alpha = 1000;
  region->beta = 1.1;
  TRY(config_number(config, group, "porosity", &region->porosity, &porosity_given));
  TRY(read_positive(config, group, "grain_size", DIM_LENGTH, &region->grain_size));
  TRY(config_number(config, group, "alpha", &region->alpha, NULL));
  TRY(config_number(config, group, "beta", &region->beta, NULL));
  TRY(config_bool(config, group, "saturated", &region->saturated, NULL));
  TRY(read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->soil_velocity));
  if (!porosity_given) TRY(config_error(config, group, "porosity is missing, like porosity = 0.4"));
  if (!(region->porosity > 0 && region->porosity <= 1))
    TRY(config_error(config, config_child(config, group, "porosity"),
                     "must be above 0 and at most 1"));
  if (!(region->grain_size > 0))
    TRY(config_error(config, group,
                     "grain_size is missing: soil needs its D50, like grain_size = \"3 mm\""));
  if (!(region->alpha >= 0 && region->beta >= 0))
    TRY(config_error(config, group, "alpha and beta must not be negative"));
cleanup:
  return status;
}

static enum status read_inflow(struct config *config, config_node *group, struct region *region) {
  enum status status = STATUS_OK;
  bool head_given, flux_given;
  TRY(config_quantity(config, group, "head", DIM_LENGTH, &region->head, &head_given));
  TRY(config_quantity(config, group, "flux", DIM_VELOCITY, &region->flux, &flux_given));
  if (head_given == flux_given)
    TRY(config_error(config, group, "either head (a length) or flux (a velocity) is wanted"));
  region->boundary = head_given ? BOUNDARY_HEAD : BOUNDARY_FLUX;
cleanup:
  return status;
}

/* The lattice keeps a site's region in 16 bits. */
enum { MOST_REGIONS = 65000 };

static enum status read_regions(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config, config_root(config), "regions");
  if (list == NULL) return STATUS_OK;
  if (!config_is_list(list))
    TRY(config_error(config, list, "a list ( { ... }, { ... } ) is wanted"));
  scene->region_count = config_count(list);
  if (scene->region_count > MOST_REGIONS)
    TRY(config_error(config, list, "%zu regions; at most %d are possible", scene->region_count,
                     MOST_REGIONS));
  TRY(memory_allocate(&scene->regions, scene->region_count, sizeof *scene->regions, "regions"));
  for (size_t i = 0; i < scene->region_count; i++) {
    struct region *region = &scene->regions[i];
    config_node *group = config_item(list, i);
    int type = -1;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { type = ...; } is wanted"));
    region->line = config_line(group);
    TRY(config_choice(config, group, "type", region_names, &type, NULL));
    if (type < 0)
      TRY(config_error(
          config, group,
          "type is missing: \"water\", \"porous\", \"wall\", \"inflow\" or \"empty\""));
    region->type = (enum region_type)type;
    TRY(read_box(config, group, scene, region->box));
    switch (region->type) {
    case REGION_POROUS:
      TRY(read_porous(config, group, scene, region));
      break;
    case REGION_INFLOW:
      TRY(read_inflow(config, group, region));
      break;
    case REGION_WALL:
      TRY(config_bool(config, group, "slip", &region->slip, NULL));
      TRY(read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->velocity));
      break;
    case REGION_WATER:
      TRY(read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->velocity));
      break;
    case REGION_EMPTY:
      break;
    }
  }
cleanup:
  return status;
}

static enum status read_force(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "force");
  bool given;
  scene->hydraulic_gradient = NAN;
  TRY(read_vector(config, group, "gravity", scene, DIM_ACCELERATION, scene->gravity));
  TRY(read_vector(config, group, "body_acceleration", scene, DIM_ACCELERATION,
                  scene->body_acceleration));
  TRY(read_vector(config, group, "pressure_gradient", scene, DIM_PRESSURE_GRADIENT,
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

static enum status read_methods(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config), *group = config_child(config, root, "wcsph");
  int eos = EOS_GAUGE, kernel = KERNEL_QUINTIC, wall = WALL_SUBVOXEL;
  TRY(read_positive(config, group, "sound_speed", DIM_VELOCITY, &scene->wcsph.sound_speed));
  TRY(config_choice(config, group, "equation_of_state", eos_names, &eos, NULL));
  TRY(config_choice(config, group, "kernel", kernel_names, &kernel, NULL));
  TRY(read_positive(config, group, "support", DIM_LENGTH, &scene->wcsph.support));
  TRY(read_positive(config, group, "dt", DIM_TIME, &scene->wcsph.dt));
  TRY(config_bool(config, group, "force_dt", &scene->wcsph.force_dt, NULL));
  TRY(config_choice(config, group, "wall", wall_names, &wall, NULL));
  scene->wcsph.equation_of_state = (enum equation_of_state)eos;
  scene->wcsph.kernel = (enum kernel)kernel;
  scene->wcsph.wall = (enum wall_scheme)wall;

  group = config_child(config, root, "stokes");
  wall = WALL_SUBVOXEL;
  scene->stokes.tolerance = 1e-6;
  TRY(read_positive(config, group, "support", DIM_LENGTH, &scene->stokes.support));
  TRY(config_choice(config, group, "wall", wall_names, &wall, NULL));
  TRY(config_number(config, group, "tolerance", &scene->stokes.tolerance, NULL));
  scene->stokes.wall = (enum wall_scheme)wall;

  group = config_child(config, root, "isph");
  int form = FORM_AKBARI, porosity = 0;
  bool alpha_given, tau_given;
  kernel = KERNEL_CUBIC;
  scene->isph.support_ratio = 2.4;
  scene->isph.tau = 0.1;
  scene->isph.alpha = NAN;
  scene->isph.tolerance = 1e-6;
  scene->isph.smagorinsky = 0.2;
  TRY(config_choice(config, group, "form", form_names, &form, NULL));
  TRY(config_choice(config, group, "kernel", kernel_names, &kernel, NULL));
  TRY(config_number(config, group, "support_ratio", &scene->isph.support_ratio, NULL));
  TRY(config_quantity(config, group, "tau", DIM_TIME, &scene->isph.tau, &tau_given));
  TRY(config_number(config, group, "alpha", &scene->isph.alpha, &alpha_given));
  TRY(read_positive(config, group, "dt", DIM_TIME, &scene->isph.dt));
  TRY(config_number(config, group, "tolerance", &scene->isph.tolerance, NULL));
  TRY(config_number(config, group, "smagorinsky", &scene->isph.smagorinsky, NULL));
  TRY(config_choice(config, group, "porosity", porosity_names, &porosity, NULL));
  config_node *isph_wall = config_child(config, group, "wall");
  TRY(config_bool(config, isph_wall, "slip", &scene->isph.slip, NULL));
  scene->isph.form = (enum unified_form)form;
  scene->isph.kernel = (enum kernel)kernel;
  scene->isph.porosity_paper = porosity == 1;
  if (alpha_given && tau_given)
    TRY(config_error(config, group, "alpha and tau say the same (alpha = dt / tau); give one"));
  if (alpha_given && !(scene->isph.alpha >= 0 && scene->isph.alpha <= 1))
    TRY(config_error(config, config_child(config, group, "alpha"),
                     "a number from 0 to 1 is wanted"));
  if (!(scene->isph.tau > 0))
    TRY(config_error(config, config_child(config, group, "tau"),
                     "must be greater than 0; alpha = 0 switches the relaxation off"));
  if (!(scene->isph.support_ratio >= 1.5 && scene->isph.support_ratio <= 6))
    TRY(config_error(config, config_child(config, group, "support_ratio"),
                     "1.5 to 6 spacings are possible"));
  if (!(scene->isph.smagorinsky >= 0 && scene->isph.smagorinsky < 1))
    TRY(config_error(config, config_child(config, group, "smagorinsky"), "0 to 1 is possible"));
  double *tolerances[2] = {&scene->stokes.tolerance, &scene->isph.tolerance};
  for (int i = 0; i < 2; i++)
    if (!(*tolerances[i] > 0 && *tolerances[i] < 0.1))
      TRY(config_error(
          config,
          config_child(config, i ? group : config_child(config, root, "stokes"), "tolerance"),
          "above 0 and below 0.1 is wanted, like 1e-6"));
cleanup:
  return status;
}

static enum status read_switches(struct config *config, struct scene *scene) {
  config_node *group = config_child(config, config_root(config), "effects");
  int turbulence = SWITCH_AUTO, shifting = SWITCH_AUTO;
  enum status status = config_choice(config, group, "turbulence", switch_names, &turbulence, NULL);
  if (status == STATUS_OK)
    status = config_choice(config, group, "shifting", switch_names, &shifting, NULL);
  scene->turbulence = (enum switch_state)turbulence;
  scene->shifting = (enum switch_state)shifting;
  return status;
}

static enum status read_gauges(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config, config_root(config), "gauges");
  scene->gauge_count = config_count(list);
  TRY(memory_allocate(&scene->gauges, scene->gauge_count, sizeof *scene->gauges, "gauges"));
  for (size_t i = 0; i < scene->gauge_count; i++) {
    struct gauge *gauge = &scene->gauges[i];
    config_node *group = config_item(list, i);
    const char *name = NULL;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { at = [x, y, z]; } is wanted"));
    TRY(config_string(config, group, "name", &name, NULL));
    if (name != NULL)
      snprintf(gauge->name, sizeof gauge->name, "%s", name);
    else
      snprintf(gauge->name, sizeof gauge->name, "gauge_%zu", i + 1);
    if (config_child(config, group, "at") == NULL)
      TRY(config_error(config, group, "at is missing: where the pressure is gauged"));
    TRY(read_vector(config, group, "at", scene, DIM_LENGTH, gauge->at));
  }
cleanup:
  return status;
}

static enum status read_planes(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  static const char *const axes[] = {"x", "y", "z"};
  config_node *list = config_child(config, config_root(config), "planes");
  scene->plane_count = config_count(list);
  TRY(memory_allocate(&scene->planes, scene->plane_count, sizeof *scene->planes, "planes"));
  for (size_t i = 0; i < scene->plane_count; i++) {
    struct flux_plane *plane = &scene->planes[i];
    config_node *group = config_item(list, i);
    const char *name = NULL;
    int axes_given = 0;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { z = \"0.2 m\"; } is wanted"));
    TRY(config_string(config, group, "name", &name, NULL));
    if (name != NULL)
      snprintf(plane->name, sizeof plane->name, "%s", name);
    else
      snprintf(plane->name, sizeof plane->name, "plane_%zu", i + 1);
    for (int a = 0; a < 3; a++) {
      bool given;
      TRY(config_quantity(config, group, axes[a], DIM_LENGTH, &plane->position, &given));
      if (given) plane->axis = a, axes_given++;
    }
    if (axes_given != 1)
      TRY(config_error(config, group, "one of x, y, z is wanted: the plane's position"));
  }
cleanup:
  return status;
}

static enum status read_output(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config), *group = config_child(config, root, "output");
  TRY(read_positive(config, group, "interval", DIM_TIME, &scene->output_interval));
  TRY(read_positive(config, group, "history_interval", DIM_TIME, &scene->history_interval));
  config_node *fields = config_child(config, group, "fields");
  scene->output_field_count = config_count(fields);
  TRY(memory_allocate(&scene->output_fields, scene->output_field_count,
                      sizeof *scene->output_fields, "output fields"));
  for (size_t i = 0; i < scene->output_field_count; i++) {
    config_node *item = config_item(fields, i);
    if (!config_is_text(item))
      TRY(config_error(config, item, "the name of a field in quotes is wanted"));
    snprintf(scene->output_fields[i], sizeof *scene->output_fields, "%s", config_text_value(item));
  }
  TRY(read_positive(config, config_child(config, root, "checkpoint"), "interval", DIM_TIME,
                    &scene->checkpoint_interval));
cleanup:
  return status;
}

static enum status check_whole(struct config *config, const struct scene *scene) {
  config_node *root = config_root(config), *domain = config_child(config, root, "domain");
  bool has_model = *scene->model_path != '\0', has_domain = domain != NULL;
  if (has_model && has_domain)
    return config_error(config, domain, "a scene has either a model or a domain, not both");
  if (!has_model && !has_domain)
    return config_error(config, NULL,
                        "model or domain is missing: model = { file = \"dense.hdf\"; }; or domain "
                        "= { size = ...; spacing = ...; };");
  if (has_model && scene->region_count > 0)
    return config_error(config, config_child(config, root, "regions"),
                        "regions need a domain; a voxel model brings its own grains");
  if (has_domain && scene->region_count == 0)
    return config_error(config, domain, "regions are missing: nothing fills the domain");
  bool driven = scene->driving[0] != 0 || scene->driving[1] != 0 || scene->driving[2] != 0;
  if (has_model && !driven)
    return config_error(config, config_child(config, root, "force"),
                        "nothing drives the flow: give force.body_acceleration, like [\"0\", "
                        "\"0\", \"-9.8 m/s^2\"]");
  return STATUS_OK;
}

enum status scene_read(const char *path, const char *const *overrides, size_t override_count,
                       struct scene *scene) {
  enum status status = STATUS_OK;
  struct config *config = NULL;
  *scene = (struct scene){0};
  snprintf(scene->path, sizeof scene->path, "%s", path);
  TRY(config_open(path, overrides, override_count, &config));
  TRY(read_scene_group(config, scene));
  TRY(read_model(config, scene));
  TRY(read_domain(config, scene));
  TRY(read_fluid(config, scene));
  TRY(read_regions(config, scene));
  TRY(read_force(config, scene));
  TRY(read_methods(config, scene));
  TRY(read_switches(config, scene));
  TRY(read_gauges(config, scene));
  TRY(read_planes(config, scene));
  TRY(read_output(config, scene));
  TRY(config_refuse_unknown(config));
  TRY(check_whole(config, scene));
  TRY(memory_allocate(&scene->text, strlen(config_text(config)) + 1, 1, "the scene's text"));
  strcpy(scene->text, config_text(config));
cleanup:
  if (status == STATUS_INPUT && config != NULL) status = config_explain_failure(config, status);
  config_close(config);
  if (status != STATUS_OK) scene_free(scene);
  return status;
}

void scene_free(struct scene *scene) {
  memory_free(&scene->regions);
  memory_free(&scene->gauges);
  memory_free(&scene->planes);
  memory_free(&scene->output_fields);
  memory_free(&scene->text);
}
