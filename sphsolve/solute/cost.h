/* Predicted cost and error of method solute. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_COST_H
#define TOSUI_SPHSOLVE_SOLUTE_COST_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

/* Reads the flow's walls and prints predicted time, memory and error. */
enum status solute_explain(const struct scene *scene, int threads, bool json);

/* Prefixes an input error of the flow with the line of flow.file; returns the status. */
enum status solute_add_location(const struct scene *scene, enum status status);

#endif
