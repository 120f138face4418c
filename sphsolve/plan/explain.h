/* Output of `sphsolve explain`: the plan as text and as JSON. */
#ifndef TOSUI_SPHSOLVE_PLAN_EXPLAIN_H
#define TOSUI_SPHSOLVE_PLAN_EXPLAIN_H

#include "sphsolve/plan/recommend.h"
#include "sphsolve/plan/ranks_forecast.h"
#include "sphsolve/plan/plan.h"

/* `ranks` (the forecast for several ranks) and `recommended` may be NULL. */
void explain_print(const struct plan *plan, const struct ranks_forecast *ranks);
enum status explain_print_json(const struct plan *plan, const struct ranks_forecast *ranks,
                               const struct recommendation *recommended);

#endif
