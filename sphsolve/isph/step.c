#include "sphsolve/isph/step.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/variants.h"
#include "sphsolve/isph/effects/drag_linear.h"
#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/biharmonic.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/images.h"
#include "sphsolve/isph/interface.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/threads.h"
#include "sphsolve/isph/viscosity.h"
#include "sphsolve/isph/enclosed.h"
#include "sphsolve/isph/mobility.h"
#include "sphsolve/isph/motion.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/outside.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/pressure.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/window.h"

/* Adds up g = grad v of particle i, without its correction; along sides with slip, images are
 * neighbours like others. */
ROW void velocity_gradient(enum isph_images images, const struct isph *s,
                           const struct isph_chunk *chunk, size_t i, double g[9]) {
  four sum[3] = {{0}}, r, vj;
  const bool held = isph_sides_hold(s);
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    uint32_t j = chunk->pair[p] & PAIR_MASK;
    if (held && isph_is_reflected(images, s, chunk->pair[p])) continue;
    isph_separation_four(images, s, i, chunk->pair[p], &r);
    isph_turn_four(images, s, chunk->pair[p], s->velocity[j], &vj);
    const double weight = s->volume[j] * (double)chunk->slope[p];
    const four d = weight * (FOUR(s->velocity[i]) - vj);
    for (int a = 0; a < 3; a++) sum[a] += d[a] * r;
  }
  for (int a = 0; a < 9; a++) g[a] = sum[a / 3][a % 3];
}

TARGETS static void find_velocity_gradient(const struct isph *s, const struct isph_chunk *chunk) {
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    double g[9];
    ISPH_ROW(s, i, velocity_gradient, s, chunk, i, g);
    const float *l = s->correction[i];
    for (int a = 0; a < 3; a++)
      for (int b = 0; b < 3; b++)
        s->gradient[i][3 * a + b] =
            (float)(g[3 * a] * (double)l[b] + g[3 * a + 1] * (double)l[3 + b] +
                    g[3 * a + 2] * (double)l[6 + b]);
  }
}

static void find_velocity_gradients(struct isph *s) {
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) find_velocity_gradient(s, &s->chunks[c]);
}

/* Predictor: v* without the driving force, and the mobility k = B T / rho_w; the equation of motion
 * is divided by G. */
static void predict(struct isph *s, double dt) {
  bool paper = s->scene->isph.form == FORM_M15;
  if (s->calm != NULL) isph_biharmonic_begin(s);
  if (s->ground != NULL) isph_links_begin(s);
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) {
    struct isph_chunk *chunk = &s->chunks[c];
    for (size_t i = chunk->begin; i < chunk->end; i++) {
      const double *v = s->velocity[i];
      double force[3] = {0}, t = dt, left = 1, own[3] = {0};
      struct isph_applied *applied = &s->applied[i];
      struct isph_links links;
      memset(applied, 0, sizeof *applied);
      if (s->ground != NULL) isph_link(s, chunk, i, dt, &links);
      if (s->eddy != NULL) isph_viscous(s, chunk, i, applied->viscous, applied->friction);
      if (s->porosity != NULL) {
        double eps = s->porosity[i], b = s->drag_b[i];
        t = dt / s->inertia[i];
        if (paper)
          for (int a = 0; a < 3; a++) applied->viscous[a] *= eps, applied->friction[a] *= eps;
        if (s->soil_velocity != NULL)
          for (int a = 0; a < 3; a++) own[a] = eps * s->soil_velocity[i][a];
        double u[3] = {v[0] - own[0], v[1] - own[1], v[2] - own[2]};
        double speed = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
        left = drag_factor(t, s->drag_a[i], b, speed);
        s->drag_factor[i] = left;
        for (int a = 0; a < 3; a++) force[a] = b * speed * u[a];
        if (s->interface != NULL) {
          struct isph_interface *along = &s->interface[i];
          along->drag_factor = drag_factor(t, along->drag_a, along->drag_b, speed);
          along->mobility = along->drag_factor * t / s->density;
          isph_interface_turn(along, isph_interface_ratio(along->drag_b, b), force);
        }
      }
      for (int a = 0; a < 3; a++) force[a] += applied->viscous[a] + applied->friction[a];
      if (s->calm != NULL) isph_biharmonic(s, chunk, i, force);
      for (size_t k = 0; k < s->on.own_count; k++)
        for (int a = 0; a < 3 && s->own_force[k] != NULL; a++) force[a] += s->own_force[k][i][a];
      s->mobility[i] = left * t / s->density;
      double *to = s->predicted[i];
      for (int a = 0; a < 3; a++) to[a] = left * (v[a] - own[a] + t * force[a]);
      if (s->interface != NULL)
        isph_interface_turn(&s->interface[i], s->interface[i].drag_factor / left, to);
      if (s->ground != NULL) {
        const double u[3] = {v[0] - own[0], v[1] - own[1], v[2] - own[2]};
        isph_link_predict(s, i, &links, u, t, to);
      }
      for (int a = 0; a < 3; a++) to[a] += own[a];
    }
  }
}

/* The pressure without its hydrostatic part, q = P - rho f.x of all particles, and by image code
 * what q rises by across periodic sides. */
struct reduced_pressure {
  const double *q;
  double across[27];
};

/* Sets the gradient of q (`reduced`) from the pairs of particle i, and that of P (`own`) unless
 * NULL. Where mobilities differ, also `flux` for isph_edge_turn, and the sums `edge` until they are
 * known; otherwise these are NULL. */
ROW void pressure_gradient(enum isph_images images, const struct isph *s,
                           const struct isph_chunk *chunk, size_t i,
                           const struct reduced_pressure *pressure, const double f[3],
                           double reduced[3], double own[3], double flux[3],
                           struct isph_edge *edge) {
  const double *q = pressure->q, rho = s->density, k = s->mobility[i];
  four r, by_fall = {0}, by_force = {0}, by_flux = {0};
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    isph_separation_four(images, s, i, entry, &r);
    const double weight = s->volume[j] * (double)chunk->slope[p];
    const double over = images == IMAGES_NONE ? 0 : pressure->across[entry >> PAIR_BITS];
    const double fall = q[i] - q[j] - over;
    by_fall += weight * fall * r;
    if (own != NULL) by_force += weight * rho * FOUR_DOT(r, f) * r;
    if (flux == NULL) continue;
    const double kij = isph_mobility_between(s, chunk, p, i, j) / k;
    by_flux += weight * kij * fall * r;
    if (edge != NULL) isph_edge_add(edge, kij, weight, (double[3]){r[0], r[1], r[2]});
  }
  for (int a = 0; a < 3; a++) reduced[a] = by_fall[a];
  for (int a = 0; a < 3 && own != NULL; a++) own[a] = by_fall[a] + by_force[a];
  for (int a = 0; a < 3 && flux != NULL; a++) flux[a] = by_flux[a];
}

/* The corrector (leaves the mean of v^n and v^{n+1} in v*):
 *   v^{n+1} = v* - k grad q,   q = P - rho f.x the pressure without its hydrostatic part,
 *   grad q = sum_j V_j (q_j - q_i) grad W + 2 w (q_i - q_s) sum V grad W,   q_s = -rho f.x_s;
 * the second term is that of the surface, walls have q_w = q_i. In water at rest q is the same
 * everywhere and nothing moves. The gradient is the adjoint of the divergence up to terms in sum V
 * grad W, so that pressure takes energy from the flow and never adds any. (The full adjoint, with 2
 * q_i sum V grad W inside the water too, only adds noise.) In free water it is corrected to be
 * exact for linear fields (isph/linear.h), which noise costs less than the adjoint saves. In soil
 * the part of the moment along a wall that is missing beside it is compensated for, except beside
 * an outline, where images supply it; without this, a column ten particles wide carries 2 % too
 * little. In free water that would keep eddies alive at rest. */
TARGETS static void correct_chunk(const struct isph *s, const struct isph_chunk *chunk,
                                  const struct reduced_pressure *q) {
  const bool again = s->solve.again;
  static const double none[3] = {0};
  const double *f = again ? none : s->force, rho = s->density, held = again ? 0 : 1;
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const double *xi = s->position[i];
    const bool edges = s->ground != NULL ? s->ground[i] == GROUND_MIXED
                                         : s->porosity != NULL && s->surface == NULL;
    double k = s->mobility[i], pressure = s->pressure[i], reduced[3] = {0}, own[3] = {0};
    double flux[3] = {0}, plain[3], turn[3] = {0}; /* turn: what an edge adds to the gradient */
    struct isph_edge_frame here, *frame = s->ground != NULL ? &s->linked[i].edge : &here;
    /* share of the moment present along each axis, walls left out */
    double present[3] = {1, 1, 1};
    if (edges && again && s->ground != NULL) {
      ISPH_ROW(s, i, pressure_gradient, s, chunk, i, q, f, reduced, own, flux, NULL);
    } else if (edges) {
      struct isph_edge edge = {.level = 0};
      ISPH_ROW(s, i, pressure_gradient, s, chunk, i, q, f, reduced, own, flux, &edge);
      isph_edge_find(&edge, s->interface != NULL ? s->interface[i].normal : NULL, frame);
    } else if (s->surface != NULL && !again && surface_falls(s, i)) {
      ISPH_ROW(s, i, pressure_gradient, s, chunk, i, q, f, reduced, own, NULL, NULL);
    } else {
      ISPH_ROW(s, i, pressure_gradient, s, chunk, i, q, f, reduced, NULL, NULL, NULL);
    }
    if (isph_faces_outline(s, i))
      isph_outline_gradient(s, chunk, i, q->q, q->across, reduced, flux);
    memcpy(plain, reduced, sizeof plain);
    for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
      uint32_t entry = chunk->wall[p], j = entry & PAIR_MASK;
      double r[3];
      isph_separation(s, xi, s->boundary_position, entry, r);
      if (s->boundary_kind[j] != BOUNDARY_OPEN_HEAD) {
        if (s->porosity == NULL || s->soil_fraction[i] == 0 || isph_is_of_outline(s, j)) continue;
        double xj[3] = {xi[0] - r[0], xi[1] - r[1], xi[2] - r[2]}, mirror[6];
        isph_wall_mirror(s, i, j, xj, mirror, NULL);
        double weight = isph_wall_volume(s, j) * (double)chunk->wall_slope[p];
        for (int a = 0; a < 3; a++)
          present[a] -=
              s->soil_fraction[i] * (1 - mirror[symmetric_diagonal[a]]) * weight * r[a] * r[a];
        continue;
      }
      double side[3], stretch = isph_window_stretch(s, xi, entry, r, side);
      double weight = isph_wall_volume(s, j) * (double)chunk->wall_slope[p] * stretch;
      double drop = pressure - held * s->boundary_pressure[j];
      double fall = drop - rho * (f[0] * side[0] + f[1] * side[1] + f[2] * side[2]);
      for (int a = 0; a < 3; a++)
        reduced[a] += weight * fall * r[a], own[a] += weight * drop * r[a];
    }
    if (s->on.wells) isph_wells_gradient(s, i, reduced), isph_wells_gradient(s, i, own);
    for (int a = 0; a < 3; a++) {
      present[a] = fmax(0.5, present[a]);
      reduced[a] /= present[a], flux[a] /= present[a], turn[a] = plain[a] /= present[a];
    }
    if (edges) isph_edge_turn(frame, flux, turn);
    for (int a = 0; a < 3; a++) turn[a] -= plain[a];
    if (s->linear != NULL) isph_linear_correct(s, i, reduced), isph_linear_correct(s, i, own);
    double whole = s->surface != NULL ? surface_close(s, i, reduced, own) : 1;
    double change[3], gradient[3];
    for (int a = 0; a < 3; a++) {
      gradient[a] = whole * reduced[a] + (1 - whole) * (own[a] - rho * f[a]);
      change[a] = k * (gradient[a] + whole * turn[a]);
    }
    const double across = edges ? dot(frame->normal, turn) : 0;
    for (int a = 0; a < 3 && edges && s->ground != NULL; a++) turn[a] -= across * frame->normal[a];
    if (s->interface != NULL)
      isph_interface_turn(&s->interface[i], s->interface[i].mobility / k, change);
    for (int a = 0; a < 3; a++) {
      double old = s->velocity[i][a], step = change[a];
      s->applied[i].pressure[a] += gradient[a] + whole * turn[a];
      if (again) {
        s->velocity[i][a] -= step;
        s->predicted[i][a] -= 0.5 * step;
        continue;
      }
      s->velocity[i][a] = s->predicted[i][a] - step;
      s->predicted[i][a] = 0.5 * (old + s->velocity[i][a]);
    }
  }
}

static void correct(struct isph *s) {
  struct reduced_pressure reduced = {.q = s->pressure};
  if (!s->solve.again) { /* the second pressure is an increment */
    double *q = s->work[0];
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < s->count; i++)
      q[i] = s->pressure[i] - s->density * dot(s->force, s->position[i]);
    for (int code = 0; code < 27; code++)
      for (int a = 0; a < 3; a++)
        if (s->image[code].turn[a] > 0)
          reduced.across[code] -= s->density * s->force[a] * s->image[code].shift[a];
    reduced.q = q;
  }
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) correct_chunk(s, &s->chunks[c], &reduced);
}

/* Water with a surface bears no tension: P >= 0, so that it can break up. If no force acts on it,
 * negative pressures are kept inside, but not on the surface: a rotating body of water has P < 0
 * inside and would otherwise fall apart. */
static void remove_tension(struct isph *s) {
  bool holds = isph_is_unforced(s);
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    double least = holds ? (1 - s->surface[i]) * s->pressure[i] : 0;
    if (s->surface_pressure != NULL) least += s->surface[i] * fmin(0, s->surface_pressure[i]);
    s->pressure[i] = fmax(least, s->pressure[i]);
  }
}

/* Whether a step begins with the pressure of the last step as a first projection (incremental
 * pressure correction: Van Kan 1986, SIAM J. Sci. Stat. Comput. 7; Guermond, Minev, Shen 2006,
 * Comput. Methods Appl. Mech. Eng. 195, section 3.2), so that the one solve of the step is a second
 * projection. The error of an approximate projection is then proportional to the change of the
 * pressure in the step, not to the pressure: a single projection takes a tenth of a wave's energy
 * per period. Only in free water: in soil fronts and ponds are calibrated with the error that one
 * projection leaves. */
static bool carries_pressure(const struct isph *s) {
  return s->step > 0 && isph_is_free_water(s);
}

/* Adds `sign` times what the second projection of the last step gave to the pressure: both solves
 * of a step begin with what they gave in the last one. */
static void add_increment(struct isph *s, double sign) {
  for (size_t i = s->local.begin; i < s->local.end && s->increment != NULL; i++)
    s->pressure[i] += sign * s->increment[i];
}

/* A second projection, of the divergence that the first, approximate one has left; for water
 * without a surface in soil, and for water that carries its pressure over. Where the drag jumps,
 * that divergence is so large in a step of full length that the flux through a layer four particles
 * thick is 7 % too large (1 % with a sixth of the step, or with the second projection). */
static enum status project_again(struct isph *s, double dt) {
  enum status status = STATUS_OK;
  double *first = s->scratch;
  memcpy(first, s->pressure, s->count * sizeof *first);
  memset(s->pressure, 0, s->count * sizeof *first);
  add_increment(s, 1);
  s->solve.again = true;
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->velocity)});
  isph_assemble(s);
  double before = clock_seconds();
  TRY(isph_solve_pressure(s));
  ISPH_HOOK(s, solved, dt);
  before = clock_seconds() - before;
  s->seconds_solve += before, s->seconds_correct -= before;
  if (s->surface != NULL) { /* the conditions on the pressure apply to the sum of both */
    for (size_t i = s->local.begin; i < s->local.end; i++) s->pressure[i] += first[i];
    isph_enclosed_level(s);
    remove_tension(s);
    for (size_t i = s->local.begin; i < s->local.end; i++) s->pressure[i] -= first[i];
  }
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->pressure)});
  for (size_t i = s->local.begin; i < s->local.end && s->increment != NULL; i++)
    s->increment[i] = s->pressure[i];
  correct(s);
  for (size_t i = 0; i < s->count; i++) s->pressure[i] += first[i];
cleanup:
  s->solve.again = false;
  return status;
}

static enum status check_finite(const struct isph *s) {
  for (size_t i = s->local.begin; i < s->local.end; i++)
    for (int a = 0; a < 3; a++)
      if (!isfinite(s->velocity[i][a]))
        return FAIL(
            STATUS_NUMERIC, "velocity of particle %llu at (%.4g, %.4g, %.4g) m is no number",
            (unsigned long long)s->id[i], s->position[i][0], s->position[i][1], s->position[i][2]);
  return STATUS_OK;
}

/* Most solves in a step of which each is repeated because the pressure changes rows. */
#define SOLVES_MOST 20

/* Whether the pressure changes the rows of an active effect. */
static bool changes(struct isph *s) {
  bool any = false;
  for (size_t k = 0; k < s->on.active_count; k++)
    if (s->on.active[k]->changes != NULL && s->on.active[k]->changes(s)) any = true;
  return any;
}

enum status isph_project(struct isph *s, double dt) {
  enum status status = STATUS_OK;
  const struct scene *scene = s->scene;
  s->dt = dt;
  /* alpha refers to the scene's dt, if it gives one, also for a shorter last step. */
  s->relaxation_time = scene->isph.relaxation_time;
  if (!isnan(scene->isph.alpha))
    s->relaxation_time = (isnan(scene->isph.dt) ? dt : scene->isph.dt) / scene->isph.alpha;
  s->relaxation_time = fmax(s->relaxation_time, dt); /* a shorter time would overshoot */
  omp_set_num_threads(
      isph_threads(scene, (double)(s->local.end - s->local.begin), s->threads_most));
  isph_apply_tables(s, dt);
  double start = clock_seconds(), now;
  s->solve.carries = carries_pressure(s);
  if (s->gradient != NULL) find_velocity_gradients(s);
  if (s->calm != NULL) isph_calm_find(s);
  ISPH_HOOK(s, begin, dt);
  for (size_t k = 0; k < s->on.own_count; k++) {
    if (s->own_force[k] != NULL) s->on.own[k]->force(s, s->own_force[k]);
    if (s->on.own[k]->surface_pressure != NULL)
      s->on.own[k]->surface_pressure(s, s->surface_pressure);
  }
  predict(s, dt);
  ISPH_HOOK(s, predicted, dt);
  isph_send(s, 2, (struct ghost_field[]){ISPH_FIELD(s->predicted), ISPH_FIELD(s->mobility)});
  if (s->linked_mobility != NULL) isph_links_close(s);
  ISPH_HOOK(s, mobile, dt);
  isph_assemble(s);
  now = clock_seconds(), s->seconds_predict += now - start, start = now;
  add_increment(s, -1);
  if (s->solve.carries)
    isph_carry_pressure(s);
  else
    TRY(isph_solve_pressure(s));
  for (int n = 0; n < SOLVES_MOST && changes(s); n++) {
    isph_assemble(s);
    TRY(isph_solve_pressure(s));
  }
  ISPH_HOOK(s, solved, dt);
  now = clock_seconds(), s->seconds_solve += now - start, start = now;
  isph_enclosed_level(s);
  if (s->surface != NULL) remove_tension(s);
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->pressure)});
  correct(s);
  if (s->solve.carries || isph_projects_twice(s)) TRY(project_again(s, dt));
  s->seconds_correct += clock_seconds() - start;
cleanup:
  return status;
}

enum status isph_advance(struct isph *s, double dt) {
  enum status status = STATUS_OK;
  double *tried = NULL;
  if (s->step == 0 && dt == s->trial_dt && s->on.moving_walls) {
    TRY(memory_allocate(&tried, s->count, sizeof *tried, "pressure of the first step"));
    memcpy(tried, s->pressure, s->count * sizeof *tried);
  }
  TRY(isph_project(s, dt));
  double start = clock_seconds();
  TRY(ranks_agree(check_finite(s)));
  ISPH_HOOK(s, corrected, dt);
  isph_budget_forces(s, dt);
  if (tried != NULL) memcpy(s->pressure, tried, s->count * sizeof *tried);
  isph_move(s, dt);
  isph_budget_moved(s);
  TRY(isph_remove_outside(s, dt));
  ISPH_HOOK(s, arrive, dt);
  ISPH_HOOK(s, moved, dt);
  s->time += dt;
  s->step++;
  s->seconds_correct += clock_seconds() - start;
  TRY(isph_refresh(s));
  isph_budget_settled(s);
  ISPH_HOOK(s, settled, dt);
cleanup:
  memory_free(&tried);
  return status;
}
