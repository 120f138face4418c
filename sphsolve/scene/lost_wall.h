/* Walls that are made of points, where they are thinner than the spacing: a polygon or body may
 * cross the link between two neighbouring points without holding one of them. */
#ifndef TOSUI_SPHSOLVE_SCENE_LOST_WALL_H
#define TOSUI_SPHSOLVE_SCENE_LOST_WALL_H

#include <stdint.h>

#include "sphsolve/scene/scene_parts.h"

/* The points around a body, and the links between them that it crosses. */
struct lost_wall {
  const struct scene *scene;
  long first[3]; /* point of the domain that is the first here, along each axis */
  size_t size[3];
  uint8_t *bits; /* see lost_wall.c */
};

/* Begins with a body of this extent, none of whose lines are known. along: axis of a prism, which
 * is looked at in one plane, the points' index along it being 0; -1: none. Free `bits` with
 * memory_free. */
enum status lost_wall_begin(const struct scene *scene, const double extent[6], int along,
                            struct lost_wall *wall);

/* Adds a piece of the body, from..to (m), of the line along `axis` through the points `at` of the
 * domain; at[axis] is not read. */
void lost_wall_add(struct lost_wall *wall, int axis, const long at[3], double from, double to);

/* Adds to the boxes of the body the nearer point of each link that it crosses, except where it only
 * clips a thick body. */
enum status lost_wall_fill(struct lost_wall *wall, const struct region *whole,
                           struct scene_parts *parts);

#endif
