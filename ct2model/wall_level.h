/* On which greys the walls are measured, and at which of them they lie: where they enclose the void
 * ratio, to fractions of a voxel. */
#ifndef TOSUI_CT2MODEL_WALL_LEVEL_H
#define TOSUI_CT2MODEL_WALL_LEVEL_H

#include "ct2model/scan/enclosed.h"
#include "ct2model/state.h"

/* The volume that the walls enclose: as it is mirrored in a model of the scan's own voxels; else
 * the region's, so that walls do not depend on which axis the model mirrors. */
struct enclosed_sides wall_level_sides(const struct pipeline *pipeline);

/* Fills pipeline->walls, after the threshold and the restored scan are known. A threshold that the
 * user gave stays what it is, but on a restored scan, which has other greys. */
enum status wall_level_find(struct pipeline *pipeline);

#endif
