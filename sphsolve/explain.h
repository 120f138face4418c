/* Output of `sphsolve explain`: the plan as text and as JSON. */
#ifndef TOSUI_SPHSOLVE_EXPLAIN_H
#define TOSUI_SPHSOLVE_EXPLAIN_H

#include <stdbool.h>

#include "sphsolve/plan/plan.h"

/* The spacing at which a wanted error of k is expected with the scene's method and walls, and its
 * cost: from the same predictions that explain prints. */
struct recommendation {
  double wanted;           /* relative error, set by the caller */
  bool found;              /* some spacing reaches it */
  double spacing, support; /* m */
  double sound_speed;      /* m/s, 0 for stokes */
  size_t size[3];          /* sites, x y z, of the body without added walls */
  double error, seconds, bytes;
};

/* Returns an input error if no error can be predicted (isph, no walls). */
enum status recommend_find(const struct plan *plan, struct recommendation *recommended);
void recommend_print(const struct plan *plan, const struct recommendation *recommended);

/* `recommended` may be NULL. */
void explain_print(const struct plan *plan);
enum status explain_print_json(const struct plan *plan, const struct recommendation *recommended);

#endif
