/* Whether the scan is an image of labels: its phases are known then, and its walls smoothed. */
#ifndef TOSUI_CT2MODEL_SEGMENT_H
#define TOSUI_CT2MODEL_SEGMENT_H

#include "ct2model/state.h"

/* A segmented image is one by --segmented, or where a model is wanted of two values and no
 * threshold or filter for greys is asked for; --micro makes labels of greys. */
enum status segment_take(struct pipeline *pipeline);

#endif
