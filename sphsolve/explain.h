/* What `sphsolve explain` prints: the plan, for people and as JSON. */
#ifndef TOSUI_SPHSOLVE_EXPLAIN_H
#define TOSUI_SPHSOLVE_EXPLAIN_H

#include "sphsolve/cheapest.h"
#include "sphsolve/plan.h"

void explain_print(const struct plan *plan);
/* `cheapest` may be NULL. */
enum status explain_print_json(const struct plan *plan, const struct cheapest *cheapest);

#endif
