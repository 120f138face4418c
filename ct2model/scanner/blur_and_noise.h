/* What the scanner did to the specimen: how wide it blurs a grain's surface, what fringe it leaves
 * there, how strong the noise is and over what length it is correlated. */
#ifndef TOSUI_CT2MODEL_SCANNER_BLUR_AND_NOISE_H
#define TOSUI_CT2MODEL_SCANNER_BLUR_AND_NOISE_H

#include <stdbool.h>

#include "ct2model/scanner/edge_response.h"

struct scanner {
  bool known;              /* false: segmented, or no surface stands alone; all else is then NAN */
  bool assumed;            /* then as much of it as taking a blur out needs, the blur assumed */
  bool narrow;             /* a phase is nowhere deep: each surface has another one near */
  bool levels;             /* then pore, grain and fringe are known all the same */
  double blur, blur_error; /* m: standard deviation, without the voxel's own width; 1 sigma */
  double fringe;           /* strength of the Laplacian, per blur^2 */
  double pore, grain;      /* greys of the region, far from surfaces */
  double noise;            /* standard deviation, greys of the region */
  double contrast_to_noise;
  double noise_correlation; /* m: standard deviation of the Gaussian that correlates white noise */
  double resolution;        /* m: period at which the modulation transfer falls to a tenth */
  double smooth_walls;      /* 0 as of sand to 1, no relief (smooth_walls.h); NAN: not looked for */
  double fine_relief;       /* 0 as of sand to 1, much small relief, as of fines; likewise */
  double unit;              /* m: the smallest side of a voxel, unit of the response's distances */
  struct edge_response response; /* greys 0 pore, 1 grain; over all windows */
};

#endif
