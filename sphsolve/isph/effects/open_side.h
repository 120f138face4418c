/* Sides of given head or flux, through which water comes and goes: isph/open.c. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_OPEN_SIDE_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_OPEN_SIDE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/cells.h"
#include "sphsolve/isph/open.h"
#include "sphsolve/isph/ranks.h"

static inline bool isph_open_wanted(const struct effect_context *context, char why[EFFECT_WHY]) {
  snprintf(why, EFFECT_WHY, context->has_inflow ? "inflow regions" : "no inflow region");
  return context->has_inflow;
}

static inline enum status isph_open_predicted(void *state, double dt) {
  (void)dt;
  isph_open_straighten(state);
  return STATUS_OK;
}

static inline enum status isph_open_corrected(void *state, double dt) {
  struct isph *s = state;
  (void)dt;
  isph_send(s, 1, (struct ghost_field[]){ISPH_FIELD(s->velocity)});
  return isph_open_measure(s);
}

static inline enum status isph_open_arrive(void *state, double dt) {
  return isph_open_move(state, dt);
}

static inline enum status isph_open_moved(void *state, double dt) {
  (void)dt;
  return isph_sort_walls(state);
}

#endif

EFFECT(isph_open_side, .model = "fixed head or flux on a side", .citation = "docs/physics/isph.md",
       .wanted = isph_open_wanted, .switches_on = EFFECT_SWITCH(struct isph_switches, open_sides),
       .budget = 1u << BUDGET_OPEN_SIDES | 1u << BUDGET_ENTERED | 1u << BUDGET_LEFT |
                 1u << BUDGET_STRAIGHTENING,
       .predicted = isph_open_predicted, .corrected = isph_open_corrected,
       .arrive = isph_open_arrive, .moved = isph_open_moved)
