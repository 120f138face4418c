#include "sphsolve/isph/switches.h"

#include <math.h>

#include "sphsolve/isph/link.h"
#include "sphsolve/isph/soil.h"

enum status isph_switches_of(const struct plan *plan, struct isph_switches *on) {
  const struct scene *scene = plan->context.scene;
  *on = (struct isph_switches){.budget = plan_budget(plan), .dt_most = INFINITY};
  plan_switch(plan, on);
  size_t fields = 0;
  for (size_t i = 0; i < plan->effect_count; i++) {
    const struct planned_effect *planned = &plan->effects[i];
    if (!planned->on) continue;
    if (planned->dt_max < on->dt_most)
      on->dt_most = planned->dt_max, on->dt_most_by = planned->effect->name;
    if (on->active_count == ISPH_EFFECTS)
      return FAIL(STATUS_RUN, "more than %d effects", ISPH_EFFECTS);
    on->active[on->active_count++] = planned->effect;
    if (planned->effect->row != NULL) on->rows[on->row_count++] = planned->effect;
    for (const struct effect_field *f = planned->effect->fields; f != NULL && f->name != NULL; f++)
      if (fields++ == ISPH_OWN_FIELDS)
        return FAIL(STATUS_RUN, "more than %d fields of effects", ISPH_OWN_FIELDS);
    if (planned->effect->force == NULL && planned->effect->surface_pressure == NULL) continue;
    if (on->own_count == ISPH_OWN)
      return FAIL(STATUS_RUN, "more than %d effects with a force of their own", ISPH_OWN);
    on->own[on->own_count++] = planned->effect;
  }
  on->interfaces = isph_soils_differ(scene);
  on->links = isph_links_wanted(scene, on->surface) && on->soil;
  on->mean_of_ends = on->surface && !on->links;
  on->own_mobilities = !on->surface && !on->links;
  return STATUS_OK;
}
