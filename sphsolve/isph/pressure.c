#include "sphsolve/isph/pressure.h"

#include <math.h>
#include <string.h>

#include "common/variants.h"
#include "sphsolve/isph/effects/relaxation.h"
#include "sphsolve/isph/effects/surface.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/matrix.h"
#include "sphsolve/isph/multigrid.h"
#include "sphsolve/isph/outline.h"
#include "sphsolve/isph/petsc.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/symmetric.h"
#include "sphsolve/isph/enclosed.h"
#include "sphsolve/isph/mobility.h"
#include "sphsolve/isph/wall.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/window.h"

#define ITERATIONS_MAX 2000

/* Finds the coefficients of row i and returns their sum; sets `way` to the sum of a_ij (x_i - x_j),
 * and `whole` to what the coefficients would sum up to with mobilities of 1. */
ROW double assemble_pairs(enum isph_images images, const struct isph *s,
                          const struct isph_chunk *chunk, size_t i, four *way, double *whole) {
  four sum = {0}, r, fall;
  double diagonal = 0, weights = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    isph_separation_four(images, s, i, entry, &r);
    const double weight = 2 * s->volume[i] * s->volume[j] * (double)chunk->slope[p];
    const float a = (float)(weight * isph_mobility_between(s, chunk, p, i, j));
    isph_fall_way(images, s, i, entry, &r, &fall);
    chunk->matrix[p] = a;
    diagonal += (double)a, weights += weight;
    sum += (double)a * fall;
  }
  *way = sum, *whole = weights;
  return diagonal;
}

/* Divergence of the velocities v at particle i, from its pairs. d: isph/linear.h. */
ROW double pairs_divergence(enum isph_images images, const struct isph *s,
                            const struct isph_chunk *chunk, size_t i, double (*v)[3],
                            const double d[6]) {
  const four x = {d[0], d[1], d[2]}, y = {d[1], d[3], d[4]}, z = {d[2], d[4], d[5]};
  const bool linked = s->linked_mobility != NULL && s->ground[i] == GROUND_MIXED;
  four sum = {0}, r, vj;
  double carried = 0;
  for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++) {
    const uint32_t entry = chunk->pair[p], j = entry & PAIR_MASK;
    const double weight = s->volume[j] * (double)chunk->slope[p];
    isph_separation_four(images, s, i, entry, &r);
    isph_turn_four(images, s, entry, v[j], &vj);
    if (linked)
      carried +=
          weight * isph_link_difference(s, chunk, p, i, v[i], (double[3]){vj[0], vj[1], vj[2]},
                                        (double[3]){r[0], r[1], r[2]});
    else
      sum += weight * (FOUR(v[i]) - vj) * (r[0] * x + r[1] * y + r[2] * z);
  }
  return carried + (sum[0] + sum[1] + sum[2]);
}

/* Assembles the rows i of a chunk,
 *   sum_j a_ij [ P_i - P_j - rho f.(x_i - x_j) ] + c_i [ P_i - rho f.(x_i - x_s) ] = -V_i source,
 *   a_ij = 2 V_i V_j k_ij slope_ij,  k_ij of isph_mobility_between,
 * The driving force f enters through its potential, with the coefficients of the pressure itself: P
 * = rho f.x + constant solves the rows exactly on any arrangement of particles and for any
 * porosity, so that water at rest stays at rest. Walls have no pressure pairs (Neumann condition);
 * their images reflect the velocity. If the pressure is carried over from the last step, the rows
 * of the first projection have no source: it is that of the second solve. */
TARGETS static void assemble_chunk(struct isph *s, const struct isph_chunk *chunk) {
  const bool again = s->solve.again, sources = again || !s->solve.carries;
  static const double none[3] = {0};
  const double *f = again ? none : s->force, rho = s->density, held = again ? 0 : 1;
  double(*v)[3] = again ? s->velocity : s->predicted;
  for (size_t i = chunk->begin; i < chunk->end; i++) {
    const double *xi = s->position[i], *vi = v[i];
    double ki = s->mobility[i], vol = s->volume[i];
    double d[6] = {1, 0, 0, 1, 0, 1};
    const bool strains = isph_strain_turn(s, i, d);
    double diagonal = 0, divergence = 0, whole = 0;
    four way = {0};
    if (again) /* the matrix is that of the first solve */
      for (size_t p = s->pair_first[i], n = p + s->pair_number[i]; p < n; p++)
        diagonal += (double)chunk->matrix[p];
    else
      ISPH_ROW(s, i, diagonal = assemble_pairs, s, chunk, i, &way, &whole);
    const bool imaged = isph_faces_outline(s, i);
    double fall = 0;
    if (imaged && !again) diagonal += isph_outline_row(s, chunk, i, f, &fall, &whole);
    if (!again && s->pair_mobility != NULL) s->pair_mobility[i] = whole > 0 ? diagonal / whole : ki;
    double source = rho * (FOUR_DOT(way, f) + fall);
    if (sources) ISPH_ROW(s, i, divergence = pairs_divergence, s, chunk, i, v, d);
    if (sources && imaged) divergence += isph_outline_divergence(s, chunk, i, v);
    const bool linked = s->linked_mobility != NULL && s->ground[i] == GROUND_MIXED;
    double walled = 0, tied = 0;
    double beside = s->on.surface ? s->surface[i] : 0;
    for (size_t p = s->wall_first[i], n = p + s->wall_number[i]; p < n; p++) {
      uint32_t entry = chunk->wall[p], j = entry & PAIR_MASK;
      double r[3], slope = chunk->wall_slope[p];
      isph_separation(s, xi, s->boundary_position, entry, r);
      if (s->boundary_kind[j] == BOUNDARY_OPEN_HEAD) {
        double side[3], stretch = isph_window_stretch(s, xi, entry, r, side);
        const double a = 2 * vol * isph_wall_volume(s, j) * ki * slope * stretch;
        diagonal += a, tied += a;
        source += a * (held * s->boundary_pressure[j] +
                       rho * (f[0] * side[0] + f[1] * side[1] + f[2] * side[2]));
        continue;
      }
      const double *vw = isph_wall_velocity(s, j);
      walled += 2 * vol * isph_wall_volume(s, j) * ki * slope;
      double xj[3] = {xi[0] - r[0], xi[1] - r[1], xi[2] - r[2]}, mirror[6], across[3], back[3];
      double ratio, felt = 1;
      isph_wall_mirror(s, i, j, xj, mirror, &ratio);
      double image = 2 * isph_wall_volume(s, j) * slope;
      if (beside > 0) image *= 1 - beside * surface_gap(s, i, r, mirror);
      if (strains) symmetric_times(d, r, r);
      isph_turn(IMAGES_REFLECTED, s, entry, r,
                /* image of a wall particle behind a reflecting side: both reverse the velocity */
                back);
      symmetric_times(mirror, back, across);
      if (linked && s->boundary_kind[j] == BOUNDARY_WALL && dot(vw, vw) > 0) {
        for (int a = 0; a < 3; a++) xj[a] = xi[a] - (xi[a] - xj[a]) / (1 + ratio); /* on its face */
        felt = isph_link_to_wall(s, i, xj, s->dt);
      }
      for (int a = 0; a < 3; a++)
        divergence +=
            image * (vi[a] - felt * vw[a]) * across[a] + 0.5 * image * vi[a] * (r[a] - back[a]);
    }
    if (s->porosity_rate != NULL) divergence += s->porosity_rate[i]; /* d eps/dt + div v_D = 0 */
    double passed = 0;
    double *into = s->on.wells && isph_wells_take_source(s, i) ? &passed : &source;
    if (sources) *into -= vol * divergence;
    if (s->on.surface) {
      double coefficient, load;
      const double backed = s->surface[i] > 0 ? isph_reflection_backs(s, i) : 0;
      surface_row(s, i, diagonal + walled, backed, &coefficient, &load);
      diagonal += coefficient, tied += coefficient;
      source += load;
    }
    if (s->calm != NULL && sources) *into += vol * isph_calm_expansion(s, i);
    if (s->on.relaxation && sources) *into -= vol * relaxation_source(s, i, s->relaxation_time);
    struct effect_row row = {diagonal, source, tied, passed};
    for (size_t k = 0; k < s->on.row_count; k++) s->on.rows[k]->row(s, i, &row);
    s->diagonal[i] = row.diagonal > 0 ? row.diagonal : 1;
    s->source[i] = row.source;
    s->tied[i] = row.tied;
  }
}

void isph_assemble(struct isph *s) {
  double fixed = 0;
  if (!s->solve.again) {
    s->solve.iterations = 0, s->solve.energy = 0, s->solve.solves++;
    s->solve.fresh = true;
  }
#pragma omp parallel for schedule(dynamic, 1)
  for (size_t c = 0; c < s->chunk_count; c++) assemble_chunk(s, &s->chunks[c]);
  for (size_t i = s->local.begin; i < s->local.end; i++) fixed += s->tied[i];
  s->closed = ranks_sum(fixed) == 0;
  isph_enclosed_source(s, s->source);
}

static void remove_mean(struct isph *s, double *values) {
  double *ones = s->work[3];
  for (size_t i = s->local.begin; i < s->local.end; i++) ones[i] = 1;
  double mean = isph_dot(s, values, ones) / (double)s->total;
  for (size_t i = s->local.begin; i < s->local.end; i++) values[i] -= mean;
}

/* Lower bound of the energy to which the error of a solution is related: that of a pressure
 * gradient 1e-8 of the driving force's, far above the rounding error of the rows where the force
 * alone drives uniform water. */
static double energy_least(struct isph *s) {
  const double *f = s->force, gradient = 1e-8 * s->density;
  const double square = gradient * gradient * (f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  return square > 0 ? square * isph_dot(s, s->volume, s->mobility) : 0;
}

/* Collective: the largest |x|. */
static double largest(const struct isph *s, const double *x) {
  double most = 0;
  for (size_t i = s->local.begin; i < s->local.end; i++) most = fmax(most, fabs(x[i]));
  return ranks_max(most);
}

/* Whether the pressure itself is as accurate as the velocities: its error, estimated by the
 * preconditioner, relative to the largest pressure. In soil so fine that mobilities are 1e-12 of
 * those in free water, an error of 1e-6 in the velocities of all the water corresponds to a
 * pressure a hundred times the actual one, and moves a thousand times the seepage. */
static bool pressure_is_exact(struct isph *s, const double *error) {
  struct isph_solve *solve = &s->solve;
  if (!s->on.soil) return true;
  if (!solve->again) solve->pressure = largest(s, s->pressure);
  return largest(s, error) <= s->scene->isph.tolerance * solve->pressure;
}

/* One Jacobi sweep from the last pressure, except for particles on the surface. A pressure that
 * alternates from particle to particle has almost no gradient, so that the second solve does not
 * see it; as the gradient is not quite the adjoint of the divergence, it would grow, by 1 % a step
 * in a small wave. The sweep removes most of it, and almost nothing of a smooth pressure. At the
 * surface the rows' gradient and the one in use differ most, and the sweep would bring the
 * difference back. What exceeds the weight of water up to the highest particle is not carried over:
 * it may be the pressure of an impact, which is over with its step. */
void isph_carry_pressure(struct isph *s) {
  double *x = s->pressure, *q = s->work[3], top = -INFINITY;
  const double *f = s->force, force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  if (s->total == 0) return;
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const double *at = s->position[i];
    top = fmax(top, -(f[0] * at[0] + f[1] * at[1] + f[2] * at[2]));
  }
  top = ranks_max(top);
  isph_multiply(s, x, q);
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) {
    const double *at = s->position[i];
    const double weight = top + f[0] * at[0] + f[1] * at[1] + f[2] * at[2] + force * s->spacing;
    x[i] += (1 - s->surface[i]) * (s->source[i] - q[i]) / s->diagonal[i];
    x[i] = fmin(x[i], s->density * weight);
  }
  s->solve.energy = isph_dot(s, x, s->source);
}

enum status isph_solve_pressure(struct isph *s) {
  size_t n = s->count;
  double *x = s->pressure, *b = s->source;
  double *r = s->work[0], *z = s->work[1], *p = s->work[2], *q = s->work[3];
  double tolerance = s->scene->isph.tolerance;
  struct isph_solve *solve = &s->solve;
  enum status status;
  if (s->total == 0) return STATUS_OK;
  if (RANKS && s->scene->isph.solver == SOLVER_PETSC) return isph_petsc_solve(s);
  if (s->closed) remove_mean(s, b);
  double norm = sqrt(isph_dot(s, b, b));
  solve->residual = 0;
  if (!(norm > 0)) {
    if (norm != 0)
      return FAIL(STATUS_NUMERIC,
                  "t = %.4g s: the pressure equation has no finite "
                  "right-hand side; use a smaller isph.dt",
                  s->time);
    if (n > 0) memset(x, 0, n * sizeof *x);
    return STATUS_OK;
  }
  if (solve->fresh && (status = multigrid_build(s)) != STATUS_OK) return status;
  solve->fresh = false;
  isph_multiply(s, x, q);
#pragma omp parallel for schedule(static)
  for (size_t i = s->local.begin; i < s->local.end; i++) r[i] = b[i] - q[i];
  /* r.M^-1 r and x.b are the squares of the error and of the solution in the energy norm, which is
   * that of the velocities the pressure makes: so a tolerance means the same whatever the number of
   * particles (in the plain norm of r it would be stricter, the smoother b is). With soil the
   * pressure has to be as accurate. */
  double error = 0, rz = 0, energy = 0, least = fmax(energy_least(s), 1e-300);
  int iteration = 0;
  for (;; iteration++) {
    multigrid_apply(s, r, z);
    double rz_new = isph_dot(s, r, z), beta = iteration > 0 ? rz_new / rz : 0;
    double whole = fmax(isph_dot(s, x, b), solve->energy);
    rz = rz_new;
    error = sqrt(fabs(rz) / fmax(whole, least));
    energy = whole;
    if (!(rz > 0) || iteration == ITERATIONS_MAX) break;
    if (!(error > tolerance) && pressure_is_exact(s, z)) break;
#pragma omp parallel for schedule(static)
    for (size_t i = s->local.begin; i < s->local.end; i++) p[i] = z[i] + beta * p[i];
    isph_multiply(s, p, q);
    double step = rz / isph_dot(s, p, q);
#pragma omp parallel for schedule(static)
    for (size_t i = s->local.begin; i < s->local.end; i++) x[i] += step * p[i], r[i] -= step * q[i];
  }
  solve->energy = energy;
  solve->iterations += iteration;
  solve->iterations_total += iteration;
  solve->residual = error;
  if (!(error <= 1e3 * tolerance)) return isph_solve_failed(s, error, iteration);
  if (s->closed) remove_mean(s, x);
  return STATUS_OK;
}
