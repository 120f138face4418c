/* Finds out whether the scan is an image of labels: its phases are then known, and its walls are
 * smoothed. */
#ifndef TOSUI_CT2MODEL_SEGMENT_H
#define TOSUI_CT2MODEL_SEGMENT_H

#include "ct2model/state.h"

/* Takes a scan as labels if --segmented says so, or if a model is to be built, the scan holds two
 * values, and no threshold or filter for greys is requested; --micro makes labels from greys. */
enum status segment_take(struct pipeline *pipeline);

#endif
