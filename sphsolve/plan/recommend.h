/* The cheapest settings that reach a wanted error of k: method, walls and resolution, from the same
 * predictions that explain prints. */
#ifndef TOSUI_SPHSOLVE_PLAN_RECOMMEND_H
#define TOSUI_SPHSOLVE_PLAN_RECOMMEND_H

#include <jansson.h>
#include <stdbool.h>

#include "common/error.h"
#include "sphsolve/plan/plan.h"

/* Settings that reach the error; `refined`: spacing of the scene divided by the required one. */
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
  size_t count; /* candidates, cheapest first */
  struct candidate candidates[6];
};

/* The caller sets `wanted`; `plan` is that of the unchanged scene. Returns an input error if no
 * error can be predicted (isph, no walls). */
enum status recommend_find(const struct scene *scene, const struct lattice *lattice,
                           const struct plan *plan, int threads,
                           struct recommendation *recommended);
void recommend_print(const struct plan *plan, const struct recommendation *recommended);
json_t *recommend_json(const struct recommendation *recommended);

#endif
