/* What `sphsolve explain` prints: the plan, for people and as JSON. */
#ifndef TOSUI_SPHSOLVE_EXPLAIN_H
#define TOSUI_SPHSOLVE_EXPLAIN_H

#include "sphsolve/cheapest.h"
#include "sphsolve/foresee.h"
#include "sphsolve/plan.h"

/* `foreseen`, on several ranks, and `cheapest` may be NULL. */
void explain_print(const struct plan *plan, const struct foreseen *foreseen);
enum status explain_print_json(const struct plan *plan, const struct foreseen *foreseen,
                               const struct cheapest *cheapest);

#endif
