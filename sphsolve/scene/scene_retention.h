/* Variably saturated soil: retention curves of van Genuchten, Haverkamp or Gardner, and the initial
 * water content. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_RETENTION_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_RETENTION_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Reads the curve of a soil region and how wet it starts; porosity and permeability must have been
 * read. */
enum status scene_read_retention(struct config *config, config_node *group, struct region *region);

#endif
