/* Consistency of regions with each other, with the spacing and with the gauges in them. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_GEOMETRY_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_GEOMETRY_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Checks all regions: extents relative to the spacing, overlaps, throats between walls. */
enum status scene_check_geometry(struct config *config, config_node *list,
                                 const struct scene *scene);
/* Least thickness of a wall region, in spacings: what is thinner may be missed between two sites
 * (thin_wall.h). */
#define SCENE_WALL_THICKNESS_MIN 1e-3
/* Smallest extent of a region along the axes that the scene has, m. */
double scene_region_thickness(const struct scene *scene, const struct region *region);
/* Whether a point lies inside a wall at rest. */
bool scene_in_wall(const struct scene *scene, const double point[3]);

#endif
