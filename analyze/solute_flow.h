/* The flow that a solute was carried by, and whether it belongs beside runs. */
#ifndef TOSUI_ANALYZE_SOLUTE_FLOW_H
#define TOSUI_ANALYZE_SOLUTE_FLOW_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"

/* An input error where the flow of one of the files `solutes` is none of the runs and has another
 * model than they, or is nowhere to be found; with `told` the same as a line of information. */
enum status solute_flow_check(const char *const *solutes, size_t count, const struct run *runs,
                              size_t n, bool told);

#endif
