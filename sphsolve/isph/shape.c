#include "sphsolve/isph/shape.h"

#include <math.h>
#include <string.h>

#define ITERATIONS_MAX 30
#define TOLERANCE 1e-5 /* error of the moment, which is of the order of 1 */
/* Bound on a Newton step, the sum of the absolute changes of S's components. */
#define STEP_MAX 2.0
/* Weight of |S - start|^2 / 2 in the minimised function: it keeps S finite where no positive
 * weights have that moment, and otherwise changes the moment by .001. */
#define RIDGE 1e-3

void isph_directions_add(struct isph_directions *around, const double r[3], double weight,
                         double moment[6]) {
  const double square = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], length = sqrt(square);
  for (int a = 0, k = 0; a < 3; a++)
    for (int b = a; b < 3; b++, k++) moment[k] += weight * r[a] * r[b];
  if (!(square > 0) || around->count == ISPH_DIRECTIONS) return;
  around->weight[around->count] = weight * square;
  for (int a = 0; a < 3; a++) around->n[around->count][a] = r[a] / length;
  around->count++;
}

/* Components of S in use: xx, xz, zz in 2-D, otherwise all. */
static const int used[2][6] = {{0, 2, 5}, {0, 1, 2, 3, 4, 5}};
static const int first[6] = {0, 0, 0, 1, 1, 2}, second[6] = {0, 1, 2, 1, 2, 2};

/* Solves m x = x in place for a positive definite m (Cholesky); m is overwritten. */
static void solve(int size, double m[6][6], double x[6]) {
  for (int j = 0; j < size; j++) {
    for (int k = 0; k < j; k++) m[j][j] -= m[j][k] * m[j][k];
    m[j][j] = sqrt(fmax(m[j][j], 1e-30));
    for (int i = j + 1; i < size; i++) {
      for (int k = 0; k < j; k++) m[i][j] -= m[i][k] * m[j][k];
      m[i][j] /= m[j][j];
    }
  }
  for (int i = 0; i < size; i++) {
    for (int k = 0; k < i; k++) x[i] -= m[i][k] * x[k];
    x[i] /= m[i][i];
  }
  for (int i = size; i-- > 0;) {
    for (int k = i + 1; k < size; k++) x[i] -= m[k][i] * x[k];
    x[i] /= m[i][i];
  }
}

/* Newton's method for the minimum of
 *   sum weight exp(n.S.n) - S:target + RIDGE |S - start|^2 / 2. */
static void minimise(int dimensions, const struct isph_directions *around, const double target[6],
                     const double start[6], double shape[6]) {
  const int size = dimensions == 3 ? 6 : 3, *at = used[dimensions - 2];
  memcpy(shape, start, 6 * sizeof *shape);
  for (int round = 0; round < ITERATIONS_MAX; round++) {
    double step[6], slope[6], curve[6][6], off = 0, longest = 0;
    for (int k = 0; k < size; k++) {
      const double twice = first[at[k]] == second[at[k]] ? 1 : 2;
      slope[k] = twice * (RIDGE * (shape[at[k]] - start[at[k]]) - target[at[k]]);
      for (int l = 0; l < size; l++) curve[k][l] = k == l ? twice * RIDGE : 0;
    }
    for (size_t m = 0; m < around->count; m++) {
      const double *n = around->n[m];
      double part[6], level = 0;
      for (int k = 0; k < size; k++) {
        const int a = first[at[k]], b = second[at[k]];
        part[k] = (a == b ? 1 : 2) * n[a] * n[b];
        level += shape[at[k]] * part[k];
      }
      const double weight = around->weight[m] * exp(level);
      for (int k = 0; k < size; k++) {
        slope[k] += weight * part[k];
        for (int l = 0; l <= k; l++) curve[k][l] += weight * part[k] * part[l];
      }
    }
    for (int k = 0; k < size; k++) {
      off = fmax(off, fabs(slope[k]));
      step[k] = -slope[k];
    }
    if (!(off > TOLERANCE)) return;
    solve(size, curve, step);
    for (int k = 0; k < size; k++) longest += fabs(step[k]);
    const double scale = longest > STEP_MAX ? STEP_MAX / longest : 1;
    for (int k = 0; k < size; k++) shape[at[k]] += scale * step[k];
  }
}

void isph_shape_find(int dimensions, const struct isph_directions *around, const double target[6],
                     const double start[6], float shape[6]) {
  double found[6];
  minimise(dimensions, around, target, start, found);
  for (int k = 0; k < 6; k++) shape[k] = (float)found[k];
}

/* Directions: equal angles in 2-D; in 3-D a spiral on the sphere with the golden angle between
 * successive points. */
void isph_shape_even(int dimensions, const double target[6], double shape[6]) {
  static const double start[6] = {0};
  struct isph_directions around = {.count = ISPH_DIRECTIONS};
  for (size_t m = 0; m < ISPH_DIRECTIONS; m++) {
    const double part = ((double)m + 0.5) / ISPH_DIRECTIONS;
    const double angle = dimensions == 3 ? M_PI * (3 - sqrt(5)) * (double)m : 2 * M_PI * part;
    const double y = dimensions == 3 ? 2 * part - 1 : 0, flat = sqrt(1 - y * y);
    around.n[m][0] = flat * cos(angle), around.n[m][1] = y, around.n[m][2] = flat * sin(angle);
    around.weight[m] = dimensions / (double)ISPH_DIRECTIONS;
  }
  minimise(dimensions, &around, target, start, shape);
}
