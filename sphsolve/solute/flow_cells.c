/* Open parts of cells and faces. The wall is taken as a plane normal to the gradient of the
 * distance, at the mean distance over the cell or face: d + h^2/24 times its second derivatives,
 * which corrects for curved walls (without this term, spheres with a radius of 5 spacings are 1 %
 * too large). */
#include "sphsolve/solute/flow_cells.h"

#include <math.h>

#include "sphsolve/geometry/plane_cut.h"
#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow.h"

/* Sum over the corners of a square that gives the integral of the Heaviside function of x (power 2:
 * the area) or of max(0, x) (power 3: the distance) for a linear x. */
static double corner_sum(double highest, double m0, double m1, int power) {
  const double at[4] = {highest, highest - m0, highest - m1, highest - m0 - m1};
  double sum = 0;
  for (int c = 0; c < 4; c++)
    if (at[c] > 0) sum += (c == 1 || c == 2 ? -1 : 1) * (power == 2 ? 1 : at[c]) * at[c] * at[c];
  return sum / ((power == 2 ? 2 : 6) * m0 * m1);
}

void solute_face_open(double d, double m0, double m1, double *area, double *moment) {
  const double unit = fmax(fmax(fabs(d), fabs(m0)), fabs(m1));
  m0 = fmax(fabs(m0), NORMAL_MIN * unit), m1 = fmax(fabs(m1), NORMAL_MIN * unit);
  const double reach = 0.5 * (m0 + m1);
  *area = d >= reach ? 1 : d <= -reach ? 0 : 0.5;
  *moment = d >= reach ? d : 0;
  if (fabs(d) >= reach) return;
  *area = fmin(fmax(corner_sum(d + reach, m0, m1, 2), 0), 1);
  *moment = fmax(corner_sum(d + reach, m0, m1, 3), 0);
}

/* Gradient of the distance at a cell's centre (dimensionless). */
static void gradient(const struct solute_flow *f, const int x[3], double g[3]) {
  for (int a = 0; a < 3; a++) {
    int up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
    up[a]++, down[a]--;
    g[a] = ((double)f->distance[solute_flow_at(f, up[0], up[1], up[2])] -
            (double)f->distance[solute_flow_at(f, down[0], down[1], down[2])]) /
           (2 * f->spacing[a]);
  }
}

/* Normalises to length 1. Where two walls meet the gradient may be much shorter; it is then left as
 * the mean of both. */
static void normalise(double g[3]) {
  const double length = sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  for (int a = 0; a < 3 && length > 0.5; a++) g[a] /= length;
}

/* Second difference of the distance along an axis, m, limited: that on a ridge between two equally
 * near walls is not a curvature. */
static double second_difference(const struct solute_flow *f, const int x[3], int axis) {
  int up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
  up[axis]++, down[axis]--;
  const double second = (double)f->distance[solute_flow_at(f, up[0], up[1], up[2])] +
                        (double)f->distance[solute_flow_at(f, down[0], down[1], down[2])] -
                        2 * (double)f->distance[solute_flow_at(f, x[0], x[1], x[2])];
  const double most = SECOND_DIFFERENCE_MAX * f->spacing[axis];
  return fmin(fmax(second, -most), most);
}

static float cell_open(const struct solute_flow *f, const int x[3]) {
  double g[3], m[3], sum = 0;
  double d = (double)f->distance[solute_flow_at(f, x[0], x[1], x[2])];
  for (int a = 0; a < 3; a++) d += second_difference(f, x, a) / 24;
  gradient(f, x, g);
  normalise(g);
  double least = 0;
  for (int a = 0; a < 3; a++) least = fmax(least, NORMAL_MIN * f->spacing[a]);
  for (int a = 0; a < 3; a++) {
    m[a] = fmax(fabs(g[a]) * f->spacing[a], least);
    sum += m[a];
  }
  for (int a = 0; a < 3; a++) m[a] /= sum;
  return (float)plane_box_below(m, 0.5 + d / sum);
}

/* Interpolates the distance half-way between two centres, to third order where it is smooth. */
static double interpolate_midway(const float d[4]) {
  const double mean = 0.5 * ((double)d[1] + (double)d[2]);
  const double low = (double)d[0] - 2 * (double)d[1] + (double)d[2];
  const double high = (double)d[1] - 2 * (double)d[2] + (double)d[3];
  if (low * high <= 0) return mean;
  return mean - (fabs(low) < fabs(high) ? low : high) / 8;
}

static float face_open(const struct solute_flow *f, const int x[3], int axis) {
  float d[4];
  double g[3], other[3], area, moment;
  for (int step = -2; step < 2; step++) {
    int at[3] = {x[0], x[1], x[2]};
    for (int s = step; s < 0; s++) at[axis] = (at[axis] + f->n[axis] - 1) % f->n[axis];
    for (int s = 0; s < step; s++) at[axis] = (at[axis] + 1) % f->n[axis];
    d[step + 2] = f->distance[solute_flow_at(f, at[0], at[1], at[2])];
  }
  int low[3] = {x[0], x[1], x[2]};
  low[axis] = (low[axis] + f->n[axis] - 1) % f->n[axis];
  gradient(f, x, g);
  gradient(f, low, other);
  for (int a = 0; a < 3; a++) g[a] = 0.5 * (g[a] + other[a]);
  g[axis] = ((double)d[2] - (double)d[1]) / f->spacing[axis];
  normalise(g);
  const int p = (axis + 1) % 3, q = (axis + 2) % 3;
  const double mean =
      interpolate_midway(d) + (second_difference(f, x, p) + second_difference(f, low, p) +
                               second_difference(f, x, q) + second_difference(f, low, q)) /
                                  48;
  solute_face_open(mean, g[p] * f->spacing[p], g[q] * f->spacing[q], &area, &moment);
  return area < 1e-4 ? 0 : (float)area;
}

void solute_flow_cut(struct solute_flow *f) {
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const int x[3] = {i, j, k};
        const size_t at = solute_flow_at(f, i, j, k);
        f->volume[at] = cell_open(f, x);
        for (int a = 0; a < 3; a++) f->aperture[a][at] = face_open(f, x, a);
      }
}
