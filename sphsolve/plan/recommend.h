/* The cheapest settings that reach a wanted error of k: method, walls and resolution, from the same
 * predictions that explain prints. */
#ifndef TOSUI_SPHSOLVE_PLAN_RECOMMEND_H
#define TOSUI_SPHSOLVE_PLAN_RECOMMEND_H

#include <jansson.h>
#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/plan/plan.h"

/* One way to reach it; `refined`: the scene's spacing over the one that is needed. */
struct candidate {
  const struct method *method;
  enum wall_scheme wall;
  double refined, spacing, support; /* m */
  double sound_speed;               /* m/s, 0 for stokes */
  size_t size[3];                   /* sites, x y z, of the body without added walls */
  double error, seconds, bytes;
};

struct recommendation {
  double wanted;
  size_t count; /* candidates, the cheapest first */
  struct candidate candidates[6];
};

/* `wanted` is set by the caller; `plan` is that of the scene as it is. An input error where no
 * error can be predicted (isph, no walls). */
enum status recommend_find(const struct scene *scene, const struct lattice *lattice,
                           const struct plan *plan, int threads,
                           struct recommendation *recommended);
void recommend_print(const struct plan *plan, const struct recommendation *recommended);
json_t *recommend_json(const struct recommendation *recommended);

#endif
