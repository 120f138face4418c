/* Consistency of regions with each other, with the spacing and with the gauges in them. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_GEOMETRY_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_GEOMETRY_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Checks all regions: extents relative to the spacing, overlaps, throats between walls. */
enum status scene_check_geometry(struct config *config, config_node *list,
                                 const struct scene *scene);
/* Whether a point lies inside a wall at rest. */
bool scene_in_wall(const struct scene *scene, const double point[3]);

#endif
