/* How much relief the walls of a scan have: none but what noise makes of smooth ones, as in tubes,
 * fibres and beads; that of sand; or more, as with fines. */
#ifndef TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H
#define TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"

/* Sets `smooth_walls` and `fine_relief`, as they are in the middle of the region; 0 where the
 * scanner is not known. */
enum status smooth_walls_find(const struct region *region, struct scanner *scanner);

#endif
