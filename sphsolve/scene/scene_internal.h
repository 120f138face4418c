/* Shared by the parts of the scene reader: scene.c (groups, driving force), scene_regions.c
 * (regions, gauges, planes), scene_geometry.c (consistency of regions), scene_settings.c (methods,
 * effects, output), scene_solute.c (solute in a finished flow). */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_INTERNAL_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_INTERNAL_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* A positive quantity, or NAN when missing or "auto". */
enum status scene_positive(struct config *config, config_node *group, const char *name,
                           struct dimension dimension, double *value);
/* A vector of the scene's dimensions: [x, z] of a 2-D scene, else [x, y, z]. */
enum status scene_vector(struct config *config, config_node *group, const char *name,
                         const struct scene *scene, struct dimension dimension, double vector[3]);
/* Moves the two values of a 2-D vector to x and z. */
void scene_spread(const struct scene *scene, int count, double vector[3]);

/* Checks all regions: extents relative to the spacing, overlaps, throats between walls. */
enum status scene_check_geometry(struct config *config, config_node *list,
                                 const struct scene *scene);
/* Whether a point lies inside a wall at rest. */
bool scene_in_wall(const struct scene *scene, const double point[3]);

/* scene_permeability.c: drag of soil with a given permeability; porosity, grain_size and alpha must
 * have been read. */
enum status scene_read_permeability(struct config *config, config_node *group,
                                    const struct scene *scene, struct region *region);

/* scene_retention.c: retention curve of a soil region and its initial water content. */
enum status scene_read_retention(struct config *config, config_node *group, struct region *region);

/* scene_shapes.c: regions other than boxes. Whether a group describes one; reads it, with its
 * extent in `box`; cuts all of them into boxes, at most `most` regions in total. */
bool scene_has_shape(struct config *config, config_node *group);
enum status scene_read_shape(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region);
enum status scene_cut_shapes(struct config *config, config_node *list, struct scene *scene,
                             size_t most);

/* Returns an input error at `node` if a region of this type can only be a box. */
enum status scene_refuse_box_only(struct config *config, config_node *node,
                                  const struct region *region);

/* The boxes of one region. */
struct scene_parts {
  size_t count;
  struct region *region;
};
/* Adds a box of the region `whole`. */
enum status scene_add_part(struct scene_parts *parts, const struct region *whole,
                           const double box[6]);

/* scene_stl.c: the same for bodies given by a surface in an STL file. */
bool scene_has_stl(struct config *config, config_node *group);
enum status scene_read_stl(struct config *config, config_node *group, const struct scene *scene,
                           struct region *region);
enum status scene_cut_stl(const struct scene *scene, const struct region *whole,
                          struct scene_parts *parts);
void scene_free_stl(struct region *region);

/* Each function reads the groups of its file into the scene. */
enum status scene_read_regions(struct config *config, struct scene *scene);
enum status scene_read_probes(struct config *config, struct scene *scene); /* gauges, planes */
enum status scene_read_solute(struct config *config, struct scene *scene); /* flow, solute */
/* Reads group.file, which must exist and be readable, relative to the scene or to the working
 * directory; `example` and `made` (the program that makes it) are used in messages. `path` holds
 * 4096 bytes. */
enum status scene_file(struct config *config, config_node *group, const char *name,
                       const char *example, const char *made, char *path);
enum status scene_read_settings(struct config *config, struct scene *scene);

#endif
