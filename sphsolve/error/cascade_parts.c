#include "sphsolve/error/cascade_parts.h"

#include <math.h>

#include "common/convergence.h"
#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/other_sides.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/geometry/surface_blur.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/error/scan_error.h"

/* Displacement of the surface for dk/de, in spacings: it changes k by some per cent to some tens of
 * per cent, far more than the tolerance of the solver. */
#define SURFACE_STEP 0.05
bool cascade_sides_wait(const struct cascade *c) {
  return c->plan->goal.seconds > 0.0 && c->fixed == 0 && isnan(c->uncertainty.sides) &&
         cascade_sides_copies(c->base) > 1.0;
}

/* Parts of the error by the void ratio and by the threshold: their uncertainties, given by the
 * model, times the slope d ln k / de. */
static void add_calibration(const struct model_facts *model, struct uncertainty *u) {
  if (!isfinite(u->slope_void_ratio)) return;
  u->void_ratio = fabs(u->slope_void_ratio * model->void_ratio_error);
  u->slope_threshold = u->slope_void_ratio / model->threshold_slope;
  if (model->threshold_uncertainty > 0.0)
    u->threshold = fabs(u->slope_threshold) * model->threshold_uncertainty;
}

/* Solves k of the sample as it wraps, k[0], and mirrored, one axis after the other, along the axes
 * whose sides do not match. `wrapped`: its lattice, to be freed by the caller. */
static enum status solve_sides(struct cascade *c, double spacing, struct lattice *wrapped,
                               double k[4], int *count) {
  enum status status = STATUS_OK;
  struct lattice mirrored = {0};
  bool axes[3] = {false};
  const struct stokes_solver none = {0};
  const struct model_facts *model = &c->base->model;
  *count = 1;
  TRY(lattice_resample(c->base, spacing, 0.0, wrapped));
  TRY(cascade_solve(c, wrapped, &none, &cascade_sides_goal, false, k));
  /* z and y come first: only half of what is mirrored along them is solved. */
  for (int a = 2; a >= 0; a--) {
    if (!model->unlike[a]) continue;
    axes[a] = true;
    TRY(lattice_mirror_sides(wrapped, axes, &mirrored));
    TRY(cascade_solve(c, &mirrored, &none, &cascade_sides_goal, false, &k[(*count)++]));
    lattice_free(&mirrored);
  }
cleanup:
  lattice_free(&mirrored);
  return status;
}

/* An effect of the sides larger than this is computed again on finer lattices, as is one with
 * closed throats: coarse lattices let too much flow through, or nothing. */
#define SIDES_LARGE 0.2

static bool sides_are_settled(double before, double share) {
  return share <= SIDES_LARGE || fabs(share - before) < 0.1 * share; /* false if one is NAN */
}

static void warn_of_cut_ends(const struct cascade *c) {
  const double *force = c->scene->driving;
  const bool across = c->base->model.flow_cut && force[2] == 0.0;
  log_warning("%s: pores do not meet where the model repeats itself along %c, and the share of "
              "the sides is large for that: %s, unless the image is periodic",
              c->scene->model_path,
              !across           ? 'z'
              : force[0] != 0.0 ? 'x'
                                : 'y',
              across ? "run it with --tensor, which mirrors it there, or build it with --sides "
                       "mirrored"
                     : "build it with --mirror z");
}

enum status cascade_add_sides(struct cascade *c) {
  enum status status = STATUS_OK;
  struct lattice wrapped = {0}, closed = {0};
  double k[4], tube, before = NAN;
  int count = 1;
  const struct stokes_solver none = {0};
  const struct model_facts *model = &c->base->model;
  double spacing = cascade_sides_spacing(c->plan, c->base);
  if (!(cascade_sides_copies(c->base) > 1.0)) return STATUS_OK;
  TRY(solve_sides(c, spacing, &wrapped, k, &count));
  c->sides = uncertainty_share_of_sides(k, count);
  double sites;
  while (!isnan(k[0]) && !isnan(k[count - 1]) && !sides_are_settled(before, c->sides) &&
         cascade_sides_finer(c->base, &spacing, &sites) && cascade_have_memory(c->base, sites)) {
    before = k[count - 1] > 0.0 ? c->sides : NAN;
    lattice_free(&wrapped);
    TRY(solve_sides(c, spacing, &wrapped, k, &count));
    c->sides = uncertainty_share_of_sides(k, count);
  }
  /* If refinement increased the effect, it may increase as much again. */
  if (c->sides > before) c->sides += c->sides - before;
  if (k[0] == 0.0) {
    c->uncertainty.sides_unknown = 1.0;
    log_warning("%s: what the sample's sides do to k is not known, and not in its error: no pore "
                "leads through the lattice on which it is looked for; smaller voxels would tell",
                c->scene->model_path);
  }
  if ((model->unlike[2] || model->flow_cut) && k[0] > 0.0 && k[count - 1] > 0.0) {
    c->mirrored = k[count - 1];
    warn_of_cut_ends(c);
  }
  /* A tube has walls at x and y, and flow along z. */
  if (!model->sides_wrapped || c->scene->driving[2] == 0.0) goto cleanup;
  TRY(lattice_close_sides(&wrapped, (size_t)c->plan->context.method->wall_layers, &closed));
  TRY(cascade_solve(c, &closed, &none, &cascade_sides_goal, false, &tube));
  if (k[0] > 0.0 && tube > 0.0) c->uncertainty.sides_closed = log(tube / k[0]);
cleanup:
  lattice_free(&closed);
  lattice_free(&wrapped);
  return status;
}

enum status cascade_add_model_parts(struct cascade *c, const struct lattice *lattice,
                                    double spacing, double k, const struct stokes_solver *from) {
  enum status status = STATUS_OK;
  struct lattice moved = {0}, coarser = {0};
  double more, other;
  if (!*c->scene->model_path) return STATUS_OK;
  TRY(lattice_resample(lattice, spacing, SURFACE_STEP * spacing, &moved));
  TRY(cascade_solve(c, &moved, from, &cascade_part_goal, false, &more));
  const double change = lattice_void_ratio(&moved, 0.0) - lattice_void_ratio(lattice, 0.0);
  if (more > 0.0 && change > 0.0) c->uncertainty.slope_void_ratio = log(more / k) / change;
  add_calibration(&c->base->model, &c->uncertainty);
  lattice_free(&moved);
  /* The model from every second of its voxels, in each direction. */
  TRY(lattice_sample(c->base, 2.0 * c->plan->context.spacing, 0.0, &coarser));
  TRY(lattice_resample(&coarser, spacing, 0.0, &moved));
  TRY(cascade_solve(c, &moved, from, &cascade_part_goal, false, &other));
  if (other > 0.0) c->uncertainty.model = CONVERGE_MODEL_SHARE * fabs(other / k - 1.0);
  lattice_free(&moved);
  lattice_free(&coarser);
  if (!cascade_sides_wait(c)) TRY(cascade_add_sides(c));
cleanup:
  lattice_free(&moved);
  lattice_free(&coarser);
  return status;
}

/* The effect of the scan is not settled if it grew by this factor from one lattice to the next and
 * is at least SCAN_SLOPE_MIN. */
#define SCAN_GROWTH 1.25
#define SCAN_SLOPE_MIN 0.003

static bool scan_grew(const struct uncertainty *u, int lattices) {
  if (lattices < 2) return false;
  const double last = fabs(u->levels[lattices - 1].slope_blur);
  return last > SCAN_SLOPE_MIN && last > SCAN_GROWTH * fabs(u->levels[lattices - 2].slope_blur);
}

/* Number of the first lattice on which the effect of the scan is computed. It must be finer than
 * those of the preceding parts, so that it resolves throats: the fourth of an open cascade, which
 * begins with coarse lattices; with a time limit the third as well, as it may be the last. Slits
 * of a few voxels in labels far finer than that lattice are not resolved by it: for labels, the
 * effect is therefore also computed on the third lattice and, as long as it grows, on each
 * following one. */
static int first_scan_lattice(const struct cascade *c) {
  return c->fixed > 0 ? 2 : 4;
}

/* Whether the blur closed the pores of that lattice; it may not close those of a finer one. */
static bool scan_closed(const struct uncertainty *u, int lattices) {
  return u->scan >= 1.0 && isnan(u->levels[lattices - 1].slope_blur);
}

bool cascade_scan_grows(const struct cascade *c) {
  return c->base->model.scan.labels && c->uncertainty.level_count >= first_scan_lattice(c) &&
         scan_grew(&c->uncertainty, c->uncertainty.level_count);
}

bool cascade_scan_is_due(const struct cascade *c) {
  const int n = c->uncertainty.level_count, first = first_scan_lattice(c);
  const bool labels = c->base->model.scan.labels;
  return n == first || (n == first - 1 && (labels || isfinite(c->seconds))) ||
         (n > first &&
          (scan_closed(&c->uncertainty, n - 1) || (labels && scan_grew(&c->uncertainty, n - 1))));
}

enum status cascade_add_scan_part(struct cascade *c, const struct lattice *lattice, double k,
                                  const struct stokes_solver *from) {
  enum status status = STATUS_OK;
  struct lattice blurred = {0};
  const struct scan_quality *scan = &c->base->model.scan;
  double scale, other = 0.0;
  if (!scan->known) return STATUS_OK;
  TRY(lattice_blur(c->base, scan_deviation(scan), lattice, &scale, &blurred));
  TRY(cascade_solve(c, &blurred, from, &cascade_part_goal, false, &other));
  const double width = c->plan->shape.width * c->plan->context.spacing;
  c->uncertainty.blur_assumed = scan->assumed ? scan->blur : NAN;
  if (other == 0.0) c->uncertainty.scan = 1.0; /* the blur closes the pores: k may be 0 */
  if (other > 0.0) {
    c->uncertainty.slope_blur = scale * log(other / k);
    c->uncertainty.levels[c->uncertainty.level_count - 1].slope_blur = c->uncertainty.slope_blur;
    const double slope = c->uncertainty.slope_void_ratio;
    c->uncertainty.scan = hypot(scan_error(scan, c->uncertainty.slope_blur, width),
                                isfinite(slope) ? slope * scan->void_ratio_error : 0.0);
    if (scan_shape_error(scan, width) > 0.05)
      log_warning("the scan's blur hides the shape of pores as narrow as these: that alone may be "
                  "%.0f %% of k; a sharper scan, or smaller voxels, would tell",
                  100.0 * scan_shape_error(scan, width));
  }
cleanup:
  lattice_free(&blurred);
  return status;
}
