/* The flow that carries a solute, and whether it belongs to the same model as given runs. */
#ifndef TOSUI_ANALYZE_SOLUTE_FLOW_H
#define TOSUI_ANALYZE_SOLUTE_FLOW_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"

/* An input error if the flow of one of the files `solutes` is not among the runs and has another
 * model, or cannot be found; with `allowed` an information instead. */
enum status solute_flow_check(const char *const *solutes, size_t count, const struct run *runs,
                              size_t n, bool allowed);

#endif
