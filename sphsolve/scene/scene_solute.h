/* A scene with a solute in a flow that is already solved. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_SOLUTE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_SOLUTE_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

/* Reads the groups flow and solute; nothing where the scene has neither. */
enum status scene_read_solute(struct config *config, struct scene *scene);

#endif
