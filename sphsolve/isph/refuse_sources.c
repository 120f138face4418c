/* Rejects wells, drains, rain and absorbing sides that method isph cannot solve correctly, as
 * isph/refuse.c does. */
#include "sphsolve/isph/method.h"

#include <math.h>

#include "sphsolve/isph/effects/absorbing.h"
#include "sphsolve/isph/rain.h"

/* Least width of a well in spacings: a narrower one holds too few particles. */
#define WELL_WIDTH_MIN 3.0

/* Whether soil that does not move is at a site. The lattice only has the last region there, which
 * may be the water that fills the soil. */
static bool soil_stays_at(const struct effect_context *context, size_t site, const double x[3]) {
  const struct scene *scene = context->scene;
  const struct region *soil = NULL;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    bool inside = region->type == REGION_POROUS;
    for (int a = 0; a < 3; a++)
      if (isph_scene_uses_axis(context, a))
        inside = inside && x[a] > region->box[a] && x[a] < region->box[a + 3];
    if (inside) soil = region;
  }
  if (soil == NULL || context->lattice->kind[site] == SITE_WALL) return false;
  return soil->soil_velocity[0] == 0 && soil->soil_velocity[1] == 0 && soil->soil_velocity[2] == 0;
}

/* Wells have to be in soil that does not move; what they take has to come from somewhere. */
enum status isph_refuse_wells(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  const double width_least = WELL_WIDTH_MIN * context->spacing;
  bool source = context->has_surface, inflow = context->has_surface;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    inflow = inflow || region->type == REGION_INFLOW;
    source = source || (region->type == REGION_INFLOW && region->boundary == BOUNDARY_HEAD);
  }
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *well = &scene->regions[r];
    const bool is_well = well->type == REGION_WELL;
    size_t site = 0;
    if (!is_well && well->type != REGION_DRAIN) continue;
    const char *kind = region_type_names[well->type];
    for (int a = 0; a < 3; a++)
      if (isph_scene_uses_axis(context, a) &&
          well->extent[a + 3] - well->extent[a] < width_least * (1 - 1e-6))
        return FAIL(STATUS_INPUT,
                    "%s:%d: this %s is %g m wide in %c, and holds too few particles; make it %g m, "
                    "three spacings, or domain.spacing %g m",
                    scene->path, well->line, kind, well->extent[a + 3] - well->extent[a], "xyz"[a],
                    width_least, (well->extent[a + 3] - well->extent[a]) / WELL_WIDTH_MIN);
    if (is_well ? !source && well->rate > 0 : !inflow)
      return FAIL(STATUS_INPUT,
                  "%s:%d: nothing gives what this %s takes; let an inflow region%s, or a free "
                  "surface, give it",
                  scene->path, well->line, kind, is_well ? " of given head" : "");
    for (size_t k = 0; k < l->size[2]; k++)
      for (size_t j = 0; j < l->size[1]; j++)
        for (size_t i = 0; i < l->size[0]; i++, site++) {
          const size_t at[3] = {i, j, k};
          double x[3];
          bool inside = true;
          for (int a = 0; a < 3; a++) {
            x[a] = l->origin[a] + (double)at[a] * l->spacing[a];
            if (isph_scene_uses_axis(context, a))
              inside = inside && x[a] > well->box[a] && x[a] < well->box[a + 3];
          }
          if (inside && !soil_stays_at(context, site, x))
            return FAIL(
                STATUS_INPUT,
                "%s:%d: a %s takes water out of soil that stays; at (%g, %g, %g) m there is "
                "none: keep it within a porous region",
                scene->path, well->line, kind, x[0], x[1], x[2]);
        }
  }
  return STATUS_OK;
}

/* Most rows of particles that rain may bring in a step of water at rest, whose length the force
 * limits; with more, they pile up in the air. */
#define RAIN_ROWS_MAX 0.2

/* The top of a rain's box must be free of walls, since rain falls from there. */
static enum status check_top(const struct effect_context *context, const struct region *rain) {
  const struct scene *scene = context->scene;
  const double near = 1e-6 * context->spacing;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *wall = &scene->regions[k];
    bool covers = wall->type == REGION_WALL && wall->box[2] < rain->box[5] - near &&
                  wall->box[5] > rain->box[5] - near;
    for (int a = 0; a < 2; a++)
      covers = covers &&
               (!isph_scene_uses_axis(context, a) ||
                (wall->box[a] < rain->box[a + 3] - near && wall->box[a + 3] > rain->box[a] + near));
    if (covers)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain falls from the top of its box, at z = %g m, which the wall of line "
                  "%d covers in part; leave that part out, or let it begin elsewhere",
                  scene->path, rain->line, rain->box[5], wall->line);
  }
  return STATUS_OK;
}

enum status isph_refuse_rain(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double *g = scene->gravity, dx = context->spacing;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *rain = &scene->regions[k];
    if (rain->type != REGION_RAIN) continue;
    if (!(g[2] < 0) || scene->periodic[2])
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain falls along -z onto what lies below: force.gravity has to point "
                  "there, and domain.periodic be false in z",
                  scene->path, rain->line);
    if (!context->has_surface)
      return FAIL(STATUS_INPUT,
                  "%s:%d: water fills the domain, so rain has no surface to fall on; leave room "
                  "above it",
                  scene->path, rain->line);
    const double fastest = RAIN_ROWS_MAX / 0.25 * sqrt(dx * -g[2]);
    if (rain->rate > fastest)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain of %g m/s comes faster than water falls out of its way, %g m/s at "
                  "this spacing; for a jet use an inflow region",
                  scene->path, rain->line, rain->rate, fastest);
    const double brings = scene_mean_given(scene, rain, rain->rate) * scene->end_time,
                 area = isph_rain_area(scene, rain);
    const double least = pow(dx, scene->dimensions);
    if (brings > 0 && brings * area < least)
      return FAIL(STATUS_INPUT,
                  "%s:%d: rain brings %g m of water by scene.end_time, on its area less than one "
                  "particle; use a domain.spacing below %.3g m or a longer scene.end_time",
                  scene->path, rain->line, brings, pow(brings * area, 1.0 / scene->dimensions));
    const enum status status = check_top(context, rain);
    if (status != STATUS_OK) return status;
  }
  return STATUS_OK;
}

/* Absorbing regions lie before a single closed side, in free water. */
enum status isph_refuse_absorbing(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    bool low;
    if (region->type != REGION_ABSORBING) continue;
    const int axis = absorbing_axis(scene, region, &low);
    if (scene->gravity[scene_axis_along(scene->gravity)] == 0)
      return FAIL(STATUS_INPUT, "%s:%d: an absorbing region takes waves, which need force.gravity",
                  scene->path, region->line);
    if (!context->has_surface)
      return FAIL(
          STATUS_INPUT,
          "%s:%d: water fills the domain, so there are no waves to absorb; leave room above "
          "it, or the region out",
          scene->path, region->line);
    if (axis < 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: an absorbing region lies against one upright side of the domain that is "
                  "not periodic; let its box reach one such side, or from side to side",
                  scene->path, region->line);
    for (size_t j = 0; j < scene->region_count; j++) {
      const struct region *other = &scene->regions[j];
      bool meets = other->type == REGION_POROUS || other->type == REGION_INFLOW ||
                   (other->type == REGION_ABSORBING && j < k);
      for (int a = 0; a < 3 && meets; a++)
        meets = !isph_scene_uses_axis(context, a) ||
                (other->box[a] < region->box[a + 3] && region->box[a] < other->box[a + 3]);
      if (meets)
        return FAIL(STATUS_INPUT,
                    "%s:%d: the absorbing region would brake what flows in the %s region of line "
                    "%d; let them not overlap",
                    scene->path, region->line, region_type_names[other->type], other->line);
    }
  }
  return STATUS_OK;
}
