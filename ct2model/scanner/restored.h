/* The scan without its blur and noise, from which the model is made: levels of the share of grain,
 * and the level at which the surface lies. */
#ifndef TOSUI_CT2MODEL_SCANNER_RESTORED_H
#define TOSUI_CT2MODEL_SCANNER_RESTORED_H

#include <stdbool.h>

#include "ct2model/resample/resample.h"
#include "ct2model/scan/enclosed.h"
#include "ct2model/scanner/restore.h"
#include "ct2model/scanner/scanner.h"
#include "ct2model/surface/coarse.h"

struct restored {
  struct coarse scan; /* without levels the scan is used as it is */
  double threshold;   /* level at which the walls enclose the void ratio */
  double middle;      /* void ratio at the middle level, where the scan's own edges lie */
  double void_ratio;  /* void ratio enclosed at `threshold` */
  /* What the scan itself says, whatever was measured: the void ratio at
   * LEVEL_EXPECTED with the greys of its edges, and its 95 % half width; NAN: nothing. */
  double scan_void_ratio, scan_void_ratio_error;
  double two_phases; /* weight with which grain and pore were told to be two phases (deblur.h) */
};

/* Removes the blur from the region and finds the level that encloses `void_ratio`. `restored` has
 * no levels, and a warning is given, where the edges of the scan do not allow that void ratio.
 * `sides`: as in enclosed.h. Free with restored_end. */
enum status restored_make(const struct region *region, const struct scanner *scanner,
                          double void_ratio, const struct enclosed_sides *sides,
                          struct restored *restored);
void restored_end(struct restored *restored);
/* The restored scan as a region of levels. */
struct region restored_region(const struct restored *restored, const struct region *region);
/* Resamples the levels into volume[size z][size y][size x], by a filter that reads rows. */
enum status restored_resample(const struct restored *restored, enum filter filter,
                              const size_t size[3], float *volume);

/* What the restoration of a scan needs where grains and throats are only a few blurs wide: pores do
 * not show the grey of pore, and throats close unless grain and pore are told to be two phases. */
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
