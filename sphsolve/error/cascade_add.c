#include "sphsolve/error/cascade_add.h"

#include <math.h>

#include "common/log.h"
#include "common/memory.h"
#include "sphsolve/geometry/resample.h"
#include "sphsolve/plan/method.h"
#include "sphsolve/error/cascade_next.h"
#include "sphsolve/error/cascade_parts.h"

/* Error of k by the position of the walls in the ways where the energy is dissipated, relative. At
 * an edge a wall is known to half a spacing, on smooth walls to a part of that
 * (stokes_solver_find_dissipating). k of an opening in a thin wall is proportional to N^d, of a
 * slit (d = 2: Hasimoto 1958) as of a round hole (d = 3: Sampson 1891) N spacings wide; half a
 * spacing makes it uncertain by d / (2 N). The errors of independent ways side by side average.
 * Their number is that of the sites among which a plane across the flow dissipates, over N^(d - 1)
 * with d axes along which the walls change (a way that runs on along another axis is one): d / (2
 * sqrt(N^(3 - d) sites)). Where it is over that of a single way of two spacings, d / 4, the lattice
 * may close the only way, or let far too much through: it shows nothing of how k converges, and the
 * error is 1. See docs/physics/error-of-k.md. */
static double critical_width_error(const struct cascade *c, const struct lattice *lattice,
                                   double spacing, double dissipating) {
  const double width = cascade_critical_width(c, spacing);
  int dimensions = 0;
  for (int a = 0; a < 3; a++) {
    dimensions += c->varies[a];
    if (!c->varies[a]) dissipating /= (double)lattice->size[a];
  }
  if (!(dissipating > 0.0) || !isfinite(width)) return 0.0;
  const double error = 0.5 * dimensions / sqrt(pow(width, 3 - dimensions) * dissipating);
  return error > 0.25 * dimensions ? 1.0 : error;
}

static bool is_finest(const struct cascade *c, double spacing) {
  return c->fixed > 0 ? c->tried == c->fixed : spacing <= 1.01 * c->plan->context.spacing;
}

void cascade_skip(struct cascade *c) {
  c->tried++;
  c->left_tried = c->left;
  c->counted = c->uncertainty.level_count;
}

static enum status add(struct cascade *c, const struct lattice *lattice, double spacing, double k,
                       const struct stokes_solver *from, double seconds) {
  enum status status = STATUS_OK;
  struct uncertainty *u = &c->uncertainty;
  cascade_skip(c);
  const double critical = critical_width_error(c, lattice, spacing, from->dissipating);
  if (!(k > 0.0) || (critical >= 1.0 && !is_finest(c, spacing))) return STATUS_OK;
  u->levels[u->level_count++] = (struct error_level){.spacing = spacing,
                                                     .permeability = k,
                                                     .slope_blur = NAN,
                                                     .critical = critical,
                                                     .sites = (double)lattice->count,
                                                     .seconds = seconds,
                                                     .iterations = (double)from->iterations};
  if (!c->model_parts && u->level_count == 2) {
    TRY(cascade_add_model_parts(c, lattice, spacing, k, from));
    c->model_parts = true;
  }
  if (cascade_scan_is_due(c)) TRY(cascade_add_scan_part(c, lattice, k, from));
  cascade_estimate(c);
cleanup:
  return status;
}

enum status cascade_add(struct cascade *c, const struct lattice *lattice, double spacing,
                        struct stokes_solver *s, double seconds) {
  if (s->grid.active_all > 0) {
    const enum status status = cascade_find_dissipating(c, s);
    if (status != STATUS_OK) return status;
  }
  return add(c, lattice, spacing, s->grid.active_all > 0 ? cascade_permeability(s) : 0.0, s,
             seconds);
}

enum status cascade_finish(struct cascade *c) {
  enum status status = STATUS_OK;
  const struct uncertainty *u = &c->uncertainty;
  struct lattice last = {0};
  bool is_base = true;
  /* A series may end before the lattice on which that part is due. */
  if (c->fixed == 0 && u->level_count > 0 && isnan(u->scan)) {
    const struct error_level *level = &u->levels[u->level_count - 1];
    TRY(cascade_lattice(c, level->spacing, &last, &is_base));
    TRY(cascade_add_scan_part(c, &last, level->permeability, &c->coarse));
  }
  if (c->uncertainty.level_count > 1 && cascade_sides_wait(c)) {
    TRY(cascade_add_sides(c));
    cascade_estimate(c);
  }
  if (c->uncertainty.level_count == 2 && clock_seconds() - c->started > c->seconds)
    log_info("a k with its error takes no less: two lattices, and what else moves k");
cleanup:
  if (!is_base) lattice_free(&last);
  return status;
}

enum status cascade_measure(const struct scene *scene, const struct plan *plan,
                            const struct lattice *base, double found, struct uncertainty *u) {
  enum status status = STATUS_OK;
  struct cascade c = {0};
  const char *why;
  double spacing, k_base = NAN;
  const struct uncertainty given = *u;
  struct lattice unfilled = {0};
  if (!cascade_is_possible(scene, plan)) return STATUS_OK;
  /* Walls that the method made thicker than they are: k of those that are meant. */
  if (base->filled) {
    TRY(lattice_build(scene, plan->context.method->wall_layers, &unfilled));
    TRY(lattice_apply_spacing(scene, &unfilled));
    base = &unfilled;
  }
  cascade_begin(scene, plan, base, &c);
  c.fixed = CASCADE_FIXED;
  c.wanted = 0.0;
  while (cascade_next(&c, &spacing, &why)) {
    struct lattice lattice;
    bool is_base;
    TRY(cascade_lattice(&c, spacing, &lattice, &is_base));
    const double started = clock_processor_seconds();
    double k = 0.0;
    if (lattice_holds_fluid(&lattice))
      status = cascade_solve(&c, &lattice, &c.coarse, &cascade_part_goal, true, &k);
    if (status == STATUS_OK)
      status = add(&c, &lattice, spacing, k, &c.coarse, clock_processor_seconds() - started);
    if (is_base) k_base = k;
    if (!is_base) lattice_free(&lattice);
    TRY(status);
  }
  *u = c.uncertainty;
  u->averaging = given.averaging;
  u->steadiness = given.steadiness;
  u->micro = given.micro, u->slope_micro = given.slope_micro;
  /* Difference between the run's k and the estimate, due to its walls or to what its method
   * leaves. If the run cannot tell how far its flow is from steady, the difference is taken as
   * that error. */
  if (c.uncertainty.level_count > 0 && found > 0.0) {
    const double off = c.uncertainty.extrapolated / found - 1.0;
    if (isnan(given.steadiness)) {
      u->steadiness = fabs(off);
    } else {
      u->resolution_low = hypot(u->resolution_low, fmax(0.0, -off));
      u->resolution_high = hypot(u->resolution_high, fmax(0.0, off));
      u->resolution = fmax(u->resolution_low, u->resolution_high);
    }
  }
  if (c.uncertainty.level_count < CASCADE_FIXED || !(k_base > 0.0) ||
      plan->context.method->wall(scene) != WALL_SUBVOXEL) {
    u->resolution_low = fmax(u->resolution_low, plan->expected.error);
    u->resolution_high = fmax(u->resolution_high, plan->expected.error);
    u->resolution = fmax(u->resolution_low, u->resolution_high);
  }
  /* No coarser lattice has a continuous pore: the throats are one or two sites wide. */
  if (c.uncertainty.level_count == 1 && c.tried > 1) {
    u->resolution = u->resolution_low = u->resolution_high = fmax(u->resolution, 1.0);
    if (cascade_sides_copies(base) > 1.0) u->sides_unknown = 1.0;
  }
cleanup:
  lattice_free(&unfilled);
  cascade_end(&c);
  return status;
}

/* /state/cascade: the state of a cascade other than the current solve. */
#define CASCADE_NUMBERS 16
#define LEVEL_NUMBERS 7

enum status cascade_write(const struct cascade *c, bool solved, struct h5_file *file) {
  const struct uncertainty *u = &c->uncertainty;
  const int levels = solved ? c->counted : u->level_count;
  const int left = c->fixed > 0 ? -1 : solved ? c->left_tried : c->left;
  double numbers[CASCADE_NUMBERS + LEVEL_NUMBERS * ERROR_LEVELS_MAX] = {
      c->tried - solved, levels,        c->model_parts, u->slope_void_ratio,
      u->void_ratio,     u->threshold,  u->model,       u->slope_threshold,
      c->sides,          u->slope_blur, u->scan,        u->sides_closed,
      u->blur_assumed,   left,          c->mirrored,    u->sides_unknown};
  size_t count = CASCADE_NUMBERS;
  for (int i = 0; i < levels; i++) {
    const struct error_level *l = &u->levels[i];
    numbers[count++] = l->spacing;
    numbers[count++] = l->permeability;
    numbers[count++] = l->sites;
    numbers[count++] = l->seconds;
    numbers[count++] = l->iterations;
    numbers[count++] = l->slope_blur;
    numbers[count++] = l->critical;
  }
  return h5_write(file, "/state/cascade", H5_F64, 1, &count, numbers, false);
}

enum status cascade_read(struct cascade *c, struct h5_file *file) {
  enum status status = STATUS_OK;
  struct uncertainty *u = &c->uncertainty;
  double *numbers = NULL;
  size_t count = 0;
  TRY(h5_read(file, "/state/cascade", H5_F64, 1, &count, &numbers));
  const double levels = count >= CASCADE_NUMBERS ? numbers[1] : -1.0;
  if (!(levels >= 0.0 && levels <= ERROR_LEVELS_MAX && numbers[0] >= levels &&
        numbers[0] <= ERROR_LEVELS_MAX &&
        count == CASCADE_NUMBERS + LEVEL_NUMBERS * (size_t)levels))
    TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(file));
  if ((c->fixed > 0) != (numbers[13] < 0.0) || !(numbers[13] < CASCADE_STEPS * ERROR_LEVELS_MAX))
    TRY_FAIL(STATUS_INPUT,
             "%s: is of a run on other lattices; go on with the --error, --time or lattice.spacing "
             "that it had, or remove it to start anew",
             h5_path(file));
  c->tried = (int)numbers[0];
  c->left = (int)numbers[13] + CASCADE_STEPS;
  c->resumed = true;
  c->model_parts = numbers[2] != 0.0;
  u->slope_void_ratio = numbers[3], u->void_ratio = numbers[4], u->threshold = numbers[5];
  u->model = numbers[6], u->slope_threshold = numbers[7], c->sides = numbers[8];
  u->slope_blur = numbers[9], u->scan = numbers[10], u->sides_closed = numbers[11];
  u->blur_assumed = numbers[12], c->mirrored = numbers[14], u->sides_unknown = numbers[15];
  for (int i = 0; i < (int)levels; i++) {
    const double *n = numbers + CASCADE_NUMBERS + LEVEL_NUMBERS * i;
    if (!(n[0] > 0.0 && n[1] > 0.0)) TRY_FAIL(STATUS_INPUT, "%s: is damaged", h5_path(file));
    u->levels[u->level_count++] = (struct error_level){.spacing = n[0],
                                                       .permeability = n[1],
                                                       .sites = n[2],
                                                       .seconds = n[3],
                                                       .iterations = n[4],
                                                       .slope_blur = n[5],
                                                       .critical = n[6]};
    cascade_estimate(c);
  }
cleanup:
  memory_free(&numbers);
  return status;
}
