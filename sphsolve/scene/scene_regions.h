/* The regions that fill a domain. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_REGIONS_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_REGIONS_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Reads all regions, checks them against each other and cuts those that are no boxes into boxes. */
enum status scene_read_regions(struct config *config, struct scene *scene);

#endif
