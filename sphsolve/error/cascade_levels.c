#include "sphsolve/error/cascade_levels.h"

#include <math.h>
#include <string.h>

#include "common/convergence.h"
#include "common/memory.h"
#include "sphsolve/error/error_forecast.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/stokes/constants.h"
#include "sphsolve/stokes/solver/cost.h"

/* Number of sites of the first lattice across a mean pore, 4 V / S, and across the body. */
#define FIRST_SITES_PER_PORE 1.6
#define FIRST_SITES_PER_BODY 8.0
/* Below so many pores across, k of a sand scatters too much for four lattices
 * (docs/physics/error-of-k.md). */
#define PORES_ACROSS_FEW 8.0
/* Fewest lattices of an open cascade, unless it is ended early. */
#define LATTICES_MIN 3
/* Tolerance for a share of about ten per cent; in a model with tight soil solves may stall before
 * `mean`, and `slack` is then accepted. */
const struct stokes_goal cascade_sides_goal = {.mean = 1e-3, .slack = 0.02};
const double cascade_fixed_ratios[CASCADE_FIXED] = {2.0, 1.5, 1.0};

bool cascade_is_possible(const struct scene *scene, const struct plan *plan) {
  const struct effect_context *context = &plan->context;
  return context->lattice->wall_distance != NULL && context->driving > 0.0 &&
         context->method->resolves_pores && !context->has_moving_wall && !context->has_surface &&
         scene->fluid.viscosity > 0.0;
}

/* Fraction of a model's length that is independent: a mirrored sample contains everything twice. */
static double independent_fraction(const struct lattice *base) {
  return base->model.sides_mirrored ? 0.5 : 1.0;
}

/* Width of a mean pore, m. In bodies whose pores are wider than the thickness 2 V / S of their
 * grains, as in felts, the grains determine the resistance: between void ratios of 1 and 2 the
 * criterion changes from the number of sites across a pore to that across a grain, with as many
 * sites as in sands (docs/physics/error-of-k.md). */
static double pore_width(const struct plan *plan) {
  const double width = plan->shape.width, grain = plan->shape.grain;
  return plan->context.spacing * fmin(width, fmax(grain, 4.0 * grain * grain / width));
}

/* Spacing with FIRST_SITES_PER_PORE sites across a mean pore and at least FIRST_SITES_PER_BODY
 * sites along `body` (m). */
static double coarse_spacing(const struct plan *plan, double body) {
  const double pore = pore_width(plan);
  return fmin(isfinite(pore) ? pore / FIRST_SITES_PER_PORE : plan->context.spacing,
              body / FIRST_SITES_PER_BODY);
}

double cascade_first_spacing(const struct plan *plan, const struct lattice *base) {
  double shortest = INFINITY;
  for (int a = 0; a < 3; a++)
    if (base->size[a] > 1) shortest = fmin(shortest, (double)base->size[a] * base->spacing[a]);
  return coarse_spacing(plan, independent_fraction(base) * shortest);
}

bool cascade_walls_change(const struct lattice *base, int axis) {
  size_t step = 1;
  for (int a = 0; a < axis; a++) step *= base->size[a];
  const float least = (float)(1e-3 * base->spacing[axis]);
  for (size_t s = 0; s < base->count; s++)
    if (s / step % base->size[axis] > 0 &&
        fabsf(base->wall_distance[s] - base->wall_distance[s - step]) > least)
      return true;
  return false;
}

/* Length of the sample along the shortest axis along which walls change, m, without mirrored
 * copies. */
static double shortest_varying_length(const struct lattice *base) {
  double shortest = INFINITY;
  for (int a = 0; a < 3; a++)
    if (base->size[a] > 1 && cascade_walls_change(base, a))
      shortest = fmin(shortest, (double)base->size[a] * base->spacing[a]);
  return independent_fraction(base) * shortest;
}

double cascade_noise_scale(const struct plan *plan, const struct lattice *base) {
  return coarse_spacing(plan, shortest_varying_length(base));
}

double cascade_pores_across(const struct plan *plan, const struct lattice *base) {
  return shortest_varying_length(base) / pore_width(plan);
}

int cascade_lattices_needed(double pores_across) {
  return pores_across < PORES_ACROSS_FEW ? CASCADE_LATTICES_FEW_PORES : CASCADE_LATTICES_MIN;
}

/* The last lattice is the scene's own: below the voxel size of a model a lattice resolves the
 * interpolation of its voxels, not the walls. */
int cascade_open_steps(const struct plan *plan, const struct lattice *base) {
  const double steps =
      log(cascade_first_spacing(plan, base) / plan->context.spacing) / log(CASCADE_RATIO);
  return CASCADE_STEPS * (int)fmin(fmax(round(steps), LATTICES_MIN - 1), ERROR_LEVELS_MAX - 1);
}

double cascade_step_ratio(int left) {
  return pow(CASCADE_RATIO, (double)left / CASCADE_STEPS);
}

/* A lattice as fine as the voxels, or as the scene's chosen lattice, exhausts the model; a model as
 * fine as its scan exhausts the scan. */
enum resolution_needs cascade_needs(const struct plan *plan, double spacing) {
  const struct model_facts *model = &plan->context.lattice->model;
  const double chosen =
      isfinite(plan->context.scene->lattice_spacing) ? 0.0 : plan->context.spacing;
  if (model->count == 0 || spacing > 1.01 * fmax(model->voxel, chosen)) return NEEDS_LATTICE;
  return model->voxel <= 1.01 * model->voxel_scanned ? NEEDS_SCAN : NEEDS_MODEL;
}

double cascade_sides_copies(const struct lattice *base) {
  const bool *unlike = base->model.unlike;
  return (unlike[0] ? 2.0 : 1.0) * (unlike[1] ? 2.0 : 1.0) * (unlike[2] ? 2.0 : 1.0);
}

/* A coarse lattice, on which narrow throats are to stay open; with all its mirrored copies it has
 * at most twice the sites of the scene. */
double cascade_sides_spacing(const struct plan *plan, const struct lattice *base) {
  return fmax(cbrt(0.5 * cascade_sides_copies(base)) * plan->context.spacing,
              0.5 * cascade_first_spacing(plan, base));
}

/* Largest number of sites, copies included, of a refined lattice for the sides. */
#define SIDES_SITES_MAX 8e6

bool cascade_sides_finer(const struct lattice *base, double *spacing, double *sites) {
  const double *h = base->spacing, finest = fmin(h[0], fmin(h[1], h[2]));
  const double finer = fmax(*spacing * M_SQRT1_2, finest);
  *sites = cascade_sides_copies(base) * (double)base->count * h[0] * h[1] * h[2] /
           (finer * finer * finer);
  if (*spacing <= 1.01 * finest || *sites > SIDES_SITES_MAX) return false;
  *spacing = finer;
  return true;
}

double cascade_sides_sites(const struct plan *plan) {
  const struct lattice *l = plan->context.lattice;
  const struct scene *scene = plan->context.scene;
  const double copies = cascade_sides_copies(l);
  if (!cascade_is_possible(scene, plan) || !(copies > 1.0)) return 0.0;
  return copies * (double)l->count *
         pow(plan->context.spacing / cascade_sides_spacing(plan, l), l->dimensions);
}

double cascade_sides_times(const struct lattice *base, bool open) {
  const double y_part = open && base->micro_porosity == NULL ? 0.5 : 1.0;
  double sites = 1.0, times = 1.0;
  if (base->model.unlike[2]) times += sites *= open ? 1.0 : 2.0;
  if (base->model.unlike[1]) times += sites *= 2.0 * y_part;
  if (base->model.unlike[0]) times += sites *= 2.0;
  return times + (base->model.sides_wrapped ? 1.0 : 0.0);
}

/* Processor seconds of all solves for the effect of the sides. */
static double sides_seconds(const struct plan *plan, const struct stokes_goal *goal, bool open) {
  const struct lattice *l = plan->context.lattice;
  const double sides = cascade_sides_sites(plan);
  if (!(sides > 0.0)) return 0.0;
  const double refined =
      pow(sides / cascade_sides_copies(l) / (double)l->count, 1.0 / l->dimensions);
  return cascade_sides_times(l, open) *
         stokes_solver_seconds(&plan->shape, l, refined, goal, WALL_SUBVOXEL);
}

double cascade_sides_finer_seconds(const struct plan *plan, bool open) {
  const struct lattice *l = plan->context.lattice;
  double seconds = 0.0, spacing = cascade_sides_spacing(plan, l), sites;
  if (!(cascade_sides_sites(plan) > 0.0)) return 0.0;
  while (cascade_sides_finer(l, &spacing, &sites))
    seconds += cascade_sides_times(l, open) *
               stokes_solver_seconds(&plan->shape, l, plan->context.spacing / spacing,
                                     &cascade_sides_goal, WALL_SUBVOXEL);
  return seconds;
}

double cascade_seconds(const struct scene *scene, const struct plan *plan, bool with_base) {
  const struct lattice *l = plan->context.lattice;
  const struct stokes_goal goal = stokes_goal_of(scene);
  double seconds = 0.0;
  if (!cascade_is_possible(scene, plan)) return 0.0;
  for (int i = 0; i < CASCADE_FIXED - (with_base ? 0 : 1); i++) {
    const double solves = i == 1 && *scene->model_path ? 3.0 : 1.0;
    seconds += solves * stokes_solver_seconds(&plan->shape, l, 1.0 / cascade_fixed_ratios[i], &goal,
                                              WALL_SUBVOXEL);
  }
  return seconds + sides_seconds(plan, &goal, false);
}

/* For an open cascade: iterations of a solve that starts from the preceding lattice; and the error
 * of the estimate over the error predicted from three lattices of similar spacing. Set on sands
 * with 1.6 to 15 sites across a mean pore. */
#define ITERATIONS_WARM 24.0
#define OPEN_ERROR_RATIO 0.55
/* Bytes beside the solver. Per site of the base lattice: kind and wall distance. Per site of the
 * preceding lattice: its solution, indices, kind and wall distance. */
#define BASE_BYTES 5.0
#define PRECEDING_BYTES 25.0
/* Bytes per site of the base lattice while the effect of the scan is computed: the lattice, its
 * blurred copy, and the work space of the blur. */
#define BLUR_BYTES 14.0

/* Expected part of the error of resolution by the model's voxels, as cascade_add_model_parts finds
 * it on the second lattice: none where that has every second voxel itself, at CASCADE_RATIO^2 = 2
 * voxels. */
static double expected_of_model(const struct plan *plan) {
  const struct pore_shape *shape = &plan->shape;
  const int second = cascade_open_steps(plan, plan->context.lattice) - CASCADE_STEPS;
  if (!*plan->context.scene->model_path || shape->flat || second == 2 * CASCADE_STEPS) return 0.0;
  return CONVERGE_MODEL_SHARE * shape->slope * MODEL_RECEDES / shape->grain;
}

/* Predicted error of resolution with `lattices` lattices, the last of them `left` steps before the
 * base. */
static double expected_of_open(const struct plan *plan, int enough, int lattices, int left) {
  const double error = error_forecast_of(&plan->shape, plan->context.method, WALL_SUBVOXEL,
                                         1.0 / cascade_step_ratio(left))
                           .error;
  const double few = lattices < enough && !plan->shape.flat ? cascade_few_lattices[lattices] : 1.0;
  return fmin(1.0, hypot(few * OPEN_ERROR_RATIO * error, expected_of_model(plan)));
}

/* Whether the cascade is expected to end with this error of resolution: either it and the
 * errors of scan and threshold together meet the goal, or those dominate, so that a finer lattice
 * does not help. */
static bool is_expected_enough(const struct plan *plan, double error) {
  const double wanted = plan->goal.error, rest = error_expected_rest(plan);
  return hypot(error, rest) <= wanted || (wanted > 0.0 && rest > wanted && error < 0.5 * rest);
}

/* Steps from the last of `lattices` lattices to the next, as the run will choose them. */
static int expected_steps(const struct plan *plan, int enough, int lattices, int left) {
  for (int steps = 1; lattices >= enough && steps <= CASCADE_STEPS_MAX && steps <= left; steps++)
    if (is_expected_enough(plan, expected_of_open(plan, enough, lattices + 1, left - steps)))
      return steps;
  return left == 1 ? 1 : CASCADE_STEPS;
}

int cascade_levels(const struct plan *plan, int most, struct predicted_level *levels) {
  const struct lattice *base = plan->context.lattice;
  const struct scene *scene = plan->context.scene;
  const double h = plan->context.spacing, phi = (double)base->fluid_count / (double)base->count;
  double seconds = 0.0;
  int count = 0;
  if (!cascade_is_possible(scene, plan) || plan->context.method->wall(scene) != WALL_SUBVOXEL ||
      plan->shape.sharp)
    return 0;
  const double half = lattice_is_mirrored(base) ? 0.5 : 1.0;
  const int enough = cascade_lattices_needed(cascade_pores_across(plan, base));
  int left = cascade_open_steps(plan, base);
  double before = 0.0; /* sites of the preceding lattice */
  for (int i = 0; left >= 0 && count < most; i++) {
    const double refined = 1.0 / cascade_step_ratio(left);
    const double sites = (double)base->count * pow(refined, base->dimensions);
    /* Additional solves: for void ratio and voxel size with the second lattice, for the scan with
     * the third and the fourth. */
    double solves = 1.0;
    if (i == 1 && *scene->model_path) solves += 2.0;
    if ((i == 2 || i == 3) && base->model.scan.known) solves += 1.0;
    const double level_seconds = solves * stokes_soil_seconds(base) *
                                 stokes_seconds(ITERATIONS_WARM, half * sites, half * phi * sites);
    seconds += level_seconds;
    if (i == 1) seconds += half * sides_seconds(plan, &cascade_sides_goal, true);
    const double error = expected_of_open(plan, enough, i + 1, left);
    const double solving =
        BASE_BYTES * (double)base->count + PRECEDING_BYTES * before +
        stokes_solver_bytes(half * sites, half * phi * sites, base->micro_porosity != NULL);
    if (i >= LATTICES_MIN - 1) /* fewer lattices give no useful estimate */
      levels[count++] = (struct predicted_level){
          .spacing = h / refined,
          .sites = sites,
          .error = error,
          .few = i + 1 < enough,
          .seconds = seconds,
          .seconds_sides = half * cascade_sides_finer_seconds(plan, true),
          .bytes = PROGRAM_BYTES + fmax(solving, BLUR_BYTES * (double)base->model.count)};
    before = sites;
    if (i + 1 >= enough && is_expected_enough(plan, error)) break;
    left -= expected_steps(plan, enough, i + 1, left);
  }
  return count;
}
