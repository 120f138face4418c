#include "sphsolve/isph/speed_forecast.h"

#include <math.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/isph/constants.h"
#include "sphsolve/isph/method.h"

/* Drag of layers in series on the Darcy velocity v, f = a v + b v^2, as means over their length: a
 * (1/s) of M15 eq. 9c, b (1/m) of eq. 9d (M15: Morimoto et al. 2015); and the least porosity. */
struct layers {
  double a, b, porosity;
};

static void add_layer(const struct effect_context *context, const struct region *soil, double share,
                      struct layers *layers) {
  const double e = soil->porosity, d = soil->grain_size;
  const double scale = share / (e * e * e) * (context->scene->isph.form == FORM_M15 ? e : 1);
  layers->a += scale * soil->alpha * context->kinematic_viscosity * (1 - e) * (1 - e) / (d * d);
  layers->b += scale * soil->beta * (1 - e) / d;
  layers->porosity = fmin(layers->porosity, e);
}

/* Pore velocity in layers under a driving acceleration f = a v + b v^2. */
static double pore_speed(const struct layers *layers, double driving) {
  const double root = sqrt(layers->a * layers->a + 4 * layers->b * driving);
  return driving > 0 ? 2 * driving / (layers->a + root) / layers->porosity : 0;
}

static double size(const double v[3]) {
  return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

double isph_region_speed(const struct scene *scene, const struct region *r) {
  double fastest = fmax(size(r->velocity), size(r->soil_velocity));
  if (r->type == REGION_INFLOW && r->boundary == BOUNDARY_FLUX)
    fastest = fmax(fastest, fabs(r->flux));
  if (r->type == REGION_RAIN) fastest = fmax(fastest, r->rate);
  if (r->type == REGION_WELL) {
    const double *e = r->extent, x = e[3] - e[0], y = e[4] - e[1], z = e[5] - e[2];
    fastest = fmax(fastest, r->rate / 2 / (scene->dimensions == 3 ? x * y + y * z + z * x : x + z));
  }
  return fastest;
}

double isph_prescribed_speed(const struct scene *scene) {
  double fastest = 0;
  for (size_t k = 0; k < scene->region_count; k++)
    fastest = fmax(fastest, isph_region_speed(scene, &scene->regions[k]));
  return fastest;
}

/* The g to which heads refer (isph_window_pressure). */
static double gravity_of_heads(const struct scene *scene) {
  const double g = size(scene->gravity);
  return g > 0 ? g : GRAVITY_STANDARD;
}

double isph_head_drive(const struct scene *scene) {
  double high = -INFINITY, low = INFINITY, length = INFINITY;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    const bool drain = r->type == REGION_DRAIN;
    if (!drain && !(r->type == REGION_INFLOW && r->boundary == BOUNDARY_HEAD)) continue;
    /* The head of a drain at atmospheric pressure is its height, or 0 without gravity. */
    const double air = size(scene->gravity) > 0 ? r->extent[2] : 0;
    const double head = r->boundary == BOUNDARY_HEAD ? r->head : air;
    high = fmax(high, head), low = fmin(low, head);
  }
  for (int a = 0; a < 3; a++)
    if (scene->dimensions == 3 || a != 1) length = fmin(length, scene->domain_size[a]);
  return high > low ? gravity_of_heads(scene) * (high - low) / length : 0;
}

/* Whether a wall or a closed side is next to site p along axis a, `stride` sites apart. */
static bool is_walled(const struct effect_context *context, size_t p, int a, size_t stride,
                      bool up) {
  const struct lattice *l = context->lattice;
  const size_t n = l->size[a], at = p / stride % n, around = (n - 1) * stride;
  const bool end = at == (up ? n - 1 : 0);
  if (end && !context->scene->periodic[a]) return true;
  return l->kind[up ? (end ? p - around : p + stride) : (end ? p + around : p - stride)] ==
         SITE_WALL;
}

/* Hydraulic radius of the water, m: its volume over the area of the walls and closed sides that it
 * wets, which is the depth of a film and half the width of a slit. INFINITY: it wets none. */
static double hydraulic_radius(const struct effect_context *context) {
  const struct lattice *l = context->lattice;
  double area = 0; /* per volume of a site */
  size_t stride = 1;
  for (int a = 0; a < 3; stride *= l->size[a++])
    for (size_t p = 0; p < l->count && isph_scene_uses_axis(context, a); p++)
      if (l->kind[p] == SITE_FLUID)
        area += (is_walled(context, p, a, stride, false) + is_walled(context, p, a, stride, true)) /
                l->spacing[a];
  return (double)l->fluid_count / area;
}

/* Speed along a periodic axis: through its soil in layers along the force or in columns beside each
 * other, or of the fastest free water, in laminar flow over or between walls, f R^2/(2 nu) with R
 * the hydraulic radius, and at most that of free fall. */
static double periodic_speed(const struct effect_context *context, int axis) {
  const struct scene *scene = context->scene;
  const double driving = fabs(scene->driving[axis]), radius = hydraulic_radius(context);
  struct layers all = {0, 0, 1};
  double volume = 1, fastest = 0;
  for (int a = 0; a < 3; a++) volume *= scene->domain_size[a];
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    struct layers own = {0, 0, 1};
    double share = 1 / volume;
    if (r->type != REGION_POROUS) continue;
    for (int a = 0; a < 3; a++) share *= r->box[a + 3] - r->box[a];
    add_layer(context, r, share, &all);
    add_layer(context, r, 1, &own);
    if (r->extent[axis + 3] - r->extent[axis] > SPANS * scene->domain_size[axis])
      fastest = fmax(fastest, pore_speed(&own, driving));
  }
  if (all.a + all.b > 0) return fmax(fastest, pore_speed(&all, driving));
  return fmin(driving * scene->end_time,
              driving * radius * radius / (2 * context->kinematic_viscosity));
}

/* Speed between the highest and the lowest of the heads and the water's surface: through the soil
 * between them, or freely. */
static double head_speed(const struct effect_context *context, double surface) {
  const struct scene *scene = context->scene;
  double high = surface, low = surface, length = 0;
  struct layers all = {0, 0, 1};
  int axis = 0;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    if (r->type != REGION_INFLOW || r->boundary != BOUNDARY_HEAD) continue;
    high = isnan(high) ? r->head : fmax(high, r->head);
    low = isnan(low) ? r->head : fmin(low, r->head);
    for (int a = 0; a < 3; a++)
      if (!(scene->dimensions == 2 && a == 1) &&
          r->box[a + 3] - r->box[a] < r->box[axis + 3] - r->box[axis])
        axis = a;
  }
  if (!(high > low)) return 0;
  for (size_t k = 0; k < scene->region_count; k = scene->regions[k].end)
    if (scene->regions[k].type == REGION_POROUS)
      length += scene->regions[k].extent[axis + 3] - scene->regions[k].extent[axis];
  for (size_t k = 0; k < scene->region_count && length > 0; k = scene->regions[k].end) {
    const struct region *r = &scene->regions[k];
    if (r->type == REGION_POROUS)
      add_layer(context, r, (r->extent[axis + 3] - r->extent[axis]) / length, &all);
  }
  const double force = gravity_of_heads(scene) * (high - low);
  return all.a + all.b > 0 ? pore_speed(&all, force / length) : sqrt(2 * force);
}

/* Marks with 1 what free water can reach from where it starts; soil and walls bound it. */
static void flood(const struct effect_context *context, uint8_t *reached) {
  const struct lattice *l = context->lattice;
  const size_t *n = l->size;
  for (bool more = true; more;) {
    more = false;
    for (int back = 0; back < 2; back++)
      for (size_t q = 0; q < l->count; q++) {
        const size_t p = back ? l->count - 1 - q : q;
        const size_t at[3] = {p % n[0], p / n[0] % n[1], p / n[0] / n[1]};
        if (reached[p] != 0) continue;
        size_t stride = 1;
        for (int a = 0; a < 3 && reached[p] == 0; stride *= n[a++]) {
          const bool wraps = context->scene->periodic[a];
          const size_t low = at[a] > 0 ? p - stride : wraps ? p + (n[a] - 1) * stride : p;
          const size_t high = at[a] + 1 < n[a] ? p + stride : wraps ? p - (n[a] - 1) * stride : p;
          if (reached[low] == 1 || reached[high] == 1) reached[p] = 1, more = true;
        }
      }
  }
}

/* Marks soil and walls (2), free water (1) and where it may go (0); returns whether some of the
 * soil is dry. */
static bool mark_sites(const struct effect_context *context, uint8_t *reached) {
  const struct lattice *l = context->lattice;
  const struct scene *scene = context->scene;
  bool dry = false;
  for (size_t p = 0; p < l->count; p++)
    reached[p] = l->kind[p] == SITE_WALL ? 2 : l->kind[p] == SITE_FLUID ? 1 : 0;
  for (size_t r = 0; r < scene->region_count; r++) {
    const struct region *region = &scene->regions[r];
    size_t first[3], end[3];
    if (region->type != REGION_POROUS) continue;
    for (int a = 0; a < 3; a++) {
      const double low = (region->box[a] - l->origin[a]) / l->spacing[a];
      const double high = (region->box[a + 3] - l->origin[a]) / l->spacing[a];
      first[a] = (size_t)fmax(0, ceil(low));
      end[a] = (size_t)fmax(0, fmin(floor(high) + 1, (double)l->size[a]));
    }
    for (size_t k = first[2]; k < end[2]; k++)
      for (size_t j = first[1]; j < end[1]; j++)
        for (size_t i = first[0]; i < end[0]; i++) {
          const size_t p = (k * l->size[1] + j) * l->size[0] + i;
          dry = dry || l->kind[p] == SITE_EMPTY;
          reached[p] = 2;
        }
  }
  return dry;
}

/* Speed of free water that runs down to its level: from the mean height by which it falls, and at
 * most from the largest (Torricelli: sqrt(2 f drop)); the fastest water moves at about twice the
 * mean. The factor .75 and the duration, five times that of the fall, were fitted to runs of 19
 * scenes; for nine others the number of steps was right within a factor 2. Also sets the height of
 * the water's surface, m. */
static void level_out(const struct effect_context *context, const uint8_t *reached, int axis,
                      double *water, double *room, struct isph_speed_forecast *speeds,
                      double *surface) {
  const struct lattice *l = context->lattice;
  const size_t n = l->size[axis];
  const bool up = context->scene->driving[axis] > 0; /* the force points to higher numbers */
  double left = 0, energy = 0, all = 0;
  size_t stride = 1, top = 0, bottom = n;
  for (int a = 0; a < axis; a++) stride *= l->size[a];
  for (size_t p = 0; p < l->count; p++) {
    const size_t at = p / stride % n, layer = up ? n - 1 - at : at;
    if (reached[p] != 1) continue;
    room[layer] += 1;
    if (l->kind[p] == SITE_FLUID) water[layer] += 1;
  }
  for (size_t k = 0; k < n; k++) {
    if (water[k] > 0) top = k + 1;
    if (water[k] < room[k] && bottom == n) bottom = k;
    left += water[k], energy += water[k] * (double)k;
  }
  if (top == 0) return;
  all = left;
  for (size_t k = 0; k < n; k++) {
    const double here = fmin(left, room[k]);
    energy -= here * (double)k, left -= here;
  }
  *surface = up ? NAN : (double)top * l->spacing[axis];
  if (bottom >= top) return;
  const double drop = fmax(0, energy / all) * l->spacing[axis];
  const double fall = (double)(top - bottom) * l->spacing[axis], f = context->driving;
  speeds->speed = fmax(speeds->speed, 0.75 * fmin(2 * sqrt(2 * f * drop), sqrt(2 * f * fall)));
  speeds->lasts = 5 * sqrt(2 * fall / f);
}

enum status isph_speed_predict(const struct effect_context *context,
                               struct isph_speed_forecast *speeds) {
  enum status status = STATUS_OK;
  const struct scene *scene = context->scene;
  const int axis = scene_axis_along(scene->driving);
  double *water = NULL, *room = NULL, surface = NAN, steady = isph_prescribed_speed(scene);
  uint8_t *reached = NULL;
  *speeds = (struct isph_speed_forecast){.lasts = INFINITY};
  for (int a = 0; a < 3; a++)
    if (scene->driving[a] != 0 && scene->periodic[a])
      steady = fmax(steady, periodic_speed(context, a));
  if (context->has_surface && context->driving > 0 && !scene->periodic[axis]) {
    const size_t n = context->lattice->size[axis];
    TRY(memory_allocate(&reached, context->lattice->count, sizeof *reached, "the forecast"));
    TRY(memory_allocate(&water, n, sizeof *water, "the forecast"));
    TRY(memory_allocate(&room, n, sizeof *room, "the forecast"));
    const bool dry = mark_sites(context, reached);
    flood(context, reached);
    level_out(context, reached, axis, water, room, speeds, &surface);
    for (size_t k = 0; k < scene->region_count && dry; k++) {
      struct layers own = {0, 0, 1};
      if (scene->regions[k].type != REGION_POROUS) continue;
      add_layer(context, &scene->regions[k], 1, &own);
      if (own.a + own.b > 0) steady = fmax(steady, pore_speed(&own, 2 * context->driving));
    }
  }
  if (context->has_inflow) steady = fmax(steady, head_speed(context, surface));
  speeds->speed = fmax(speeds->speed, steady);
  speeds->speed_after = fmax(steady, 0.25 * speeds->speed);
cleanup:
  memory_free(&reached);
  memory_free(&water);
  memory_free(&room);
  return status;
}

enum status isph_reynolds_predict(const struct effect_context *context, double *reynolds) {
  const struct scene *scene = context->scene;
  struct isph_speed_forecast speeds;
  const enum status status = isph_speed_predict(context, &speeds);
  double length = context->lattice->fluid_count > 0 ? hydraulic_radius(context) : 0;
  for (size_t k = 0; k < scene->region_count; k++) {
    const struct region *r = &scene->regions[k];
    for (int a = 0; a < 3 && r->type == REGION_INFLOW; a++)
      if (isph_scene_uses_axis(context, a)) length = fmax(length, r->extent[a + 3] - r->extent[a]);
  }
  const double speed = fmax(speeds.speed, speeds.speed_after);
  *reynolds = speed > 0 ? speed * length / context->kinematic_viscosity : 0;
  return status;
}
