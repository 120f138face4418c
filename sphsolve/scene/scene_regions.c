#include "sphsolve/scene/scene_regions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/memory.h"
#include "common/units.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_geometry.h"
#include "sphsolve/scene/scene_names.h"
#include "sphsolve/scene/scene_soil.h"
#include "sphsolve/scene/scene_shapes.h"
#include "sphsolve/scene/scene_stl.h"

static enum status read_box(struct config *config, config_node *group, const struct scene *scene,
                            double box[6]) {
  int count = 6, least = scene->dimensions == 2 ? 4 : 6;
  bool given;
  enum status status =
      config_quantities(config, group, "box", DIM_LENGTH, least, 6, box, &count, &given);
  if (status != STATUS_OK) return status;
  if (!given)
    return config_error(config, group,
                        "box is missing: [x0, y0, z0, x1, y1, z1]; or the corners of a polygon, or "
                        "the centre and radius of a circle, or an stl file");
  config_node *node = config_child(group, "box");
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
      return config_error(
          config, node,
          "%g to %g m in %c lies outside the domain (0 to %g m); make it smaller, or "
          "domain.size larger",
          box[a], box[a + 3], 'x' + a, scene->domain_size[a]);
  }
  return STATUS_OK;
}

static enum status read_porous(struct config *config, config_node *group, struct scene *scene,
                               struct region *region) {
  enum status status = STATUS_OK;
  TRY(keys_read(config, group, "regions[]", 1u << REGION_POROUS, scene, region));
  double largest = 0.0;
  bool cell = true; /* periodic in all directions: a representative cell */
  for (int a = 0; a < 3; a++) {
    if (scene->dimensions == 2 && a == 1) continue;
    largest = fmax(largest, scene->domain_size[a]);
    cell = cell && scene->periodic[a];
  }
  if (region->grain_size >= largest && !cell)
    TRY(config_error(config, config_child(group, "grain_size"),
                     "grains of %g m are as large as the domain, %g m; is %g mm meant?",
                     region->grain_size, largest, region->grain_size));
  region->dry = config_child(group, "saturated") != NULL && !region->saturated;
  TRY(keys_read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->soil_velocity));
  TRY(scene_read_permeability(config, group, scene, region));
  TRY(scene_read_retention(config, group, region));
  if (!(region->grain_size > 0))
    TRY(config_error(
        config, group,
        "grain_size is missing: soil needs its D50, like grain_size = \"3 mm\", or its "
        "permeability = \"1e-4 m/s\""));
cleanup:
  return status;
}

/* Reads the `times` of a region and at each time `width` quantities `name`, all in one list. */
static enum status read_table(struct config *config, config_node *group, const char *name,
                              struct dimension dimension, const struct scene *scene, int width,
                              struct time_table *table) {
  enum status status = STATUS_OK;
  config_node *times = config_child(group, "times"), *node = config_child(group, name);
  double *values = NULL;
  const size_t n = config_count(times);
  if (n < 2 || n > 1000000)
    return config_error(config, times, "at least two times are wanted, like [\"0 s\", \"1 h\"]");
  if (node == NULL || config_count(node) != n * (size_t)width)
    return config_error(config, node != NULL ? node : group,
                        width > 1 ? "with %zu times, %zu velocities are wanted: all components of "
                                    "the first, then of the second, ..."
                                  : "with %zu times, a list of %zu is wanted",
                        n, width > 1 ? n * (size_t)width : n);
  TRY(memory_allocate(&table->time, n, sizeof *table->time, "a table of times"));
  TRY(memory_allocate(&table->value, n, sizeof *table->value, "a table of times"));
  TRY(memory_allocate(&values, n * (size_t)width, sizeof *values, "a table of times"));
  table->count = n;
  TRY(config_quantities(config, group, "times", DIM_TIME, (int)n, (int)n, table->time, NULL, NULL));
  TRY(config_quantities(config, group, name, dimension, (int)n * width, (int)n * width, values,
                        NULL, NULL));
  for (size_t k = 0; k < n; k++) {
    if (k > 0 && !(table->time[k] > table->time[k - 1]))
      TRY(config_error(config, times, "%g s does not come after %g s", table->time[k],
                       table->time[k - 1]));
    memcpy(table->value[k], values + k * (size_t)width, (size_t)width * sizeof *values);
    if (width > 1) keys_spread(scene, width, table->value[k]);
  }
cleanup:
  memory_free(&values);
  return status;
}

static enum status read_wall(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region) {
  enum status status = STATUS_OK;
  TRY(keys_read(config, group, "regions[]", 1u << REGION_WALL, scene, region));
  if (config_child(group, "name") != NULL)
    TRY(scene_read_name(config, group, "wall", 0, region->name, sizeof region->name));
  for (const struct region *r = scene->regions; r < region && *region->name; r++)
    if (!strcmp(r->name, region->name))
      TRY(config_error(config, group, "a wall before is called '%s' too; rename one", r->name));
  if (config_child(group, "times") == NULL)
    return keys_read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->velocity);
  TRY(read_table(config, group, "velocity", DIM_VELOCITY, scene, scene->dimensions,
                 &region->table));
  for (int a = 0; a < 3; a++) region->velocity[a] = time_table_extreme(&region->table, a);
cleanup:
  return status;
}

static enum status read_inflow(struct config *config, config_node *group, const struct scene *scene,
                               struct region *region) {
  enum status status = STATUS_OK;
  const bool flux_given = config_child(group, "flux") != NULL;
  const bool pressure_given = config_child(group, "pressure_head") != NULL;
  const bool head_given = config_child(group, "head") != NULL;
  const char *key = flux_given ? "flux" : pressure_given ? "pressure_head" : "head";
  const struct dimension of = flux_given ? DIM_VELOCITY : DIM_LENGTH;
  double *value = flux_given ? &region->flux : &region->head;
  TRY(keys_read(config, group, "regions[]", 1u << REGION_INFLOW, scene, region));
  if (flux_given + pressure_given + head_given != 1)
    TRY(config_error(config, group,
                     "either head (a length) or flux (a velocity) is wanted; before soil that "
                     "is not full also pressure_head (a length)"));
  if (config_child(group, "times") != NULL) {
    TRY(read_table(config, group, key, of, scene, 1, &region->table));
    *value = time_table_extreme(&region->table, 0);
  } else {
    TRY(config_quantity(config, group, key, of, value, NULL));
  }
  region->boundary = flux_given       ? BOUNDARY_FLUX
                     : pressure_given ? BOUNDARY_PRESSURE
                                      : BOUNDARY_HEAD;
  if (region->radiates && !head_given)
    TRY(config_error(config, config_child(group, "radiates"),
                     "waves leave by a side of given head, whose level they raise and lower; give "
                     "head, or leave radiates out"));
cleanup:
  return status;
}

/* Reads the rate of a well or of rain, or the head of a drain; each may depend on time. */
static enum status read_well(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region) {
  enum status status = STATUS_OK;
  const bool rain = region->type == REGION_RAIN, given_rate = region->type != REGION_DRAIN;
  const char *key = given_rate ? "rate" : "head", *title = region_type_names[region->type];
  const struct dimension rate = {rain ? 1 : scene->dimensions, 0, -1},
                         of = given_rate ? rate : DIM_LENGTH;
  double *value = given_rate ? &region->rate : &region->head;
  bool given = config_child(group, key) != NULL;
  TRY(keys_read(config, group, "regions[]", 1u << region->type, scene, region));
  TRY(scene_read_name(config, group, title, region->number + 1, region->name, sizeof region->name));
  for (const struct region *r = scene->regions; r < region; r++)
    if (!strcmp(r->name, region->name))
      TRY(config_error(config, group, "a region before is called '%s' too; rename one", r->name));
  if (given_rate && !given)
    TRY(config_error(config, group, "rate is missing: what the %s, like rate = \"%s\"",
                     rain ? "rain brings" : "well takes",
                     rain                     ? "10 mm/h"
                     : scene->dimensions == 2 ? "1e-5 m^2/s"
                                              : "1e-5 m^3/s"));
  if (config_child(group, "times") != NULL) {
    TRY(read_table(config, group, key, of, scene, 1, &region->table));
    *value = time_table_extreme(&region->table, 0);
  } else {
    TRY(config_quantity(config, group, key, of, value, NULL));
  }
  bool negative = region->rate < 0;
  for (size_t k = 0; k < region->table.count && given_rate; k++)
    negative = negative || region->table.value[k][0] < 0;
  if (negative)
    TRY(config_error(
        config, config_child(group, key),
        rain ? "rain brings water, at a rate of 0 or more; for water that goes out, use "
               "an inflow region of flux < 0 on a side, or a drain in the soil"
             : "a well takes water out of the soil, at a rate of 0 or more; for water "
               "that comes in, use an inflow region on a side"));
  region->boundary = !given_rate && given ? BOUNDARY_HEAD : BOUNDARY_NONE;
cleanup:
  return status;
}

/* The lattice stores the region of a site in 16 bits. */
enum { REGIONS_MAX = 65000 };

enum status scene_read_regions(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config_root(config), "regions");
  if (list == NULL) return STATUS_OK;
  if (*scene->model_path)
    TRY(config_error(config, list, "regions need a domain; a voxel model brings its own grains"));
  scene->region_count = config_count(list);
  if (scene->region_count > REGIONS_MAX)
    TRY(config_error(config, list, "%zu regions; at most %d are possible", scene->region_count,
                     REGIONS_MAX));
  TRY(memory_allocate(&scene->regions, scene->region_count, sizeof *scene->regions, "regions"));
  for (size_t i = 0; i < scene->region_count; i++) {
    struct region *region = &scene->regions[i];
    config_node *group = config_item(list, i);
    int type = -1;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { type = ...; } is wanted"));
    region->line = config_line(group);
    region->number = region->first = i, region->end = i + 1;
    TRY(config_choice(config, group, "type", region_type_names, &type, NULL));
    if (type < 0)
      TRY(config_error(
          config, group,
          "type is missing: \"water\", \"porous\", \"wall\", \"inflow\", \"empty\", \"well\", "
          "\"drain\", \"rain\" or \"absorbing\""));
    region->type = (enum region_type)type;
    TRY(scene_has_stl(group)     ? scene_read_stl(config, group, scene, region)
        : scene_has_shape(group) ? scene_read_shape(config, group, scene, region)
                                 : read_box(config, group, scene, region->box));
    switch (region->type) {
    case REGION_POROUS:
      TRY(read_porous(config, group, scene, region));
      break;
    case REGION_INFLOW:
      TRY(read_inflow(config, group, scene, region));
      break;
    case REGION_WALL:
      TRY(read_wall(config, group, scene, region));
      break;
    case REGION_WATER:
      TRY(keys_read_vector(config, group, "velocity", scene, DIM_VELOCITY, region->velocity));
      break;
    case REGION_WELL:
    case REGION_DRAIN:
    case REGION_RAIN:
      TRY(read_well(config, group, scene, region));
      break;
    case REGION_EMPTY:
    case REGION_ABSORBING:
      break;
    }
  }
  TRY(scene_check_geometry(config, list, scene));
  TRY(scene_cut_shapes(config, list, scene, REGIONS_MAX));
cleanup:
  return status;
}
