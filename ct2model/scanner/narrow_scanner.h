/* The scanner of a scan none of whose surfaces stands alone, as all pores or all grains are narrow:
 * the one with which its grains look most like the scan. */
#ifndef TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/blur_and_noise.h"

/* Of a scanner that is assumed, or was read where each surface has another one near, or too wide to
 * have been read from few: it becomes known, with what its grains say; or stays as it is where no
 * blur up to three voxels explains the scan better than others, or where there is hardly any noise.
 */
enum status narrow_scanner_find(const struct region *region, struct scanner *scanner);

/* The widest blur it tries, in voxels. */
double narrow_scanner_widest(void);

#endif
