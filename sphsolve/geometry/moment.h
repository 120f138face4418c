/* First moment m = sum over the neighbours of g r of a gradient sum g (f_b - f_a), and its inverse.
 * Multiplied by the inverse, the gradient is exact for linear fields where sites are missing
 * (Bonet, Lok 1999). */
#ifndef TOSUI_SPHSOLVE_GEOMETRY_MOMENT_H
#define TOSUI_SPHSOLVE_GEOMETRY_MOMENT_H

#include <math.h>
#include <string.h>

/* Lower bound of the eigenvalues, for directions with hardly any neighbours. */
#define MOMENT_FLOOR 0.1

/* Along the wall normal n the missing sites mirror the inner ones (equal pressure, opposite
 * velocity) and need no correction: m = (1 - n n) m (1 - n n) + n n. */
static inline void moment_free_normal(int axes, const double n[3], double m[3][3]) {
  double along[3] = {0.0}, twice = 0.0;
  if (n[0] == 0.0 && n[1] == 0.0 && n[2] == 0.0) return;
  for (int a = 0; a < axes; a++)
    for (int c = 0; c < axes; c++) along[a] += m[a][c] * n[c];
  for (int a = 0; a < axes; a++) twice += n[a] * along[a];
  for (int a = 0; a < axes; a++)
    for (int c = 0; c < axes; c++)
      m[a][c] += (twice + 1.0) * n[a] * n[c] - n[a] * along[c] - along[a] * n[c];
}

/* Inverse of a symmetric matrix whose eigenvalues are bounded below by MOMENT_FLOOR, by Jacobi
 * rotations; m is overwritten. */
static inline void moment_invert_bounded(int n, double m[3][3], double inverse[3][3]) {
  double v[3][3];
  memset(v, 0, sizeof v);
  for (int a = 0; a < 3; a++) v[a][a] = 1;
  for (int sweep = 0; sweep < 8; sweep++)
    for (int p = 0; p < n; p++)
      for (int q = p + 1; q < n; q++) {
        if (fabs(m[p][q]) < 1e-12) continue;
        const double theta = 0.5 * (m[q][q] - m[p][p]) / m[p][q];
        const double t = copysign(1.0, theta) / (fabs(theta) + sqrt(theta * theta + 1.0));
        const double c = 1.0 / sqrt(t * t + 1.0), s = t * c;
        for (int k = 0; k < n; k++) {
          const double kp = m[k][p], kq = m[k][q];
          m[k][p] = c * kp - s * kq, m[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < n; k++) {
          const double pk = m[p][k], qk = m[q][k], vp = v[k][p], vq = v[k][q];
          m[p][k] = c * pk - s * qk, m[q][k] = s * pk + c * qk;
          v[k][p] = c * vp - s * vq, v[k][q] = s * vp + c * vq;
        }
      }
  for (int a = 0; a < n; a++)
    for (int b = 0; b < n; b++) {
      inverse[a][b] = 0.0;
      for (int k = 0; k < n; k++) inverse[a][b] += v[a][k] * v[b][k] / fmax(m[k][k], MOMENT_FLOOR);
    }
}

/* The same for 3 x 3 matrices, by the adjugate if no eigenvalue can be below the floor: the
 * smallest one is above det/(trace/2)^2. */
static inline void moment_invert(double m[3][3], double inverse[3][3]) {
  const double xx = m[1][1] * m[2][2] - m[1][2] * m[1][2],
               yy = m[0][0] * m[2][2] - m[0][2] * m[0][2],
               zz = m[0][0] * m[1][1] - m[0][1] * m[0][1];
  const double xy = m[0][2] * m[1][2] - m[0][1] * m[2][2],
               xz = m[0][1] * m[1][2] - m[0][2] * m[1][1],
               yz = m[0][1] * m[0][2] - m[0][0] * m[1][2];
  const double det = m[0][0] * xx + m[0][1] * xy + m[0][2] * xz;
  const double trace = m[0][0] + m[1][1] + m[2][2];
  if (!(trace > 0.0 && xx + yy + zz > 0.0 && 4.0 * det > MOMENT_FLOOR * trace * trace)) {
    moment_invert_bounded(3, m, inverse);
    return;
  }
  inverse[0][0] = xx / det, inverse[1][1] = yy / det, inverse[2][2] = zz / det;
  inverse[0][1] = inverse[1][0] = xy / det;
  inverse[0][2] = inverse[2][0] = xz / det;
  inverse[1][2] = inverse[2][1] = yz / det;
}

#endif
