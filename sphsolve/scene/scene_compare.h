/* Text form of a scene, one setting in SI units per line, to find changes since a checkpoint. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_COMPARE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_COMPARE_H

#include "sphsolve/scene/scene.h"

/* Writes lines such as "fluids.viscosity = 0.001" into new memory. Lines of settings that may
 * change during a run (duration, output intervals, tolerances) begin with '~'. */
enum status scene_describe(const struct scene *scene, char **text);

/* Compares two such texts. A difference in a line that must not change is an input error with both
 * values; other differences are only logged. `path` is that of the checkpoint. */
enum status scene_compare(const char *then, const char *now, const char *path);

#endif
