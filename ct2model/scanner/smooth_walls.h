/* Whether the walls of a scan have relief, or only what noise makes of smooth ones: as in tubes,
 * fibres and beads. */
#ifndef TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H
#define TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"

/* From 0, walls with relief, to 1, smooth ones, in the middle of the region; 0 where the scanner is
 * not known. */
enum status smooth_walls_find(const struct region *region, const struct scanner *scanner,
                              double *smooth);

#endif
