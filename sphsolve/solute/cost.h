/* What method solute will cost and how good it will be, before it runs. */
#ifndef TOSUI_SPHSOLVE_SOLUTE_COST_H
#define TOSUI_SPHSOLVE_SOLUTE_COST_H

#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/scene/scene.h"

/* Reads the flow's walls and prints time, memory and error. */
enum status solute_explain(const struct scene *scene, int threads, bool json);

/* Puts the line of flow.file before an input error of the flow; returns the status. */
enum status solute_say_where(const struct scene *scene, enum status status);

#endif
