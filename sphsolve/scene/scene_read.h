/* Reads a scene file. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_READ_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_READ_H

#include "sphsolve/scene/scene.h"

/* Reads and validates a scene. Errors name file, line and a remedy. Free with scene_free. */
enum status scene_read(const char *path, const char *const *overrides, size_t override_count,
                       struct scene *scene);

#endif
