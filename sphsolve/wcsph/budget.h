/* The budget of momentum and energy of a wcsph run (conservation.h), by samples. */
#ifndef TOSUI_SPHSOLVE_WCSPH_BUDGET_H
#define TOSUI_SPHSOLVE_WCSPH_BUDGET_H

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/output/conservation.h"

#define WCSPH_RATES 4 /* of momentum and energy, all terms together */

struct wcsph_budget { /* doubles but for total.on: see budget_write */
  struct budget total;
  struct budget_sums rate; /* of the last sample */
  double samples, time, dt, elastic;
  /* Of all terms together: the integral since the last second sample by every sample and without
   * the one between; and of these pairs the sums of the differences and of their squares. */
  double rate_all[WCSPH_RATES], every[WCSPH_RATES], second_rate[WCSPH_RATES], second_time;
  double defect[WCSPH_RATES], squares[WCSPH_RATES];
};

/* `terms`: those of the effects (plan_budget), beside which the pressure and walls have theirs. */
void wcsph_budget_begin(const struct engine *engine, uint32_t terms, struct wcsph_budget *budget);
/* Whether a sample is due before this step: each of the first, then fewer. */
bool wcsph_budget_due(int64_t step);
/* A sample, `mass` that of a particle, kg; the budget is then closed at `time`, s. Changes no bit
 * of what comes. */
enum status wcsph_budget_sample(struct engine *engine, double mass, double time,
                                struct wcsph_budget *budget);

#endif
