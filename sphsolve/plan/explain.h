/* Output of `sphsolve explain`: the plan as text and as JSON. */
#ifndef TOSUI_SPHSOLVE_PLAN_EXPLAIN_H
#define TOSUI_SPHSOLVE_PLAN_EXPLAIN_H

#include "sphsolve/plan/recommend.h"
#include "sphsolve/plan/plan.h"

/* `ranks`: their number, to print the memory of one, or 0; `recommended` may be NULL. */
void explain_print(const struct plan *plan, int ranks);
enum status explain_print_json(const struct plan *plan, int ranks,
                               const struct recommendation *recommended);

#endif
