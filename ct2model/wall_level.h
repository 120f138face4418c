/* On which greys the walls are measured, and at which of them they lie: where they enclose the void
 * ratio, to fractions of a voxel. */
#ifndef TOSUI_CT2MODEL_WALL_LEVEL_H
#define TOSUI_CT2MODEL_WALL_LEVEL_H

#include "ct2model/state.h"

/* Fills pipeline->walls, after the threshold and the restored scan are known. A threshold that the
 * user gave stays what it is, but on a restored scan, which has other greys. */
enum status wall_level_find(struct pipeline *pipeline);

#endif
