/* Volume fluxes through faces from the velocities of sites. Between two sites in the fluid the
 * velocity of a face is their mean. Near the wall the velocity decreases to 0 with the wall
 * distance d: there u / d varies slowly, and the flux is u / d times the integral of the distance
 * over the open part of the face. */
#include "sphsolve/solute/flow_faces.h"

#include <math.h>

#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/flow_cells.h"

/* Mean of u / d, 1/s, over the two sites at the face; if both are too near the wall, over those
 * around. */
static double slope(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  const double near = FACE_DISTANCE_MIN * f->spacing[axis];
  for (int ring = 0; ring < 2; ring++) {
    double sum = 0, weights = 0;
    for (int s = 0; s < (ring ? 18 : 2); s++) {
      int at[3] = {x[0], x[1], x[2]};
      at[axis] -= s % 2;
      at[(axis + 1) % 3] += ring ? s / 2 % 3 - 1 : 0;
      at[(axis + 2) % 3] += ring ? s / 6 - 1 : 0;
      const size_t site = solute_flow_at(f, at[0], at[1], at[2]);
      const double d = (double)f->distance[site];
      if (!(d > near)) continue;
      sum += (double)sites[3 * site + (size_t)axis];
      weights += d;
    }
    if (weights > 0) return sum / weights;
  }
  return 0;
}

/* Velocity of a site along the axis, averaged over the cross-section of its cell: the site value
 * plus h^2/24 times the second derivatives across the axis (without this term the mean of a
 * parabola over N sites has an error of 1/(2 N^2)). If a site beside it is in grain, the parabola
 * is 0 at the wall between the two. */
static double site_mean(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  const size_t a = (size_t)axis, at = solute_flow_at(f, x[0], x[1], x[2]);
  const double u = (double)sites[3 * at + a], d = (double)f->distance[at];
  double mean = u;
  for (int t = 1; t < 3; t++) {
    double change[2], apart[2]; /* of velocity, and distance in spacings, to the sites beside it */
    for (int side = 0; side < 2; side++) {
      int y[3] = {x[0], x[1], x[2]};
      y[(axis + t) % 3] += side ? 1 : -1;
      const size_t there = solute_flow_at(f, y[0], y[1], y[2]);
      const double other = (double)f->distance[there];
      apart[side] = other > 0 ? 1 : fmax(d / (d - other), FACE_DISTANCE_MIN);
      change[side] = (other > 0 ? (double)sites[3 * there + a] : 0) - u;
    }
    mean += 2 * (change[0] / apart[0] + change[1] / apart[1]) / (apart[0] + apart[1]) / 24;
  }
  return mean;
}

static double face_flux(const struct solute_flow *f, const float *sites, const int x[3], int axis) {
  int low[3] = {x[0], x[1], x[2]};
  low[axis]--;
  const size_t here = solute_flow_at(f, x[0], x[1], x[2]),
               there = solute_flow_at(f, low[0], low[1], low[2]);
  const double open = (double)f->aperture[axis][here];
  const double d = 0.5 * ((double)f->distance[here] + (double)f->distance[there]);
  if (!(open > 0)) return 0;
  if (open >= 1 && f->distance[here] > 0 && f->distance[there] > 0)
    return 0.5 * (site_mean(f, sites, x, axis) + site_mean(f, sites, low, axis));
  double m[2], area, moment;
  for (int t = 0; t < 2; t++) {
    const int across = (axis + 1 + t) % 3;
    double sum = 0;
    for (int side = 0; side < 2; side++) {
      int up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
      up[axis] -= side, down[axis] -= side;
      up[across]++, down[across]--;
      sum += (double)f->distance[solute_flow_at(f, up[0], up[1], up[2])] -
             (double)f->distance[solute_flow_at(f, down[0], down[1], down[2])];
    }
    m[t] = 0.25 * sum;
  }
  solute_face_open(d, m[0], m[1], &area, &moment);
  return slope(f, sites, x, axis) * moment;
}

void solute_flow_fluxes(struct solute_flow *f, const float *sites) {
#pragma omp parallel for schedule(static)
  for (int k = 0; k < f->n[2]; k++)
    for (int j = 0; j < f->n[1]; j++)
      for (int i = 0; i < f->n[0]; i++) {
        const int x[3] = {i, j, k};
        for (int a = 0; a < 3; a++)
          f->velocity[a][solute_flow_at(f, i, j, k)] = (float)face_flux(f, sites, x, a);
      }
}
