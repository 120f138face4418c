/* Specific surface of a restored scan by Porod's law. What the scanner's blur hides, wedges beside
 * contacts and fine relief, is missing from the restored surface itself, but not from how often the
 * phases differ at distances that the scanner resolves. */
#ifndef TOSUI_CT2MODEL_SCANNER_POROD_H
#define TOSUI_CT2MODEL_SCANNER_POROD_H

#include "common/error.h"
#include "ct2model/scanner/restored.h"
#include "ct2model/scanner/scanner.h"

/* On entry `surface` (1/m) is that of the restored walls. It is left unchanged where the law does
 * not apply: walls that are smooth all over or near each other everywhere, or a scan that is too
 * small. `error`: 95 % half width (1/m), from generated sands and bodies. `voxel`: edges of the
 * restored voxels, m. */
enum status porod_surface(const struct restored *restored, const struct scanner *scanner,
                          const double voxel[3], double *surface, double *error);
/* Weight from 0 to 1 that the walls are those of grains in contact: by the B of the law, alike in
 * all directions. 0 where the law does not apply. `surface` (1/m): roughly that of the walls. */
enum status porod_grains(const struct restored *restored, double blur, const double voxel[3],
                         double surface, double *grains);

#endif
