/* Chooses the cost of surface with which the restored grains, blurred again, are closest to the
 * scan without its noise. */
#ifndef TOSUI_CT2MODEL_SCANNER_LEAST_RISK_H
#define TOSUI_CT2MODEL_SCANNER_LEAST_RISK_H

#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/windows.h"

/* Cost relative to the usual one, 1/4 to 8, for the first window of `scan`. The greys of the window
 * are 0 in pores and 1 in grains; its distances are overwritten. `noise`: standard deviation of the
 * noise, `length`: its correlation length (voxels). `deblur` holds the properties of the scanner
 * and space for the window; its cost of surface is overwritten. */
enum status least_risk_find(struct windows *scan, double noise, double length,
                            struct deblur *deblur, double *cost);

#endif
