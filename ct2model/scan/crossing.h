/* Area of a surface from the changes of phase between neighbouring voxels. Lines along an axis d,
 * one for each face of a voxel, cross a surface of area A and unit normal n |n_d| A times over that
 * face's area. So each crossing counts |n_d|, with n from the greys beside it, and the three axes
 * add up to (n_x^2 + n_y^2 + n_z^2) A = A, for planes in any direction; normals that are off by an
 * angle b leave cos b of it. */
#ifndef TOSUI_CT2MODEL_SCAN_CROSSING_H
#define TOSUI_CT2MODEL_SCAN_CROSSING_H

#include <math.h>
#include <stdint.h>

/* Sums of weights are integers of this unit, so that they are the same in any order. */
#define CROSSING_UNIT 16777216.0

/* `gradient`: of the field, in x, y, z, of any scale. Where it is 0 a direction's mean over all,
 * 2/3 (Crofton). */
static inline uint64_t crossing_weight(const double gradient[3], int axis) {
  const double length =
      sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  return (uint64_t)(CROSSING_UNIT * (length > 0 ? fabs(gradient[axis]) / length : 2.0 / 3.0) + 0.5);
}

#endif
