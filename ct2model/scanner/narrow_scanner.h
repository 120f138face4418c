/* The scanner of a scan none of whose surfaces stands alone, as all pores or all grains are narrow:
 * the one with which its grains look most like the scan. */
#ifndef TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"

/* Of a scanner that is assumed: it becomes known, with what its pieces say; or stays as it is where
 * the blur that explains it best is none, or more than three voxels. */
enum status narrow_scanner_find(const struct region *region, struct scanner *scanner);

#endif
