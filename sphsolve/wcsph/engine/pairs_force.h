/* The forces of a step: v_next from v by the momentum equation of one particle, whose terms the
 * loops compute:
 *
 * v' = (v + dt (F + a_pressure + a_other)) / (1 + dt K)
 *
 * F is gravity, acceleration and mean pressure gradient (body_force); K v' is the
 * friction at sub-voxel walls, taken with the new velocity so that particles close to a wall do not
 * limit the step. Forces of effects with their own file act before (engine_kick.c). */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_FORCE_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_FORCE_H

#include "sphsolve/wcsph/constants.h"
#include "sphsolve/wcsph/effects/pressure_difference.h"
#include "sphsolve/wcsph/effects/pressure_symmetric.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/effects/viscosity_morris.h"
#include "sphsolve/wcsph/effects/wall_subvoxel.h"
#include "sphsolve/wcsph/effects/density_continuity.h"
#include "sphsolve/wcsph/engine/pairs.h"
#include "sphsolve/wcsph/engine/simd.h"
#include "sphsolve/wcsph/engine/pairs_exact.h"

/* F + a_pressure along axis a, m/s^2; the loops add the other terms. */
SIMD_INLINE double momentum_change(const struct pass *pass, int a, double pressed) {
  return pass->force[a] + pressed;
}

/* v'; `stiff`: dt K. */
SIMD_INLINE double momentum_next(const struct pass *pass, double v, double change, double stiff) {
  return (v + pass->dt * change) / (1 + stiff);
}

/* Sums over columns [0, n) that are treated as fluid (including frozen and adami walls). `carry`:
 * the drift of the particle relative to the fluid, used if `carried`, in units in which the weight
 * of viscosity is 1 (with viscosity); `shifted`: also sums the offsets. */
SIMD_INLINE void row_force_fluid(const struct pass *pass, const struct local *local, size_t n,
                                 const vec at[3], size_t i, const float carry[3], bool symmetric,
                                 bool viscous, bool carried, bool shifted, struct row_force *row) {
  const struct particles *p = pass->particles;
  float tile[MAX_SUMS][SIMD_LANES];
  vec vi[3], u[3], state = vec_set(p->state[i]), zero = vec_set(0.0f);
  for (int a = 0; a < 3; a++) {
    vi[a] = vec_set(p->v[a][i]);
    u[a] = vec_set(carry[a]);
  }
  vec term = symmetric ? pressure_symmetric_term(state, vec_set((float)pass->rest_ratio)) : state;
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec pressure[3] = {{0}}, velocity[3] = {{0}}, concentration[3] = {{0}};
    for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse;
      vec weight = symmetric
                       ? pressure_symmetric_pair(term, vec_load(local->field[LTERM] + k), slope)
                       : pressure_difference_pair(term, vec_load(local->field[LSTATE] + k), slope);
      pressure[0] -= weight * g.x;
      pressure[1] -= weight * g.y;
      pressure[2] -= weight * g.z;
      if (viscous || carried) {
        vec share = !viscous    ? zero
                    : symmetric ? vec_load(local->field[LSTATE] + k)
                                : vec_set(1.0f);
        if (carried) share = shifting_carry(share, g.x, g.y, g.z, u);
        viscosity_morris_pair(carried || symmetric ? slope * share : slope,
                              vec_load(local->field[LVX] + k) - vi[0],
                              vec_load(local->field[LVY] + k) - vi[1],
                              vec_load(local->field[LVZ] + k) - vi[2], velocity);
      }
      if (shifted) shifting_pair(slope, g.x, g.y, g.z, concentration);
    }
    for (int a = 0; a < 3; a++) {
      vec_store(tile[a] + group * SIMD_WIDTH, pressure[a]);
      vec_store(tile[3 + a] + group * SIMD_WIDTH, velocity[a]);
      vec_store(tile[6 + a] + group * SIMD_WIDTH, concentration[a]);
    }
  }
  lanes_sums(tile, shifted ? 9 : viscous || carried ? 6 : 3, row->pressure);
}

/* Sums over sub-voxel walls in columns [begin, end). */
struct row_wall {
  double weight, beta, rough, offsets[3], drag[3], inflow;
};
SIMD_INLINE void row_force_subvoxel(const struct pass *pass, const struct local *local,
                                    size_t begin, size_t end, const vec at[3], size_t i,
                                    bool moving, struct row_wall *row) {
  float distance = pass->particles->distance[i];
  float floor_h = (float)(WALL_SUBVOXEL_FLOOR * pass->spacing / pass->smoothing_length);
  float d_row = fabsf(distance) * (float)(1.0 / pass->smoothing_length);
  if (d_row < floor_h) d_row = floor_h;
  vec d_a = vec_set(d_row), inverse_d_a = vec_set(1.0f / d_row);
  float tile[MAX_SUMS][SIMD_LANES];
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum = {0}, beta = {0}, rough = {0}, inflow = {0}, drag[3] = {{0}}, offsets[3] = {{0}};
    for (size_t k = begin + (size_t)group * SIMD_WIDTH; k < end; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse, weight;
      wall_subvoxel_pair(slope, g.s, d_a, inverse_d_a, vec_load(local->field[LSTATE] + k), &weight,
                         &beta, &rough);
      sum += weight;
      density_continuity_wall(slope, g.x, g.y, g.z, offsets);
      if (!moving) continue;
      vec vx = vec_load(local->field[LVX] + k), vy = vec_load(local->field[LVY] + k),
          vz = vec_load(local->field[LVZ] + k);
      viscosity_morris_pair(weight, vx, vy, vz, drag);
      inflow += slope * density_continuity_pair(g.x, g.y, g.z, vx, vy, vz);
    }
    vec_store(tile[0] + group * SIMD_WIDTH, sum);
    vec_store(tile[1] + group * SIMD_WIDTH, beta);
    vec_store(tile[2] + group * SIMD_WIDTH, rough);
    for (int a = 0; a < 3; a++) {
      vec_store(tile[3 + a] + group * SIMD_WIDTH, offsets[a]);
      if (moving) vec_store(tile[6 + a] + group * SIMD_WIDTH, drag[a]);
    }
    if (moving) vec_store(tile[9] + group * SIMD_WIDTH, inflow);
  }
  lanes_sums(tile, moving ? 10 : 6, &row->weight);
  row->beta *= pass->l_scale * pass->smoothing_length * pass->smoothing_length;
  if (distance < 0 || row->rough > 0 || row->beta < 0) row->beta = 0;
  if (row->beta > WALL_SUBVOXEL_BETA_MAX) row->beta = WALL_SUBVOXEL_BETA_MAX;
}

SIMD_INLINE void force_rows(const struct pass *pass, struct local *local, size_t begin, size_t end,
                            enum pass_wall wall, bool viscous, bool shift) {
  struct particles *p = pass->particles;
  const bool symmetric = wall == PASS_FROZEN, subvoxel = wall == PASS_SUBVOXEL;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const float *walls[4] = {p->wall_v[0], p->wall_v[1], p->wall_v[2], p->wall_state};
  const bool moving = p->wall_velocity != NULL;
  double gradient = pass->g_scale, square = pass->sound_speed * pass->sound_speed;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 4, fluid, 0);
    size_t all;
    if (wall == PASS_FROZEN || wall == PASS_ADAMI)
      n = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 4, walls,
                         wall == PASS_FROZEN ? GATHER_MOVE : 0);
    n = all = pad_columns(local, n, 4);
    if (symmetric)
      for (size_t k = 0; k < n; k += SIMD_WIDTH)
        vec_store(local->field[LTERM] + k,
                  pressure_symmetric_term(vec_load(local->field[LSTATE] + k),
                                          vec_set((float)pass->rest_ratio)));
    if (subvoxel) {
      all = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, moving ? 3 : 0, walls,
                           GATHER_DEPTH | GATHER_MOVE);
      all = pad_columns(local, all, 4);
    }
    /* All walls first, as the rows of fluid need their sums. */
    struct row_wall walls_of[CLUSTER] = {{0}};
    for (int l = 0; l < CLUSTER && all > n; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      if (moving) /* two instances: walls at rest have no velocity to load */
        row_force_subvoxel(pass, local, n, all, at, i, true, &walls_of[l]);
      else
        row_force_subvoxel(pass, local, n, all, at, i, false, &walls_of[l]);
    }
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      const struct row_wall *near = &walls_of[l];
      struct row_force row;
      double drag = viscous ? 2 * pass->kinematic_viscosity * pass->l_scale : gradient, stiff = 0;
      if (subvoxel && viscous) {
        drag /= 1 - near->beta;
        stiff = pass->dt * drag * near->weight;
      }
      if (viscous && symmetric) drag *= (double)p->state[i];
      float carry[3] = {0};
      for (int a = 0; a < 3 && shift; a++)
        carry[a] = (float)(gradient / drag * (double)p->shift[a][i]);
      if (wall == PASS_OPEN)
        row_force_exact(pass, local, n, at, i, carry, viscous, shift, &row);
      else
        row_force_fluid(pass, local, n, at, i, carry, symmetric, viscous, shift, shift, &row);
      double u[3], speed = 0, rate = -2 * near->inflow;
      for (int a = 0; a < 3; a++) {
        double change = momentum_change(pass, a, gradient * square * row.pressure[a]);
        if (viscous || shift)
          change += drag * (row.velocity[a] + (subvoxel && viscous && moving ? near->drag[a] : 0));
        p->v_next[a][i] = (float)momentum_next(pass, (double)p->v[a][i], change, stiff);
        if (subvoxel) rate += 2 * (double)p->v_next[a][i] * near->offsets[a];
        if (!shift) continue;
        u[a] = -pass->shift_length * pass->shift_speed * gradient *
               (row.concentration[a] + (subvoxel ? near->offsets[a] : 0));
        speed += u[a] * u[a];
      }
      if (shift) {
        speed = sqrt(speed);
        double most = SHIFTING_LIMIT * pass->shift_speed, share = speed > most ? most / speed : 1;
        for (int a = 0; a < 3; a++) {
          p->shift[a][i] = (float)(u[a] * share);
          /* (u . grad) p is u . the gradient of p. */
          if (subvoxel) rate -= (double)p->shift[a][i] * row.pressure[a];
        }
      }
      if (subvoxel) p->rate[i] = (float)rate;
    }
  }
}

#endif
