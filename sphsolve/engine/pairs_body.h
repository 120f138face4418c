/* The pair loops, compiled once per instruction set by the thin files beside it. Each loop is
 * specialised at compile time for its set of effects: the flags of an `always_inline` function are
 * constants where it is instantiated, and what is off leaves no instruction behind.
 *
 * A row cluster first gathers its columns into a small local buffer (pairs_gather.h). Then each row
 * runs over the buffer with full vectors. */
#include <math.h>

#include "sphsolve/effects/density_continuity.h"
#include "sphsolve/effects/density_summation.h"
#include "sphsolve/effects/pressure_difference.h"
#include "sphsolve/effects/pressure_diffusion.h"
#include "sphsolve/effects/pressure_symmetric.h"
#include "sphsolve/effects/shifting.h"
#include "sphsolve/effects/viscosity_morris.h"
#include "sphsolve/effects/wall_adami.h"
#include "sphsolve/effects/wall_subvoxel.h"
#include "sphsolve/engine/kernel_vector.h"
#include "sphsolve/engine/pairs_gather.h"

#define MAX_SUMS 12

/* ---- density by summation ---- */
SIMD_INLINE double row_density(const struct local *local, size_t n, const vec at[3]) {
  float tile[SIMD_LANES];
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum = vec_set(0.0f);
    for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES)
      density_summation_pair(pair_geometry(local, k, at).s, &sum);
    vec_store(tile + group * SIMD_WIDTH, sum);
  }
  return (double)lanes_sum(tile);
}

static void density(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 0, NULL, false);
    n = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 0, NULL, false);
    n = pad_columns(local, n, 0);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      vec at[3];
      row_position(pass, &ref, l, at);
      p->state[c * CLUSTER + (size_t)l] =
          (float)(1.0 / (pass->w_scale * row_density(local, n, at)));
    }
  }
}

static void density_wall(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, true, &ref);
    size_t n = gather_columns(pass, local, 0, pass->wall_fluid, c, false, &ref, 0, NULL, false);
    n = pad_columns(local, n, 0);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      vec at[3];
      row_position(pass, &ref, l, at);
      p->wall_state[i] =
          (float)(1.0 / ((double)p->wall_base[i] + pass->w_scale * row_density(local, n, at)));
    }
  }
}

/* ---- forces: v_next ---- */
struct row_force {
  double pressure[3], viscous[3], carried[3], crowd[3];
};

/* Over columns [begin, end) that act as fluid does (frozen and adami walls among them). */
SIMD_INLINE void row_force_fluid(const struct pass *pass, const struct local *local, size_t n,
                                 const vec at[3], size_t i, bool symmetric, bool viscosity,
                                 bool shift, struct row_force *row) {
  const struct particles *p = pass->particles;
  float tile[MAX_SUMS][SIMD_LANES];
  vec vi[3], u[3], state = vec_set(p->state[i]);
  for (int a = 0; a < 3; a++) vi[a] = vec_set(p->v[a][i]);
  if (shift)
    for (int a = 0; a < 3; a++) u[a] = vec_set(p->shift[a][i]);
  vec term = symmetric ? pressure_symmetric_term(state, vec_set((float)pass->rest_ratio)) : state;
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec pressure[3] = {{0}}, viscous[3] = {{0}}, carried[3] = {{0}}, crowd[3] = {{0}};
    for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse;
      vec weight = symmetric
                       ? pressure_symmetric_pair(term, vec_load(local->field[LTERM] + k), slope)
                       : pressure_difference_pair(term, vec_load(local->field[LSTATE] + k), slope);
      pressure[0] -= weight * g.x;
      pressure[1] -= weight * g.y;
      pressure[2] -= weight * g.z;
      if (viscosity || shift) {
        vec dvx = vec_load(local->field[LVX] + k) - vi[0];
        vec dvy = vec_load(local->field[LVY] + k) - vi[1];
        vec dvz = vec_load(local->field[LVZ] + k) - vi[2];
        if (viscosity)
          viscosity_morris_pair(symmetric ? slope * vec_load(local->field[LSTATE] + k) : slope, dvx,
                                dvy, dvz, viscous);
        if (shift)
          viscosity_morris_pair(shifting_weight(slope, g.x, g.y, g.z, u), dvx, dvy, dvz, carried);
      }
      if (shift) shifting_pair(slope, g.x, g.y, g.z, crowd);
    }
    for (int a = 0; a < 3; a++) {
      vec_store(tile[a] + group * SIMD_WIDTH, pressure[a]);
      if (viscosity) vec_store(tile[3 + a] + group * SIMD_WIDTH, viscous[a]);
      if (shift) {
        vec_store(tile[6 + a] + group * SIMD_WIDTH, carried[a]);
        vec_store(tile[9 + a] + group * SIMD_WIDTH, crowd[a]);
      }
    }
  }
  memset(row, 0, sizeof *row);
  tile_sums(tile, 3, row->pressure);
  if (viscosity) tile_sums(tile + 3, 3, row->viscous);
  if (viscosity && symmetric)
    for (int a = 0; a < 3; a++) row->viscous[a] *= (double)p->state[i];
  if (shift) {
    tile_sums(tile + 6, 3, row->carried);
    tile_sums(tile + 9, 3, row->crowd);
  }
}

/* Sub-voxel walls in columns [begin, end). */
struct row_wall {
  double weight, beta, drag[3], crowd[3];
};
SIMD_INLINE void row_force_subvoxel(const struct pass *pass, const struct local *local,
                                    size_t begin, size_t end, const vec at[3], size_t i,
                                    bool moving, bool shift, struct row_wall *row) {
  float distance = pass->particles->distance[i];
  float floor_h = (float)(WALL_SUBVOXEL_FLOOR * pass->spacing / pass->smoothing_length);
  float d_row = fabsf(distance) * (float)(1.0 / pass->smoothing_length);
  if (d_row < floor_h) d_row = floor_h;
  vec d_a = vec_set(d_row), inverse_d_a = vec_set(1.0f / d_row);
  float tile[MAX_SUMS][SIMD_LANES];
  for (int group = 0; group < SIMD_GROUPS; group++) {
    vec sum = {0}, beta = {0}, rough = {0}, drag[3] = {{0}}, crowd[3] = {{0}};
    for (size_t k = begin + (size_t)group * SIMD_WIDTH; k < end; k += SIMD_LANES) {
      struct geometry g = pair_geometry(local, k, at);
      vec slope = kernel_vector_slope(g.s) * g.inverse, weight;
      wall_subvoxel_pair(slope, g.s, d_a, inverse_d_a, vec_load(local->field[LSTATE] + k), &weight,
                         &beta, &rough);
      sum += weight;
      if (moving)
        viscosity_morris_pair(weight, vec_load(local->field[LVX] + k),
                              vec_load(local->field[LVY] + k), vec_load(local->field[LVZ] + k),
                              drag);
      if (shift) shifting_pair(slope, g.x, g.y, g.z, crowd);
    }
    vec_store(tile[0] + group * SIMD_WIDTH, sum);
    vec_store(tile[1] + group * SIMD_WIDTH, beta);
    vec_store(tile[8] + group * SIMD_WIDTH, rough);
    for (int a = 0; a < 3; a++) {
      vec_store(tile[2 + a] + group * SIMD_WIDTH, drag[a]);
      vec_store(tile[5 + a] + group * SIMD_WIDTH, crowd[a]);
    }
  }
  tile_sums(tile, 1, &row->weight);
  tile_sums(tile + 1, 1, &row->beta);
  tile_sums(tile + 2, 3, row->drag);
  tile_sums(tile + 5, 3, row->crowd);
  double rough;
  tile_sums(tile + 8, 1, &rough);
  row->beta *= pass->g_scale * pass->smoothing_length;
  if (distance < 0 || rough > 0 || row->beta < 0) row->beta = 0;
  if (row->beta > WALL_SUBVOXEL_BETA_MAX) row->beta = WALL_SUBVOXEL_BETA_MAX;
}

SIMD_INLINE void force_rows(const struct pass *pass, struct local *local, size_t begin, size_t end,
                            enum pass_wall wall, bool viscosity, bool shift) {
  struct particles *p = pass->particles;
  const bool symmetric = wall == PASS_FROZEN, subvoxel = wall == PASS_SUBVOXEL;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const float *walls[4] = {p->wall_v[0], p->wall_v[1], p->wall_v[2], p->wall_state};
  const bool moving = p->wall_v[0] != NULL;
  double gradient = pass->g_scale, square = pass->sound_speed * pass->sound_speed;
  double drag = 2 * pass->viscosity * pass->g_scale / pass->smoothing_length;
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref, 4, fluid, false);
    size_t all;
    if (wall == PASS_FROZEN || wall == PASS_ADAMI)
      n = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 4, walls, false);
    n = all = pad_columns(local, n, 4);
    if (symmetric)
      for (size_t k = 0; k < n; k += SIMD_WIDTH)
        vec_store(local->field[LTERM] + k,
                  pressure_symmetric_term(vec_load(local->field[LSTATE] + k),
                                          vec_set((float)pass->rest_ratio)));
    if (subvoxel) {
      all = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, moving ? 3 : 0, walls,
                           true);
      all = pad_columns(local, all, 4);
    }
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      vec at[3];
      row_position(pass, &ref, l, at);
      struct row_force row;
      row_force_fluid(pass, local, n, at, i, symmetric, viscosity, shift, &row);
      double stiff = 0, curve = 1;
      if (subvoxel && all > n && (viscosity || shift)) {
        struct row_wall near;
        if (moving) /* two instances: resting walls have no velocity to load */
          row_force_subvoxel(pass, local, n, all, at, i, true, shift, &near);
        else
          row_force_subvoxel(pass, local, n, all, at, i, false, shift, &near);
        curve = 1 / (1 - near.beta);
        stiff = pass->dt * drag * near.weight * curve;
        for (int a = 0; a < 3; a++) {
          row.viscous[a] += near.drag[a];
          row.crowd[a] += near.crowd[a];
        }
      }
      double u[3], speed = 0;
      for (int a = 0; a < 3; a++) {
        double change = pass->force[a] + gradient * square * row.pressure[a];
        if (viscosity) change += drag * curve * row.viscous[a];
        if (shift) change += gradient * row.carried[a];
        double v = ((double)p->v[a][i] + pass->dt * change) / (1 + stiff);
        p->v_next[a][i] = (float)v;
        if (!shift) continue;
        u[a] = -pass->shift_length * pass->shift_speed * gradient * row.crowd[a];
        speed += u[a] * u[a];
      }
      if (!shift) continue;
      speed = sqrt(speed);
      double most = SHIFTING_LIMIT * pass->shift_speed;
      for (int a = 0; a < 3; a++)
        p->shift[a][i] = (float)(speed > most ? u[a] * (most / speed) : u[a]);
    }
  }
}

/* ---- continuity: state_next ---- */
SIMD_INLINE void continuity_rows(const struct pass *pass, struct local *local, size_t begin,
                                 size_t end, bool walls, bool diffusion, bool shift) {
  struct particles *p = pass->particles;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  bool given = p->wall_given[0] != NULL;
  const float *wall[3];
  for (int a = 0; a < 3; a++)
    wall[a] = given ? p->wall_given[a] : p->wall_state == NULL ? p->wall_v[a] : NULL;
  double diffuse = 2 * pass->diffusion * pass->g_scale / pass->smoothing_length;
  const vec mirror = vec_set(p->wall_state == NULL ? 2.0f : 1.0f);
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, false, &ref);
    size_t n = gather_columns(pass, local, 0, pass->fluid_fluid, c, false, &ref,
                              diffusion || shift ? 4 : 3, fluid, false);
    size_t all = n = pad_columns(local, n, 4);
    if (walls) {
      all = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 3, wall, false);
      all = pad_columns(local, all, 3);
    }
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      size_t i = c * CLUSTER + (size_t)l;
      float tile[MAX_SUMS][SIMD_LANES];
      vec at[3], vi[3], u[3], state = vec_set(p->state[i]);
      row_position(pass, &ref, l, at);
      for (int a = 0; a < 3; a++) vi[a] = vec_set(p->v[a][i]);
      if (shift)
        for (int a = 0; a < 3; a++) u[a] = vec_set(p->shift[a][i]);
      for (int group = 0; group < SIMD_GROUPS; group++) {
        vec divergence = {0}, laplacian = {0}, weights = {0}, carried = {0}, mirrored = {0};
        for (size_t k = (size_t)group * SIMD_WIDTH; k < n; k += SIMD_LANES) {
          struct geometry g = pair_geometry(local, k, at);
          vec slope = kernel_vector_slope(g.s) * g.inverse;
          density_continuity_pair(slope, g.x, g.y, g.z, vec_load(local->field[LVX] + k) - vi[0],
                                  vec_load(local->field[LVY] + k) - vi[1],
                                  vec_load(local->field[LVZ] + k) - vi[2], &divergence);
          if (diffusion)
            pressure_diffusion_pair(slope, state, vec_load(local->field[LSTATE] + k), &laplacian,
                                    &weights);
          if (shift)
            carried += shifting_weight(slope, g.x, g.y, g.z, u) *
                       (vec_load(local->field[LSTATE] + k) - state);
        }
        if (walls)
          for (size_t k = n + (size_t)group * SIMD_WIDTH; k < all; k += SIMD_LANES) {
            struct geometry g = pair_geometry(local, k, at);
            vec slope = kernel_vector_slope(g.s) * g.inverse;
            density_continuity_pair(slope, g.x, g.y, g.z, vec_load(local->field[LVX] + k) - vi[0],
                                    vec_load(local->field[LVY] + k) - vi[1],
                                    vec_load(local->field[LVZ] + k) - vi[2], &mirrored);
          }
        vec_store(tile[0] + group * SIMD_WIDTH, divergence + mirror * mirrored);
        vec_store(tile[1] + group * SIMD_WIDTH, laplacian);
        vec_store(tile[2] + group * SIMD_WIDTH, carried);
        vec_store(tile[3] + group * SIMD_WIDTH, weights);
      }
      double sum[4] = {0};
      tile_sums(tile, 1, sum);
      if (diffusion) tile_sums(tile + 1, 1, sum + 1);
      if (shift) tile_sums(tile + 2, 1, sum + 2);
      if (diffusion) tile_sums(tile + 3, 1, sum + 3);
      double rate = pass->g_scale * (sum[2] - sum[0]) + diffuse * sum[1];
      double stiff = pass->dt * diffuse * sum[3];
      p->state_next[i] = (float)((double)p->state[i] + pass->dt * rate / (1 + stiff));
    }
  }
}

/* ---- adami's walls ---- */
static void image_velocity(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  struct particles *p = pass->particles;
  const float *fluid[4] = {p->v[0], p->v[1], p->v[2], p->state};
  double head = pass->smoothing_length / (pass->sound_speed * pass->sound_speed);
  for (size_t c = begin; c < end; c++) {
    struct reference ref;
    reference_make(pass, c, true, &ref);
    size_t n = gather_columns(pass, local, 0, pass->wall_fluid, c, false, &ref, 4, fluid, false);
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
      tile_sums(tile, 8, sum);
      bool reached = sum[0] > 1e-6;
      double hydrostatic = 0;
      for (int a = 0; a < 3; a++) {
        double wall = p->wall_given[0] != NULL ? (double)p->wall_given[a][i] : 0;
        p->wall_v[a][i] = (float)(reached ? 2 * wall - sum[1 + a] / sum[0] : wall);
        hydrostatic -= head * pass->force[a] * sum[5 + a];
      }
      p->wall_state[i] = reached ? (float)((sum[4] + hydrostatic) / sum[0]) : 0;
    }
  }
}

/* ---- counting ---- */
SIMD_INLINE uint64_t count_rows(const struct pass *pass, struct local *local, size_t c, bool wall) {
  struct reference ref;
  uint64_t pairs = 0;
  reference_make(pass, c, wall, &ref);
  size_t n = gather_columns(pass, local, 0, wall ? pass->wall_fluid : pass->fluid_fluid, c, false,
                            &ref, 0, NULL, false);
  if (!wall) n = gather_columns(pass, local, n, pass->fluid_wall, c, true, &ref, 0, NULL, false);
  n = pad_columns(local, n, 0);
  for (int l = 0; l < CLUSTER; l++) {
    if (!ref.live[l]) continue;
    vec at[3], radius = vec_set(pass->radius);
    row_position(pass, &ref, l, at);
    for (size_t k = 0; k < n; k += SIMD_WIDTH)
      pairs += (uint64_t)__builtin_popcount(vec_below(pair_geometry(local, k, at).s, radius));
    if (!wall) pairs--;
  }
  return pairs;
}
static void count(const struct pass *pass, struct local *local, size_t begin, size_t end,
                  uint64_t *pairs) {
  for (size_t c = begin; c < end; c++) *pairs += count_rows(pass, local, c, false);
}
static void count_wall(const struct pass *pass, struct local *local, size_t begin, size_t end,
                       uint64_t *pairs) {
  for (size_t c = begin; c < end; c++) *pairs += count_rows(pass, local, c, true);
}

/* ---- instances ---- */
#define FORCE(wall, viscosity, shift)                                                              \
  static void force_##wall##_##viscosity##_##shift(const struct pass *pass, struct local *local,   \
                                                   size_t begin, size_t end) {                     \
    force_rows(pass, local, begin, end, PASS_##wall, viscosity, shift);                            \
  }
#define FORCES(wall) FORCE(wall, 0, 0) FORCE(wall, 0, 1) FORCE(wall, 1, 0) FORCE(wall, 1, 1)
FORCES(FROZEN)
FORCES(OPEN)
FORCES(ADAMI)
FORCES(SUBVOXEL)
#define CONTINUITY(walls, diffusion, shift)                                                        \
  static void continuity_##walls##_##diffusion##_##shift(                                          \
      const struct pass *pass, struct local *local, size_t begin, size_t end) {                    \
    continuity_rows(pass, local, begin, end, walls, diffusion, shift);                             \
  }
#define CONTINUITIES(walls)                                                                        \
  CONTINUITY(walls, 0, 0) CONTINUITY(walls, 0, 1) CONTINUITY(walls, 1, 0) CONTINUITY(walls, 1, 1)
CONTINUITIES(0)
CONTINUITIES(1)

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
#define TABLE_NAME_(isa) pair_table_##isa
#define TABLE_NAME(isa) TABLE_NAME_(isa)
#define TEXT_(isa) #isa
#define TEXT(isa) TEXT_(isa)
const struct pair_table TABLE_NAME(SIMD_ISA) = {
    .name = TEXT(SIMD_ISA),
    .density = density,
    .density_wall = density_wall,
    .force = {TABLE_FORCE(FROZEN), TABLE_FORCE(OPEN), TABLE_FORCE(ADAMI), TABLE_FORCE(SUBVOXEL)},
    .continuity = {TABLE_CONTINUITY(0), TABLE_CONTINUITY(1)},
    .image_velocity = image_velocity,
    .count = count,
    .count_wall = count_wall,
};
