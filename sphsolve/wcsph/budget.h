/* Momentum and energy budget of a wcsph run (conservation.h), integrated from samples. */
#ifndef TOSUI_SPHSOLVE_WCSPH_BUDGET_H
#define TOSUI_SPHSOLVE_WCSPH_BUDGET_H

#include "sphsolve/wcsph/engine/engine.h"
#include "sphsolve/output/conservation.h"

#define WCSPH_RATES 4 /* momentum (3) and energy, all terms together */

struct wcsph_budget { /* only doubles after total.on: see budget_write */
  struct budget total;
  struct budget_sums rate; /* rates at the last sample */
  double samples, time, dt, elastic;
  /* For all terms together: the rates at the last sample and at the last second sample; the
   * integral since the latter with every sample; and the sums over pairs of intervals of the change
   * by omitting the middle sample, and of its square. */
  double rate_all[WCSPH_RATES], every[WCSPH_RATES], second_rate[WCSPH_RATES], second_time;
  double defect[WCSPH_RATES], squares[WCSPH_RATES];
};

/* Starts a budget; `terms`: those of the effects (plan_budget), to which those of pressure and
 * walls are added. */
void wcsph_budget_begin(const struct engine *engine, uint32_t terms, struct wcsph_budget *budget);
/* Whether a sample is due before this step: at first at each step, later less often. */
bool wcsph_budget_due(int64_t step);
/* Takes a sample at `time` (s) and closes the budget there; `mass`: of a particle, kg. The run
 * stays bitwise unchanged. */
enum status wcsph_budget_sample(struct engine *engine, double mass, double time,
                                struct wcsph_budget *budget);

#endif
