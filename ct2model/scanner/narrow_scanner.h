/* Estimates blur and noise of a scan in which no surface is free of neighbours, because all pores
 * or all grains are narrow. */
#ifndef TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_NARROW_SCANNER_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"

/* Improves a scanner that is assumed, or was measured where each surface has another one near, or
 * whose blur is too wide and uncertain: the blur with which the restored grains look most like the
 * scan. On success `scanner` becomes known; it is left unchanged where no blur up to about three
 * voxels explains the scan better than the others, or where there is hardly any noise. */
enum status narrow_scanner_find(const struct region *region, struct scanner *scanner);

/* The widest blur that narrow_scanner_find tries, in voxels. */
double narrow_scanner_widest(void);

#endif
