/* The cost of the grains' surface: the sum of |grad u| over voxels (total variation, Rudin, Osher
 * and Fatemi 1992), for each grain by itself.
 *
 * With a single total variation of all grains a contact would cost nothing, and the wedge beside it
 * would be filled as by a liquid that wets both grains (Young's law: cos(angle / 2) is the cost of
 * the contact over that of two walls). If a contact costs as much as the two walls that it
 * replaces, the angle is 0, and wedges stay as the scan shows them. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_SURFACE_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_SURFACE_H

#include <stddef.h>
#include <stdint.h>

struct grain_surface {
  size_t size[3];
  double stretch[3];       /* voxel edges over the shortest one */
  double cost;             /* of a unit of surface area, in voxels */
  const uint8_t *contacts; /* [z][y][x], from grains_find */
};

/* Lipschitz constant of the gradient of the cost: an upper bound of its change over the change of
 * u. */
double grain_surface_stiffness(const struct grain_surface *surface);
/* downhill -= the derivative of the cost with respect to share[z][y][x]; `work` is as large. */
void grain_surface_pull(const struct grain_surface *surface, const float *share, float *work,
                        float *downhill);

#endif
