/* What a scene says, one line a setting in SI: to tell what has changed since a checkpoint. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_COMPARE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_COMPARE_H

#include "sphsolve/scene/scene.h"

/* "fluids.viscosity = 0.001" and so on, each in a line of its own, in new memory. Lines of settings
 * that a run may change on its way (how long, how often, how exactly) begin with '~'. */
enum status scene_describe(const struct scene *scene, char **text);

/* Compares two such texts. A line that a run may not change: an input error that names it, what it
 * said then and what it says now. The others are told. `path` is that of the checkpoint. */
enum status scene_compare(const char *then, const char *now, const char *path);

#endif
