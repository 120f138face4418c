#include "sphsolve/solute/walk_slope.h"

#include <math.h>
#include <stdbool.h>

#include "sphsolve/solute/constants.h"
#include "sphsolve/solute/flow.h"
#include "sphsolve/solute/flow_cells.h"

/* Wall distance, m, at the middle of the face of axis `axis` that lies `by` cells from that of cell
 * x along `across`. */
static double distance_at(const struct solute_flow *f, const int x[3], int axis, int across,
                          int by) {
  int high[3] = {x[0], x[1], x[2]}, low[3];
  high[across] += by;
  for (int a = 0; a < 3; a++) low[a] = high[a];
  low[axis]--;
  return 0.5 * ((double)f->distance[solute_flow_at(f, high[0], high[1], high[2])] +
                (double)f->distance[solute_flow_at(f, low[0], low[1], low[2])]);
}

static size_t beside(const struct solute_flow *f, const int x[3], int across, int by) {
  int y[3] = {x[0], x[1], x[2]};
  y[across] += by;
  return solute_flow_at(f, y[0], y[1], y[2]);
}

/* Distance from the middle of the open face to a wall on the side `by`, cells; INFINITY: none
 * nearby. */
static double wall_at(const struct solute_flow *f, const int x[3], int axis, int across, int by) {
  if (f->aperture[axis][beside(f, x, across, by)] >= 1) return INFINITY;
  const double here = distance_at(f, x, axis, across, 0),
               there = distance_at(f, x, axis, across, by);
  const double wall = here > there ? here / (here - there) : INFINITY;
  return wall <= SLOPE_DISTANCE_MAX ? fmax(wall, 0.5) : INFINITY;
}

/* Slope of an uncut face: that in its middle of the parabola that has the mean of this face and, on
 * each side, the mean of the next face or, if a wall lies between, the value 0 at the wall. */
static double open_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const float *q = f->velocity[axis];
  const double here = (double)q[beside(f, x, across, 0)], low = (double)q[beside(f, x, across, -1)],
               high = (double)q[beside(f, x, across, 1)];
  const double to_low = wall_at(f, x, axis, across, -1), to_high = wall_at(f, x, axis, across, 1);
  if (isinf(to_low) && isinf(to_high)) return 0.5 * (high - low);
  if (!isinf(to_low) && !isinf(to_high)) /* c (to_low + t) (to_high - t) */
    return here * (to_high - to_low) / (to_low * to_high - 1.0 / 12);
  const double w = fmin(to_low, to_high), square = w * w - 1.0 / 12;
  const double slope =
      (here * (1 - square) + (isinf(to_low) ? low : high) * square) / (w * (w + 1) - 1.0 / 12);
  return isinf(to_low) ? -slope : slope;
}

/* Slope of a face cut by the wall. The flux is linear over the whole face, with the given mean, and
 * along the normal of the wall so steep that the part in grain passes no net flux and the open part
 * all of it. The flux is 0 at the centroid of the part in grain, which lies beyond the wall; near
 * the wall walkers therefore have a little too much velocity, and too little in the middle. */
static double cut_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const size_t at = solute_flow_at(f, x[0], x[1], x[2]);
  const double q = (double)f->velocity[axis][at], d = distance_at(f, x, axis, across, 0);
  double m[2], area, moment;
  for (int t = 0; t < 2; t++) {
    const int along = (axis + 1 + t) % 3;
    m[t] = 0.5 * (distance_at(f, x, axis, along, 1) - distance_at(f, x, axis, along, -1));
  }
  const double own = m[(across - axis + 3) % 3 - 1], rise = fabs(m[0]) + fabs(m[1]);
  if (rise < RISE_MIN * f->spacing[across]) return 0;
  solute_face_open(d, m[0], m[1], &area, &moment);
  if (area > FRACTION_MIN && area < 1 - FRACTION_MIN && moment > area * d)
    return own * q * (1 - area) / (moment - area * d);
  return own * 2 * q / (rise * fmax((double)f->aperture[axis][at], FRACTION_MIN));
}

float walk_slope(const struct solute_flow *f, const int x[3], int axis, int across) {
  const size_t at = solute_flow_at(f, x[0], x[1], x[2]);
  const float open = f->aperture[axis][at];
  if (!(open > 0)) return 0;
  if (open < 1) return (float)cut_slope(f, x, axis, across);
  const float slope = (float)open_slope(f, x, axis, across);
  if (f->aperture[axis][beside(f, x, across, -1)] >= 1 &&
      f->aperture[axis][beside(f, x, across, 1)] >= 1)
    return slope;
  /* Limited such that the flux is at least 0 at the edges: there is no backflow at walls. */
  const float most = 2 * fabsf(f->velocity[axis][at]);
  return fminf(fmaxf(slope, -most), most);
}
