#include "sphsolve/wcsph/plan.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/kernel.h"
#include "common/units.h"
#include "sphsolve/error/cascade.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/stokes/method.h"
#include "sphsolve/stokes/solver/state.h"
#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/modes.h"
#include "sphsolve/wcsph/state.h"

double wcsph_gap(const struct lattice *lattice) {
  size_t faces[3];
  lattice_count_faces(lattice, faces);
  return 2 * (double)lattice->fluid_count / (double)(faces[0] + faces[1] + faces[2]);
}

static double region_speed(const struct scene *scene) {
  double most = 0;
  for (size_t r = 0; r < scene->region_count; r++) {
    const double *v = scene->regions[r].velocity;
    most = fmax(most, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]));
  }
  return most;
}

/* Length of the box along the force. */
static double path_length(const struct scene *scene, const struct lattice *lattice) {
  const int along = scene_axis_along(scene->driving);
  return (double)lattice->size[along] * lattice->spacing[along];
}

enum status wcsph_scales(struct plan *plan) {
  struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  const struct lattice *lattice = context->lattice;
  if (!pair_table_exists(scene->wcsph.kernel)) {
    char known[100] = "";
    for (int k = 0; k < KERNELS; k++)
      if (pair_table_exists((enum kernel)k))
        snprintf(known + strlen(known), sizeof known - strlen(known), "%s\"%s\"",
                 *known ? " or " : "", kernel_names[k]);
    return scene_error(scene, AT_WCSPH_KERNEL, "wcsph has no loops with this kernel; write %s",
                       known);
  }
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].type == REGION_WALL && scene->regions[r].slip)
      return FAIL(STATUS_INPUT,
                  "%s:%d: wcsph has no-slip walls only; leave slip out, or use "
                  "method = \"isph\"",
                  scene->path, scene->regions[r].line);
  context->kernel = scene->wcsph.kernel;
  context->support =
      isnan(scene->wcsph.support) ? SUPPORT_DEFAULT * context->spacing : scene->wcsph.support;
  double widest = 0, least = INFINITY;
  for (int a = 0; a < 3; a++) {
    if (lattice->dimensions == 2 && a == 1) continue;
    widest = fmax(widest, lattice->spacing[a]);
    least = fmin(least, lattice->spacing[a]);
  }
  if (context->support < 1.5 * widest || context->support > 6 * least)
    return scene_error(scene, AT_WCSPH_SUPPORT,
                       "%g m is %.2f spacings; 1.5 to 6 make sense, 2.9 is the default",
                       context->support, context->support / widest);
  context->smoothing_length = context->support / kernel_support_ratio(context->kernel);

  double porosity = (double)lattice->fluid_count / lattice->bulk_count;
  double peak = *scene->model_path ? PEAK_VELOCITY_MODEL : 2;
  double speed = fmax(region_speed(scene), peak * context->velocity_scale / porosity);
  if (lattice->wall_count == 0) speed = region_speed(scene);
  context->velocity_scale = speed;
  double head = sqrt(context->driving * path_length(scene, lattice) / COMPRESSION);
  /* A lower sound speed does not allow a larger time step: viscosity then limits it. */
  double creep = 2 * context->kinematic_viscosity / context->smoothing_length;
  if (lattice->wall_count == 0) creep = 0;
  char *why = context->sound_why, text[32];
  if (!isnan(scene->wcsph.sound_speed)) {
    context->sound_speed = scene->wcsph.sound_speed;
    /* A slightly too small value is left to the watchdog; a value this small has a wrong unit. */
    if (context->sound_speed < 1e-4 * speed)
      return scene_error(
          scene, AT_SOUND,
          "%g m/s is far below the largest velocity expected, %g m/s; write \"auto\", "
          "or ten times that velocity",
          context->sound_speed, speed);
    snprintf(why, EFFECT_WHY, "the scene says so");
  } else if (10 * speed > fmax(head, creep)) {
    context->sound_speed = 10 * speed;
    snprintf(why, EFFECT_WHY, "ten times the largest velocity expected, %.3g m/s", speed);
    if (context->inertia > ERGUN_TOLD && lattice->wall_count > 0)
      snprintf(why + strlen(why), EFFECT_WHY - strlen(why),
               " (Ergun: inertia takes %s %% of the force)",
               percent_format(context->inertia, text));
  } else {
    context->sound_speed = fmax(head, creep);
    snprintf(why, EFFECT_WHY,
             head > creep ? "density within 1 %% under the force over the length of the box"
                          : "2 nu/h: below it sound creeps behind viscosity");
  }
  if (!(context->sound_speed > 0))
    return scene_error(scene, AT_FORCE,
                       "nothing drives a flow: give a force, a moving wall or an initial velocity, "
                       "or wcsph.sound_speed");
  return STATUS_OK;
}

bool wcsph_eulerian(const struct effect_context *context, char why[EFFECT_WHY]) {
  const double cell = context->velocity_scale * context->spacing / context->kinematic_viscosity;
  const struct scene *scene = context->scene;
  const char *moves = scene->wcsph.wall != WALL_SUBVOXEL    ? "wcsph.wall is another"
                      : !context->has_wall                  ? "no walls"
                      : context->has_moving_wall            ? "a wall region has a velocity"
                      : scene->shifting != SWITCH_AUTO      ? "the scene chose about shifting"
                      : !(context->kinematic_viscosity > 0) ? "no viscosity"
                                                            : NULL;
  const bool eulerian = moves == NULL && cell < ADVECTION_CELL_REYNOLDS;
  if (why == NULL) return eulerian;
  if (moves != NULL)
    snprintf(why, EFFECT_WHY, "particles move: %s", moves);
  else
    snprintf(why, EFFECT_WHY, "u dx/nu = %.2g with the largest velocity expected, %s %g: %s", cell,
             eulerian ? "below" : "not below", ADVECTION_CELL_REYNOLDS,
             eulerian ? "particles may stay on their lattice points" : "particles move");
  return eulerian;
}

enum pass_wall wcsph_pass_wall(const struct effect_context *context) {
  const enum wall_scheme wall = context->scene->wcsph.wall;
  return wall == WALL_FROZEN             ? PASS_FROZEN
         : !context->has_wall            ? PASS_OPEN
         : wall == WALL_ADAMI            ? PASS_ADAMI
         : wcsph_eulerian(context, NULL) ? PASS_EULERIAN
                                         : PASS_SUBVOXEL;
}

double wcsph_sound_for_dt(const struct effect_context *context) {
  return (wcsph_eulerian(context, NULL) ? 2 : 1) * context->sound_speed;
}

double wcsph_diffusion(const struct effect_context *context) {
  const double c = context->sound_speed, dx = context->spacing, nu = context->kinematic_viscosity;
  if (context->scene->wcsph.wall == WALL_FROZEN) return 0;
  if (!(nu > 0 && context->has_wall)) return DELTA_DIFFUSION * context->smoothing_length * c;
  if (wcsph_eulerian(context, NULL)) return c * c * WCSPH_STABILISATION_EULERIAN * dx * dx / nu;
  return c * c *
         fmin(WCSPH_STABILISATION * dx * dx / nu,
              STABILISATION_INERTIAL * dx / context->velocity_scale);
}

/* Collects the active effects that have their own force. */
static enum status own_forces(const struct plan *plan, struct engine_settings *settings) {
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct effect *effect = plan->effects[i].effect;
    if (!plan->effects[i].on || effect->force == NULL) continue;
    if (settings->own_count == ENGINE_OWN)
      return FAIL(STATUS_RUN, "more than %d effects with a force of their own", ENGINE_OWN);
    settings->own[settings->own_count++] = (struct engine_own){effect->name, effect->force};
  }
  return STATUS_OK;
}

enum status wcsph_settings(const struct scene *scene, const struct plan *plan,
                           double (*region_velocity)[3], struct engine_settings *settings) {
  const struct effect_context *context = &plan->context;
  memset(settings, 0, sizeof *settings);
  settings->wall = wcsph_pass_wall(context);
  plan_switch(plan, settings);
  settings->kernel = context->kernel;
  settings->smoothing_length = context->smoothing_length;
  settings->support = context->support;
  settings->sound_speed = context->sound_speed;
  settings->kinematic_viscosity = context->kinematic_viscosity;
  settings->dt = plan->dt;
  memcpy(settings->force, scene->driving, sizeof settings->force);
  const struct lattice_modes modes = wcsph_modes_of(context);
  settings->rest_ratio = scene->wcsph.equation_of_state == EOS_GAUGE ? modes.sum : 0;
  settings->moment = modes.moment;
  settings->shifting_stiffness = modes.shifting_stiffness;
  settings->weights = modes.weights;
  settings->pressure_diffusion = wcsph_diffusion(context);
  for (size_t r = 0; r < scene->region_count; r++)
    memcpy(region_velocity[r], scene->regions[r].velocity, sizeof *region_velocity);
  settings->region_velocity = (const double(*)[3])region_velocity;
  settings->region_count = scene->region_count;
  return own_forces(plan, settings);
}

/* Number of steps until the pressure of a porous body is steady along the force to within 1/20: it
 * diffuses by Darcy's law with c^2/(1 + dt D w) k/nu (effects/pressure_diffusion.h), k from Kozeny
 * and Carman. */
static double pressure_steps(const struct plan *plan, const struct lattice_modes *modes) {
  const struct effect_context *context = &plan->context;
  const struct lattice *lattice = context->lattice;
  const double c = context->sound_speed, diffusion = wcsph_diffusion(context);
  const double porosity = (double)lattice->fluid_count / lattice->bulk_count;
  if (!*context->scene->model_path || !(context->driving > 0) || !(diffusion > 0)) return 0;
  const double darcy = context->velocity_scale * porosity / PEAK_VELOCITY_MODEL;
  const double spread =
      c * c / (1 + plan->dt * diffusion * modes->weights) * darcy / (porosity * context->driving);
  const double wave = 2 * M_PI / path_length(context->scene, lattice);
  return 3 / (plan->dt * spread * wave * wave);
}

enum status wcsph_cost(struct plan *plan, int threads) {
  const struct effect_context *context = &plan->context;
  const struct scene *scene = context->scene;
  const struct lattice *lattice = context->lattice;
  double stable = INFINITY, accurate = INFINITY, own = INFINITY;
  const char *accurate_by = NULL;
  threads = engine_threads(lattice, context->support, threads);
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    const struct effect *effect = planned->effect;
    const char *by = effect->limit != NULL ? effect->limit : effect->name;
    if (!planned->on) continue;
    if (effect->dt_accuracy && planned->dt_max < accurate)
      accurate = planned->dt_max, accurate_by = by;
    if (effect->force != NULL) own = fmin(own, planned->dt_max);
    if (!effect->dt_accuracy && planned->dt_max < stable)
      stable = planned->dt_max, plan->dt_limited_by = by, plan->dt_power = effect->dt_power;
  }
  const struct lattice_modes modes = wcsph_modes_of(context);
  const bool absolute =
      scene->wcsph.wall == WALL_FROZEN && scene->wcsph.equation_of_state == EOS_ABSOLUTE;
  plan->dt_limit = lattice_modes_dt(&modes, absolute, wcsph_sound_for_dt(context),
                                    context->kinematic_viscosity, wcsph_diffusion(context));
  if (own < plan->dt_limit) plan->dt_limit = own;
  plan->dt = DT_SAFETY * plan->dt_limit;
  plan->dt_by = plan->dt_limited_by;
  /* Limits of accuracy, which a dt given by the scene may exceed. */
  if (accurate < plan->dt) plan->dt = accurate, plan->dt_by = accurate_by;
  if (!isnan(scene->wcsph.dt)) plan->dt = scene->wcsph.dt, plan->dt_by = "scene";
  /* A whole number of steps between the history rows that the scene requests. */
  if (isnan(scene->wcsph.dt) && scene->history_interval > plan->dt)
    plan->dt = scene->history_interval / ceil(scene->history_interval / plan->dt - 1e-9);
  if (plan->dt > plan->dt_limit && !scene->wcsph.force_dt)
    return scene_error(scene, AT_WCSPH_DT,
                       "%g s is beyond the stable %g s (%s, sound speed %g m/s); write dt = "
                       "\"auto\" or a smaller one, or wcsph.force_dt = true",
                       plan->dt, plan->dt_limit, plan->dt_limited_by, context->sound_speed);

  struct engine_settings settings = {.wall = wcsph_pass_wall(context)};
  plan_switch(plan, &settings);
  const enum status status = own_forces(plan, &settings);
  if (status != STATUS_OK) return status;
  const bool eulerian = settings.wall == PASS_EULERIAN;
  const bool subvoxel = eulerian || settings.wall == PASS_SUBVOXEL;
  double site = 1 + (lattice->wall_distance != NULL && subvoxel ? sizeof(float) : 0);
  plan->bytes_fluid = engine_bytes_fluid(&settings) + site;
  plan->bytes_wall = engine_bytes_wall(&settings) + site;
  struct particle_fields fields = engine_fields(&settings);
  plan->bytes_disk =
      (double)particles_bytes_kept(&fields) * SLOTS_FLUID * (double)lattice->fluid_count +
      (double)lattice->count *
          ((lattice->region != NULL ? 2 : 0) + (lattice->wall_distance && !subvoxel ? 4 : 0));
  plan->bytes_method = plan->bytes_fluid * (double)lattice->fluid_count +
                       plan->bytes_wall * (double)lattice->wall_count +
                       threads * engine_bytes_thread(lattice, context->support);

  double gap = wcsph_gap(lattice), wide = gap + (settings.wall == PASS_FROZEN ? 1 : 0);
  double time = wide * wide * context->spacing * context->spacing / context->kinematic_viscosity;
  if (!(scene->steady_tolerance > 0) || !isfinite(time)) time = INFINITY;
  time = fmin(scene->end_time, 2 * time);
  plan->steps = ceil(time / plan->dt);
  if (eulerian && isfinite(time) && scene->steady_tolerance > 0)
    plan->steps =
        ceil(fmin(plan->steps + pressure_steps(plan, &modes), scene->end_time / plan->dt));
  if (scene->steady_tolerance > 0)
    plan->steps = fmax(plan->steps, fmin(WCSPH_SAMPLES_LEAST, ceil(scene->end_time / plan->dt)));
  double passes = settings.wall == PASS_FROZEN ? PASSES_FROZEN : 2;
  plan->seconds = plan->steps * passes * modes.neighbours * (double)lattice->fluid_count /
                  (PAIRS_PER_SECOND * threads);
  const double split = cascade_seconds(scene, plan, true);
  plan->seconds += split / threads;
  plan->bytes_sides = stokes_sides_finer_bytes(plan);
  plan->seconds_sides = cascade_sides_finer_seconds(plan, false) / threads;
  if (split > 0)
    plan->bytes_split =
        stokes_solver_bytes((double)lattice->count, (double)lattice->fluid_count, false);
  plan->expected = error_forecast_of(&plan->shape, &method_wcsph, scene->wcsph.wall, 1);
  return STATUS_OK;
}
