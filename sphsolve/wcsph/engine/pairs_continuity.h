/* The continuity equation: state_next from state and v; and the velocity and pressure of adami's
 * walls. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_CONTINUITY_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_CONTINUITY_H

#include "sphsolve/wcsph/effects/density_continuity.h"
#include "sphsolve/wcsph/effects/pressure_diffusion.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/effects/wall_adami.h"
#include "sphsolve/wcsph/engine/pairs_exact.h"

SIMD_INLINE void continuity_rows(const struct pass *pass, struct local *local, size_t begin,
                                 size_t end, bool walls, bool diffusion, bool shift,
                                 bool eulerian) {
  struct particles *p = pass->particles;
  float *const *v = eulerian ? p->v_next : p->v;
  const float *fluid[4] = {v[0], v[1], v[2], p->state};
  /* Factors of the pressure differences and of their weights, in units of g_scale. */
  double diffuse = 2 * pass->diffusion * pass->l_scale;
  const vec share = vec_set((float)(diffusion ? diffuse / pass->g_scale : 0));
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref,
                              diffusion || shift ? 4 : 3, fluid, 0);
    size_t all = n = pad_columns(local, n, 4);
    if (walls) {
      all = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 3, NULL, GATHER_MOVE);
      all = pad_columns(local, all, 3);
    }
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      float tile[MAX_SUMS][SIMD_LANES];
      vec vi[3], u[3], state = vec_set(p->state[i]);
      /* Eulerian: walls, which have the velocity -v_i, complete the sum of gradients to 0: the sum
       * of v_j - v_i including them equals that of v_j + v_i without them. */
      for (int a = 0; a < 3; a++) vi[a] = vec_set(eulerian ? -v[a][i] : v[a][i]);
      if (shift)
        for (int a = 0; a < 3; a++) u[a] = vec_set(p->shift[a][i]);
      for (int group = 0; group < SIMD_GROUPS; group++) {
        vec change = {0}, weights = {0};
        size_t first = (size_t)group * SIMD_WIDTH;
        for (size_t k = first; k < n; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          vec slope = kernel_vector_slope(g.s) * g.inverse;
          vec term = -density_continuity_pair(
              g.x, g.y, g.z, vec_load(local->field[LVX] + k) - vi[0],
              vec_load(local->field[LVY] + k) - vi[1], vec_load(local->field[LVZ] + k) - vi[2]);
          if (diffusion || shift) {
            vec factor = shift ? shifting_carry(share, g.x, g.y, g.z, u) : share;
            term += factor * (vec_load(local->field[LSTATE] + k) - state);
          }
          change += slope * term;
          if (diffusion && !eulerian) pressure_diffusion_pair(slope, &weights);
        }
        /* Adami's walls, without diffusion. */
        for (size_t k = n + first; k < all; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          change -= kernel_vector_slope(g.s) * g.inverse *
                    density_continuity_pair(g.x, g.y, g.z, vec_load(local->field[LVX] + k) - vi[0],
                                            vec_load(local->field[LVY] + k) - vi[1],
                                            vec_load(local->field[LVZ] + k) - vi[2]);
        }
        vec_store(tile[0] + group * SIMD_WIDTH, change);
        vec_store(tile[1] + group * SIMD_WIDTH, weights);
      }
      double sum[2];
      lanes_sums(tile, diffusion && !eulerian ? 2 : 1, sum);
      /* Eulerian: the weights of a full lattice, as the corrected gradients next to missing
       * neighbours would otherwise let sound be faster than this term slows it down. */
      double stiff = !diffusion ? 0
                     : eulerian ? pass->dt * pass->diffusion * pass->weights
                                : pass->dt * diffuse * sum[1];
      double rate = sum[0] + (p->rate != NULL ? (double)p->rate[i] : 0);
      p->state_next[i] =
          (float)((double)p->state[i] + pass->dt * pass->g_scale * rate / (1 + stiff));
    }
  }
}

SIMD_INLINE void continuity_exact_rows(const struct pass *pass, struct local *local, size_t begin,
                                       size_t end, bool diffusion, bool shift) {
  struct particles *p = pass->particles;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const double diffuse = diffusion ? 2 * pass->diffusion * pass->l_scale : 0;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    size_t n = gather_fluid(pass, local, c, 4, fluid, &ref);
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      double sum[2];
      row_continuity_exact(pass, local, n, at, i, diffuse / pass->g_scale, shift, sum);
      p->state_next[i] = (float)((double)p->state[i] + pass->dt * pass->g_scale * sum[0] /
                                                           (1 + pass->dt * diffuse * sum[1]));
    }
  }
}

static void image_velocity(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const float(*moving)[3] = (const float(*)[3])p->wall_velocity;
  double head = 2 * pass->smoothing_length / (pass->sound_speed * pass->sound_speed);
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, true, &ref);
    size_t n = gather_columns(pass, local, 0, pass->wall_fluid, c, false, &ref, 4, fluid, 0);
    n = pad_columns(local, n, 4);
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      float tile[MAX_SUMS][SIMD_LANES];
      double sum[8];
      for (int group = 0; group < SIMD_GROUPS; group++) {
        vec sums[8] = {{0}};
        for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          wall_adami_pair(kernel_vector_w(g.s), g.x, g.y, g.z, vec_load(local->field[LVX] + k),
                          vec_load(local->field[LVY] + k), vec_load(local->field[LVZ] + k),
                          vec_load(local->field[LSTATE] + k), sums);
        }
        for (int s = 0; s < 8; s++) vec_store(tile[s] + group * SIMD_WIDTH, sums[s]);
      }
      lanes_sums(tile, 8, sum);
      bool reached = sum[0] > 1e-6;
      double hydrostatic = 0;
      for (int a = 0; a < 3; a++) {
        double wall = moving != NULL ? (double)moving[p->wall_region[c]][a] : 0;
        p->wall_v[a][i] = (float)(reached ? 2 * wall - sum[1 + a] / sum[0] : wall);
        hydrostatic -= head * pass->force[a] * sum[5 + a];
      }
      p->wall_state[i] = reached ? (float)((sum[4] + hydrostatic) / sum[0]) : 0;
    }
  }
}

#endif
