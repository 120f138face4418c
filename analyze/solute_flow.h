/* Files of a solute: what they hold, and whether their flow belongs to the model of given runs. */
#ifndef TOSUI_ANALYZE_SOLUTE_FLOW_H
#define TOSUI_ANALYZE_SOLUTE_FLOW_H

#include <stdbool.h>
#include <stddef.h>

#include "analyze/run_file.h"

#define SOLUTE "/solute"                          /* in every such file */
#define SOLUTE_WALK "/solute/walk/0/passage_time" /* with random walks */
#define SOLUTE_PLUME "/solute/walk/0/plume"       /* with pictures of a plume */
/* Whether the file at `path` has an object; false also if it cannot be read. */
bool solute_has(const char *path, const char *object);
/* Whether one of the files has it. */
bool solute_any_has(const char *const *paths, size_t n, const char *object);

/* An input error if the flow of one of the files `solutes` is not among the runs and has another
 * model, or cannot be found; with `allowed` an information instead. */
enum status solute_flow_check(const char *const *solutes, size_t count, const struct run *runs,
                              size_t n, bool allowed);

#endif
