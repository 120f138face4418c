/* Rejects scenes that method richards cannot solve: each ends before the run with a one-line
 * message that says why, and what would work. */
#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/darcy/basin.h"
#include "sphsolve/darcy/constants.h"
#include "sphsolve/darcy/domain.h"
#include "sphsolve/darcy/method.h"
#include "sphsolve/darcy/open_water.h"

static enum status check_soil(const struct scene *scene, const struct region *region) {
  const double *v = region->soil_velocity;
  if (!region->retention.given)
    return FAIL(
        STATUS_INPUT,
        "%s:%d: this soil has no van_genuchten, haverkamp or gardner, and others have: all of a "
        "scene has one, or none; give its curve, or take the others' away for soil that is "
        "full or dry, and leave the method out",
        scene->path, region->line);
  if (v[0] != 0 || v[1] != 0 || v[2] != 0)
    return FAIL(STATUS_INPUT,
                "%s:%d: velocity: soil that is not full of water stays where it is; leave it out",
                scene->path, region->line);
  if (region->anisotropic && region->anisotropy[2] != 0)
    return FAIL(STATUS_INPUT,
                "%s:%d: bedding: beds in soil that is not full of water lie along x and z; give "
                "the permeability along these, without bedding",
                scene->path, region->line);
  if (region->dry)
    return FAIL(STATUS_INPUT,
                "%s:%d: saturated: how wet this soil starts is said by head, pressure_head or "
                "water_content; leave it out",
                scene->path, region->line);
  if (region->retention.starts_by == START_HEAD && scene->driving[2] == 0)
    return FAIL(STATUS_INPUT,
                "%s:%d: head: without gravity no level says how wet soil is; give pressure_head or "
                "water_content",
                scene->path, region->line);
  return STATUS_OK;
}

static enum status check_region(const struct scene *scene, const struct region *region) {
  switch (region->type) {
  case REGION_POROUS:
    return check_soil(scene, region);
  case REGION_WATER:
    if (!(scene->driving[2] < 0) || region->velocity[0] != 0 || region->velocity[1] != 0 ||
        region->velocity[2] != 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: free water beside soil that is not full is at rest under gravity along "
                  "-z: give that, and leave velocity out",
                  scene->path, region->line);
    return STATUS_OK;
  case REGION_WELL:
  case REGION_DRAIN:
    return STATUS_OK; /* check_well */
  case REGION_ABSORBING:
    return FAIL(STATUS_INPUT,
                "%s:%d: method richards has no %s; an inflow region on a side has a head or a flux",
                scene->path, region->line, region_type_names[region->type]);
  case REGION_INFLOW:
    if (region->boundary == BOUNDARY_HEAD && scene->driving[2] == 0)
      return FAIL(STATUS_INPUT,
                  "%s:%d: head: without gravity a level has no pressure; give pressure_head",
                  scene->path, region->line);
    if (region->radiates)
      return FAIL(STATUS_INPUT, "%s:%d: radiates: method richards has no waves; leave it out",
                  scene->path, region->line);
    return STATUS_OK;
  case REGION_RAIN:
    if (!(scene->driving[2] < 0))
      return FAIL(STATUS_INPUT, "%s:%d: rain needs a gravity along -z", scene->path, region->line);
    return STATUS_OK;
  case REGION_WALL:
    if (*region->name)
      return FAIL(STATUS_INPUT, "%s:%d: name: method richards has no forces on walls; leave it out",
                  scene->path, region->line);
    return STATUS_OK;
  case REGION_EMPTY:
    return STATUS_OK;
  }
  return STATUS_OK;
}

/* A well or a drain has to be in soil: it contains the centre of at least one site, and of sites of
 * soil only. */
static enum status check_well(const struct effect_context *context, const struct region *whole) {
  const struct lattice *l = context->lattice;
  const struct scene *scene = context->scene;
  size_t held = 0, site = 0;
  for (size_t k = 0; k < l->size[2]; k++)
    for (size_t j = 0; j < l->size[1]; j++)
      for (size_t i = 0; i < l->size[0]; i++, site++) {
        const double x[3] = {l->origin[0] + (double)i * l->spacing[0],
                             l->origin[1] + (double)j * l->spacing[1],
                             l->origin[2] + (double)k * l->spacing[2]};
        bool inside = false;
        for (const struct region *part = whole; part < scene->regions + whole->end; part++)
          inside = inside || domain_holds(scene, part->box, x);
        held += inside;
        if (inside && (l->kind[site] != SITE_FLUID || domain_is_water(scene, l, site)))
          return FAIL(STATUS_INPUT,
                      "%s:%d: a %s takes water out of soil; at (%g, %g, %g) m there is none: keep "
                      "it within a porous region",
                      scene->path, whole->line, region_type_names[whole->type], x[0], x[1], x[2]);
      }
  if (held > 0) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s:%d: this %s holds the middle of no site; make it a spacing wide, %g m, or "
              "domain.spacing smaller",
              scene->path, whole->line, region_type_names[whole->type], l->spacing[0]);
}

/* Whether the free water of a window (open_water_find) is beside a site. */
static bool is_beside_water(const struct effect_context *context, const struct region *window,
                            const uint16_t *water, size_t site) {
  const struct lattice *l = context->lattice;
  for (int side = 0; side < 6; side++) {
    const size_t next = lattice_beyond(context->scene->periodic, l, site, side / 2, side % 2 == 0);
    if (next != l->count && water[next] == window->first + 1) return true;
  }
  return false;
}

/* What brings water to a face of a site besides a region, to the same part of it, or all over it as
 * a head does; NULL: nothing. */
static const struct region *other_at(const struct scene *scene, const struct lattice *l,
                                     const struct region *region, size_t site, int axis, bool low) {
  double x[3], share;
  domain_place(l, site, x);
  if (lattice_beyond(scene->periodic, l, site, axis, low) == l->count) {
    const struct region *window = domain_window_at(scene, l, x, axis, low);
    if (window != NULL) return window;
  }
  for (size_t r = 0;; r++) {
    double both[6];
    r = domain_source_at(scene, l, site, axis, low, r, &share);
    if (r == scene->region_count) return NULL;
    for (int a = 0; a < 3; a++) {
      both[a] = fmax(region->box[a], scene->regions[r].box[a]);
      both[a + 3] = fmin(region->box[a + 3], scene->regions[r].box[a + 3]);
    }
    if (&scene->regions[r] != region && domain_share(l, x, axis, both) > COVERED_LEAST)
      return &scene->regions[r];
  }
}

/* Whether a region brings water to a face of a site. An error where another does to the same part
 * of it: of two that share it one would be lost. */
static enum status look_at_face(const struct scene *scene, const struct lattice *l,
                                const struct region *region, size_t site, int axis, bool low,
                                bool *reached) {
  double x[3], share;
  domain_place(l, site, x);
  if (region->type != REGION_RAIN && region->boundary != BOUNDARY_FLUX) {
    *reached = *reached || (lattice_beyond(scene->periodic, l, site, axis, low) == l->count &&
                            domain_window_at(scene, l, x, axis, low) == region);
    return STATUS_OK;
  }
  const size_t own = (size_t)(region - scene->regions);
  if (domain_source_at(scene, l, site, axis, low, own, &share) != own) return STATUS_OK;
  *reached = true;
  const struct region *other = other_at(scene, l, region, site, axis, low);
  if (other == NULL) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s:%d: the %s of line %d brings water to the face at (%g, %g, %g) m as well: let "
              "them not overlap, and meet a head where faces do, %g m apart",
              scene->path, region->line, region_type_names[other->type], other->line, x[0], x[1],
              x[2], l->spacing[0]);
}

/* Rain and inflows need a face of soil, and a head a place beside its window: there may be no water
 * at times. `water`: open_water_find, or NULL. */
static enum status check_faces(const struct effect_context *context, const struct region *region,
                               const uint16_t *water) {
  const struct lattice *l = context->lattice;
  const struct scene *scene = context->scene;
  const bool rain = region->type == REGION_RAIN;
  bool low = false, reached = false;
  if (!rain && region->type != REGION_INFLOW) return STATUS_OK;
  const int axis = rain ? 2 : scene_inflow_axis(scene, region, &low);
  for (size_t site = 0; site < l->count; site++) {
    if (l->kind[site] == SITE_WALL ||
        (l->kind[site] == SITE_EMPTY && region->boundary != BOUNDARY_HEAD))
      continue;
    if (l->kind[site] == SITE_FLUID && water != NULL)
      reached = reached || is_beside_water(context, region, water, site);
    const enum status status = look_at_face(scene, l, region, site, axis, low, &reached);
    if (status != STATUS_OK) return status;
  }
  if (reached) return STATUS_OK;
  return FAIL(STATUS_INPUT,
              "%s:%d: this %s reaches no soil, so nothing comes in by it: let its box lie on a "
              "face of soil%s",
              scene->path, region->line, region_type_names[region->type],
              rain ? ", or above one with nothing but air between" : ", half of it at least");
}

/* Soil without a curve has to stay full of water. */
static enum status check_full(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  bool confined;
  char why[EFFECT_WHY];
  enum status status = richards_confined(context, &confined, why);
  if (status == STATUS_OK && !confined)
    status = scene_error(scene, AT_METHOD,
                         "method darcy is for seepage through soil that stays full of water, but "
                         "%s; leave the method out",
                         why);
  for (size_t r = 0; r < scene->region_count && status == STATUS_OK; r++) {
    const struct region *region = &scene->regions[r];
    if (region->first == r && region_is_sink(region)) status = check_well(context, region);
    if (status == STATUS_OK) status = check_faces(context, region, NULL);
  }
  return status;
}

enum status richards_refuse(const struct effect_context *context) {
  enum status status = STATUS_OK;
  const struct scene *scene = context->scene;
  uint16_t *water = NULL;
  struct basin *basins = NULL;
  if (ranks_count() > 1)
    TRY(scene_error(scene, AT_METHOD, "method %s runs in one process; leave out mpirun",
                    context->method->name));
  if (context->method == &method_darcy) return check_full(context);
  if (scene->driving[0] != 0 || scene->driving[1] != 0 || scene->driving[2] > 0)
    TRY(scene_error(scene, AT_FORCE,
                    "in method richards gravity is along -z, or absent: heads are heights"));
  if (!isfinite(scene->end_time) && scene->steady_tolerance == 0)
    TRY(scene_error(scene, AT_METHOD, "scene.end_time is missing, like end_time = \"1 h\""));
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    TRY(check_region(scene, region));
    if (region->first == r && region_is_sink(region)) TRY(check_well(context, region));
  }
  TRY(open_water_find(scene, context->lattice, true, &water)); /* windows that fill one place */
  TRY(memory_allocate(&basins, scene->region_count, sizeof *basins, "free water"));
  TRY(basin_find(scene, context->lattice, water, basins));
  for (size_t r = 0; r < scene->region_count; r++)
    TRY(check_faces(context, &scene->regions[r], water));
cleanup:
  memory_free(&water);
  memory_free(&basins);
  return status;
}
