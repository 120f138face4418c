/* Estimates the relief of the walls of a scan: only what noise makes on smooth walls, as in tubes,
 * fibres and beads; that of sand; or finer relief, as with fines. */
#ifndef TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H
#define TOSUI_CT2MODEL_SCANNER_SMOOTH_WALLS_H

#include "ct2model/scan/region.h"
#include "ct2model/scanner/scanner.h"

/* Sets `smooth_walls` and `fine_relief` of the scanner from the middle of the region; both are 0
 * where the scanner is not known. */
enum status smooth_walls_find(const struct region *region, struct scanner *scanner);

#endif
