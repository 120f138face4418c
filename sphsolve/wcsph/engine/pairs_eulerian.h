/* Rows of Eulerian particles next to sub-voxel walls (advection in effects/registry.def). The
 * effect of the surrounding sites is the same in every step: the first two passes here sum it once,
 * and it is stored packed (site_terms.h); steps only visit pairs of fluid. The equations are those
 * of method stokes plus time derivative and advection:
 *
 * dv/dt = -(v . grad) v + F - B G p + nu (pairs of fluid - weight v)/(1 - beta)
 *
 * dp/dt = -c^2 D B (v + gamma G p) + c^2 gamma lap p
 *
 * with p divided by density, G p the sum over its differences, D the transpose of G, and B the
 * inverse of the moment of G (Bonet, Lok 1999). The term gamma lap p damps alternating pressures;
 * the divergence of gamma G p compensates its effect on smooth pressures. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_EULERIAN_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_EULERIAN_H

#include "sphsolve/wcsph/engine/pairs_force.h"
#include "sphsolve/wcsph/engine/site_terms.h"

/* Sums over walls: weight and beta (0 where distances are rough), stored in v_next. */
static void eulerian_walls(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n =
        gather_columns(pass, local, 0, pass->fluid_wall, c, true, &ref, 0, NULL, GATHER_DEPTH);
    n = pad_columns(local, n, 4);
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      const float d = p->distance[i] * (float)(1.0 / pass->smoothing_length);
      vec d_a = vec_set(d), inverse_d_a = vec_set(1.0f / d);
      float tile[MAX_SUMS][SIMD_LANES];
      double sum[3];
      for (int group = 0; group < SIMD_GROUPS; group++) {
        vec sums[3] = {{0}};
        for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          vec slope = kernel_vector_slope(g.s) * g.inverse, weight;
          wall_subvoxel_pair(slope, g.s, d_a, inverse_d_a, vec_load(local->field[LSTATE] + k),
                             &weight, &sums[1], &sums[2]);
          sums[0] += weight;
        }
        for (int s = 0; s < 3; s++) vec_store(tile[s] + group * SIMD_WIDTH, sums[s]);
      }
      lanes_sums(tile, 3, sum);
      p->v_next[0][i] = (float)sum[0];
      p->v_next[1][i] = sum[2] > 0 ? 0 : (float)sum[1];
    }
  }
}

/* Moments over fluid, stored in the five site terms and v_next. */
static void eulerian_moments(const struct pass *pass, struct local *local, size_t begin,
                             size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    size_t n = gather_fluid(pass, local, c, 0, NULL, &ref);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      vec at[3];
      float tile[MAX_SUMS][SIMD_LANES];
      double sum[6];
      row_position(pass, &ref, l, at);
      for (int group = 0; group < SIMD_GROUPS; group++) {
        vec sums[6] = {{0}};
        for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          moment_pair(kernel_vector_slope(g.s) * g.inverse, &g, sums);
        }
        for (int s = 0; s < 6; s++) vec_store(tile[s] + group * SIMD_WIDTH, sums[s]);
      }
      lanes_sums(tile, 6, sum);
      const size_t i = c * CLUSTER + (size_t)l;
      for (int k = 0; k < 5; k++) p->site_terms[k][i] = (float)sum[k];
      p->v_next[2][i] = (float)sum[5];
    }
  }
}

/* `flow`: with all terms; otherwise only force and pressure, and no flux. */
SIMD_INLINE void eulerian_force_rows(const struct pass *pass, struct local *local, size_t begin,
                                     size_t end, bool flow) {
  struct particles *p = pass->particles;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const double gradient = pass->g_scale, square = pass->sound_speed * pass->sound_speed;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    size_t n = gather_fluid(pass, local, c, 4, fluid, &ref);
    for (int l = 0; l < CLUSTER; l++) {
      size_t i;
      vec at[3];
      if (!row_begin(pass, &ref, c, l, &i, at)) continue;
      struct site_terms terms;
      struct row_force row;
      float carry[3] = {0};
      double pressed[3], more[3];
      site_terms_load(p, i, &terms);
      const double drag = 2 * pass->kinematic_viscosity * pass->l_scale / terms.kept;
      for (int a = 0; a < 3; a++) carry[a] = (float)(-gradient / drag * (double)p->v[a][i]);
      row_force_fluid(pass, local, n, at, i, carry, false, flow, flow, false, &row);
      for (int a = 0; a < 3; a++) {
        pressed[a] = gradient * square * row.pressure[a];
        more[a] = -pass->stabilisation * pressed[a];
      }
      times(terms.correction, pressed);
      for (int a = 0; a < 3; a++) {
        double change = momentum_change(pass, a, pressed[a]), stiff = 0;
        if (flow) {
          change += drag * row.velocity[a];
          stiff = pass->dt * drag * terms.weight;
        }
        p->v_next[a][i] = (float)momentum_next(pass, (double)p->v[a][i], change, stiff);
        more[a] += (double)p->v_next[a][i];
      }
      if (!flow) continue;
      uint32_t packed[2];
      times(terms.correction, more);
      for (int a = 0; a < 3; a++) more[a] -= (double)p->v_next[a][i];
      vector_pack(more, pass->sound_speed, packed);
      for (int k = 0; k < 2; k++) memcpy(&p->flux[k][i], &packed[k], sizeof *packed);
    }
  }
}
static void eulerian_acceleration(const struct pass *pass, struct local *local, size_t begin,
                                  size_t end) {
  eulerian_force_rows(pass, local, begin, end, false);
}
static void eulerian_force(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  eulerian_force_rows(pass, local, begin, end, true);
}

#endif
