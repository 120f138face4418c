/* The share of grain in each voxel as the scan would show it without the scanner: of all images
 * between 0 (pore) and 1 (grain) the one that, blurred as the scanner blurs, explains the scan to
 * within its noise with the least surface. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORE_H
#define TOSUI_CT2MODEL_SCANNER_RESTORE_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"
#include "ct2model/surface/coarse.h"

/* Into `restored`, whose levels 0 .. 255 are shares 0 .. 1 (free with coarse_end). Where the blur
 * spans several voxels of a large region these are averaged first. `blur` (m) is taken for that of
 * the scanner. Step 1 with no levels: memory would not hold it. */
enum status restore_run(const struct region *region, const struct scanner *scanner, double blur,
                        struct coarse *restored);

#endif
