/* Symmetric 3 x 3 tensors, stored as xx xy xz yy yz zz. */
#ifndef TOSUI_SPHSOLVE_ISPH_SYMMETRIC_H
#define TOSUI_SPHSOLVE_ISPH_SYMMETRIC_H

#include <math.h>
#include <stdbool.h>

/* Indices of xx, yy and zz. */
static const int symmetric_diagonal[3] = {0, 3, 5};

/* y = t x; y may be x. */
static inline void symmetric_times(const double t[6], const double x[3], double y[3]) {
  const double a = t[0] * x[0] + t[1] * x[1] + t[2] * x[2],
               b = t[1] * x[0] + t[3] * x[1] + t[4] * x[2],
               c = t[2] * x[0] + t[4] * x[1] + t[5] * x[2];
  y[0] = a, y[1] = b, y[2] = c;
}

/* n.t.n */
static inline double symmetric_along(const double t[6], const double n[3]) {
  return t[0] * n[0] * n[0] + t[3] * n[1] * n[1] + t[5] * n[2] * n[2] +
         2 * (t[1] * n[0] * n[1] + t[2] * n[0] * n[2] + t[4] * n[1] * n[2]);
}

/* The least eigenvalue of t, or a lower bound for it that is at least `enough` (by Gershgorin's
 * circles, which suffice in most neighbourhoods). The roots of the cubic are after Smith (1961,
 * Commun. ACM 4). In 2-D the component yy, out of the plane, is set to the mean of the two others.
 */
static inline double symmetric_least(const double t[6], bool plane, double enough) {
  const double xx = t[0], yy = plane ? 0.5 * (t[0] + t[5]) : t[3], zz = t[5];
  const double xy = fabs(t[1]), xz = fabs(t[2]), yz = fabs(t[4]);
  const double bound = fmin(fmin(xx - xy - xz, yy - xy - yz), zz - xz - yz);
  if (bound >= enough) return bound;
  const double mean = (xx + yy + zz) / 3, a = xx - mean, b = yy - mean, c = zz - mean;
  const double size = sqrt((a * a + b * b + c * c + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
  if (!(size > 0)) return mean;
  const double determinant =
      a * b * c + 2 * t[1] * t[2] * t[4] - a * t[4] * t[4] - b * t[2] * t[2] - c * t[1] * t[1];
  const double angle = acos(fmax(-1, fmin(1, 0.5 * determinant / (size * size * size)))) / 3;
  return mean + 2 * size * cos(angle + 2 * M_PI / 3);
}

#endif
