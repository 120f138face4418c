/* The table of keys for readers: `sphsolve keys`, and docs/reference/scene.md. */
#ifndef TOSUI_SPHSOLVE_SCENE_KEYS_PRINT_H
#define TOSUI_SPHSOLVE_SCENE_KEYS_PRINT_H

#include <stdio.h>

#include "common/error.h"

/* As text for a terminal; as the page of the documentation; as a JSON array on stdout. */
void keys_print(FILE *stream);
void keys_print_markdown(FILE *stream);
enum status keys_print_json(void);

#endif
