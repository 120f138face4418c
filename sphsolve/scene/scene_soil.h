/* Soil with a given permeability, one number or one along each principal axis; and variably
 * saturated soil: retention curves of van Genuchten, Haverkamp or Gardner, and the initial water
 * content. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_SOIL_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_SOIL_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Sets the drag of soil with a given permeability; porosity, grain_size and alpha must have been
 * read. */
enum status scene_read_permeability(struct config *config, config_node *group,
                                    const struct scene *scene, struct region *region);

/* Reads the curve of a soil region and how wet it starts; porosity and permeability must have been
 * read. */
enum status scene_read_retention(struct config *config, config_node *group, struct region *region);

#endif
