/* Plot of histories: Darcy velocity, density and further columns of scenes and methods. */
#ifndef TOSUI_ANALYZE_HISTORY_PLOT_H
#define TOSUI_ANALYZE_HISTORY_PLOT_H

#include "analyze/history.h"
#include "analyze/product.h"

/* Whether the column is recorded by every run, independent of scene and method. */
bool history_is_standard(const char *column);
/* Writes the plot of n runs and sets its size. */
void history_plot(const struct run_history *table, size_t n, struct product *product);

#endif
