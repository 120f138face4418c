#include "sphsolve/isph/particles.h"

#include <string.h>

#include "common/statistics.h"
#include "sphsolve/isph/budget.h"
#include "sphsolve/isph/fields.h"
#include "sphsolve/isph/ranks.h"

enum status isph_reserve(struct isph *s, size_t n) {
  enum status status = STATUS_OK;
  if (n <= s->capacity) return STATUS_OK;
  if (s->capacity > 0) n += n / (isph_is_distributed(s) ? 32 : 4);
  if (n > PAIR_MASK)
    return FAIL(STATUS_INPUT, "%zu water particles; method isph takes %u at most", n, PAIR_MASK);
  TRY(isph_fields_resize(s, n));
  s->capacity = n;
cleanup:
  return status;
}

enum status isph_add_particle(struct isph *s, const double position[3], const double velocity[3],
                              double mass) {
  enum status status = isph_reserve(s, s->count + 1);
  if (status != STATUS_OK) return status;
  size_t i = s->count++;
  struct isph_kept kept;
  isph_fields_kept(s, &kept);
  for (size_t k = 0; k < kept.count; k++)
    memset(isph_field_data(s, &kept.field[k]) + i * kept.field[k].size, 0, kept.field[k].size);
  memcpy(s->position[i], position, sizeof s->position[i]);
  memcpy(s->velocity[i], velocity, sizeof s->velocity[i]);
  s->mass[i] = mass;
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
