/* What the scanner did to the specimen, measured on windows of the scan itself. */
#ifndef TOSUI_CT2MODEL_SCANNER_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_SCANNER_H

#include "common/error.h"
#include "ct2model/scan/region.h"
#include "ct2model/scanner/blur_and_noise.h"

struct survey;

/* `survey` says about where pore and grain lie, and what they are where both are narrow. */
enum status scanner_measure(const struct region *region, const struct survey *survey,
                            struct scanner *scanner);

#endif
