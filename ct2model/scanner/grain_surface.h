/* The surface of grains as a cost: the sum of |grad u| over voxels (total variation, Rudin, Osher
 * and Fatemi 1992), each grain's by itself.
 *
 * With one total variation of all grains a contact would cost nothing, and a wedge beside it would
 * be filled as a liquid that wets both grains fills it (Young's law: cos(angle / 2) is the
 * contact's cost over that of two walls). With a contact that costs as much as the two walls that
 * it takes the place of the angle is 0, and wedges stay as the scan shows them. */
#ifndef TOSUI_CT2MODEL_SCANNER_GRAIN_SURFACE_H
#define TOSUI_CT2MODEL_SCANNER_GRAIN_SURFACE_H

#include <stddef.h>
#include <stdint.h>

struct grain_surface {
  size_t size[3];
  double stretch[3];       /* voxel edges over their shortest */
  double cost;             /* of a voxel's area of surface */
  const uint8_t *contacts; /* as grains_find makes them */
};

/* The most that the gradient changes by, over the change of u. */
double grain_surface_stiffness(const struct grain_surface *surface);
/* downhill -= the derivative of the cost of share[z][y][x]; `work` is as large. */
void grain_surface_pull(const struct grain_surface *surface, const float *share, float *work,
                        float *downhill);

#endif
