/* Gauges and planes, at which a run is recorded. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_PROBES_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_PROBES_H

#include "common/config.h"
#include "sphsolve/scene/scene.h"

enum status scene_read_probes(struct config *config, struct scene *scene);

#endif
