#include "sphsolve/stokes/soil_response.h"

#include <math.h>
#include <string.h>

#include "common/log.h"
#include "common/memory.h"
#include "common/ranks.h"
#include "sphsolve/geometry/soil.h"
#include "sphsolve/plan/method.h"

/* Relative reduction of 1 / k_micro. The corrected flux is linear in 1 / k_micro except for the
 * slip at surfaces, so that one step, and one assembly, is enough: rounding in single precision
 * leaves an error of 2e-3 of the slope, slip one of 7e-3 of its part. */
#define RESISTANCE_STEP 0.01

static double along_force(const struct stokes_solver *s) {
  double mean = 0.0;
  for (int a = 0; a < 3; a++) mean += s->mean[a] * s->force[a];
  return mean;
}

static void find_shares(const struct stokes_solver *s, const struct lattice *l,
                        struct micropores_point *point) {
  const struct stokes_grid *grid = &s->grid;
  double sums[2] = {0.0}, soils = 0.0; /* flux through soil, soil sites on a path; all soil sites */
  for (size_t row = stokes_grid_begin(grid); row < stokes_grid_end(grid); row++) {
    size_t n = grid->row_start[row];
    double row_flux = 0.0, sites = 0.0;
    for (size_t i = 0; i < grid->size[0]; i++) {
      if (!stokes_grid_is_active(grid, row, i)) continue;
      const bool soil = lattice_is_soil(l, row * grid->size[0] + i);
      sites += soil;
      for (int a = 0; a < s->stencil.axis_count && soil; a++) {
        const int axis = s->stencil.axes[a];
        if (grid->mirrored && grid->parity[axis] < 0.0f) continue; /* both halves cancel */
        row_flux += s->force[axis] * s->x[(size_t)a * grid->active + n];
      }
      n++;
    }
    sums[0] += stokes_grid_weight(grid, row) * row_flux;
    sums[1] += stokes_grid_weight(grid, row) * sites;
  }
  ranks_sum_all(sums, 2);
  for (size_t i = 0; i < l->count; i++) soils += lattice_is_soil(l, i);
  point->flux = sums[0] / (along_force(s) * s->bulk_count);
  point->connected = sums[1] / soils;
}

enum status soil_response_measure(struct stokes_solver *s, const struct lattice *lattice,
                                  struct micropores_point *point) {
  enum status status = STATUS_OK;
  struct lattice scaled = *lattice;
  double mean[3];
  find_shares(s, lattice, point);
  point->slope = NAN;
  memcpy(mean, s->mean, sizeof mean);
  if (s->walls_move) return STATUS_OK; /* no adjoint is known then */
  const double functional = stokes_solver_functional(s);
  const double factor = 1.0 / (1.0 - RESISTANCE_STEP);
  TRY(lattice_soil_scale(lattice, factor, &scaled));
  scaled.micro_moved = factor;
  TRY(stokes_solver_set_soil(s, &scaled));
  point->slope = (stokes_solver_functional(s) / functional - 1.0) / RESISTANCE_STEP;
  memcpy(s->mean, mean, sizeof mean);
cleanup:
  if (scaled.micro_permeability != lattice->micro_permeability)
    memory_free(&scaled.micro_permeability);
  return status;
}

double soil_response_uncertainty(const struct scene *scene, const struct model_facts *model) {
  const double said = scene->micro.uncertainty > 1.0 ? log(scene->micro.uncertainty) : 0.0;
  return model->soil_error > 0.0 ? hypot(said, model->soil_error) : said;
}

void soil_response_describe(const struct lattice *l, struct micropores *m) {
  double soils = 0.0, porosity = 0.0, logarithm = 0.0;
  for (size_t i = 0; i < l->count; i++) {
    if (!lattice_is_soil(l, i)) continue;
    soils += 1.0;
    porosity += (double)l->micro_porosity[i];
    logarithm += log((double)l->micro_permeability[i]);
  }
  m->sites = soils / l->bulk_count;
  m->porosity = porosity / soils;
  m->permeability = exp(logarithm / soils);
}

/* Solves one point of the curve, starting from the solution of another; `s` is the solver of the
 * point, of which soil_response_measure leaves the solution. */
static enum status solve_point(const struct cascade *c, const struct lattice *lattice,
                               const struct stokes_solver *from, struct micropores_point *point,
                               struct stokes_solver *s) {
  enum status status = STATUS_OK;
  struct lattice scaled;
  const struct stokes_goal goal = cascade_goal(c);
  const size_t n = from->grid.active * (size_t)(from->stencil.axis_count + 1);
  TRY(lattice_soil_scale(lattice, point->factor, &scaled));
  TRY(cascade_build(c, &scaled, c->plan->context.method->wall(c->scene), s));
  memcpy(s->x, from->x, n * sizeof *s->x);
  stokes_solver_restart(s);
  TRY(stokes_solver_run(s, &goal));
  point->k = along_force(s) * s->stencil.unit * s->stencil.unit;
  TRY(soil_response_measure(s, &scaled, point));
cleanup:
  memory_free(&scaled.micro_permeability);
  return status;
}

enum status soil_response_curve(const struct cascade *c, const struct lattice *lattice, double k,
                                struct micropores *m) {
  enum status status = STATUS_OK;
  const double k_last = along_force(&c->coarse) * c->coarse.stencil.unit * c->coarse.stencil.unit;
  const int count = c->scene->micro.factor_count;
  m->own.factor = 1.0, m->own.k = k;
  if (count > 0) micropores_add(m, &m->own);
  /* Starts from the model's own soil, first towards higher, then towards lower permeability; each
   * point starts from the preceding one. */
  for (int up = 1; up >= 0; up--) {
    struct stokes_solver s[2];
    memset(s, 0, sizeof s);
    const struct stokes_solver *from = &c->coarse;
    for (int i = 0; i < count && status == STATUS_OK; i++) {
      struct stokes_solver *to = &s[i % 2];
      struct micropores_point point = {.factor = c->scene->micro.factors[up ? i : count - 1 - i]};
      if (point.factor == 1.0 || (point.factor > 1.0) != up) continue;
      stokes_solver_free(to);
      status = solve_point(c, lattice, from, &point, to);
      if (status == STATUS_OK) {
        point.k *= k / k_last;
        micropores_add(m, &point);
        from = to;
      } else if (status == STATUS_NUMERIC) {
        log_warning("micro.factors: %g is left out: %s", point.factor, error_message());
        error_clear();
        status = STATUS_OK;
        from = &c->coarse;
      }
    }
    stokes_solver_free(&s[0]);
    stokes_solver_free(&s[1]);
  }
  return status;
}
