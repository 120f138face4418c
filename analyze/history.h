/* How a run went in time: maximum density, Darcy velocity and whatever columns its scene added. */
#ifndef TOSUI_ANALYZE_HISTORY_H
#define TOSUI_ANALYZE_HISTORY_H

#include <stddef.h>

#include "analyze/product.h"
#include "analyze/run_file.h"

enum status history_analyze(const struct run *runs, size_t n, struct product *product);

#endif
