/* Checks the void ratio of the model against the measured one, with the reason for a difference and
 * its effect on k. */
#ifndef TOSUI_CT2MODEL_MISFIT_H
#define TOSUI_CT2MODEL_MISFIT_H

#include "ct2model/state.h"

/* Warns if the void ratio of the finished model differs from the measured one by more than its
 * uncertainty and 1 % (5 % with --roi, where it refers to another region). */
void misfit_warn(const struct pipeline *pipeline);
/* Difference between the measured void ratio, as the region has it, and the one that the scan
 * itself shows, where it exceeds what the 95 % half widths of both allow; else 0. NAN where either
 * is unknown. */
double misfit_void_ratio_doubt(const struct pipeline *pipeline);
/* Warns of such a difference. */
void misfit_warn_of_doubt(const struct pipeline *pipeline);

#endif
