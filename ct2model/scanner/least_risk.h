/* The cost of surface under which the restored grains, blurred again, come nearest to the true
 * ones. */
#ifndef TOSUI_CT2MODEL_SCANNER_LEAST_RISK_H
#define TOSUI_CT2MODEL_SCANNER_LEAST_RISK_H

#include "ct2model/scanner/deblur.h"
#include "ct2model/scanner/windows.h"

/* Over the usual cost, 1/4 to 8, for the first window of `scan`, whose greys are 0 in the pore and
 * 1 in the grain and whose distances are lost. `noise`: its standard deviation, and `length` over
 * which it is correlated (voxels). `deblur` has the scan's scanner and room for the window. */
enum status least_risk_find(struct windows *scan, double noise, double length,
                            struct deblur *deblur, double *cost);

#endif
