/* On which greys the walls are measured, and at which of them they lie: where they enclose the void
 * ratio, to fractions of a voxel. */
#ifndef TOSUI_CT2MODEL_WALL_LEVEL_H
#define TOSUI_CT2MODEL_WALL_LEVEL_H

#include "ct2model/state.h"

/* Axes along which the volume is mirrored that walls enclose: as in the model where it has the
 * scan's own voxels; else all, so that walls do not depend on which axis the model mirrors. */
void wall_level_reflect(const struct pipeline *pipeline, bool reflect[3]);

/* Fills pipeline->walls, after the threshold and the restored scan are known. A threshold that the
 * user gave stays what it is, but on a restored scan, which has other greys. */
enum status wall_level_find(struct pipeline *pipeline);

#endif
