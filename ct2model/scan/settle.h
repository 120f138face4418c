/* Decides which of the voxels with greys of soil are soil: edges between pore and grain have these
 * greys too, and noise gives them to others. */
#ifndef TOSUI_CT2MODEL_SCAN_SETTLE_H
#define TOSUI_CT2MODEL_SCAN_SETTLE_H

#include "common/error.h"
#include "ct2model/scan/micro.h"

/* micro->kind is MICRO_PORE, MICRO_GRAIN or, between them, a level that rises with the grey. First
 * noise is removed: a voxel whose phase at most SETTLE_SPECK of the 3x3x3 voxels around it share
 * takes the phase of the majority, but edges are kept; soil takes the mean level of these voxels.
 * Then edges: a level with more than SETTLE_SHARE of both pore and grain within SETTLE_RIM voxels
 * becomes pore below the level `middle`, else grain. Then noise is removed once more
 * (docs/physics/restoration.md says on what they were set). *noisy: the fraction of voxels that
 * were noise in the first round. */
#define SETTLE_SPECK 0.3 /* 8 of 27 */
#define SETTLE_RIM 2
#define SETTLE_SHARE 0.1
enum status settle(struct micro *micro, double middle, double *noisy);

#endif
