#include "sphsolve/isph/state.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"
#include "sphsolve/isph/anisotropy.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/multigrid.h"
#include "sphsolve/isph/packing.h"
#include "sphsolve/isph/petsc.h"
#include "sphsolve/isph/rain.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/well.h"

/* Stiffness of grad C on the lattice, in units of the spacing: its change at a particle over the
 * particle's displacement along axis `along`, when alternate rows across the axes in `odd` move
 * against each other. */
static double stiffness_of(const struct isph *s, const int odd[3], int along) {
  const double ratio = s->scene->isph.support_ratio, apart = 1e-4;
  const int reach = (int)ceil(ratio), reach_y = s->dimensions == 3 ? reach : 0;
  double change = 0;
  for (int k = -reach; k <= reach; k++)
    for (int j = -reach_y; j <= reach_y; j++)
      for (int i = -reach; i <= reach; i++) {
        if ((i * odd[0] + j * odd[1] + k * odd[2]) % 2 == 0) continue;
        for (int sign = -1; sign <= 1; sign += 2) {
          double r[3] = {i, j, k}, w, slope;
          r[along] += sign * 2 * apart; /* neighbours move oppositely */
          const double distance = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
          if (distance >= ratio) continue;
          isph_kernel(s->scene->isph.kernel, s->dimensions, distance, ratio, &w, &slope);
          change += sign * s->kernel_slope * slope * r[along] / (2 * apart);
        }
      }
  return -change;
}

/* Stiffness of the stiffest of these patterns; it is within 15 % of the stiffest of all waves on
 * the lattice. */
static double shift_stiffness(const struct isph *s) {
  double most = 0;
  for (int pattern = 1; pattern < 8; pattern++) {
    const int odd[3] = {pattern & 1, pattern >> 1 & 1, pattern >> 2 & 1};
    if (s->dimensions == 2 && odd[1]) continue;
    for (int a = 0; a < 3; a++)
      if (s->dimensions == 3 || a != 1) most = fmax(most, stiffness_of(s, odd, a));
  }
  return most;
}

/* Normalises the kernel by its sums over the lattice, of V W and V slope r^2: a kernel with a
 * support of a few spacings misses 1 by a few tenths to two per cent, which is taken out of every
 * operator. */
static void normalise_kernel(struct isph *s) {
  double ratio = s->scene->isph.support_ratio, w, slope, sum_w = 0, sum_m = 0, sum_s = 0;
  double top = 0, trace = 0, sum_top = 0; /* sums for the outermost layer of a level surface */
  int reach = (int)ceil(ratio), reach_y = s->dimensions == 3 ? reach : 0;
  for (int k = -reach; k <= reach; k++)
    for (int j = -reach_y; j <= reach_y; j++)
      for (int i = -reach; i <= reach; i++) {
        double r2 = i * i + j * j + k * k;
        if (r2 >= ratio * ratio) continue;
        isph_kernel(s->scene->isph.kernel, s->dimensions, sqrt(r2), ratio, &w, &slope);
        sum_w += w, sum_m += slope * i * i;
        if (k <= 0) sum_top += w;
        if (k <= 0) top -= slope * k, trace += slope * r2;
        if (r2 > 0) sum_s += slope;
      }
  s->kernel_w = 1 / sum_w;
  s->kernel_slope = 1 / sum_m;
  s->slope_sum = sum_s / sum_m;
  s->kernel_top = sum_top / sum_w;
  s->asymmetry_top = top * ratio / trace;
  s->shift_stiffness = shift_stiffness(s);
}

enum status isph_reserve(struct isph *s, size_t n) {
  enum status status = STATUS_OK;
  const char *what = "water particles";
  if (n <= s->capacity) return STATUS_OK;
  if (s->capacity > 0) n += n / (isph_is_distributed(s) ? 32 : 4);
  if (n > PAIR_MASK)
    return FAIL(STATUS_INPUT, "%zu water particles; method isph takes %u at most", n, PAIR_MASK);
  TRY(memory_resize(&s->id, n, sizeof *s->id, what));
  TRY(memory_resize(&s->position, n, sizeof *s->position, what));
  TRY(memory_resize(&s->velocity, n, sizeof *s->velocity, what));
  TRY(memory_resize(&s->pressure, n, sizeof *s->pressure, what));
  TRY(memory_resize(&s->mass, n, sizeof *s->mass, what));
  if (s->on.surface) TRY(memory_resize(&s->packing, n, sizeof *s->packing, what));
  TRY(memory_resize(&s->volume, n, sizeof *s->volume, what));
  TRY(memory_resize(&s->support, n, sizeof *s->support, what));
  if (s->on.soil) {
    TRY(memory_resize(&s->porosity, n, sizeof *s->porosity, what));
    TRY(memory_resize(&s->soil_fraction, n, sizeof *s->soil_fraction, what));
    TRY(memory_resize(&s->inertia, n, sizeof *s->inertia, what));
    TRY(memory_resize(&s->drag_a, n, sizeof *s->drag_a, what));
    TRY(memory_resize(&s->drag_b, n, sizeof *s->drag_b, what));
    TRY(memory_resize(&s->drag_factor, n, sizeof *s->drag_factor, what));
    TRY(memory_resize(&s->moment_defect, n, sizeof *s->moment_defect, what));
    if (s->on.interfaces) TRY(memory_resize(&s->interface, n, sizeof *s->interface, what));
    if (s->on.anisotropy) {
      TRY(memory_resize(&s->anisotropy, n, sizeof *s->anisotropy, what));
      TRY(memory_resize(&s->shape, n, sizeof *s->shape, what));
    }
    if (s->on.links) {
      TRY(memory_resize(&s->ground, n, sizeof *s->ground, what));
      TRY(memory_resize(&s->linked, n, sizeof *s->linked, what));
      if (s->on.surface)
        TRY(memory_resize(&s->linked_mobility, n, sizeof *s->linked_mobility, what));
    }
    if (s->on.moving_soil) {
      TRY(memory_resize(&s->soil_velocity, n, sizeof *s->soil_velocity, what));
      TRY(memory_resize(&s->porosity_rate, n, sizeof *s->porosity_rate, what));
    }
  }
  TRY(memory_resize(&s->kernel_sum, n, sizeof *s->kernel_sum, what));
  TRY(memory_resize(&s->gradient_sum, n, sizeof *s->gradient_sum, what));
  TRY(memory_resize(&s->correction, n, sizeof *s->correction, what));
  if (s->on.surface) {
    TRY(memory_resize(&s->surface, n, sizeof *s->surface, what));
    TRY(memory_resize(&s->body, n, sizeof *s->body, what));
  }
  if (isph_is_unforced(s) || isph_has_calm(s))
    TRY(memory_resize(&s->near, n, sizeof *s->near, what));
  if (isph_is_free_water(s)) TRY(memory_resize(&s->linear, n, sizeof *s->linear, what));
  if (isph_has_calm(s)) {
    TRY(memory_resize(&s->thick, n, sizeof *s->thick, what));
    TRY(memory_resize(&s->calm, n, sizeof *s->calm, what));
    TRY(memory_resize(&s->curvature, n, sizeof *s->curvature, what));
    TRY(memory_resize(&s->biharmonic, n, sizeof *s->biharmonic, what));
  }
  if (s->on.turbulence || s->on.shifting || s->on.artificial_viscosity)
    TRY(memory_resize(&s->gradient, n, sizeof *s->gradient, what));
  TRY(memory_resize(&s->mobility, n, sizeof *s->mobility, what));
  if (s->on.viscous) TRY(memory_resize(&s->eddy, n, sizeof *s->eddy, what));
  TRY(memory_resize(&s->predicted, n, sizeof *s->predicted, what));
  TRY(memory_resize(&s->applied, n, sizeof *s->applied, what));
  for (size_t k = 0; k < s->on.own_count; k++) {
    if (s->on.own[k]->force != NULL)
      TRY(memory_resize(&s->own_force[k], n, sizeof *s->own_force[k], what));
    if (s->on.own[k]->surface_pressure != NULL)
      TRY(memory_resize(&s->surface_pressure, n, sizeof *s->surface_pressure, what));
  }
  TRY(memory_resize(&s->diagonal, n, sizeof *s->diagonal, what));
  TRY(memory_resize(&s->source, n, sizeof *s->source, what));
  TRY(memory_resize(&s->tied, n, sizeof *s->tied, what));
  if (s->on.wells) TRY(memory_resize(&s->outlet, n, sizeof *s->outlet, what));
  for (int k = 0; k < 4; k++) TRY(memory_resize(&s->work[k], n, sizeof *s->work[k], what));
  TRY(memory_resize(&s->pair_first, n, sizeof *s->pair_first, what));
  TRY(memory_resize(&s->wall_first, n, sizeof *s->wall_first, what));
  TRY(memory_resize(&s->pair_number, n, sizeof *s->pair_number, what));
  TRY(memory_resize(&s->wall_number, n, sizeof *s->wall_number, what));
  TRY(memory_resize(&s->images, n, sizeof *s->images, what));
  TRY(memory_resize(&s->order, n, sizeof *s->order, what));
  TRY(memory_resize(&s->cell_of, n, sizeof *s->cell_of, what));
  TRY(memory_resize(&s->scratch, n, sizeof(double[3]), what));
  s->capacity = n;
cleanup:
  return status;
}

enum status isph_add_particle(struct isph *s, const double position[3], const double velocity[3],
                              double mass) {
  enum status status = isph_reserve(s, s->count + 1);
  if (status != STATUS_OK) return status;
  size_t i = s->count++;
  memcpy(s->position[i], position, sizeof s->position[i]);
  memcpy(s->velocity[i], velocity, sizeof s->velocity[i]);
  s->pressure[i] = 0;
  s->mass[i] = mass;
  if (s->packing != NULL) memset(s->packing[i], 0, sizeof s->packing[i]);
  s->id[i] = s->next_id++;
  return STATUS_OK;
}

enum status isph_let_in(struct isph *s, const double position[3], const double velocity[3],
                        double mass, double pressure) {
  if (ranks_own() + 1 == ranks_count()) {
    enum status status = isph_add_particle(s, position, velocity, mass);
    if (status != STATUS_OK) return status;
    s->pressure[s->count - 1] = pressure;
  } else {
    s->next_id++;
  }
  isph_budget_entered(s, position, velocity, mass);
  add_compensated(&s->passed.entered, &s->passed.rounded, mass * s->thickness);
  s->entered_count++;
  return STATUS_OK;
}

enum status isph_create(const struct scene *scene, const struct lattice *lattice,
                        const struct isph_switches *switches, struct isph *s) {
  enum status status = STATUS_OK;
  memset(s, 0, sizeof *s);
  s->scene = scene;
  s->threads_most = omp_get_max_threads();
  s->on = *switches;
  s->on.interfaces = isph_soils_differ(scene);
  s->on.links = isph_links_wanted(scene, switches->surface) && s->on.soil;
  s->on.mean_of_ends = s->on.surface && !s->on.anisotropy && !s->on.links;
  s->on.own_mobilities = !s->on.surface && !s->on.links && !s->on.anisotropy;
  s->on.fading = s->on.interfaces && !s->on.anisotropy;
  s->relaxation_factor = s->crowd_factor = 1;
  s->dimensions = scene->dimensions;
  s->density = scene->fluid.density;
  s->kinematic_viscosity = scene->fluid.viscosity / scene->fluid.density;
  double product = 1;
  for (int a = 0; a < 3; a++) {
    bool used = s->dimensions == 3 || a != 1;
    s->force[a] = used ? scene->driving[a] : 0;
    s->low[a] = 0;
    s->high[a] = used ? scene->domain_size[a] : lattice->spacing[a];
    s->periodic[a] = used && scene->periodic[a];
    if (used) product *= lattice->spacing[a];
  }
  s->spacing = s->dimensions == 3 ? cbrt(product) : sqrt(product);
  s->thickness = s->dimensions == 3 ? 1 : lattice->spacing[1];
  normalise_kernel(s);
  s->soil_porosity_least = isph_soil_minimum(scene);
  s->support_max =
      scene->isph.support_ratio * s->spacing * pow(s->soil_porosity_least, -1.0 / s->dimensions);
  for (int a = 0; a < 3; a++) {
    double length = s->high[a] - s->low[a], support = scene->isph.support_ratio * s->spacing;
    if (s->periodic[a] && length < support)
      TRY_FAIL(STATUS_INPUT,
               "%s: domain.size: %.4g m along the periodic axis %c is less than the "
               "kernel's support of %.4g m; make the domain wider or the spacing smaller",
               scene->path, length, "xyz"[a], support);
    if (s->periodic[a]) s->support_max = fmin(s->support_max, length);
  }
  isph_images_create(s);
  TRY(memory_allocate(&s->soil_offset, scene->region_count, sizeof *s->soil_offset, "regions"));
  if (s->on.anisotropy) TRY(isph_anisotropy_create(s));
  if (s->on.links) TRY(isph_links_create(s));
  TRY(isph_choose_mass(s, lattice));
  TRY(isph_open_create(s));
  if (s->on.wells) TRY(isph_wells_create(s));
  if (s->on.rain) TRY(isph_rain_create(s));
  TRY(isph_wall_create(s));
  TRY(isph_place_water(s, lattice));
  TRY(isph_refresh(s));
  if (s->on.surface) isph_packing_begin(s);
  isph_budget_begin(s);
cleanup:
  return status;
}

void isph_free(struct isph *s) {
  if (s->threads_most > 0) omp_set_num_threads(s->threads_most);
  multigrid_free(s);
  isph_petsc_free(s);
  ghosts_free(&s->local);

  for (size_t c = 0; c < s->chunk_capacity; c++) {
    memory_free(&s->chunks[c].pair);
    memory_free(&s->chunks[c].slope);
    memory_free(&s->chunks[c].mobility);
    memory_free(&s->chunks[c].path_porosity);
    memory_free(&s->chunks[c].plain);
    memory_free(&s->chunks[c].matrix);
    memory_free(&s->chunks[c].wall);
    memory_free(&s->chunks[c].wall_slope);
  }
  void *blocks[] = {&s->id,
                    &s->position,
                    &s->velocity,
                    &s->pressure,
                    &s->packing,
                    &s->mass,
                    &s->volume,
                    &s->support,
                    &s->porosity,
                    &s->soil_fraction,
                    &s->inertia,
                    &s->drag_a,
                    &s->drag_b,
                    &s->drag_factor,
                    &s->interface,
                    &s->anisotropy,
                    &s->shape,
                    &s->beds,
                    &s->ground,
                    &s->linked,
                    &s->linked_mobility,
                    &s->grounds,
                    &s->soil_velocity,
                    &s->porosity_rate,
                    &s->kernel_sum,
                    &s->gradient_sum,
                    &s->correction,
                    &s->moment_defect,
                    &s->surface,
                    &s->body,
                    &s->enclosed,
                    &s->near,
                    &s->linear,
                    &s->thick,
                    &s->calm,
                    &s->curvature,
                    &s->biharmonic,
                    &s->gradient,
                    &s->mobility,
                    &s->eddy,
                    &s->predicted,
                    &s->applied,
                    &s->surface_pressure,
                    &s->diagonal,
                    &s->source,
                    &s->tied,
                    &s->outlet,
                    &s->wells,
                    &s->rains,
                    &s->work[0],
                    &s->work[1],
                    &s->work[2],
                    &s->work[3],
                    &s->partial,
                    &s->sums,
                    &s->chunk_partition,
                    &s->layer_start,
                    &s->pair_first,
                    &s->wall_first,
                    &s->pair_number,
                    &s->wall_number,
                    &s->images,
                    &s->order,
                    &s->cell_of,
                    &s->scratch,
                    &s->chunks,
                    &s->cells.start,
                    &s->wall_cells.start,
                    &s->wall_order,
                    &s->wall_boxes,
                    &s->boundary_position,
                    &s->boundary_pressure,
                    &s->boundary_volume,
                    &s->boundary_kind,
                    &s->boundary_box,
                    &s->sides,
                    &s->columns,
                    &s->column_front,
                    &s->soil_offset};
  for (size_t k = 0; k < sizeof blocks / sizeof *blocks; k++) memory_free(blocks[k]);
  for (size_t k = 0; k < ISPH_OWN; k++) memory_free(&s->own_force[k]);
  memset(s, 0, sizeof *s);
}
