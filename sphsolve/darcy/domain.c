#include "sphsolve/darcy/domain.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "sphsolve/darcy/constants.h"
#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/geometry/lattice.h"
#include "sphsolve/geometry/thin_wall.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/darcy/retention.h"

bool domain_is_full(const struct scene *scene) {
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].retention.given) return false;
  return true;
}

bool domain_holds(const struct scene *scene, const double box[6], const double x[3]) {
  bool inside = true;
  for (int a = 0; a < 3; a++)
    if (!(scene->dimensions == 2 && a == 1)) inside = inside && x[a] >= box[a] && x[a] < box[a + 3];
  return inside;
}

size_t domain_soil_at(const struct scene *scene, const double x[3]) {
  for (size_t r = scene->region_count; r-- > 0;)
    if (scene->regions[r].type == REGION_POROUS && domain_holds(scene, scene->regions[r].box, x))
      return r;
  return scene->region_count;
}

enum region_type domain_filled_at(const struct scene *scene, const struct lattice *l, size_t at) {
  double x[3];
  domain_place(l, at, x);
  for (size_t r = scene->region_count; r-- > 0;) {
    const enum region_type type = scene->regions[r].type;
    if ((type == REGION_POROUS || type == REGION_WATER || type == REGION_EMPTY) &&
        domain_holds(scene, scene->regions[r].box, x))
      return type;
  }
  return REGION_EMPTY;
}

bool domain_is_water(const struct scene *scene, const struct lattice *l, size_t at) {
  return l->kind[at] == SITE_FLUID && l->region[at] > 0 &&
         scene->regions[l->region[at] - 1].type == REGION_WATER && !domain_is_full(scene);
}

bool domain_is_open(const struct scene *scene, const struct lattice *l, size_t at) {
  return l->kind[at] == SITE_EMPTY || domain_is_water(scene, l, at);
}

void domain_place(const struct lattice *l, size_t at, double x[3]) {
  const size_t place[3] = {at % l->size[0], at / l->size[0] % l->size[1],
                           at / (l->size[0] * l->size[1])};
  for (int a = 0; a < 3; a++) x[a] = l->origin[a] + (double)place[a] * l->spacing[a];
}

double domain_share(const struct lattice *l, const double x[3], int axis, const double box[6]) {
  double share = 1;
  for (int a = 0; a < 3; a++) {
    if (a == axis || (l->dimensions == 2 && a == 1)) continue;
    const double low = fmax(x[a] - 0.5 * l->spacing[0], box[a]),
                 high = fmin(x[a] + 0.5 * l->spacing[0], box[a + 3]);
    share *= fmax(0, high - low) / l->spacing[0];
  }
  return share;
}

/* Whether a wall lies between a site at x and the side of the domain beside it. */
static bool is_walled(const struct scene *scene, const struct lattice *l, const double x[3],
                      int axis, bool low) {
  const double side = x[axis] + (low ? -0.5 : 0.5) * l->spacing[axis];
  for (size_t r = 0; r < scene->region_count; r++) {
    const double *box = scene->regions[r].box;
    double at[3] = {x[0], x[1], x[2]};
    at[axis] = box[axis];
    if (scene->regions[r].type == REGION_WALL && !domain_holds(scene, box, x) &&
        box[axis] < fmax(side, x[axis]) && box[axis + 3] > fmin(side, x[axis]) &&
        domain_holds(scene, box, at))
      return true;
  }
  return false;
}

const struct region *domain_window_at(const struct scene *scene, const struct lattice *lattice,
                                      const double x[3], int axis, bool low) {
  const struct region *found = NULL;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    bool at_low;
    if (region->type == REGION_INFLOW && region->boundary != BOUNDARY_FLUX &&
        scene_inflow_axis(scene, region, &at_low) == axis && at_low == low &&
        domain_share(lattice, x, axis, region->box) >= COVERED_HALF)
      found = region;
  }
  return found != NULL && is_walled(scene, lattice, x, axis, low) ? NULL : found;
}

/* Whether nothing is above a site. */
static bool is_under_sky(const struct scene *scene, const struct lattice *lattice, size_t at) {
  size_t below = at;
  for (size_t above = lattice_beyond(scene->periodic, lattice, at, 2, false);
       above != lattice->count; above = lattice_beyond(scene->periodic, lattice, above, 2, false)) {
    if (above == at || !domain_is_open(scene, lattice, above) ||
        thin_wall_on_face(lattice, below, 2))
      return false;
    below = above;
  }
  double x[3];
  domain_place(lattice, below, x);
  return !is_walled(scene, lattice, x, 2, false);
}

size_t domain_source_at(const struct scene *scene, const struct lattice *lattice, size_t at,
                        int axis, bool low, size_t from, double *share) {
  const bool side = lattice_beyond(scene->periodic, lattice, at, axis, low) == lattice->count;
  double x[3];
  domain_place(lattice, at, x);
  for (size_t r = from; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    const bool rain = region->type == REGION_RAIN && axis == 2 && !low && x[2] <= region->box[5];
    bool at_low;
    if (!rain && (!side || region->type != REGION_INFLOW || region->boundary != BOUNDARY_FLUX ||
                  scene_inflow_axis(scene, region, &at_low) != axis || at_low != low))
      continue;
    *share = domain_share(lattice, x, axis, region->box);
    if (*share > COVERED_LEAST &&
        (rain ? is_under_sky(scene, lattice, at) : !is_walled(scene, lattice, x, axis, low)))
      return r;
  }
  return scene->region_count;
}

static bool is_moving(const double v[3]) {
  return v[0] != 0 || v[1] != 0 || v[2] != 0;
}

/* Longest time, s, in which drag brings the water in soil to its velocity, 1/(eps a); INFINITY
 * without soil. */
static double relaxation_of(const struct scene *scene) {
  const double nu = scene->fluid.viscosity / scene->fluid.density;
  double longest = -INFINITY;
  for (size_t r = 0; r < scene->region_count; r++) {
    struct retention soil;
    if (scene->regions[r].type != REGION_POROUS) continue;
    const bool drags = retention_full(&scene->regions[r], nu, &soil);
    longest = fmax(longest, drags ? fmax(soil.conductivity[0], soil.conductivity[2]) /
                                        (scene->regions[r].porosity * GRAVITY_STANDARD)
                                  : INFINITY);
  }
  return longest < 0 ? INFINITY : longest;
}

/* Why the scene alone is none of seepage at rest; NULL if it may be. */
static const char *other_than_seepage(const struct effect_context *context) {
  const struct scene *scene = context->scene;
  const double *f = scene->driving;
  bool heads = false, levels = f[0] == 0 && f[1] == 0 && f[2] <= 0;
  if (!context->has_porous) return "the scene has no soil";
  if (!domain_is_full(scene)) return "soil has a retention curve";
  if (scene->isph.form == FORM_M15) return "form = \"m15\" is asked for";
  if (context->has_rain || context->has_absorbing) return "rain or an absorbing side";
  if (context->has_moving_wall) return "a wall moves";
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    if (region->type == REGION_POROUS && is_moving(region->soil_velocity)) return "soil moves";
    if (region->type == REGION_WATER && is_moving(region->velocity)) return "water starts moving";
    if (region->type == REGION_WALL && *region->name)
      return "a wall has a name, which asks for the force on it";
    if (region->radiates) return "waves leave by a side";
    heads = heads || region->boundary == BOUNDARY_HEAD || region->type == REGION_DRAIN;
  }
  if (heads && !levels) return "heads, and a force not along -z";
  for (int a = 0; a < 3; a++)
    if (f[a] != 0 && scene->periodic[a] && context->lattice->size[a] == 1)
      return "one site along the force";
  return NULL;
}

/* A body of free water: how it lies, and the windows at it. */
struct body {
  bool goes_round, free;       /* it joins itself along the force; it has a surface */
  double top;                  /* m, of its highest site */
  const struct region *window; /* the last found */
  bool differ;                 /* windows of more than one head, or one with a flux */
};

static void add_window(const struct region *window, struct body *body) {
  if (window == NULL) return;
  const struct region *other = body->window;
  body->differ = body->differ || (other != NULL && other->first != window->first &&
                                  (other->boundary != window->boundary ||
                                   other->boundary == BOUNDARY_FLUX || other->table.count > 0 ||
                                   window->table.count > 0 || other->head != window->head));
  body->window = window;
}

/* Follows the free water from a site. `image`: of each site, how often the periodic sides were
 * crossed on the way to it; `stack` has room for all sites. */
static void follow(const struct scene *scene, const struct lattice *l, size_t from, bool *seen,
                   int16_t (*image)[3], uint32_t *stack, struct body *body) {
  size_t n = 1;
  *body = (struct body){.top = -INFINITY};
  stack[0] = (uint32_t)from, seen[from] = true;
  memset(image[from], 0, sizeof image[from]);
  while (n > 0) {
    const size_t at = stack[--n];
    double x[3];
    domain_place(l, at, x);
    body->top = fmax(body->top, x[2] + 0.5 * l->spacing[2]);
    for (int side = 0; side < 6; side++) {
      const int axis = side / 2;
      const bool low = side % 2 == 0;
      double share, y[3];
      if (l->dimensions == 2 && axis == 1) continue;
      const size_t next = lattice_beyond(scene->periodic, l, at, axis, low);
      if (next == l->count) {
        const size_t flux = domain_source_at(scene, l, at, axis, low, 0, &share);
        add_window(domain_window_at(scene, l, x, axis, low), body);
        if (flux < scene->region_count) add_window(&scene->regions[flux], body);
        continue;
      }
      if (thin_wall_on_face(l, low ? next : at, axis)) continue;
      body->free = body->free || l->kind[next] == SITE_EMPTY;
      domain_place(l, next, y);
      if (l->kind[next] != SITE_FLUID || domain_soil_at(scene, y) < scene->region_count) continue;
      int16_t there[3];
      memcpy(there, image[at], sizeof there);
      if (low ? next > at : next < at) there[axis] = (int16_t)(there[axis] + (low ? -1 : 1));
      if (seen[next]) {
        for (int a = 0; a < 3; a++)
          body->goes_round =
              body->goes_round || (scene->driving[a] != 0 && there[a] != image[next][a]);
        continue;
      }
      memcpy(image[next], there, sizeof there);
      seen[next] = true, stack[n++] = (uint32_t)next;
    }
  }
}

/* Whether free water goes past the soil, or its surface may move: its flow is not that of soil. */
static enum status look_at_water(const struct effect_context *context, const char **why) {
  enum status status = STATUS_OK;
  const struct scene *scene = context->scene;
  const struct lattice *l = context->lattice;
  bool *seen = NULL;
  int16_t(*image)[3] = NULL;
  uint32_t *stack = NULL;
  TRY(memory_allocate(&seen, l->count, sizeof *seen, "free water"));
  TRY(memory_allocate(&image, l->count, sizeof *image, "free water"));
  TRY(memory_allocate(&stack, l->count, sizeof *stack, "free water"));
  for (size_t at = 0; at < l->count && *why == NULL; at++) {
    double x[3];
    domain_place(l, at, x);
    const bool soil = domain_soil_at(scene, x) < scene->region_count;
    struct body body;
    if (soil && l->kind[at] == SITE_EMPTY) *why = "some of the soil is dry";
    if (soil || l->kind[at] != SITE_FLUID || seen[at]) continue;
    follow(scene, l, at, seen, image, stack, &body);
    if (body.goes_round || body.differ) *why = "free water flows past the soil";
    if (!body.free) continue;
    if (body.window == NULL || body.window->boundary != BOUNDARY_HEAD ||
        body.window->table.count > 0 || fabs(body.window->head - body.top) > l->spacing[2])
      *why = "free water has a surface that may move";
  }
cleanup:
  memory_free(&seen);
  memory_free(&image);
  memory_free(&stack);
  return status;
}

enum status richards_confined(const struct effect_context *context, bool *confined,
                              char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  const char *not_so = other_than_seepage(context);
  const double relaxation = not_so == NULL ? relaxation_of(scene) : 0;
  *confined = false;
  if (not_so == NULL) {
    const enum status status = look_at_water(context, &not_so);
    if (status != STATUS_OK) return status;
  }
  if (not_so == NULL && isfinite(scene->end_time) &&
      !(RELAXATIONS_MIN * relaxation < scene->end_time))
    not_so = "inertia counts: the run is no longer than it takes the water to reach its velocity";
  *confined = not_so == NULL;
  if (*confined)
    snprintf(why, EFFECT_WHY,
             "soil stays full of water, no surface moves, and inertia counts for %.2g s only",
             relaxation);
  else
    snprintf(why, EFFECT_WHY, "%s", not_so);
  return STATUS_OK;
}
