/* The specific surface of a restored scan by Porod's law: what lies beyond the scanner's blur,
 * wedges beside contacts and relief, is missing from the restored surface itself, but not from how
 * often phases differ at distances that the scanner resolves. */
#ifndef TOSUI_CT2MODEL_SCANNER_POROD_H
#define TOSUI_CT2MODEL_SCANNER_POROD_H

#include "common/error.h"
#include "ct2model/scanner/restored.h"
#include "ct2model/scanner/scanner.h"

/* `surface` (1/m) comes as the restored walls have it, and stays where the law says nothing: walls
 * smooth all over or near each other everywhere, or a scan too small. `error`: its 95 % half width,
 * as generated sands and bodies have it. `voxel`: edges of the restored voxels, m. */
enum status porod_surface(const struct restored *restored, const struct scanner *scanner,
                          const double voxel[3], double *surface, double *error);
/* 0 to 1: how far the walls are as near to each other as those of grains that touch, alike in all
 * directions; 0 where the law says nothing. `surface` (1/m) as the walls have it, roughly. */
enum status porod_grains(const struct restored *restored, double blur, const double voxel[3],
                         double surface, double *grains);

#endif
