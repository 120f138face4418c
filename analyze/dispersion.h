/* Dispersion of a solute against the Peclet number, from runs of method solute. */
#ifndef TOSUI_ANALYZE_DISPERSION_H
#define TOSUI_ANALYZE_DISPERSION_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"

/* Whether `path` is a file of a solute (/solute); false also if it cannot be read. */
bool dispersion_is(const char *path);

#endif
