/* The boxes that a polygon or a body is cut into. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_PARTS_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_PARTS_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* The boxes of one region. */
struct scene_parts {
  size_t count;
  struct region *region;
};
/* Adds a box of the region `whole`. */
enum status scene_parts_add(struct scene_parts *parts, const struct region *whole,
                            const double box[6]);

/* Returns an input error at `node` if a region of this type can only be a box. */
enum status scene_parts_refuse_box_only(struct config *config, config_node *node,
                                        const struct region *region);

/* Order of doubles for qsort. */
int scene_parts_by_value(const void *a, const void *b);

#endif
