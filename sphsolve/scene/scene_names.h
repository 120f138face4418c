/* Names in a scene: of gauges, planes, walls and wells, and of files. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_NAMES_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_NAMES_H

#include "common/config.h"

/* Reads group.name, which is used as a column title; without it the name is `title` and `number`.
 */
enum status scene_read_name(struct config *config, config_node *group, const char *title,
                            size_t number, char *name, size_t size);

/* Finds the file that group.NAME gives, relative to the scene or else to the working directory; it
 * must be readable. Messages: `example` as a value in quotes, `made` the command that makes such a
 * file, "" for none. */
enum status scene_file_find(struct config *config, config_node *group, const char *name,
                            const char *example, const char *made, char path[4096]);

#endif
