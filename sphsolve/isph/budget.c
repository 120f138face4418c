/* Balance of momentum and energy. For a particle with the mass m of water, pore velocity u =
 * v_D/eps and inertia I = C_r/(eps G), which includes that added by soil (drag_linear.h; I = eps =
 * 1 in free water), the equation of motion is
 *   m I dv_D/dt = m [ f - grad P/rho_w + viscous + drag ].
 * It conserves the momentum sum m I v_D and, multiplied by u, the kinetic energy sum m I v_D^2/(2
 * eps). A step takes v^n to v^{n+1} with every force as it was applied,
 *   m I (v^{n+1} - v^n) = dt sum F,
 *   T^{n+1} - T^n = dt sum F.u^{n+1} - sum (m I/(2 eps)) |v^{n+1} - v^n|^2,
 * where the last term is the dissipation by the time step (it never adds energy). These are
 * identities: the energy balance closes to rounding as long as no effect is forgotten. The implicit
 * drag is, at v^{n+1},
 *   -a v^{n+1} - b (2 |v^n| v^{n+1} - |v^n| v^n)                               (drag_linear.h)
 * and grad P is that of correct() in isph/step.c. To these are added the changes that are not
 * forces: the guards at walls, shifting (its change of velocity, and the weight it lifts),
 * straightening at open sides, the bound of isph/energy.c, particles that move into other soil at
 * the same v_D (soil_entry), and particles that enter or leave.
 *
 * Pressure acts both on the water and, as a reaction, on walls, open sides and soil; the two sides
 * are summed independently. Momentum of walls: from the pressure of the particles before them,
 * extrapolated to the wall,
 *   F = sum_i sum_w eps_i V_i V_w slope (P_i + P_w) r_iw,   P_w = P_i - rho f.r_iw
 * with f along closed axes (along periodic ones it makes no pressure). For a planar wall and a P
 * linear in space this is exactly the integral of P over the face if sum V slope r r = 1: a pair n
 * spacings long crosses the face n times, at P's mean on the face. Open sides: the same with their
 * own pressure. Soil: sum V P grad eps. The water gets -grad P from pressure differences that
 * involve no wall, summed particle by particle. The difference between action and reaction is a
 * term of its own (projection), which also takes up what viscous pairs do not exchange exactly (m_i
 * V_j differs from m_j V_i between particles of different porosity). Energy: the pressure's work on
 * the water is summed particle by particle; that of moving walls, open sides and the relaxation (P
 * div v as prescribed) separately. The rest is work that an exact projection would not do. What
 * then remains unaccounted for in momentum and energy is what no effect has counted: rounding. */
#include "sphsolve/isph/budget.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/isph/effects/artificial_viscosity.h"
#include "sphsolve/isph/effects/drag_forchheimer.h"
#include "sphsolve/isph/effects/relaxation.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/vector.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/wall.h"

static double porosity_of(const struct isph *s, size_t i) {
  return s->on.soil ? s->porosity[i] : 1;
}

static double inertia_of(const struct isph *s, size_t i) {
  return s->on.soil ? s->inertia[i] : 1;
}

static void add_force(struct budget_sums *sums, enum budget_term term, double scale,
                      const double force[3], const double u[3]) {
  for (int a = 0; a < 3; a++) sums->impulse[term][a] += scale * force[a];
  sums->work[term] += scale * dot(force, u);
}

/* Adds `sign` times the momentum m I v and the energy m I v^2/(2 eps). */
static void add_stored(double mass, double inertia, double porosity, const double v[3], double sign,
                       double momentum[3], double *energy) {
  for (int a = 0; a < 3; a++) momentum[a] += sign * mass * inertia * v[a];
  *energy += sign * 0.5 * mass * inertia / porosity * dot(v, v);
}

static void sum_stored(const struct isph *s, double momentum[3], double *energy) {
  double total[4];
#pragma omp parallel for schedule(static)
  for (size_t c = 0; c < s->chunk_count; c++) {
    double sum[4] = {0};
    for (size_t i = s->chunks[c].begin; i < s->chunks[c].end; i++)
      add_stored(s->mass[i] * s->thickness, inertia_of(s, i), porosity_of(s, i), s->velocity[i], 1,
                 sum, &sum[3]);
    memcpy(s->sums[c], sum, sizeof sum);
  }
  isph_sum_chunks(s, 4, total);
  memcpy(momentum, total, 3 * sizeof *total);
  *energy = total[3];
}

void isph_budget_begin(struct isph *s) {
  bool walls = s->boundary_count > 0;
  for (int a = 0; a < 3; a++) walls = walls || s->reflects[a][0] || s->reflects[a][1];
  uint32_t on = s->on.budget | 1u << BUDGET_TIME_STEP;
  memset(&s->budget, 0, sizeof s->budget);
  if (dot(s->force, s->force) > 0) on |= 1u << BUDGET_FORCE;
  if (walls) on |= 1u << BUDGET_WALL_PRESSURE | 1u << BUDGET_LOST | 1u << BUDGET_WALL_GUARD;
  if (walls && s->on.viscous && s->on.no_slip) on |= 1u << BUDGET_WALL_FRICTION;
  for (size_t k = 0; k < s->on.own_count; k++) {
    on |= 1u << (BUDGET_OWN + k);
    snprintf(s->budget.own[k], sizeof s->budget.own[k], "%s", s->on.own[k]->name);
  }
  s->budget.on = on;
  sum_stored(s, s->budget.momentum[0], &s->budget.energy[0]);
}

/* Pressure of reflecting sides on particle i; `scale` as in budget_sides. */
static void budget_reflected(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                             const double f[3], double scale, struct budget_sums *sums) {
  static const double still[3] = {0};
  four sum = {0}, r, way;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    if (!isph_is_reflected(IMAGES_REFLECTED, s, entry)) continue;
    isph_separation_four(IMAGES_REFLECTED, s, i, entry, &r);
    isph_fall_way(IMAGES_REFLECTED, s, i, entry, &r, &way);
    way -= r;
    const double pressure = s->pressure[i] + s->pressure[j] + s->density * FOUR_DOT(way, f);
    sum += s->volume[j] * (double)chunk->slope[p] * pressure * r;
  }
  add_force(sums, BUDGET_WALL_PRESSURE, scale, (double[3]){sum[0], sum[1], sum[2]}, still);
}

/* Pressure of walls and open sides on particle i, and the work of moving ones. `scale`: m dt / rho.
 */
static void budget_sides(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                         double scale, const double u[3], struct budget_sums *sums) {
  const double *x = s->position[i];
  double f[3] = {0};
  for (int a = 0; a < 3; a++) f[a] = s->periodic[a] ? 0 : s->force[a];
  if (s->images[i] == IMAGES_REFLECTED) budget_reflected(s, chunk, i, f, scale, sums);
  for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
    uint32_t entry = chunk->wall[p], j = entry & PAIR_MASK;
    double r[3] = {0}, weight = scale * isph_wall_volume(s, j) * (double)chunk->wall_slope[p];
    isph_separation(s, x, s->boundary_position, entry, r);
    if (s->boundary_kind[j] == BOUNDARY_WALL) {
      const double pressure = 2 * s->pressure[i] - s->density * dot(f, r);
      add_force(sums, BUDGET_WALL_PRESSURE, weight * pressure, r, isph_wall_velocity(s, j));
    } else {
      const bool head = s->boundary_kind[j] == BOUNDARY_OPEN_HEAD;
      const double pressure =
          head ? 2 * s->boundary_pressure[j] : 2 * s->pressure[i] - s->density * dot(f, r);
      add_force(sums, BUDGET_OPEN_SIDES, weight * pressure, r, u);
    }
  }
}

/* V P grad eps of particle i at an edge of soil. `scale`: m dt / (eps rho), that is V dt. */
static void budget_soil(const struct isph *s, const struct isph_chunk *chunk, size_t i,
                        double scale, struct budget_sums *sums) {
  const double still[3] = {0}, *soil = still;
  const float *l = s->correction[i];
  double gradient[3] = {0};
  four g = {0}, r;
  if (s->on.moving_soil) soil = s->soil_velocity[i];
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    uint32_t j = chunk->pair[p] & PAIR_MASK;
    const double d = s->volume[j] * (double)chunk->slope[p] * (s->porosity[i] - s->porosity[j]);
    isph_separation_four(IMAGES_REFLECTED, s, i, chunk->pair[p], &r);
    g += d * r;
  }
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) gradient[a] += (double)l[3 * b + a] * g[b];
  add_force(sums, BUDGET_SOIL_PRESSURE, scale * s->pressure[i], gradient, soil);
}

void isph_budget_drag(const struct isph *s, size_t i, const double v[3], const double before[3],
                      double linear[3], double forchheimer[3]) {
  const double eps = s->porosity[i];
  double own[3] = {0}, square = 0;
  for (int a = 0; a < 3; a++) {
    if (s->on.moving_soil) own[a] = eps * s->soil_velocity[i][a];
    square += (before[a] - own[a]) * (before[a] - own[a]);
  }
  const double speed = sqrt(square);
  for (int a = 0; a < 3; a++) {
    linear[a] = -s->drag_a[i] * (v[a] - own[a]);
    forchheimer[a] = -s->drag_b[i] * speed * (2 * (v[a] - own[a]) - (before[a] - own[a]));
  }
  if (s->on.interfaces) {
    const struct isph_interface *along = &s->interface[i];
    isph_interface_turn(along, isph_interface_ratio(along->drag_a, s->drag_a[i]), linear);
    isph_interface_turn(along, isph_interface_ratio(along->drag_b, s->drag_b[i]), forchheimer);
  }
}

/* Whether particle i is at an edge of soil, where its paths differ in resistance. */
static bool is_at_edge(const struct isph *s, size_t i) {
  return s->on.links && s->ground[i] == GROUND_MIXED;
}

/* The inertia of particle i times x: across an edge that of the links. */
static void times_inertia(const struct isph *s, size_t i, const double x[3], double y[3]) {
  const double inertia = inertia_of(s, i);
  for (int a = 0; a < 3; a++) y[a] = inertia * x[a];
  if (!is_at_edge(s, i)) return;
  const struct isph_linked *linked = &s->linked[i];
  isph_link_across(linked, (linked->inertia - inertia) * dot(linked->normal, x), y);
}

/* Drag of soil on particle i. At an edge it is what the pressure gradient and the other forces do
 * beyond accelerating the water: the particle's own drag, at its velocity, would be that of clay on
 * water that passes it in gravel. By how much momentum and energy take another inertia there than
 * the links' is work of the projection. */
static void budget_drag(const struct isph *s, size_t i, double m, double dt, const double before[3],
                        const double u[3], struct budget_sums *sums) {
  const struct isph_applied *applied = &s->applied[i];
  double linear[3], forchheimer[3], gains[3], given[3], rest[3];
  isph_budget_drag(s, i, s->velocity[i], before, linear, forchheimer);
  if (is_at_edge(s, i)) {
    const double slow = s->drag_a[i] + s->linked[i].drag_a;
    const double fast = s->drag_b[i] * isph_speed_through_soil(s, i) + s->linked[i].drag_b;
    const double share = fast > 0 ? slow / (slow + fast) : s->on.drag_linear;
    for (int a = 0; a < 3; a++) gains[a] = s->velocity[i][a] - before[a];
    times_inertia(s, i, gains, given);
    for (int a = 0; a < 3; a++) rest[a] = s->inertia[i] * gains[a] - given[a];
    add_force(sums, BUDGET_PROJECTION, m, rest, u);
    for (int a = 0; a < 3; a++) gains[a] -= applied->straightened[a];
    times_inertia(s, i, gains, given);
    for (int a = 0; a < 3; a++) {
      double drag = given[a] / dt + applied->pressure[a] / s->density;
      drag -= applied->viscous[a] + applied->friction[a];
      for (size_t k = 0; k < s->on.own_count; k++)
        if (s->own_force[k] != NULL) drag -= s->own_force[k][i][a];
      linear[a] = share * drag, forchheimer[a] = (1 - share) * drag;
    }
  }
  const bool quadratic = s->on.drag_forchheimer;
  add_force(sums, BUDGET_DRAG_LINEAR, m * dt, linear, u);
  add_force(sums, quadratic ? BUDGET_DRAG_FORCHHEIMER : BUDGET_PROJECTION, m * dt, forchheimer, u);
}

/* Splits the viscous force of the pairs between laminar viscosity and whichever is the larger of
 * nu_T and nu_c. */
static void budget_viscosity(const struct isph *s, size_t i, double scale, const double u[3],
                             struct budget_sums *sums) {
  const struct isph_applied *applied = &s->applied[i];
  const double eps = porosity_of(s, i), thick = s->eddy[i] * eps;
  const double own = thick > 0 ? s->kinematic_viscosity / thick : 1;
  const double least = isph_artificial_viscosity_at(s, i) * (1 + 1e-9); /* rounding */
  const bool artificial =
      s->on.artificial_viscosity && (!s->on.turbulence || thick - s->kinematic_viscosity <= least);
  const enum budget_term more = artificial ? BUDGET_ARTIFICIAL_VISCOSITY : BUDGET_TURBULENCE;
  add_force(sums, BUDGET_VISCOSITY, scale * own, applied->viscous, u);
  add_force(sums, more, scale * (1 - own), applied->viscous, u);
  add_force(sums, BUDGET_WALL_FRICTION, scale, applied->friction, u);
  if (s->calm != NULL) add_force(sums, BUDGET_ARTIFICIAL_VISCOSITY, scale, s->biharmonic[i], u);
}

/* Effects that add a force, or a pressure outside the surface. The latter's part of the corrector's
 * gradient (surface_close) is taken out of `pressed`, since it does not belong to the projection.
 */
static void budget_own(const struct isph *s, size_t i, double scale, const double u[3],
                       double pressed[3], struct budget_sums *sums) {
  for (size_t k = 0; k < s->on.own_count; k++) {
    if (s->own_force[k] != NULL) add_force(sums, BUDGET_OWN + k, scale, s->own_force[k][i], u);
    if (s->on.own[k]->surface_pressure == NULL) continue;
    double outside[3];
    for (int a = 0; a < 3; a++) {
      outside[a] = -2 * s->surface[i] * s->surface_pressure[i] * s->gradient_sum[i][a] / s->density;
      pressed[a] -= outside[a];
    }
    add_force(sums, BUDGET_OWN + k, scale, outside, u);
  }
}

TARGETS static void budget_chunk(const struct isph *s, struct isph_chunk *chunk, double dt) {
  struct budget_sums *sums = &chunk->budget;
  memset(sums, 0, sizeof *sums);
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const double m = s->mass[i] * s->thickness, eps = porosity_of(s, i), *f = s->force;
    const double inertia = inertia_of(s, i), *v = s->velocity[i];
    const double *applied = s->applied[i].pressure;
    double u[3] = {0}, before[3], pressed[3] = {0}, square = 0;
    for (int a = 0; a < 3; a++) {
      u[a] = v[a] / eps;
      before[a] = 2 * s->predicted[i][a] - v[a]; /* see correct() */
      pressed[a] = -applied[a] / s->density - f[a];
      square += (v[a] - before[a]) * (v[a] - before[a]);
      sums->impulse[BUDGET_FORCE][a] += m * dt * f[a];
    }
    budget_own(s, i, m * dt, u, pressed, sums);
    add_force(sums, BUDGET_PROJECTION, m * dt, pressed, u);
    sums->work[BUDGET_TIME_STEP] -= 0.5 * m * inertia / eps * square;
    if (s->on.viscous) budget_viscosity(s, i, m * dt, u, sums);
    if (s->on.soil) budget_drag(s, i, m, dt, before, u, sums);
    if (s->on.soil && s->soil_fraction[i] > 0 && s->soil_fraction[i] < 1)
      budget_soil(s, chunk, i, m * dt / (eps * s->density), sums);
    budget_sides(s, chunk, i, m * dt / s->density, u, sums);
    if (s->on.open_sides) {
      double given[3];
      times_inertia(s, i, s->applied[i].straightened, given);
      const double left = s->on.soil && !is_at_edge(s, i) ? s->drag_factor[i] : 1;
      add_force(sums, BUDGET_STRAIGHTENING, m / left, given, u);
    }
    const double power = s->volume[i] * s->thickness * s->pressure[i] * dt;
    if (s->on.relaxation)
      sums->work[BUDGET_RELAXATION] -= power * relaxation_source(s, i, s->relaxation_time);
    if (s->on.wells)
      sums->work[BUDGET_LEFT] -= s->outlet[i].flow * s->thickness * s->pressure[i] * dt;
    if (s->on.moving_soil) sums->work[BUDGET_SOIL_PRESSURE] -= power * s->porosity_rate[i];
  }
  const enum budget_term does[] = {BUDGET_WALL_PRESSURE, BUDGET_OPEN_SIDES, BUDGET_RELAXATION,
                                   BUDGET_SOIL_PRESSURE, BUDGET_LEFT};
  for (size_t t = 0; t < sizeof does / sizeof *does; t++) {
    sums->work[BUDGET_PROJECTION] -= sums->work[does[t]];
    for (int a = 0; a < 3; a++) sums->impulse[BUDGET_PROJECTION][a] -= sums->impulse[does[t]][a];
  }
}

void isph_budget_forces(struct isph *s, double dt) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) budget_chunk(s, &s->chunks[c], dt);
}

void isph_budget_change(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                        size_t i, const double from[3]) {
  const double m = s->mass[i] * s->thickness, eps = porosity_of(s, i), in = inertia_of(s, i);
  add_stored(m, in, eps, s->velocity[i], 1, sums->impulse[term], &sums->work[term]);
  add_stored(m, in, eps, from, -1, sums->impulse[term], &sums->work[term]);
}

void isph_budget_displacement(const struct isph *s, struct budget_sums *sums, enum budget_term term,
                              size_t i, const double displacement[3]) {
  const double given = s->mass[i] * s->thickness * dot(s->force, displacement);
  sums->work[BUDGET_FORCE] += given;
  if (term != BUDGET_FORCE) sums->work[term] -= given;
}

void isph_budget_moved(struct isph *s) {
  isph_sum_budgets(s);
  if (s->on.soil) sum_stored(s, s->budget_stored, &s->budget_stored[3]);
}

void isph_budget_removed(struct isph *s, enum budget_term term, const struct isph_removed *gone) {
  const double m = gone->mass * s->thickness, in = gone->inertia, eps = gone->porosity;
  const double *v = gone->velocity;
  add_stored(m, in, eps, v, -1, s->budget.sums.impulse[term], &s->budget.sums.work[term]);
  add_stored(m, in, eps, v, -1, s->budget_stored, &s->budget_stored[3]);
}

void isph_budget_entered(struct isph *s, const double position[3], const double velocity[3],
                         double mass) {
  struct soil_point soil = {.porosity = 1, .inertia = 1};
  struct budget_sums *sums = &s->budget.sums;
  if (s->on.soil) isph_soil_at(s, position, 0, &soil);
  add_stored(mass * s->thickness, soil.inertia, soil.porosity, velocity, 1,
             sums->impulse[BUDGET_ENTERED], &sums->work[BUDGET_ENTERED]);
  add_stored(mass * s->thickness, soil.inertia, soil.porosity, velocity, 1, s->budget_stored,
             &s->budget_stored[3]);
}

void isph_budget_settled(struct isph *s) {
  struct budget_sums *sums = &s->budget.sums;
  double now[4];
  if (!s->on.soil) return;
  sum_stored(s, now, &now[3]);
  for (int a = 0; a < 3; a++) sums->impulse[BUDGET_SOIL_ENTRY][a] += now[a] - s->budget_stored[a];
  sums->work[BUDGET_SOIL_ENTRY] += now[3] - s->budget_stored[3];
}

void isph_budget_end(struct isph *s) {
  sum_stored(s, s->budget.momentum[1], &s->budget.energy[1]);
}
