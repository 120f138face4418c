/* Chooses the greys on which the walls are measured, and the grey at which they enclose the void
 * ratio, to fractions of a voxel. */
#ifndef TOSUI_CT2MODEL_WALL_LEVEL_H
#define TOSUI_CT2MODEL_WALL_LEVEL_H

#include "ct2model/scan/enclosed.h"
#include "ct2model/state.h"

/* Sides of the volume that the walls enclose: as mirrored in a model of the scan's own voxels, else
 * those of the region. So walls do not depend on which axis the model mirrors. */
struct enclosed_sides wall_level_sides(const struct pipeline *pipeline);

/* Sets pipeline->walls; threshold and restored scan must be known. A threshold given by the user is
 * kept, except on a restored scan, which has other greys. */
enum status wall_level_find(struct pipeline *pipeline);

#endif
