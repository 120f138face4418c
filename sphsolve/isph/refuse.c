/* Rejects scenes that method isph cannot solve correctly: each ends before the run with a one-line
 * message that says why, and what would work. */
#include "sphsolve/isph/method.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/effects/rain.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/speed_forecast.h"
#include "sphsolve/isph/window.h"

/* Least thickness in spacings of a wall with water on both sides, under a surface: air or water of
 * another level behind a thinner one would count as part of the neighbourhood of water that it
 * hides. The support is 2.4 spacings, and particles keep a fifth of one from each face. */
#define WALL_THICKNESS_MIN 2.0
/* Least water that an inflow brings, in spacings: it comes in whole rows of particles, and less
 * than one never comes. */
#define INFLOW_ROWS_MIN 1.0

/* Whether water or soil is at a site of the lattice; false outside. */
static bool is_wet(const struct lattice *l, const size_t at[3], int axis, double step) {
  const double k = (double)at[axis] + step;
  if (k < 0 || k >= (double)l->size[axis]) return false;
  size_t x[3] = {at[0], at[1], at[2]};
  x[axis] = (size_t)k;
  return l->kind[(x[2] * l->size[1] + x[1]) * l->size[0] + x[0]] == SITE_FLUID;
}

/* Refuses a wall of which a site is part if it is too thin there, with water on both sides. */
static enum status check_wall_site(const struct effect_context *context, const struct region *wall,
                                   const size_t at[3]) {
  const struct lattice *l = context->lattice;
  const double least = WALL_THICKNESS_MIN * context->spacing;
  for (int a = 0; a < 3; a++) {
    const double thick = wall->box[a + 3] - wall->box[a];
    if (!isph_scene_uses_axis(context, a) || thick > least * (1 - 1e-6) || !is_wet(l, at, a, -1))
      continue;
    const double rows = fmax(1, round(thick / l->spacing[a]));
    if (is_wet(l, at, a, rows))
      return FAIL(STATUS_INPUT,
                  "%s:%d: a wall %g m thick in %c with water on both sides is too thin under a "
                  "surface; make it %g m thick, two spacings, or domain.spacing %g m",
                  context->scene->path, wall->line, thick, "xyz"[a], least,
                  thick / WALL_THICKNESS_MIN);
  }
  return STATUS_OK;
}

/* Refuses polygons between the sites, of which no particle would be part. */
static enum status check_walls_held(const struct effect_context *context) {
  enum status status = STATUS_OK;
  const struct lattice *l = context->lattice;
  const struct scene *scene = context->scene;
  bool *held = NULL; /* whether a site is part of a region, or of the polygon that it begins */
  if (l->region == NULL) return STATUS_OK;
  TRY(memory_allocate(&held, scene->region_count, sizeof *held, "walls"));
  for (size_t site = 0; site < l->count; site++)
    if (l->region[site] > 0) held[scene->regions[l->region[site] - 1].first] = true;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *wall = &scene->regions[k];
    if (wall->type != REGION_WALL || wall->polygon == NULL || held[wall->first]) continue;
    TRY(FAIL(STATUS_INPUT,
             "%s:%d: this wall holds no site of the lattice; make it a spacing thick, %g m, or use "
             "a smaller domain.spacing",
             scene->path, wall->line, context->spacing));
  }
cleanup:
  memory_free(&held);
  return status;
}

/* Refuses the first wall under a surface with water on both sides that is too thin. */
static enum status check_walls(const struct effect_context *context) {
  enum status status = STATUS_OK;
  const struct lattice *l = context->lattice;
  const struct scene *scene = context->scene;
  const double least = WALL_THICKNESS_MIN * context->spacing;
  size_t site = 0;
  TRY(check_walls_held(context));
  if (!context->has_surface) return STATUS_OK;
  if (l->boxes != NULL && l->cut != NULL)
    return FAIL(STATUS_INPUT,
                "%s: a wall %g m thick with water on both sides is too thin under a surface; make "
                "it %g m thick, two spacings, or domain.spacing %g m",
                scene->path, l->thinnest, least, l->thinnest / WALL_THICKNESS_MIN);
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0]; i++, site++) {
        if (l->kind[site] != SITE_WALL || l->region == NULL || l->region[site] == 0) continue;
        const struct region *wall = &scene->regions[l->region[site] - 1];
        TRY(check_wall_site(context, wall, (size_t[3]){i, j, k}));
      }
cleanup:
  return status;
}

/* Area of an inflow's window, m^2 (m in 2-D): the product of its lengths without the smallest. */
static double area_of(const struct effect_context *context, const struct region *inflow) {
  double area = 1, thinnest = INFINITY;
  for (int a = 0; a < 3; a++) {
    if (!isph_scene_uses_axis(context, a)) continue;
    const double length = inflow->box[a + 3] - inflow->box[a];
    area *= length, thinnest = fmin(thinnest, length);
  }
  return area / thinnest;
}

static enum status check_heads(const struct scene *scene) {
  if (!(scene->gravity[2] > 0)) return STATUS_OK;
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].boundary == BOUNDARY_HEAD)
      return scene_error(scene, AT_FORCE,
                         "heads are heights above z = 0, and this gravity points up; let its z be "
                         "negative");
  return STATUS_OK;
}

/* The water of fluxes and rain needs room, or a side of given head or a drain by which it can
 * leave. */
static enum status check_inflows(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  const struct region *first = NULL;
  double in = 0, room = 0, site = 1;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    const bool inflow = region->type == REGION_INFLOW, rain = region->type == REGION_RAIN;
    if (region->type == REGION_DRAIN || (inflow && region->boundary == BOUNDARY_HEAD))
      return STATUS_OK;
    if (region->type == REGION_WELL) in -= scene_mean_given(scene, region, region->rate);
    if (rain) in += scene_mean_given(scene, region, region->rate) * isph_rain_area(scene, region);
    if (rain && first == NULL) first = region;
    if (!inflow) continue;
    if (region->table.count > 0) { /* what enters and leaves again needs no room of its own */
      in += scene_mean_given(scene, region, 0) * area_of(context, region);
      if (first == NULL) first = region;
      continue;
    }
    const double rows = region->flux * scene->end_time / context->spacing;
    if (rows > 0 && rows < INFLOW_ROWS_MIN)
      return FAIL(
          STATUS_INPUT,
          "%s:%d: an inflow of %g m/s brings %g m of water by scene.end_time, less than the "
          "row of %g m that it comes in by; use a domain.spacing below %g m, a longer "
          "scene.end_time, or from above a rain region, which brings less too",
          scene->path, region->line, region->flux, region->flux * scene->end_time, context->spacing,
          region->flux * scene->end_time);
    in += region->flux * area_of(context, region);
    if (region->flux > 0 && first == NULL) first = region;
  }
  if (!(in > 0)) return STATUS_OK;
  for (int a = 0; a < 3; a++)
    if (isph_scene_uses_axis(context, a)) site *= l->spacing[a];
  for (size_t p = 0; p < l->count; p++) {
    if (l->kind[p] != SITE_EMPTY) continue;
    const struct region *region =
        l->region != NULL && l->region[p] > 0 ? &scene->regions[l->region[p] - 1] : NULL;
    room += site * (region != NULL && region->type == REGION_POROUS ? region->porosity : 1);
  }
  if (first == NULL || in * scene->end_time <= room) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s:%d: inflows and rain bring %g m^%d by scene.end_time into room for %g, full "
              "after %g s; end before that, or give water a way out: an inflow region of given "
              "head or of flux < 0, or a drain",
              scene->path, first->line, in * scene->end_time, l->dimensions, room, room / in);
}

/* Soil that moves must not run into a closed side or a wall. */
static enum status check_moving_soil(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double near = 1e-6 * context->spacing;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *soil = &scene->regions[r];
    if (soil->type != REGION_POROUS) continue;
    for (int a = 0; a < 3; a++) {
      const double v = soil->soil_velocity[a];
      if (v == 0 || !isph_scene_uses_axis(context, a)) continue;
      const double face = v > 0 ? soil->box[a + 3] : soil->box[a], end = face + v * scene->end_time;
      double stop = scene->periodic[a] ? copysign(INFINITY, v) : v > 0 ? scene->domain_size[a] : 0;
      for (size_t w = 0; w < scene->region_count; w++) {
        const struct region *wall = &scene->regions[w];
        bool beside = wall->type == REGION_WALL;
        for (int b = 0; b < 3; b++)
          if (b != a && isph_scene_uses_axis(context, b))
            beside = beside && wall->box[b] < soil->box[b + 3] - near &&
                     wall->box[b + 3] > soil->box[b] + near;
        if (!beside) continue;
        if (v > 0 && wall->box[a] >= face - near) stop = fmin(stop, wall->box[a]);
        if (v < 0 && wall->box[a + 3] <= face + near) stop = fmax(stop, wall->box[a + 3]);
      }
      if (v > 0 ? end > stop + near : end < stop - near)
        return FAIL(STATUS_INPUT,
                    "%s:%d: this soil moves into the wall at %g m in %c, which it reaches after %g "
                    "s; end before that, or let it move slower",
                    scene->path, soil->line, stop, "xyz"[a], (stop - face) / v);
    }
  }
  return STATUS_OK;
}

/* Moments of the run at which the places of walls are checked. */
#define MOMENTS 256

/* The box of a wall, `box` at the start, at time t. */
static void wall_at(const struct region *wall, const double start[6], double t, double box[6]) {
  for (int e = 0; e < 6; e++) {
    const int a = e % 3;
    box[e] = start[e] + (wall->table.count > 0 ? time_table_integral(&wall->table, 0, t, a)
                                               : wall->velocity[a] * t);
  }
}

/* Whether two boxes overlap by more than rounding. */
static bool overlap(const struct effect_context *context, const double a[6], const double b[6]) {
  const double near = 1e-6 * context->spacing;
  for (int c = 0; c < 3; c++)
    if (isph_scene_uses_axis(context, c) && (a[c] > b[c + 3] - near || b[c] > a[c + 3] - near))
      return false;
  return true;
}

/* Whether a box reaches out of the domain by more than rounding; walls do not come in again at
 * periodic sides. */
static bool reaches_out(const struct effect_context *context, const double box[6]) {
  const struct scene *scene = context->scene;
  const double near = 1e-6 * context->spacing;
  for (int a = 0; a < 3; a++)
    if (isph_scene_uses_axis(context, a) &&
        (box[a] < -near || box[a + 3] > scene->domain_size[a] + near))
      return true;
  return false;
}

/* Walls must not move through each other; of one that leaves the domain is told when. */
static enum status check_moving_walls(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  for (size_t w = 0; w < scene->region_count && context->has_moving_wall; w++) {
    const struct region *wall = &scene->regions[w];
    if (wall->type != REGION_WALL || isph_region_speed(scene, wall) == 0) continue;
    bool out = reaches_out(context, wall->extent) || wall->first != w;
    for (int n = 1; n <= MOMENTS; n++) {
      const double t = scene->end_time * n / MOMENTS;
      double box[6], other_box[6];
      wall_at(wall, wall->extent, t, box);
      if (!out && reaches_out(context, box)) {
        log_warning("%s:%d: from %.3g s on this wall leaves the domain; what is outside does not "
                    "act on the water",
                    scene->path, wall->line, t);
        out = true;
      }
      wall_at(wall, wall->box, t, box);
      for (size_t k = 0; k < scene->region_count; k++) {
        const struct region *other = &scene->regions[k];
        if (other->type != REGION_WALL || other->first == wall->first ||
            overlap(context, wall->box, other->box))
          continue;
        wall_at(other, other->box, t, other_box);
        if (overlap(context, box, other_box))
          return FAIL(STATUS_INPUT,
                      "%s:%d: this wall moves into that of line %d at %.3g s; end before that, or "
                      "let it stop",
                      scene->path, wall->line, other->line, t);
      }
    }
  }
  return STATUS_OK;
}

/* Whether water touches a wall, of a region or several, on the low or high side of an axis. */
static bool touches_water(const struct lattice *l, const struct region *wall, int axis, int end) {
  size_t site = 0;
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0]; i++, site++) {
        const size_t at[3] = {i, j, k};
        if (l->region[site] > wall->first && l->region[site] <= wall->end &&
            is_wet(l, at, axis, end))
          return true;
      }
  return false;
}

/* A piston in a domain full of water, out of which there is no way, would press it together. */
static enum status check_pistons(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  if (context->has_surface || context->has_inflow || context->lattice->region == NULL)
    return STATUS_OK;
  for (size_t r = 0; r < scene->region_count; r++)
    if (region_is_sink(&scene->regions[r])) return STATUS_OK;
  for (size_t w = 0; w < scene->region_count; w = scene->regions[w].end) {
    const struct region *wall = &scene->regions[w];
    for (int a = 0; a < 3 && wall->type == REGION_WALL; a++)
      if (isph_scene_uses_axis(context, a) && !scene->periodic[a] && wall->velocity[a] != 0 &&
          touches_water(context->lattice, wall, a, -1) !=
              touches_water(context->lattice, wall, a, 1))
        return FAIL(STATUS_INPUT,
                    "%s:%d: this wall moves in %c with water on one side alone, and the domain is "
                    "full: leave room above the water, or give it a way out, an inflow region of "
                    "given head",
                    scene->path, wall->line, "xyz"[a]);
  }
  return STATUS_OK;
}

/* A run without an end time ends when its flow is steady. Water with a surface never comes quite to
 * rest, and if nothing drives the water there is no velocity that could become steady. */
static enum status check_end(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  bool driven = context->has_inflow;
  if (isfinite(scene->end_time)) return STATUS_OK;
  for (int a = 0; a < 3; a++) driven = driven || (scene->periodic[a] && scene->driving[a] != 0);
  if (driven && !context->has_surface) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s: scene.end_time is missing, like end_time = \"10 s\": %s, so no steady flow "
              "would end the run",
              scene->path,
              context->has_surface ? "water with a surface keeps moving a little"
                                   : "nothing drives water through the domain");
}

/* Unsaturated soil is for method richards, and so is a prescribed suction; beds for it and darcy.
 */
static enum status check_soils(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    const struct retention_curve *curve = &region->retention;
    if (region->anisotropic)
      return FAIL(
          STATUS_INPUT,
          "%s:%d: permeability: method isph knows no beds; leave the method out, and where "
          "the water has a surface in the soil give that a van_genuchten, haverkamp or gardner",
          scene->path, region->line);
    if (curve->given || region->boundary == BOUNDARY_PRESSURE)
      return FAIL(STATUS_INPUT,
                  "%s:%d: %s is of soil that is not full of water, and method isph fills it or "
                  "leaves it dry; write method = \"richards\"%s, or leave it out",
                  scene->path, region->line, curve->given ? retention_name(curve) : "pressure_head",
                  curve->given ? "" : " and give the soil its van_genuchten, haverkamp or gardner");
    if (region->ponding > 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: ponding: in method isph rain stands wherever the soil does not take it; "
                  "leave it out",
                  scene->path, region->line);
  }
  return STATUS_OK;
}

/* A window lies before water or soil. Behind a wall its water would come and go inside the wall. */
static enum status check_windows(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  for (size_t r = 0; r < scene->region_count && l->region != NULL; r++) {
    const struct region *inflow = &scene->regions[r];
    bool at_low = false;
    if (inflow->type != REGION_INFLOW) continue;
    const int axis = scene_inflow_axis(scene, inflow, &at_low);
    size_t site = 0;
    for (size_t k = 0; k < l->size[2]; k++)
      for (size_t j = 0; j < l->size[1]; j++)
        for (size_t i = 0; i < l->size[0]; i++, site++) {
          const size_t at[3] = {i, j, k};
          if (l->kind[site] != SITE_WALL || l->region[site] == 0 ||
              !isph_window_has_site(l, inflow, axis, at_low, at))
            continue;
          const struct region *wall = &scene->regions[l->region[site] - 1];
          if (isph_region_speed(scene, wall) > 0) continue;
          return FAIL(STATUS_INPUT,
                      "%s:%d: this side lies behind the wall of line %d in part, inside which its "
                      "water would come and go; let the box end where the wall begins",
                      scene->path, inflow->line, wall->line);
        }
  }
  return STATUS_OK;
}

/* The porosity of a site, 1 in free water. */
static double porosity_at(const struct effect_context *context, const size_t at[3]) {
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  double porosity = 1;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *soil = &scene->regions[r];
    bool inside = soil->type == REGION_POROUS;
    for (int a = 0; a < 3 && inside; a++) {
      const double x = l->origin[a] + (double)at[a] * l->spacing[a];
      inside = !isph_scene_uses_axis(context, a) || (x >= soil->box[a] && x < soil->box[a + 3]);
    }
    if (inside) porosity = soil->porosity;
  }
  return porosity;
}

/* The spacing of the particles in the tightest soil. All hold the water of a site where the
 * porosity is largest, of free water unless soil fills the domain (isph/place.c). */
static double widest_spacing(const struct effect_context *context) {
  const struct lattice *l = context->lattice;
  double most = context->has_surface ? 1 : 0;
  for (size_t k = 0, site = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0] && most < 1; i++, site++)
        if (l->kind[site] == SITE_FLUID)
          most = fmax(most, porosity_at(context, (const size_t[3]){i, j, k}));
  return context->spacing *
         pow(most / isph_soil_minimum(context->scene), 1.0 / context->lattice->dimensions);
}

/* A particle must not be its own neighbour through a periodic side. In soil kernels end at the
 * domain's width, but a row of less than two particles has no neighbours but its own images. */
static enum status check_periodic(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double widest =
      context->spacing * pow(isph_soil_minimum(scene), -1.0 / context->lattice->dimensions);
  for (int a = 0; a < 3; a++)
    if (isph_scene_uses_axis(context, a) && scene->periodic[a] &&
        scene->domain_size[a] < context->support)
      return scene_error(scene, AT_SIZE,
                         "%.4g m along the periodic axis %c is less than the kernel's support of "
                         "%.4g m; make the domain wider or the spacing smaller",
                         scene->domain_size[a], "xyz"[a], context -> support);
  for (int a = 0; a < 3; a++) {
    const double length = scene->domain_size[a];
    if (!isph_scene_uses_axis(context, a) || !scene->periodic[a] ||
        length >= SOIL_ROW_MIN * widest * (1 - 1e-9))
      continue;
    const double least = SOIL_ROW_MIN * widest_spacing(context);
    if (length < least * (1 - 1e-9))
      return scene_error(scene, AT_SIZE,
                         "%.4g m along the periodic axis %c is less than %g particles in the soil "
                         "of porosity %g, %.4g m; make the domain wider or the spacing smaller",
                         length, "xyz"[a], SOIL_ROW_MIN, isph_soil_minimum(scene), least);
  }
  return STATUS_OK;
}

enum status isph_refuse(const struct effect_context *context) {
  enum status status = STATUS_OK;
  TRY(check_periodic(context));
  TRY(check_soils(context->scene));
  TRY(check_end(context));
  TRY(check_walls(context));
  TRY(check_windows(context));
  for (size_t k = 0; isph_effects[k] != NULL; k++)
    if (isph_effects[k]->refuse != NULL) TRY(isph_effects[k]->refuse(context));
  TRY(check_heads(context->scene));
  if (isfinite(context->scene->end_time)) {
    TRY(check_inflows(context));
    TRY(check_moving_soil(context));
    TRY(check_moving_walls(context));
    TRY(check_pistons(context));
  }
cleanup:
  return status;
}
