/* Soil with a given permeability: one number, or one along each principal axis. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_PERMEABILITY_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_PERMEABILITY_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Sets the drag of soil with a given permeability; porosity, grain_size and alpha must have been
 * read. */
enum status scene_read_permeability(struct config *config, config_node *group,
                                    const struct scene *scene, struct region *region);

#endif
