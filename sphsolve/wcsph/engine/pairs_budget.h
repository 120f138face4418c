/* The budget of a step: the contribution of each effect to the fluid, separated from the same pair
 * sums that move it. With the velocity v before and v' = (v + dt a)/(1 + dt K) after the step, a
 * force F per mass (which may include K v') contributes the momentum m F dt and the energy m F.(v +
 * v')/2 dt. This is an identity of the leapfrog scheme, so that the balance is incomplete only if
 * an effect is not counted.
 *
 * Action and reaction of a force are summed separately where they are different pair sums. The
 * pressure on the fluid is that of pressure_difference.h; the pressure on walls is its adjoint,
 * -sum V (P_w + P_i) grad W over the pairs with walls (P_w = P_i with sub-voxel walls), the force
 * that belongs to the no-penetration condition of the continuity equation. They differ where the
 * fluid particles are unevenly distributed: summed over all pairs, by -2 sum V P_i grad C_i. The
 * symmetric pressure of frozen walls is its own adjoint. Viscous pairs of fluid are antisymmetric;
 * the additional part due to the curvature at sub-voxel walls (wall_subvoxel.h), and the change of
 * the pressure gradient by B for Eulerian particles, belong to the wall. */
#ifndef TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_BUDGET_H
#define TOSUI_SPHSOLVE_WCSPH_ENGINE_PAIRS_BUDGET_H

#include "sphsolve/wcsph/engine/pairs_force.h"
#include "sphsolve/wcsph/engine/site_terms.h"

/* Sums over columns [0, n), as in force_rows: `row` for pressure and viscosity, `moved` with the
 * weights of the carry and of the offsets. */
static void row_budget(const struct pass *pass, const struct local *local, size_t n,
                       const vec at[3], size_t i, struct row_force *row, struct row_force *moved) {
  const struct particles *p = pass->particles;
  float carry[3] = {0};
  memset(row, 0, sizeof *row);
  memset(moved, 0, sizeof *moved);
  switch (pass->wall) {
  case PASS_FROZEN:
    row_force_fluid(pass, local, n, at, i, carry, true, true, false, false, row);
    break;
  case PASS_OPEN:
    row_force_exact(pass, local, n, at, i, carry, true, false, row);
    break;
  default:
    row_force_fluid(pass, local, n, at, i, carry, false, true, false, false, row);
  }
  const bool eulerian = pass->wall == PASS_EULERIAN;
  for (int a = 0; a < 3 && pass->shifts; a++) carry[a] = p->shift[a][i];
  for (int a = 0; a < 3 && eulerian; a++) carry[a] = -p->v[a][i];
  if (pass->wall == PASS_OPEN && pass->shifts)
    row_force_exact(pass, local, n, at, i, carry, false, true, moved);
  else if (pass->shifts || eulerian || pass->wall == PASS_ADAMI)
    row_force_fluid(pass, local, n, at, i, carry, false, false, true, true, moved);
}

static void gather_terms(const struct pass *pass, struct local *local, size_t n) {
  if (pass->wall != PASS_FROZEN) return;
  for (size_t k = 0; k < n; k += SIMD_WIDTH)
    vec_store(local->field[LTERM] + k, pressure_symmetric_term(vec_load(local->field[LSTATE] + k),
                                                               vec_set((float)pass->rest_ratio)));
}

/* Elastic energy per mass / c^2: of the linear pressure, or of c^2 (rho - rho_lattice). */
static double elastic(const struct pass *pass, double state) {
  const double ratio = pass->rest_ratio;
  if (pass->wall != PASS_FROZEN) return 0.5 * state * state;
  return ratio > 0 ? ratio * state - log(ratio * state) - 1 : -log(state);
}

/* Contributions of walls to a row. */
struct row_sides {
  struct row_force pairs, moved;
  struct row_wall near;
  struct site_terms terms;
};

static void budget_row(const struct pass *pass, size_t i, const struct row_force *fluid,
                       const struct row_force *moved, const struct row_sides *walls,
                       struct pass_budget *sum) {
  const struct particles *p = pass->particles;
  const bool eulerian = pass->wall == PASS_EULERIAN,
             subvoxel = eulerian || pass->wall == PASS_SUBVOXEL;
  const double gradient = pass->g_scale, square = pass->sound_speed * pass->sound_speed;
  struct site_terms terms = walls->terms;
  const double state = (double)p->state[i], kept = eulerian ? terms.kept : 1 - walls->near.beta;
  double drag = 2 * pass->kinematic_viscosity * pass->l_scale, stiff = 0;
  double pressure[3] = {fluid->pressure[0], fluid->pressure[1], fluid->pressure[2]};
  if (pass->wall == PASS_FROZEN) drag *= state;
  if (subvoxel) stiff = drag / kept * (eulerian ? terms.weight : walls->near.weight);
  if (eulerian) times(terms.correction, pressure);
  for (int a = 0; a < 3; a++) {
    const double v = (double)p->v[a][i], viscous = drag * fluid->velocity[a];
    const double pressed = gradient * square * (pressure[a] + walls->pairs.pressure[a]);
    const double shifted = gradient * (moved->velocity[a] + walls->moved.velocity[a]);
    double friction = drag * walls->pairs.velocity[a];
    if (subvoxel) friction = drag / kept * (fluid->velocity[a] + walls->near.drag[a]) - viscous;
    const double change = momentum_change(pass, a, pressed) + viscous + friction + shifted;
    const double next = momentum_next(pass, v, change, pass->dt * stiff);
    friction -= stiff * next;
    const double mean = 0.5 * (v + next);
    sum->momentum[a] += v;
    sum->kinetic += 0.5 * v * v;
    sum->force_work += pass->force[a] * mean;
    sum->pressure[a] += pressed;
    sum->pressure_work += pressed * mean;
    sum->viscous[a] += viscous;
    sum->viscous_work += viscous * mean;
    sum->friction[a] += friction;
    sum->friction_work += friction * mean;
    sum->shift[a] += shifted;
    sum->shift_work += shifted * mean;
    double wall = walls->pairs.pressure[a];
    if (pass->wall == PASS_ADAMI) wall -= 2 * state * walls->moved.concentration[a];
    if (subvoxel) wall = -2 * state * walls->near.offsets[a];
    if (eulerian) wall = pressure[a] - fluid->pressure[a] + 2 * state * moved->concentration[a];
    sum->wall_pressure[a] += gradient * square * wall;
  }
  sum->elastic += square * elastic(pass, state);
}

static void budget(const struct pass *pass, struct local *local, size_t begin, size_t end) {
  const struct particles *p = pass->particles;
  const bool subvoxel = pass->wall == PASS_SUBVOXEL, moving = p->wall_velocity != NULL;
  const float *fields[4] = {p->v[0], p->v[1], p->v[2], p->state};
  const float *wall_fields[4] = {p->wall_v[0], p->wall_v[1], p->wall_v[2], p->wall_state};
  struct pass_budget *sum = &pass->budget[begin / PASS_BLOCK];
  memset(sum, 0, sizeof *sum);
  for (size_t c = begin; c < end; c++) {
    struct row_force fluid[CLUSTER], moved[CLUSTER];
    struct row_sides walls[CLUSTER];
    struct reference ref;
    vec at[3];
    size_t n = gather_fluid(pass, local, c, 4, fields, &ref);
    gather_terms(pass, local, n);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      row_position(pass, &ref, l, at);
      row_budget(pass, local, n, at, c * CLUSTER + (size_t)l, &fluid[l], &moved[l]);
    }
    memset(walls, 0, sizeof walls);
    n = 0;
    if (pass->wall != PASS_OPEN && pass->wall != PASS_EULERIAN)
      n = gather_columns(pass, local, 0, pass->fluid_wall, c, true, &ref,
                         !subvoxel ? 4
                         : moving  ? 3
                                   : 0,
                         wall_fields,
                         (subvoxel ? GATHER_DEPTH : 0) |
                             (pass->wall == PASS_ADAMI ? 0 : GATHER_MOVE));
    n = pad_columns(local, n, 4);
    if (!subvoxel) gather_terms(pass, local, n);
    for (int l = 0; l < CLUSTER; l++) {
      if (!ref.live[l]) continue;
      const size_t i = c * CLUSTER + (size_t)l;
      row_position(pass, &ref, l, at);
      if (pass->wall == PASS_EULERIAN) site_terms_load(p, i, &walls[l].terms);
      if (n > 0 && subvoxel && moving)
        row_force_subvoxel(pass, local, 0, n, at, i, true, &walls[l].near);
      else if (n > 0 && subvoxel)
        row_force_subvoxel(pass, local, 0, n, at, i, false, &walls[l].near);
      else if (n > 0)
        row_budget(pass, local, n, at, i, &walls[l].pairs, &walls[l].moved);
      if (!moving) memset(walls[l].near.drag, 0, sizeof walls[l].near.drag);
      budget_row(pass, i, &fluid[l], &moved[l], &walls[l], sum);
    }
  }
}

#endif
