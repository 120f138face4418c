/* Area of a surface from the changes of phase between neighbouring voxels. Lines along an axis d,
 * one through each face of a voxel, cross a surface of area A and unit normal n |n_d| A / (face
 * area) times. So each crossing is weighted by |n_d|, with n from the greys beside it, and the sum
 * over the three axes is (n_x^2 + n_y^2 + n_z^2) A = A for planes in any direction. Normals with an
 * angular error b reduce it by cos b. */
#ifndef TOSUI_CT2MODEL_SCAN_CROSSING_H
#define TOSUI_CT2MODEL_SCAN_CROSSING_H

#include <math.h>
#include <stdint.h>

/* Weights are summed as integers in this unit, so that sums do not depend on the order. */
#define CROSSING_UNIT 16777216.0

/* Weight of a crossing along `axis`, in CROSSING_UNIT. `gradient`: of the grey along x, y, z, in
 * any unit. If it is 0, the mean over all directions is used, 2/3 (Crofton). */
static inline uint64_t crossing_weight(const double gradient[3], int axis) {
  const double length =
      sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  return (uint64_t)(CROSSING_UNIT * (length > 0 ? fabs(gradient[axis]) / length : 2.0 / 3.0) + 0.5);
}

#endif
