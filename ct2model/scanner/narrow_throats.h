/* What the restoration of a scan needs where grains and throats are only a few blurs wide: pores do
 * not show the grey of pore, and throats close unless grain and pore are told to be two phases. */
#ifndef TOSUI_CT2MODEL_SCANNER_NARROW_THROATS_H
#define TOSUI_CT2MODEL_SCANNER_NARROW_THROATS_H

#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/scanner.h"

struct narrow_throats {
  double pore_width;     /* m: mean, 4 V / S, of the pore volume V and the surface S */
  double grain_diameter; /* m: Sauter mean, 6 V / S, of the grain volume V */
};

/* Measures the sample of a restored scan, which is grain where its level is above `threshold`. NAN
 * where there is no surface. */
struct narrow_throats narrow_throats_measure(const struct restore *restore, double threshold);
/* By how much the grey of pore is too bright, as a fraction of the contrast; 0 where nothing shows
 * that it is. `threshold` is the level of 255 that encloses the measured void ratio. */
double narrow_throats_pore_excess(const struct narrow_throats *throats,
                                  const struct scanner *scanner, double threshold);
/* Weight from 0 to 1 with which voxels are to be either grain or pore (deblur.h). */
double narrow_throats_two_phases(const struct narrow_throats *throats,
                                 const struct scanner *scanner);
#endif
