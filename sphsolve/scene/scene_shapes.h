/* Regions other than boxes: prisms over a polygon, and cylinders (discs in 2-D). */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_SHAPES_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_SHAPES_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Whether a group describes one. */
bool scene_has_shape(config_node *group);
/* Reads it, with its extent in `box`. */
enum status scene_read_shape(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region);
/* Cuts all polygons and bodies into boxes, at most `most` regions in total. */
enum status scene_cut_shapes(struct config *config, config_node *list, struct scene *scene,
                             size_t most);

/* Largest number of corners of a polygon. */
#define POLYGON_CORNERS_MAX 256
/* Intersections of the edges with the line where coordinate `w` of the plane is v, sorted; returns
 * their number. */
size_t polygon_scan(const struct polygon *polygon, int w, double v, double at[POLYGON_CORNERS_MAX]);
/* Whether any edge may be in the box from..to of the plane, m: false only if none is. */
bool polygon_may_meet(const struct polygon *polygon, const double from[2], const double to[2]);

#endif
