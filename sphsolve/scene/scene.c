#include "sphsolve/scene/scene.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/scene/stl.h"

const char *const scene_method_names[] = {"auto",
#define METHOD(name) #name,
#include "sphsolve/scene/methods.def"
#undef METHOD
                                          NULL};
const char *const wall_scheme_names[] = {"frozen", "adami", "subvoxel", NULL};
const char *const region_type_names[] = {"water", "porous", "wall", "inflow",    "empty",
                                         "well",  "drain",  "rain", "absorbing", NULL};
const char *const solute_way_names[] = {"closure", "walk", "both", NULL};
const char *const scene_axis_names[] = {"x", "y", "z", NULL};

const struct scene_place_name scene_places[SCENE_PLACE_COUNT] = {
#define X(symbol, group, key) {group, key},
    SCENE_PLACES(X)
#undef X
};

enum status scene_error(const struct scene *scene, enum scene_place place, const char *format,
                        ...) {
  char message[900];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(message, sizeof message, format, arguments);
  va_end(arguments);
  int line = scene->line_of[place];
  if (line == 0) /* set by --set */
    return FAIL(STATUS_INPUT, "%s: %s%s%s: %s", scene->path, scene_places[place].group,
                *scene_places[place].key ? "." : "", scene_places[place].key, message);
  return FAIL(STATUS_INPUT, "%s:%d: %s%s%s: %s", scene->path, line, scene_places[place].group,
              *scene_places[place].key ? "." : "", scene_places[place].key, message);
}

int scene_inflow_axis(const struct scene *scene, const struct region *region, bool *at_low) {
  const double near = 1e-6 * scene->spacing;
  double thinnest = INFINITY;
  int axis = -1;
  for (int a = 0; a < 3; a++) {
    const double width = region->box[a + 3] - region->box[a];
    const bool low = region->box[a] <= near;
    const bool high = region->box[a + 3] >= scene->domain_size[a] - near;
    if ((scene->dimensions == 2 && a == 1) || scene->periodic[a] || low == high ||
        width >= thinnest)
      continue;
    thinnest = width;
    axis = a;
    *at_low = low;
  }
  return axis;
}

void scene_free(struct scene *scene) {
  for (size_t k = 0; scene->regions != NULL && k < scene->region_count; k++) {
    if (scene->regions[k].first != k) continue;
    if (scene->regions[k].polygon != NULL) memory_free(&scene->regions[k].polygon->corner);
    memory_free(&scene->regions[k].polygon);
    if (scene->regions[k].stl != NULL) stl_free(scene->regions[k].stl);
    MEMORY_FREE(&scene->regions[k].stl, &scene->regions[k].table.time,
                &scene->regions[k].table.value);
  }
  MEMORY_FREE(&scene->regions, &scene->gauges, &scene->planes, &scene->output_fields, &scene->text);
}

bool scene_has_region(const struct scene *scene, enum region_type type) {
  for (size_t r = 0; r < scene->region_count; r++)
    if (scene->regions[r].type == type) return true;
  return false;
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

double scene_mean_given(const struct scene *scene, const struct region *region, double steady) {
  if (region->table.count == 0) return steady;
  return time_table_integral(&region->table, 0, scene->end_time, 0) / scene->end_time;
}

/* A head is a height above z = 0 that water falls from. */

double time_table_at(const struct time_table *table, double time, int c) {
  const double *t = table->time;
  size_t k = 0;
  if (time <= t[0]) return table->value[0][c];
  if (time >= t[table->count - 1]) return table->value[table->count - 1][c];
  while (time >= t[k + 1]) k++;
  const double share = (time - t[k]) / (t[k + 1] - t[k]);
  return table->value[k][c] + share * (table->value[k + 1][c] - table->value[k][c]);
}

double time_table_integral(const struct time_table *table, double from, double to, int c) {
  double sum = 0, at = from;
  for (size_t k = 0; k <= table->count && at < to; k++) { /* trapezoids, exact for linear pieces */
    const double end = k < table->count ? fmin(table->time[k], to) : to;
    if (end <= at) continue;
    sum += 0.5 * (end - at) * (time_table_at(table, at, c) + time_table_at(table, end, c));
    at = end;
  }
  return sum;
}

double time_table_extreme(const struct time_table *table, int c) {
  double most = table->value[0][c];
  for (size_t k = 1; k < table->count; k++)
    if (fabs(table->value[k][c]) > fabs(most)) most = table->value[k][c];
  return most;
}
