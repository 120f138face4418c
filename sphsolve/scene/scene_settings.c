#include "sphsolve/scene/scene_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "common/memory.h"
#include "common/ranks.h"
#include "common/units.h"

const char *const wall_scheme_names[] = {"frozen", "adami", "subvoxel", NULL};
static const char *const eos_names[] = {"gauge", "absolute", NULL};
static const char *const isph_kernel_names[] = {"quintic", "cubic", NULL};
static const char *const form_names[] = {"akbari", "m15", NULL};
static const char *const switch_names[] = {"auto", "on", "off", NULL};
static const char *const solver_names[] = {"grid", "petsc", NULL};
static const char *const porosity_names[] = {"clamp", "m15", NULL};

static const char *const field_names[] = {"velocity",   "pressure",      "density", "id",
                                          "porosity",   "volume",        "surface", "head",
                                          "saturation", "water_content", NULL};

static enum status read_methods(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config), *group = config_child(config, root, "wcsph");
  int eos = EOS_GAUGE, kernel = KERNEL_QUINTIC, wall = WALL_SUBVOXEL;
  TRY(scene_positive(config, group, "sound_speed", DIM_VELOCITY, &scene->wcsph.sound_speed));
  TRY(config_choice(config, group, "equation_of_state", eos_names, &eos, NULL));
  TRY(config_choice(config, group, "kernel", kernel_names, &kernel, NULL));
  TRY(scene_positive(config, group, "support", DIM_LENGTH, &scene->wcsph.support));
  TRY(scene_positive(config, group, "dt", DIM_TIME, &scene->wcsph.dt));
  TRY(config_bool(config, group, "force_dt", &scene->wcsph.force_dt, NULL));
  TRY(config_choice(config, group, "wall", wall_scheme_names, &wall, NULL));
  scene->wcsph.equation_of_state = (enum equation_of_state)eos;
  scene->wcsph.kernel = (enum kernel)kernel;
  scene->wcsph.wall = (enum wall_scheme)wall;

  group = config_child(config, root, "stokes");
  wall = WALL_SUBVOXEL;
  scene->stokes.tolerance = NAN;
  kernel = KERNEL_CUBIC;
  TRY(config_choice(config, group, "kernel", kernel_names, &kernel, NULL));
  scene->stokes.kernel = (enum kernel)kernel;
  TRY(scene_positive(config, group, "support", DIM_LENGTH, &scene->stokes.support));
  TRY(config_choice(config, group, "wall", wall_scheme_names, &wall, NULL));
  TRY(config_number(config, group, "tolerance", &scene->stokes.tolerance, NULL));
  scene->stokes.wall = (enum wall_scheme)wall;

  group = config_child(config, root, "isph");
  int form = FORM_AKBARI, porosity = 0, solver = SOLVER_GRID;
  bool alpha_given, tau_given;
  kernel = KERNEL_CUBIC;
  scene->isph.support_ratio = 2.4;
  scene->isph.relaxation_time = 0.1;
  scene->isph.alpha = NAN;
  scene->isph.tolerance = 1e-6;
  scene->isph.smagorinsky = 0.2;
  TRY(config_choice(config, group, "form", form_names, &form, NULL));
  TRY(config_choice(config, group, "kernel", isph_kernel_names, &kernel, NULL));
  TRY(config_number(config, group, "support_ratio", &scene->isph.support_ratio, NULL));
  TRY(config_quantity(config, group, "tau", DIM_TIME, &scene->isph.relaxation_time, &tau_given));
  TRY(config_number(config, group, "alpha", &scene->isph.alpha, &alpha_given));
  TRY(scene_positive(config, group, "dt", DIM_TIME, &scene->isph.dt));
  TRY(config_number(config, group, "tolerance", &scene->isph.tolerance, NULL));
  TRY(config_choice(config, group, "solver", solver_names, &solver, NULL));
  scene->isph.solver = (enum pressure_solver)solver;
  if (!RANKS && solver == SOLVER_PETSC)
    TRY(config_error(config, config_child(config, group, "solver"),
                     "PETSc is part of sphsolve-mpi (make MPI=1)"));
  TRY(config_number(config, group, "smagorinsky", &scene->isph.smagorinsky, NULL));
  TRY(config_choice(config, group, "porosity", porosity_names, &porosity, NULL));
  config_node *isph_wall = config_child(config, group, "wall");
  if (isph_wall != NULL && !config_is_group(isph_wall))
    TRY(config_error(config, isph_wall, "a group is wanted, like wall = { slip = true; };"));
  TRY(config_bool(config, isph_wall, "slip", &scene->isph.slip, NULL));
  scene->isph.form = (enum unified_form)form;
  scene->isph.kernel = (enum kernel)kernel;
  scene->isph.porosity_paper = porosity == 1;
  if (alpha_given && tau_given)
    TRY(config_error(config, group, "alpha and tau say the same (alpha = dt / tau); give one"));
  if (alpha_given && !(scene->isph.alpha >= 0 && scene->isph.alpha <= 1))
    TRY(config_error(config, config_child(config, group, "alpha"),
                     "a number from 0 to 1 is wanted"));
  if (!(scene->isph.relaxation_time > 0))
    TRY(config_error(config, config_child(config, group, "tau"),
                     "must be greater than 0; alpha = 0 switches the relaxation off"));
  if (!(scene->isph.support_ratio >= 1.5 && scene->isph.support_ratio <= 6))
    TRY(config_error(config, config_child(config, group, "support_ratio"),
                     "1.5 to 6 spacings are possible"));
  if (!(scene->isph.smagorinsky >= 0 && scene->isph.smagorinsky < 1))
    TRY(config_error(config, config_child(config, group, "smagorinsky"), "0 to 1 is possible"));
  double *tolerances[2] = {&scene->stokes.tolerance, &scene->isph.tolerance};
  for (int i = 0; i < 2; i++)
    if (*tolerances[i] <= 0 || *tolerances[i] >= 0.1) /* NAN: not given */
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

static enum status read_output(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *root = config_root(config), *group = config_child(config, root, "output");
  TRY(scene_positive(config, group, "interval", DIM_TIME, &scene->output_interval));
  TRY(scene_positive(config, group, "history_interval", DIM_TIME, &scene->history_interval));
  bool image = true;
  TRY(config_bool(config, group, "image", &image, NULL));
  scene->no_image = !image;
  config_node *fields = config_child(config, group, "fields");
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
    for (size_t k = 0; field_names[k] != NULL; k++)
      known = known || !strcmp(field_names[k], config_text_value(item));
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
  TRY(scene_positive(config, config_child(config, root, "checkpoint"), "interval", DIM_TIME,
                     &scene->checkpoint_interval));
cleanup:
  return status;
}

static int ascending(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Settings of soil with pores smaller than the voxel. */
static enum status read_micro(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *group = config_child(config, config_root(config), "micro");
  bool given;
  scene->micro.uncertainty = NAN;
  if (group != NULL && !*scene->model_path)
    TRY(config_error(config, group,
                     "is of soil with pores below the voxels of a model, and the "
                     "scene has none; leave it out"));
  TRY(config_quantities(config, group, "factors", DIM_NONE, 1, MICRO_FACTORS_MOST,
                        scene->micro.factors, &scene->micro.factor_count, &given));
  qsort(scene->micro.factors, (size_t)scene->micro.factor_count, sizeof(double), ascending);
  for (int i = 0; i < scene->micro.factor_count; i++)
    if (!(scene->micro.factors[i] > 0) ||
        (i > 0 && scene->micro.factors[i] == scene->micro.factors[i - 1]))
      TRY(config_error(config, config_child(config, group, "factors"),
                       "factors of the soil's permeability are wanted, above 0 and none twice, "
                       "like [0.1, 10.0]"));
  TRY(config_number(config, group, "uncertainty", &scene->micro.uncertainty, &given));
  if (given && !(scene->micro.uncertainty > 1 && scene->micro.uncertainty <= 1e6))
    TRY(config_error(config, config_child(config, group, "uncertainty"),
                     "a factor above 1 is wanted: 2.0 says that the permeability of the soil is "
                     "known to between half and twice"));
cleanup:
  return status;
}

enum status scene_read_settings(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  TRY(read_micro(config, scene));
  TRY(read_methods(config, scene));
  TRY(read_switches(config, scene));
  TRY(read_output(config, scene));
cleanup:
  return status;
}
