#include "sphsolve/isph/create.h"

#include <math.h>
#include <omp.h>
#include <string.h>

#include "common/memory.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/link.h"
#include "sphsolve/isph/multigrid.h"
#include "sphsolve/isph/neighbours.h"
#include "sphsolve/isph/packing.h"
#include "sphsolve/isph/petsc.h"
#include "sphsolve/isph/own.h"
#include "sphsolve/isph/reflection.h"
#include "sphsolve/isph/well.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/kernel.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/place.h"
#include "sphsolve/isph/refresh.h"
#include "sphsolve/isph/soil.h"
#include "sphsolve/isph/wall.h"

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

/* Walls and open sides, with their boundary particles. */
static enum status create_boundaries(struct isph *s) {
  enum status status = STATUS_OK;
  size_t capacity = 0;
  TRY(isph_wall_fill_tank(s, &capacity));
  TRY(isph_open_fill(s, &capacity));
  for (size_t b = 1; b < s->wall_box_count; b++) TRY(isph_wall_fill_box(s, b, &capacity));
  TRY(isph_boundary_trim(s));
  isph_apply_tables(s, 0);
  isph_open_update_dry(s, true);
  TRY(isph_sort_walls(s));
  isph_wall_move(s, 0);
cleanup:
  return status;
}

enum status isph_create(const struct scene *scene, const struct lattice *lattice,
                        const struct isph_switches *switches, struct isph *s) {
  enum status status = STATUS_OK;
  memset(s, 0, sizeof *s);
  s->scene = scene;
  s->threads_most = omp_get_max_threads();
  s->on = *switches;
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
  for (int a = 0; a < 3; a++)
    if (s->periodic[a]) s->support_max = fmin(s->support_max, s->high[a] - s->low[a]);
  TRY(memory_allocate(&s->soil_offset, scene->region_count, sizeof *s->soil_offset, "regions"));
  if (s->on.links) TRY(isph_links_create(s));
  TRY(isph_wall_find(s));
  TRY(isph_choose_mass(s, lattice));
  TRY(isph_open_create(s));
  isph_images_create(s);
  if (s->on.wells) TRY(isph_wells_create(s));
  for (size_t k = 0; k < s->on.active_count; k++)
    TRY(memory_allocate(&s->own_numbers[k], isph_own_count(s, k), sizeof **s->own_numbers,
                        s->on.active[k]->name));
  TRY(create_boundaries(s));
  TRY(isph_place_water(s, lattice));
  TRY(isph_refresh(s));
  if (s->on.surface) isph_packing_begin(s);
  if (s->on.surface) TRY(isph_find_neighbours(s));
  ISPH_HOOK(s, start, 0);
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
    memory_free(&s->chunks[c].matrix);
    memory_free(&s->chunks[c].wall);
    memory_free(&s->chunks[c].wall_slope);
  }
  isph_fields_free(s);
  for (size_t k = 0; k < ISPH_EFFECTS; k++) memory_free(&s->own_numbers[k]);
  void *blocks[] = {&s->grounds,
                    &s->enclosed,
                    &s->wells,
                    &s->partial,
                    &s->sums,
                    &s->chunk_partition,
                    &s->layer_start,
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
  memset(s, 0, sizeof *s);
}
