/* Which voxels of the greys of soil are soil: edges between pore and grain have these greys too,
 * and noise gives them to others. */
#ifndef TOSUI_CT2MODEL_SCAN_SETTLE_H
#define TOSUI_CT2MODEL_SCAN_SETTLE_H

#include "common/error.h"
#include "ct2model/scan/micro.h"

/* micro->kind is MICRO_PORE, MICRO_GRAIN or the level of a grey between them, that rises with it.
 * First noise: a voxel whose phase no more than SETTLE_SPECK of the 3x3x3 about it have goes to
 * that of most, but edges stay; soil gets their mean level. Then edges: a level with pore and grain both within
 * SETTLE_RIM voxels, in more than SETTLE_SHARE of them each, is pore below the level `middle`, else
 * grain. Then noise once more (docs/notes/2026-11-23-micropores.md has what else was tried).
 * *noisy: the share of voxels that were noise at first. */
#define SETTLE_SPECK 0.3 /* 8 of 27 */
#define SETTLE_RIM 2
#define SETTLE_SHARE 0.1
enum status settle(struct micro *micro, double middle, double *noisy);

#endif
