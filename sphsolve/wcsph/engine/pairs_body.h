/* The pair loops, for the kernel and instruction set of pair_loops.c. Each loop is
 * specialised at compile time for its set of effects: the flags of an `always_inline` function are
 * constants where it is instantiated, and what is off leaves no instruction behind.
 *
 * A row cluster first gathers its columns into a small local buffer (pairs_gather.h). Then each row
 * runs over the buffer with full vectors. */
#include <math.h>
#include <string.h>

#include "sphsolve/wcsph/effects/density_continuity.h"
#include "sphsolve/wcsph/effects/density_summation.h"
#include "sphsolve/wcsph/effects/pressure_difference.h"
#include "sphsolve/wcsph/effects/pressure_diffusion.h"
#include "sphsolve/wcsph/effects/pressure_symmetric.h"
#include "sphsolve/wcsph/effects/shifting.h"
#include "sphsolve/wcsph/effects/viscosity_morris.h"
#include "sphsolve/wcsph/effects/wall_adami.h"
#include "sphsolve/wcsph/effects/wall_subvoxel.h"
#include "sphsolve/wcsph/engine/pairs_gather.h"

#define MAX_SUMS 12

/* ---- density by summation ---- */
/* Over columns [0, n); those from `walls` on take their share of the row, too, in LWEIGHT. */
SIMD_INLINE double row_density(const struct local *local, size_t walls, size_t n, const vec at[3]) {
  float tile[SIMD_LANES], *weight = local->field[LWEIGHT];
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum = vec_set(0.0f);
    size_t k = (size_t)group * SIMD_WIDTH;
    for (; k < walls; k += SIMD_LANES)
      density_summation_pair(kernel_vector_w(pair_geometry(local, k, at).s), &sum);
    for (; k < n; k += SIMD_LANES) {
      vec own = vec_set(0.0f);
      density_summation_pair(kernel_vector_w(pair_geometry(local, k, at).s), &own);
      sum += own;
      vec_store(weight + k, vec_load(weight + k) + own);
    }
    vec_store(tile + group * SIMD_WIDTH, sum);
  }
  return (double)lanes_sum(tile);
}

/* Adds shares of a cluster to what this thread has collected. */
SIMD_INLINE void collected_add(struct collected *to, uint32_t cluster, const uint32_t *shares,
                               uint32_t *sums) {
  const size_t at = cluster % COLLECTED;
  if (__builtin_expect(to->cluster[at] != cluster, 0)) {
    collected_give(to, at, sums);
    to->cluster[at] = cluster;
  }
  uint64_t more[CLUSTER / 2];
  memcpy(more, shares, sizeof more);
  for (int i = 0; i < CLUSTER / 2; i++) to->sum[at][i] += more[i];
}

/* Adds the shares of a row cluster's walls, from column `n` on, to the sums of all rows. Whole
 * numbers: any order of rows, and of threads, gives the same. */
SIMD_INLINE void spread_density(const struct pass *pass, const struct local *local, size_t n) {
  struct collected *collected = local->collected;
  uint32_t *sums = pass->particles->wall_sum, share[SIMD_LANES];
  const vec unit = vec_set((float)(pass->w_scale / WALL_SUM_UNIT));
  const uint32_t *slots = (const uint32_t *)(const void *)local->field[LSLOT];
  const uint32_t *masks = (const uint32_t *)(const void *)local->field[LMASK];
  for (size_t e = 0; e < local->entries; e++) {
    const uint32_t slot = slots[e], mask = masks[e];
    const vec weight = vec_expand(local->field[LWEIGHT] + n, mask);
    n += (size_t)__builtin_popcount(mask);
    const uvec whole = (uvec) __builtin_convertvector(weight * unit + 0.5f, ivec);
    if (collected == NULL) {
      uvec_store(sums + slot, uvec_load(sums + slot) + whole);
      continue;
    }
    uvec_store(share, whole);
    const uint32_t first = slot % CLUSTER;
    if (SIMD_WIDTH < CLUSTER) { /* half a cluster */
      uint32_t all[CLUSTER] = {0};
      memcpy(all + first, share, SIMD_WIDTH * sizeof *all);
      collected_add(collected, slot / CLUSTER, all, sums);
      continue;
    }
    for (uint32_t k = 0; k < SIMD_WIDTH; k += CLUSTER)
      if ((mask >> k & 0xffu) != 0) collected_add(collected, (slot + k) / CLUSTER, share + k, sums);
  }
}

static void density(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 0, NULL, 0);
    const size_t walls = pad_columns(local, n, 0);
    n = gather_columns(pass, local, walls, pass->fluid_wall, c, true, &ref, 0, NULL, GATHER_PLACE);
    const size_t all = pad_columns(local, n, 0);
    memset(local->field[LWEIGHT] + walls, 0, (all - walls) * sizeof(float));
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      vec at[3];
      row_position(pass, &ref, l, at);
      p->state[c * CLUSTER + (size_t)l] =
          (float)(1.0 / (pass->w_scale * row_density(local, walls, all, at)));
    }
    spread_density(pass, local, walls);
  }
}

/* ---- forces: v_next ---- */
/* Sums over the columns of a row: of the pressure, of differences of velocity with the weights of
 * viscosity and shift, and of the offsets, the gradient of the particle concentration. */
struct row_force {
  double pressure[3], velocity[3], concentration[3];
};

#include "sphsolve/wcsph/engine/pairs_exact.h"

/* Over columns [0, n) that act as fluid does (frozen and adami walls among them). `carry`: the
 * drift of the particle beyond the fluid, in units in which the weight of viscosity is 1 (where
 * there is viscous), where it is `carried`; `shifted`: the
 * sums of offsets, too. */
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

/* Sub-voxel walls in columns [begin, end). */
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
    /* All walls first: what a row needs of them is then there when its fluid's turn comes. */
    struct row_wall walls_of[CLUSTER] = {{0}};
    for (int l = 0; l < CLUSTER && all > n; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      vec at[3];
      row_position(pass, &ref, l, at);
      if (moving) /* two instances: resting walls have no velocity to load */
        row_force_subvoxel(pass, local, n, all, at, i, true, &walls_of[l]);
      else
        row_force_subvoxel(pass, local, n, all, at, i, false, &walls_of[l]);
    }
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      vec at[3];
      row_position(pass, &ref, l, at);
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
        double change = pass->force[a] + gradient * square * row.pressure[a];
        if (viscous || shift)
          change += drag * (row.velocity[a] + (subvoxel && viscous && moving ? near->drag[a] : 0));
        double v = ((double)p->v[a][i] + pass->dt * change) / (1 + stiff);
        p->v_next[a][i] = (float)v;
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

#include "sphsolve/wcsph/engine/pairs_eulerian.h"

/* ---- continuity: state_next ---- */
SIMD_INLINE void continuity_rows(const struct pass *pass, struct local *local, size_t begin,
                                 size_t end, bool walls, bool diffusion, bool shift,
                                 bool eulerian) {
  struct particles *p = pass->particles;
  float *const *v = eulerian ? p->v_next : p->v;
  const float *fluid[4] = {v[0], v[1], v[2], p->state};
  /* In units of g_scale: what the pressure's differences and their weights count. */
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
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      float tile[MAX_SUMS][SIMD_LANES];
      vec at[3], vi[3], u[3], state = vec_set(p->state[i]);
      row_position(pass, &ref, l, at);
      /* Eulerian: walls, which move with -v_i, complete the sum of gradients to 0: that of
       * v_j - v_i with them is that of v_j + v_i without. */
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
        for (size_t k = n + first; k < all; k += SIMD_LANES) { /* adami's: p is their own */
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
      /* Eulerian: that of a full lattice: where neighbours are missing, gradients corrected for it
       * would let sound run faster than it is slowed down. */
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
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 4, fluid, 0);
    n = pad_columns(local, n, 4);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      double sum[2];
      vec at[3];
      row_position(pass, &ref, l, at);
      row_continuity_exact(pass, local, n, at, i, diffuse / pass->g_scale, shift, sum);
      p->state_next[i] = (float)((double)p->state[i] + pass->dt * pass->g_scale * sum[0] /
                                                           (1 + pass->dt * diffuse * sum[1]));
    }
  }
}

/* ---- adami's walls ---- */
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
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      float tile[MAX_SUMS][SIMD_LANES];
      double sum[8];
      vec at[3];
      row_position(pass, &ref, l, at);
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

#include "sphsolve/wcsph/engine/pairs_budget.h"

/* ---- counting ---- */
SIMD_INLINE uint64_t count_columns(const struct pass *pass, struct local *local,
                                   const struct reference *ref, size_t n) {
  uint64_t pairs = 0;
  n = pad_columns(local, n, 0);
  for (int l = 0; l < CLUSTER; l++) {
    if (!ref->live[l]) continue;
    vec at[3], radius = vec_set(2 * pass->radius);
    row_position(pass, ref, l, at);
    for (size_t k = 0; k < n; k += SIMD_WIDTH)
      pairs += (uint64_t)__builtin_popcount(vec_below(pair_geometry(local, k, at).s, radius));
  }
  return pairs;
}
static void count(const struct pass *pass, struct local *local, size_t begin, size_t end,
                  uint64_t *pairs, uint64_t *alone) {
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    uint64_t self = 0, fluid;
    reference_make(pass, c, false, &ref);
    for (int l = 0; l < CLUSTER; l++) self += ref.live[l];
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 0, NULL, 0);
    fluid = count_columns(pass, local, &ref, n) - self;
    n = 0;
    if (pass->fluid_wall->rows > 0)
      n = gather_columns(pass, local, 0, pass->fluid_wall, c, true, &ref, 0, NULL, 0);
    *alone += fluid;
    *pairs += fluid + count_columns(pass, local, &ref, n);
  }
}
static void count_wall(const struct pass *pass, struct local *local, size_t begin, size_t end,
                       uint64_t *pairs) {
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, true, &ref);
    size_t n = gather_columns(pass, local, 0, pass->wall_fluid, c, false, &ref, 0, NULL, 0);
    *pairs += count_columns(pass, local, &ref, n);
  }
}

/* ---- instances ---- */
#define FORCE(wall, viscous, shift)                                                                \
  static void force_##wall##_##viscous##_##shift(const struct pass *pass, struct local *local,     \
                                                 size_t begin, size_t end) {                       \
    force_rows(pass, local, begin, end, PASS_##wall, viscous, shift);                              \
  }
#define FORCES(wall) FORCE(wall, 0, 0) FORCE(wall, 0, 1) FORCE(wall, 1, 0) FORCE(wall, 1, 1)
FORCES(FROZEN)
FORCES(OPEN)
FORCES(ADAMI)
FORCES(SUBVOXEL)
#define CONTINUITY(walls, diffusion, shift)                                                        \
  static void continuity_##walls##_##diffusion##_##shift(                                          \
      const struct pass *pass, struct local *local, size_t begin, size_t end) {                    \
    continuity_rows(pass, local, begin, end, walls, diffusion, shift, false);                      \
  }
#define CONTINUITIES(walls)                                                                        \
  CONTINUITY(walls, 0, 0) CONTINUITY(walls, 0, 1) CONTINUITY(walls, 1, 0) CONTINUITY(walls, 1, 1)
CONTINUITIES(0)
CONTINUITIES(1)
static void eulerian_continuity(const struct pass *pass, struct local *local, size_t begin,
                                size_t end) {
  continuity_rows(pass, local, begin, end, false, true, false, true);
}
#define CONTINUITY_EXACT(diffusion, shift)                                                         \
  static void continuity_exact_##diffusion##_##shift(const struct pass *pass, struct local *local, \
                                                     size_t begin, size_t end) {                   \
    continuity_exact_rows(pass, local, begin, end, diffusion, shift);                              \
  }
CONTINUITY_EXACT(0, 0)
CONTINUITY_EXACT(0, 1)
CONTINUITY_EXACT(1, 0)
CONTINUITY_EXACT(1, 1)

#define TABLE_FORCE(wall)                                                                          \
  {                                                                                                \
    {force_##wall##_0_0, force_##wall##_0_1}, {                                                    \
      force_##wall##_1_0, force_##wall##_1_1                                                       \
    }                                                                                              \
  }
#define TABLE_CONTINUITY(walls)                                                                    \
  {                                                                                                \
    {continuity_##walls##_0_0, continuity_##walls##_0_1}, {                                        \
      continuity_##walls##_1_0, continuity_##walls##_1_1                                           \
    }                                                                                              \
  }
#define TABLE_NAME_(kernel, isa) pair_table_##kernel##_##isa
#define TABLE_NAME(kernel, isa) TABLE_NAME_(kernel, isa)
#define TEXT_(isa) #isa
#define TEXT(isa) TEXT_(isa)
const struct pair_table TABLE_NAME(KERNEL_NAME, SIMD_ISA) = {
    .name = TEXT(SIMD_ISA),
    .kernel_at_0 = KERNEL_AT_0,
    .density = density,
    .force = {TABLE_FORCE(FROZEN),
              TABLE_FORCE(OPEN),
              TABLE_FORCE(ADAMI),
              TABLE_FORCE(SUBVOXEL),
              {{eulerian_pull, eulerian_pull}, {eulerian_flow, eulerian_flow}}},
    .continuity = {TABLE_CONTINUITY(0), TABLE_CONTINUITY(1)},
    .continuity_exact = TABLE_CONTINUITY(exact),
    .eulerian_walls = eulerian_walls,
    .eulerian_moments = eulerian_moments,
    .eulerian_continuity = eulerian_continuity,
    .image_velocity = image_velocity,
    .budget = budget,
    .count = count,
    .count_wall = count_wall,
};
