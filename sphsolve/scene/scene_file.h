/* Files that a scene names. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_FILE_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_FILE_H

#include "common/config.h"

/* Finds the file that group.NAME gives, relative to the scene or else to the working directory; it
 * must be readable. Messages: `example` as a value in quotes, `made` the command that makes such a
 * file,
 * "" for none. */
enum status scene_file_find(struct config *config, config_node *group, const char *name,
                            const char *example, const char *made, char path[4096]);

#endif
