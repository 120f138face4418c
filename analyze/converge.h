/* Permeability against resolution, from runs of one body at several spacings. */
#ifndef TOSUI_ANALYZE_CONVERGE_H
#define TOSUI_ANALYZE_CONVERGE_H

#include "analyze/product.h"
#include "analyze/run_file.h"

/* Groups the runs by method and wall; order, limit and index of each into the product's JSON, CSV,
 * plot and summary. An input error where no group has two spacings. */
enum status converge_analyze(const struct run *runs, size_t n, struct product *product);

#endif
