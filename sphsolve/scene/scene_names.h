/* Names of gauges, planes, walls and wells. */
#ifndef TOSUI_SPHSOLVE_SCENE_SCENE_NAMES_H
#define TOSUI_SPHSOLVE_SCENE_SCENE_NAMES_H

#include "common/config.h"

/* Reads group.name, which is used as a column title; without it the name is `title` and `number`.
 */
enum status scene_read_name(struct config *config, config_node *group, const char *title,
                            size_t number, char *name, size_t size);

#endif
