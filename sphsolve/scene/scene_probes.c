#include "sphsolve/scene/scene_probes.h"

#include <string.h>

#include "common/memory.h"
#include "sphsolve/scene/keys.h"
#include "sphsolve/scene/scene_geometry.h"
#include "sphsolve/scene/scene_names.h"

static enum status read_gauges(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config_root(config), "gauges");
  scene->gauge_count = config_count(list);
  TRY(memory_allocate(&scene->gauges, scene->gauge_count, sizeof *scene->gauges, "gauges"));
  for (size_t i = 0; i < scene->gauge_count; i++) {
    struct gauge *gauge = &scene->gauges[i];
    config_node *group = config_item(list, i);
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { at = [x, y, z]; } is wanted"));
    TRY(scene_read_name(config, group, "gauge", i + 1, gauge->name, sizeof gauge->name));
    TRY(keys_read(config, group, "gauges[]", 0, scene, gauge));
    for (int a = 0; a < 3; a++)
      if (gauge->at[a] < 0 || gauge->at[a] > scene->domain_size[a])
        TRY(config_error(config, config_child(group, "at"),
                         "%g m in %c lies outside the domain (0 to %g m)", gauge->at[a], 'x' + a,
                         scene->domain_size[a]));
    if (scene_in_wall(scene, gauge->at))
      TRY(config_error(config, config_child(group, "at"),
                       "lies inside a wall, where there is no pressure; move it into the water"));
    for (size_t k = 0; k < i; k++)
      if (!strcmp(scene->gauges[k].name, gauge->name))
        TRY(config_error(config, group, "a gauge before is called '%s' too; rename one",
                         gauge->name));
  }
cleanup:
  return status;
}

static enum status read_planes(struct config *config, struct scene *scene) {
  enum status status = STATUS_OK;
  config_node *list = config_child(config_root(config), "planes");
  scene->plane_count = config_count(list);
  TRY(memory_allocate(&scene->planes, scene->plane_count, sizeof *scene->planes, "planes"));
  for (size_t i = 0; i < scene->plane_count; i++) {
    struct flux_plane *plane = &scene->planes[i];
    config_node *group = config_item(list, i);
    int axes_given = 0;
    if (!config_is_group(group))
      TRY(config_error(config, group, "a group { z = \"0.2 m\"; } is wanted"));
    TRY(scene_read_name(config, group, "plane", i + 1, plane->name, sizeof plane->name));
    for (int a = 0; a < 3; a++) {
      bool given;
      TRY(config_quantity(config, group, scene_axis_names[a], DIM_LENGTH, &plane->position,
                          &given));
      if (given) plane->axis = a, axes_given++;
    }
    if (axes_given != 1)
      TRY(config_error(config, group, "one of x, y, z is wanted: the plane's position"));
    if (scene->dimensions == 2 && plane->axis == 1)
      TRY(config_error(config, config_child(group, "y"),
                       "a 2-D scene lives in x and z: give x or z"));
    if (plane->position < 0 || plane->position > scene->domain_size[plane->axis])
      TRY(config_error(config, config_child(group, scene_axis_names[plane->axis]),
                       "%g m lies outside the domain (0 to %g m)", plane->position,
                       scene->domain_size[plane->axis]));
    for (size_t k = 0; k < i; k++)
      if (!strcmp(scene->planes[k].name, plane->name))
        TRY(config_error(config, group, "a plane before is called '%s' too; rename one",
                         plane->name));
  }
cleanup:
  return status;
}

enum status scene_read_probes(struct config *config, struct scene *scene) {
  enum status status = read_gauges(config, scene);
  return status == STATUS_OK ? read_planes(config, scene) : status;
}
