/* Dispersion of a solute against the Peclet number, from runs of method solute. */
#ifndef TOSUI_ANALYZE_DISPERSION_H
#define TOSUI_ANALYZE_DISPERSION_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/product.h"

/* Whether `path` holds what a solute did (/solute); false also where it cannot be read. */
bool dispersion_is(const char *path);

/* D_L / D, D_T / D, dispersivities and formation factor of each file, a table and a plot with the
 * curve of beds that are in print. */
enum status dispersion_analyze(const char *const *paths, size_t n, struct product *product);

#endif
