/* Measures blur, fringe and noise of the scanner on windows of the scan itself. */
#ifndef TOSUI_CT2MODEL_SCANNER_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_SCANNER_H

#include "common/error.h"
#include "ct2model/scan/region.h"
#include "ct2model/scanner/blur_and_noise.h"

struct survey;

/* Fills `scanner`; `scanner->known` is false where it cannot be measured. `survey` gives a first
 * estimate of the greys of pore and grain, and their greys by the mean where both phases are
 * narrow. Lengths in m. */
enum status scanner_measure(const struct region *region, const struct survey *survey,
                            struct scanner *scanner);

#endif
