/* Volume fraction of a box on one side of a plane (Scardovelli, Zaleski 2000). */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_PLANE_CUT_H
#define TOSUI_SPHSOLVE_GEOMETRY_PLANE_CUT_H

#include <math.h>

/* Volume fraction of a unit box below the plane m.x = level; the components of m are positive and
 * add up to 1. */
static inline double plane_box_below(const double m[3], double level) {
  double sum = 0;
  if (level <= 0) return 0;
  if (level >= 1) return 1;
  for (int c = 0; c < 8; c++) {
    double rest = level;
    int corners = 0;
    for (int a = 0; a < 3; a++)
      if (c >> a & 1) rest -= m[a], corners++;
    if (rest > 0) sum += (corners % 2 ? -1 : 1) * rest * rest * rest;
  }
  return fmin(fmax(sum / (6 * m[0] * m[1] * m[2]), 0), 1);
}

#endif
