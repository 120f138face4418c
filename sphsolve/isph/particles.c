#include "sphsolve/isph/particles.h"

#include <string.h>

#include "common/memory.h"
#include "common/statistics.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/linear.h"
#include "sphsolve/isph/ranks.h"
#include "sphsolve/isph/well.h"

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
