/* The imaging properties of a scanner: width of its blur, strength of its phase-contrast fringe,
 * standard deviation and correlation length of its noise; and how they are measured on windows of
 * the scan itself. */
#ifndef TOSUI_CT2MODEL_SCANNER_SCANNER_H
#define TOSUI_CT2MODEL_SCANNER_SCANNER_H

#include <stdbool.h>

#include "common/error.h"
#include "ct2model/scan/region.h"
#include "ct2model/scanner/edge_response.h"

struct survey;

struct scanner {
  bool known;              /* false: the image is segmented, or no surface is free of neighbours;
                              all other members are then NAN */
  bool assumed;            /* the blur is assumed; only what deblurring needs is set */
  bool narrow;             /* one phase is nowhere deep: each surface has another one near */
  bool levels;             /* where narrow: pore, grain and fringe are known all the same */
  bool by_void_ratio;      /* a grey follows from the mean grey and the measured void ratio */
  double blur, blur_error; /* m: standard deviation without the voxel's own width, and its standard
                              error */
  double fringe;           /* coefficient of the Laplacian, in units of blur^2 (edge_response.h) */
  double pore, grain;      /* greys of the region, far from surfaces */
  double noise;            /* standard deviation, in greys of the region */
  double contrast_to_noise;
  double noise_correlation; /* m: standard deviation of the Gaussian filter that turns white noise
                               into it */
  double resolution;        /* m: period at which the modulation transfer falls to 0.1 */
  double smooth_walls;      /* 0: relief of sand, 1: none (smooth_walls.h); NAN: not estimated */
  double fine_relief;       /* 0: relief of sand, 1: much finer, as of fines; NAN: not estimated */
  double two_phases;        /* 0: grey throats as restored, 1: grain and pore told to be two phases
                               (restored.h); NAN: not estimated */
  double unit;              /* m: shortest voxel edge, the unit of distance of `response` */
  struct edge_response response; /* summed over all windows; greys 0 in pores, 1 in grains */
};

/* Fills `scanner`; `scanner->known` is false where it cannot be measured. `survey` gives a first
 * estimate of the greys of pore and grain, and their greys by the mean where both phases are
 * narrow. Lengths in m. */
enum status scanner_measure(const struct region *region, const struct survey *survey,
                            struct scanner *scanner);

#endif
