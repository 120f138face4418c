#include "sphsolve/scene/scene_parts.h"

#include <string.h>

#include "common/memory.h"

enum status scene_parts_add(struct scene_parts *parts, const struct region *whole,
                            const double box[6]) {
  enum status status =
      memory_resize(&parts->region, parts->count + 1, sizeof *parts->region, "regions");
  if (status != STATUS_OK) return status;
  struct region *part = &parts->region[parts->count++];
  *part = *whole;
  part->is_part = true;
  memcpy(part->box, box, sizeof part->box);
  return STATUS_OK;
}

enum status scene_parts_refuse_box_only(struct config *config, config_node *node,
                                        const struct region *region) {
  if (region->type == REGION_INFLOW)
    return config_error(config, node, "an inflow region is a thin box on a side; give its box");
  if (region->type == REGION_RAIN)
    return config_error(config, node, "rain falls from a box; give its box");
  if (region->type == REGION_ABSORBING)
    return config_error(config, node, "waves fade in a box along a side; give its box");
  return STATUS_OK;
}

int scene_parts_by_value(const void *a, const void *b) {
  const double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}
