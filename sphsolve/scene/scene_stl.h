/* Regions enclosed by a surface of triangles (stl.h). */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_STL_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_STL_H

#include "common/config.h"
#include "sphsolve/scene/lost_wall.h"
#include "sphsolve/scene/scene_parts.h"

/* Whether a group describes one. */
bool scene_has_stl(config_node *group);
/* Reads it, with its extent in `box`. */
enum status scene_read_stl(struct config *config, config_node *group, const struct scene *scene,
                           struct region *region);
/* Cuts it into boxes. */
enum status scene_cut_stl(const struct scene *scene, const struct region *whole,
                          struct scene_parts *parts);
/* Adds its pieces on all lines through points of the lattice. */
enum status scene_stl_lines(const struct scene *scene, const struct region *whole,
                            struct lost_wall *wall);

#endif
