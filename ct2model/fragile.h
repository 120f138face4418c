/* Warnings about greys that do not separate pore from grain well, whatever the threshold. */
#ifndef TOSUI_CT2MODEL_FRAGILE_H
#define TOSUI_CT2MODEL_FRAGILE_H

#include "ct2model/state.h"

/* Ratio of a valley to the lower peak up to which it clearly separates two phases. */
#define VALLEY_SURE 0.5

/* Gives the warnings; the threshold must be known. */
void fragile_warn(struct pipeline *pipeline);

#endif
