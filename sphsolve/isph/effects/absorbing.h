/* Absorbing sides (sponge layers; Larsen, Dancy 1983, Coastal Eng. 7, 285; Carmigniani, Violeau
 * 2018, Ocean Eng. 163, 169): before a closed side of the domain, friction that increases towards
 * the side absorbs waves,
 *
 *   dv/dt = ... - gamma v,   gamma = 10 c/l (x/l)^2,   c = sqrt(g h),
 *
 * with x the distance from the inner edge of the region, l its length to the side and h its height.
 * By the linear equations of long waves 5 % of the amplitude of a wave of length l is reflected, 4
 * % of one of l/2, 8 % of one of 2 l, 39 % of one of 4 l. Still water stays still; a current is
 * slowed down. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_ABSORBING_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_ABSORBING_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/method.h"

/* The factor, among those from 6 to 36, that reflects least of waves of length l/2 to 2 l. */
#define ABSORBING_RATE 10.0

/* The axis of the single side that an absorbing region lies against, or -1 if there is none or
 * several; *low: whether it is the lower side. A region across the whole domain lies against no
 * side of that axis. */
static inline int absorbing_axis(const struct scene *scene, const struct region *region,
                                 bool *low) {
  const double slack = 1e-6 * scene->spacing;
  const int up = scene_axis_along(scene->gravity);
  int found = -1;
  for (int a = 0; a < 3; a++) {
    if (a == up || scene->periodic[a] || (scene->dimensions == 2 && a == 1)) continue;
    const bool at_low = region->box[a] < slack;
    if (at_low == (region->box[a + 3] > scene->domain_size[a] - slack)) continue;
    if (found >= 0) return -1;
    found = a;
    *low = at_low;
  }
  return found;
}

/* The largest gamma of a region, 1/s. */
static inline double absorbing_most(const struct scene *scene, const struct region *region,
                                    int axis) {
  const int up = scene_axis_along(scene->gravity);
  const double height = region->box[up + 3] - region->box[up];
  return ABSORBING_RATE * sqrt(fabs(scene->gravity[up]) * height) /
         (region->box[axis + 3] - region->box[axis]);
}

static inline void absorbing_force(const void *state, double (*acceleration)[3]) {
  const struct isph *s = state;
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double rate = 0;
    for (size_t k = 0; k < s->scene->region_count; k++) {
      const struct region *region = &s->scene->regions[k];
      const double *box = region->box, *x = s->position[i];
      bool in = region->type == REGION_ABSORBING, low = false;
      for (int a = 0; a < 3 && in; a++)
        in = !isph_uses_axis(s, a) || (x[a] >= box[a] && x[a] <= box[a + 3]);
      if (!in) continue;
      const int axis = absorbing_axis(s->scene, region, &low);
      const double way =
          (low ? box[axis + 3] - x[axis] : x[axis] - box[axis]) / (box[axis + 3] - box[axis]);
      rate = absorbing_most(s->scene, region, axis) * way * way;
    }
    for (int a = 0; a < 3; a++) acceleration[i][a] = -rate * s->velocity[i][a];
  }
}

/* The largest length, m, and the largest gamma, 1/s, of all absorbing regions; 0 if there are none.
 */
static inline void absorbing_largest(const struct scene *scene, double *length, double *most) {
  *length = *most = 0;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *region = &scene->regions[k];
    bool low;
    if (region->type != REGION_ABSORBING) continue;
    const int axis = absorbing_axis(scene, region, &low);
    if (axis < 0) continue; /* such a scene is refused */
    *length = fmax(*length, region->box[axis + 3] - region->box[axis]);
    *most = fmax(*most, absorbing_most(scene, region, axis));
  }
}

static inline bool absorbing_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  double length, most;
  absorbing_largest(context->scene, &length, &most);
  if (length > 0)
    snprintf(why, EFFECT_WHY, "absorbing regions, for waves up to %g m long", length);
  else
    snprintf(why, EFFECT_WHY, "no absorbing region");
  return length > 0;
}

static inline double absorbing_dt(const struct effect_context *context) {
  double length, most;
  absorbing_largest(context->scene, &length, &most);
  return 0.25 / most;
}

/* Absorbing regions lie before a single closed side, in free water. */
static inline enum status isph_refuse_absorbing(const struct effect_context *context) {
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

#endif

EFFECT(isph_absorbing, .model = "- gamma v, gamma = 10 c/l (x/l)^2 towards a side",
       .citation = "Larsen, Dancy 1983; Carmigniani, Violeau 2018", .wanted = absorbing_wanted,
       .dt_max = absorbing_dt, .limit = "the friction of absorbing sides", .force = absorbing_force,
       .refuse = isph_refuse_absorbing)
