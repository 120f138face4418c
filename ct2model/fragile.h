/* Warnings of greys that do not part pore from grain well, whatever the threshold. */
#ifndef TOSUI_CT2MODEL_FRAGILE_H
#define TOSUI_CT2MODEL_FRAGILE_H

#include "ct2model/state.h"

/* Of the lower peak: a valley as deep as this parts two phases. */
#define VALLEY_SURE 0.5

/* Once the threshold is found. */
void fragile_warn(struct pipeline *pipeline);

#endif
