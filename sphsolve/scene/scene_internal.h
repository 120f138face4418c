/* What the parts of the scene reader share: scene.c (groups, driving, the whole), scene_regions.c
 * (what fills the domain, gauges, planes), scene_geometry.c (checks of regions
 * against each other), scene_settings.c (methods, effects, output), scene_solute.c (what a finished
 * flow carries). */
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
/* Spreads the two values of a 2-D vector to x and z. */
void scene_spread(const struct scene *scene, int count, double vector[3]);

/* Of all regions: extents against the spacing, what covers what, throats between walls. */
enum status scene_check_geometry(struct config *config, config_node *list,
                                 const struct scene *scene);
/* Whether a point lies inside a wall that rests. */
bool scene_in_wall(const struct scene *scene, const double point[3]);

/* scene_permeability.c: the drag of soil whose permeability is given, after its porosity,
 * grain_size and alpha. */
enum status scene_read_permeability(struct config *config, config_node *group,
                                    const struct scene *scene, struct region *region);

/* scene_retention.c: the retention curve of a region of soil, and how wet it starts. */
enum status scene_read_retention(struct config *config, config_node *group, struct region *region);

/* scene_shapes.c: regions that are no boxes. Whether a group gives one; reads it, its extent into
 * `box`; cuts all into boxes, at most `most` regions. */
bool scene_has_shape(struct config *config, config_node *group);
enum status scene_read_shape(struct config *config, config_node *group, const struct scene *scene,
                             struct region *region);
enum status scene_cut_shapes(struct config *config, config_node *list, struct scene *scene,
                             size_t most);

/* An input error at `node` where a region is of a type that only a box can have. */
enum status scene_refuse_box_only(struct config *config, config_node *node,
                                  const struct region *region);

/* The boxes of one region. */
struct scene_parts {
  size_t count;
  struct region *region;
};
/* One more, of the region `whole`. */
enum status scene_add_part(struct scene_parts *parts, const struct region *whole,
                           const double box[6]);

/* scene_stl.c: the same for bodies within a surface that a file holds. */
bool scene_has_stl(struct config *config, config_node *group);
enum status scene_read_stl(struct config *config, config_node *group, const struct scene *scene,
                           struct region *region);
enum status scene_cut_stl(const struct scene *scene, const struct region *whole,
                          struct scene_parts *parts);
void scene_free_stl(struct region *region);

/* Each reads the groups that its file is for into the scene. */
enum status scene_read_regions(struct config *config, struct scene *scene);
enum status scene_read_probes(struct config *config, struct scene *scene); /* gauges, planes */
enum status scene_read_solute(struct config *config, struct scene *scene); /* flow, solute */
/* group.file, which must be there and be readable, beside the scene or from where the program runs;
 * `example` and `made` (by what) are for messages. `path` holds 4096. */
enum status scene_file(struct config *config, config_node *group, const char *name,
                       const char *example, const char *made, char *path);
enum status scene_read_settings(struct config *config, struct scene *scene);

#endif
