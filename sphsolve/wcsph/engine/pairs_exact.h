/* Rows of a flow without walls, with gradients that are exact for linear fields for any particle
 * distribution: B sum V (f_j - f_i) grad W with B the inverse of sum V r grad W (Randles, Libersky
 * 1996), and the viscous sum divided by the mean of this moment. Without this correction the errors
 * of disordered particles generate eddies in a flow at Re 1000 and drain its energy. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_EXACT_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_EXACT_H

#include "sphsolve/geometry/moment.h"
#include "sphsolve/wcsph/effects/density_continuity.h"
#include "sphsolve/wcsph/effects/pressure_difference.h"
#include "sphsolve/wcsph/effects/pressure_diffusion.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/effects/viscosity_morris.h"
#include "sphsolve/wcsph/engine/pairs_gather.h"

/* xx yy zz xy xz yz */
SIMD_INLINE void moment_pair(vec slope, const struct geometry *g, vec sum[6]) {
  vec sx = slope * g->x, sy = slope * g->y, sz = slope * g->z;
  sum[0] += sx * g->x;
  sum[1] += sy * g->y;
  sum[2] += sz * g->z;
  sum[3] += sx * g->y;
  sum[4] += sx * g->z;
  sum[5] += sy * g->z;
}

/* tensor[3 a + b] += slope x_a dv_b */
SIMD_INLINE void tensor_pair(vec slope, const struct geometry *g, const vec dv[3], vec sum[9]) {
  vec along[3] = {slope * g->x, slope * g->y, slope * g->z};
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) sum[3 * a + b] += along[a] * dv[b];
}

/* Computes B from sums in units of 2 h; returns the divisor of the viscous sum. */
static double invert_sums(const struct pass *pass, const double s[6], double correction[3][3]) {
  const double scale = pass->g_scale * 2 * pass->smoothing_length;
  const bool flat = pass->particles->frame.step[1] == 0;
  double m[3][3] = {{scale * s[0], scale * s[3], scale * s[4]},
                    {scale * s[3], flat ? 1 : scale * s[1], scale * s[5]},
                    {scale * s[4], scale * s[5], scale * s[2]}};
  const double mean = flat ? (m[0][0] + m[2][2]) / 2 : (m[0][0] + m[1][1] + m[2][2]) / 3;
  moment_invert(m, correction);
  return fmax(mean, MOMENT_FLOOR);
}

static void times(double m[3][3], double v[3]) {
  const double x = v[0], y = v[1], z = v[2];
  for (int a = 0; a < 3; a++) v[a] = m[a][0] * x + m[a][1] * y + m[a][2] * z;
}

/* As row_force_fluid, for fluid without walls. */
SIMD_INLINE void row_force_exact(const struct pass *pass, const struct local *local, size_t n,
                                 const vec at[3], size_t i, const float carry[3], bool viscous,
                                 bool shift, struct row_force *row) {
  const struct particles *p = pass->particles;
  float tile[24][SIMD_LANES];
  vec vi[3], state = vec_set(p->state[i]);
  for (int a = 0; a < 3; a++) vi[a] = vec_set(p->v[a][i]);
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum[24] = {{0}};
    for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse;
      vec weight = pressure_difference_pair(state, vec_load(local->field[LSTATE] + k), slope);
      vec dv[3] = {vec_load(local->field[LVX] + k) - vi[0], vec_load(local->field[LVY] + k) - vi[1],
                   vec_load(local->field[LVZ] + k) - vi[2]};
      sum[0] -= weight * g.x;
      sum[1] -= weight * g.y;
      sum[2] -= weight * g.z;
      moment_pair(slope, &g, sum + 3);
      if (viscous) viscosity_morris_pair(slope, dv[0], dv[1], dv[2], sum + 9);
      if (!shift) continue;
      shifting_pair(slope, g.x, g.y, g.z, sum + 12);
      tensor_pair(slope, &g, dv, sum + 15);
    }
    for (int s = 0; s < 24; s++) vec_store(tile[s] + group * SIMD_WIDTH, sum[s]);
  }
  double s[24], correction[3][3];
  lanes_sums(tile, 24, s);
  const double mean = invert_sums(pass, s + 3, correction);
  double u[3] = {(double)carry[0], (double)carry[1], (double)carry[2]};
  times(correction, s);
  times(correction, u);
  for (int a = 0; a < 3; a++) {
    row->pressure[a] = s[a];
    row->velocity[a] = s[9 + a] / mean;
    for (int b = 0; b < 3; b++) row->velocity[a] += u[b] * s[15 + 3 * b + a];
    row->concentration[a] = s[12 + a];
  }
}

/* As continuity_rows, for fluid without walls: the rate in units of g_scale, and the sum of
 * weights. `share`: factor of the pressure differences. */
SIMD_INLINE void row_continuity_exact(const struct pass *pass, const struct local *local, size_t n,
                                      const vec at[3], size_t i, double share, bool shift,
                                      double sum[2]) {
  const struct particles *p = pass->particles;
  float tile[20][SIMD_LANES];
  vec vi[3], state = vec_set(p->state[i]);
  for (int a = 0; a < 3; a++) vi[a] = vec_set(p->v[a][i]);
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec s[20] = {{0}};
    for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse;
      vec dv[3] = {vec_load(local->field[LVX] + k) - vi[0], vec_load(local->field[LVY] + k) - vi[1],
                   vec_load(local->field[LVZ] + k) - vi[2]};
      vec change = slope * (vec_load(local->field[LSTATE] + k) - state);
      tensor_pair(slope, &g, dv, s);
      moment_pair(slope, &g, s + 9);
      s[15] += change;
      pressure_diffusion_pair(slope, &s[16]);
      if (shift) shifting_pair(change, g.x, g.y, g.z, s + 17);
    }
    for (int a = 0; a < 20; a++) vec_store(tile[a] + group * SIMD_WIDTH, s[a]);
  }
  double t[20], correction[3][3], u[3] = {0};
  lanes_sums(tile, 20, t);
  invert_sums(pass, t + 9, correction);
  for (int a = 0; a < 3 && shift; a++) u[a] = (double)p->shift[a][i];
  times(correction, u);
  sum[0] = share * t[15];
  sum[1] = t[16];
  for (int a = 0; a < 3; a++) {
    for (int b = 0; b < 3; b++) sum[0] -= correction[a][b] * t[3 * a + b];
    sum[0] += u[a] * t[17 + a];
  }
}

#endif
