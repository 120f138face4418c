/* Area of a surface from the changes of phase between neighbouring voxels. Lines along an axis d,
 * one for each face of a voxel, cross a surface of area A and unit normal n |n_d| A times over that
 * face's area: the crossings along all three add up to (|n_x| + |n_y| + |n_z|) A. So each counts
 * 1 / (|n_x| + |n_y| + |n_z|), with n from the greys beside it: exact for planes in any direction.
 * Over directions that are all alike the mean is 2/3 (Crofton). */
#ifndef TOSUI_CT2MODEL_SURFACE_CROSSING_H
#define TOSUI_CT2MODEL_SURFACE_CROSSING_H

#include <math.h>
#include <stdint.h>

/* Sums of weights are integers of this unit, so that they are the same in any order. */
#define CROSSING_UNIT 16777216.0

/* `gradient`: of the field, in x, y, z, of any scale. */
static inline uint64_t crossing_weight(const double gradient[3]) {
  const double sum = fabs(gradient[0]) + fabs(gradient[1]) + fabs(gradient[2]);
  const double length =
      sqrt(gradient[0] * gradient[0] + gradient[1] * gradient[1] + gradient[2] * gradient[2]);
  return (uint64_t)(CROSSING_UNIT * (sum > 0 ? length / sum : 2.0 / 3.0) + 0.5);
}

#endif
