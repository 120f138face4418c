/* Whether the model has the void ratio that was measured, why not, and what that does to k. */
#ifndef TOSUI_CT2MODEL_MISFIT_H
#define TOSUI_CT2MODEL_MISFIT_H

#include "ct2model/state.h"

/* Warns where the finished model's void ratio is off the measured one by more than its uncertainty
 * and 1 % (5 % where --roi says that it holds elsewhere). */
void misfit_warn(const struct pipeline *pipeline);

#endif
