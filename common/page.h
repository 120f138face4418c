/* A page of a program's: one HTML file that needs nothing beside it. Its template names the files
 * that it holds as @{page.css}, and the JSON that it shows as @{data}; all that is seen is made of
 * the latter by its scripts. */
#ifndef TOSUI_PAGE_H
#define TOSUI_PAGE_H

#include <jansson.h>
#include <stddef.h>

#include "common/error.h"

/* A file that is part of the program (page_assets.h); size 0: a library that was not installed when
 * it was built. It is not terminated by a zero byte. */
struct asset {
  const char *name, *data;
  size_t size;
};

/* Writes the page whose template is the first of the n assets. */
enum status page_write(const char *path, const struct asset *assets, size_t n, const json_t *data);

#endif
