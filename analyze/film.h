/* Film strip of a plume: where walkers are from where they began, at times that double. */
#ifndef TOSUI_ANALYZE_FILM_H
#define TOSUI_ANALYZE_FILM_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"

/* Whether a file holds such pictures. */
bool film_is(const char *path);
/* The last pictures of the first file that holds any, at its largest Peclet number. */
enum status film_analyze(const char *const *paths, size_t n, struct product *product);

#endif
