#include "sphsolve/stokes/error_budget.h"

#include <math.h>
#include <string.h>

#include "common/convergence.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/stokes/solver.h"

#define LEVELS 3
static const double ratios[LEVELS] = {1.0, 1.5, 2.0};
/* How far the surface is moved for dk/de, in spacings: it changes k by some per cent to tenths, far
 * more than the tolerance of the solver. */
#define SURFACE_STEP 0.05
static const struct stokes_goal goal = {.mean = 1e-4};

struct error_split error_split_none(void) {
  return (struct error_split){NAN,
                              NAN,
                              NAN,
                              NAN,
                              NAN,
                              .order = NAN,
                              .extrapolated = NAN,
                              .slope_void_ratio = NAN,
                              .slope_threshold = NAN};
}

double error_split_total(const struct error_split *split) {
  const double parts[] = {split->resolution, split->averaging, split->steadiness, split->void_ratio,
                          split->threshold};
  double sum = 0.0;
  int known = 0;
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    if (isfinite(parts[i])) {
      sum += parts[i] * parts[i];
      known++;
    }
  return known > 0 ? sqrt(sum) : NAN;
}

/* Sites of an axis at `ratio` times the spacing, of `copies` periods where one would leave a
 * spacing more than a twentieth off. */
static size_t coarse_size(size_t n, double ratio, size_t *copies) {
  size_t best = 1;
  double least = INFINITY;
  *copies = 1;
  if (n == 1) return 1;
  for (size_t m = 1; m <= 8 && least > 0.05; m++) {
    const double wanted = (double)(m * n) / ratio, whole = fmax(1.0, round(wanted));
    if (fabs(wanted / whole - 1.0) < least) {
      least = fabs(wanted / whole - 1.0);
      best = (size_t)whole;
      *copies = m;
    }
  }
  return best;
}

/* Cubic (Lagrange) along each axis, periodic: what is linear between sites would smooth the curved
 * walls away, and of second order. */
static double interpolate(const struct lattice *l, const double at[3]) {
  size_t index[3][4];
  double weight[3][4], sum = 0.0;
  for (int a = 0; a < 3; a++) {
    const double n = (double)l->size[a], x = at[a] - floor(at[a] / n) * n, whole = floor(x);
    const double t = x - whole;
    const double w[4] = {-t * (t - 1.0) * (t - 2.0) / 6.0, (t * t - 1.0) * (t - 2.0) / 2.0,
                         -t * (t + 1.0) * (t - 2.0) / 2.0, t * (t * t - 1.0) / 6.0};
    for (size_t i = 0; i < 4; i++) {
      index[a][i] = ((size_t)whole + i + l->size[a] - 1) % l->size[a];
      weight[a][i] = w[i];
    }
  }
  for (size_t k = 0; k < 4; k++)
    for (size_t j = 0; j < 4; j++)
      for (size_t i = 0; i < 4; i++) {
        const double w = weight[0][i] * weight[1][j] * weight[2][k];
        const size_t row = index[2][k] * l->size[1] + index[1][j];
        if (w != 0.0) sum += w * (double)l->wall_distance[row * l->size[0] + index[0][i]];
      }
  return sum;
}

/* The same walls, moved by `offset` (m) into the grains, on sites `ratio` times as far apart. */
static enum status coarsen(const struct lattice *fine, double ratio, double offset,
                           struct lattice *coarse) {
  enum status status = STATUS_OK;
  *coarse =
      (struct lattice){.dimensions = fine->dimensions, .count = 1, .bulk_count = fine->bulk_count};
  for (int a = 0; a < 3; a++) {
    size_t copies;
    coarse->size[a] = coarse_size(fine->size[a], ratio, &copies);
    coarse->spacing[a] =
        fine->spacing[a] * (double)(copies * fine->size[a]) / (double)coarse->size[a];
    coarse->count *= coarse->size[a];
    coarse->bulk_count *= (double)copies * fine->spacing[a] / coarse->spacing[a];
  }
  TRY(memory_allocate(&coarse->kind, coarse->count, 1, "a coarser lattice"));
  TRY(memory_allocate(&coarse->wall_distance, coarse->count, sizeof *coarse->wall_distance,
                      "a coarser lattice"));
  if (fine->region)
    TRY(memory_allocate(&coarse->region, coarse->count, sizeof *coarse->region,
                        "a coarser lattice"));
  for (size_t s = 0; s < coarse->count; s++) {
    const size_t index[3] = {s % coarse->size[0], s / coarse->size[0] % coarse->size[1],
                             s / coarse->size[0] / coarse->size[1]};
    double at[3];
    size_t near = 0;
    for (int a = 2; a >= 0; a--) {
      at[a] = ((double)index[a] + 0.5) * coarse->spacing[a] / fine->spacing[a] - 0.5;
      near = near * fine->size[a] + (size_t)(at[a] + 0.5) % fine->size[a];
    }
    const double d = interpolate(fine, at) + offset;
    coarse->wall_distance[s] = (float)d;
    coarse->kind[s] = d > 0.0 ? SITE_FLUID : SITE_WALL;
    coarse->fluid_count += d > 0.0;
    coarse->wall_count += d <= 0.0;
    if (fine->region) coarse->region[s] = fine->region[near];
  }
cleanup:
  return status;
}

/* Pore volume over grain volume, sites on the surface counted in part. */
static double void_ratio_of(const struct lattice *l) {
  double pores = 0.0;
  const double h = cbrt(l->spacing[0] * l->spacing[1] * l->spacing[2]);
  for (size_t s = 0; s < l->count; s++)
    pores += fmax(0.0, fmin(1.0, 0.5 + (double)l->wall_distance[s] / h));
  return pores / (l->bulk_count - pores);
}

/* Intrinsic permeability (m^2) along the force; 0 where nothing flows or the solver fails. */
static double permeability_of(const struct scene *scene, const struct plan *plan,
                              const struct lattice *lattice, enum wall_scheme wall) {
  const struct effect_context *context = &plan->context;
  const double spacing =
      lattice->dimensions == 2
          ? sqrt(lattice->spacing[0] * lattice->spacing[2])
          : cbrt(lattice->spacing[0] * lattice->spacing[1] * lattice->spacing[2]);
  struct stokes_solver s = {0};
  double k = 0.0;
  if (lattice->fluid_count > 0 &&
      stokes_solver_build(lattice, scene, context->support / context->spacing * spacing, wall,
                          context->kinematic_viscosity, scene->driving, &s) == STATUS_OK &&
      s.grid.active_all > 0 && stokes_solver_run(&s, &goal) == STATUS_OK)
    for (int a = 0; a < 3; a++) k += s.mean[a] * s.force[a] * s.stencil.unit * s.stencil.unit;
  stokes_solver_free(&s);
  error_clear();
  return k;
}

/* `own`: permeability with the run's walls, k[0] that with subvoxel walls. */
static void measure_resolution(const double *h, const double *k, int levels, double own,
                               struct error_split *split) {
  struct convergence c;
  split->levels = levels;
  if (levels < 2) return;
  converge_extrapolate(h, k, (size_t)levels, 2.0, &c);
  split->resolution = own == k[0] ? c.index : hypot(c.index, own / c.value - 1.0);
  split->order = c.order;
  split->order_credible = c.credible;
  split->extrapolated = c.value;
}

/* What the model says of its own void ratio, times the measured slope. */
static void add_model(const char *path, struct error_split *split) {
  struct h5_file *file = NULL;
  if (!*path || !isfinite(split->slope_void_ratio)) return;
  if (h5_open(path, &file) != STATUS_OK) {
    error_clear();
    return;
  }
  const double slope = h5_attribute_or_nan(file, "/calibration", "dthreshold_dvoid_ratio");
  const double uncertainty = h5_attribute_or_nan(file, "/calibration", "threshold_uncertainty");
  split->void_ratio =
      fabs(split->slope_void_ratio * (h5_attribute_or_nan(file, "/model", "void_ratio") -
                                      h5_attribute_or_nan(file, "/model", "void_ratio_measured")));
  split->slope_threshold = split->slope_void_ratio / slope;
  if (uncertainty > 0.0) split->threshold = fabs(split->slope_threshold) * uncertainty;
  h5_close(file);
}

static bool has_creeping_flow(const struct scene *scene, const struct effect_context *context) {
  return context->lattice->wall_distance != NULL && context->driving > 0.0 &&
         context->method->resolves_pores && !context->has_moving_wall && !context->has_surface &&
         scene->fluid.viscosity > 0.0;
}

double error_split_seconds(const struct scene *scene, const struct plan *plan) {
  const struct effect_context *context = &plan->context;
  const struct lattice *l = context->lattice;
  if (!has_creeping_flow(scene, context)) return 0.0;
  const bool solved = context->method->solves_creeping;
  const enum wall_scheme wall = context->method->wall(scene);
  double seconds = 0.0;
  for (int i = wall == WALL_SUBVOXEL ? 1 : 0; i < LEVELS; i++) {
    double solves = i == 1 && *scene->model_path ? 2.0 : 1.0;
    for (int a = 0; a < 3; a++) {
      size_t copies;
      coarse_size(l->size[a], ratios[i], &copies);
      solves *= (double)copies;
    }
    seconds += solves * stokes_solver_seconds(&plan->shape, l, 1.0 / ratios[i], WALL_SUBVOXEL);
  }
  return seconds + (solved ? 0.0 : stokes_solver_seconds(&plan->shape, l, 1.0, wall));
}

enum status error_split_measure(const struct scene *scene, const struct plan *plan,
                                const struct lattice *lattice, double permeability, double found,
                                struct error_split *split) {
  enum status status = STATUS_OK;
  double h[LEVELS], k[LEVELS], own = permeability;
  int levels = 0;
  enum wall_scheme wall;
  struct lattice coarse = {0}, moved = {0};
  if (!has_creeping_flow(scene, &plan->context)) return STATUS_OK;
  wall = plan->context.method->wall(scene);
  if (isnan(own)) own = permeability_of(scene, plan, lattice, wall);
  if (!(own > 0.0)) return STATUS_OK;
  for (int i = 0; i < LEVELS; i++) {
    if (i == 0) {
      k[i] = wall == WALL_SUBVOXEL ? own : permeability_of(scene, plan, lattice, WALL_SUBVOXEL);
    } else {
      TRY(coarsen(lattice, ratios[i], 0.0, &coarse));
      k[i] = permeability_of(scene, plan, &coarse, WALL_SUBVOXEL);
    }
    if (!(k[i] > 0.0)) break;
    if (i == 1 && *scene->model_path) {
      TRY(coarsen(lattice, ratios[i], SURFACE_STEP * coarse.spacing[0], &moved));
      const double more = permeability_of(scene, plan, &moved, WALL_SUBVOXEL);
      const double change = void_ratio_of(&moved) - void_ratio_of(&coarse);
      if (more > 0.0 && change > 0.0) split->slope_void_ratio = log(more / k[i]) / change;
      lattice_free(&moved);
    }
    lattice_free(&coarse);
    h[levels++] = ratios[i];
  }
  measure_resolution(h, k, levels, own, split);
  /* Pores too coarse to converge can agree by chance, and walls that stand in the wrong place do
   * not show it: no less than what explain expected. */
  if (levels < LEVELS || !split->order_credible || wall != WALL_SUBVOXEL)
    split->resolution = fmax(split->resolution, plan->expected.error);
  if (found > 0.0 && split->extrapolated > 0.0)
    split->resolution = fmax(split->resolution, fabs(found / split->extrapolated - 1.0));
  add_model(scene->model_path, split);
cleanup:
  lattice_free(&coarse);
  lattice_free(&moved);
  return status;
}

enum status error_split_write(const struct error_split *split, struct h5_file *file) {
  enum status status = STATUS_OK;
  const struct {
    const char *name;
    double value;
  } parts[] = {{"resolution", split->resolution},
               {"averaging", split->averaging},
               {"steadiness", split->steadiness},
               {"void_ratio", split->void_ratio},
               {"threshold", split->threshold},
               {"total", error_split_total(split)},
               {"observed_order", split->order},
               {"order_credible", split->order_credible},
               {"spacings", split->levels},
               {"extrapolated_permeability", split->extrapolated},
               {"dlnk_dvoid_ratio", split->slope_void_ratio},
               {"dlnk_dthreshold", split->slope_threshold}};
  TRY(h5_make_group(file, "/run/error"));
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    TRY(h5_write_attribute(file, "/run/error", parts[i].name, H5_F64, 1, &parts[i].value));
cleanup:
  return status;
}
