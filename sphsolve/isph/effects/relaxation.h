/* Density relaxation (Asai et al. 2012; Morimoto et al. 2015, "M15", eqs. 26-31): the divergence is
 * not 0, but such that an error of the kernel sum phi = sum V W (with V the bulk volume it is 1
 * everywhere, in and out of soil) decays with the time tau; M15's alpha is dt/tau.
 *   div v_D = - eps (1 - phi) B / tau
 * B is the fraction of a velocity that the drag of one step leaves: without it the correction in
 * soil of strong drag would be faster than the water.
 *
 * |1 - phi| counts up to 0.05, and from 0.005 on in scenes with soil, or with a surface beside
 * windows: phi differs by as much at the same density, and small waves on three rows beside a
 * window grew by its relaxation. On the surface only phi > 1 counts. Next to the surface this also
 * applies if no force acts on the water, and as far as free water is calm (isph/calm.h): neighbours
 * are missing there on one side, so that phi changes under a volume-preserving strain. In calm
 * water phi > 1 counts little there either, since its relaxation damps waves. In seepage without a
 * surface tau is at least the time in which a particle moves by its own size, since the errors of
 * phi arise from that motion: with a shorter tau, water that creeps through soil of porosity .1
 * gets velocity fluctuations as large as its velocity. `relaxation_factor` and `crowd_factor`:
 * isph/energy.c; without that effect they are 1. */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_RELAXATION_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_RELAXATION_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/isph/calm.h"
#include "sphsolve/isph/front.h"
#include "sphsolve/isph/packing.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/constants.h"

/* Time in which water driven by its own weight moves by a particle's size, s; 0 in free water and
 * without a force. */
static inline double time_by_weight(const struct isph *s, size_t i) {
  const double a = s->drag_a[i], b = s->drag_b[i], *f = s->force;
  const double force = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
  const double size = s->size[i];
  return force > 0 ? size * s->porosity[i] * (a + sqrt(a * a + 4 * b * force)) / (2 * force) : 0;
}

/* Rate of contraction, 1/s, by which the row catches up with a particle ahead of it. It acts on the
 * surface deep in soil, where rows of a front separate, in proportion to the deficit of the kernel
 * sum relative to a level surface, and in the time in which the water moves by a particle's size.
 */
static inline double leads(const struct isph *s, size_t i) {
  const double *v = s->velocity[i], size = s->size[i];
  const double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / s->porosity[i];
  const double lacks = fmax(0, fmin(RELAXATION_LEAD, s->kernel_top - s->kernel_sum[i]));
  return isph_front_deep(s, i) * s->surface[i] * lacks * speed / size;
}

/* Relaxation source of crowded particles in soil under a surface, for the part 1 - B that drag
 * would hold back; it is applied with the factor `crowd_factor`. */
static inline double relaxation_crowd(const struct isph *s, size_t i, double relaxation_time) {
  if (s->porosity == NULL || s->surface == NULL) return 0;
  const double crowded =
      fmax(-RELAXATION_MOST, fmin(0, isph_packing_deficit(s, i) + RELAXATION_CROWD));
  const double time = fmax(relaxation_time, RELAXATION_WEIGHT * time_by_weight(s, i));
  return s->porosity[i] * crowded * (1 - s->drag_factor[i]) / time;
}

/* The share, 0 to 1, of a deficit of the kernel sum (an excess if negative) that is not relaxed. */
static inline double relaxation_spared(const struct isph *s, size_t i, double deficit) {
  const double calm = isph_calm_surface(s, i);
  const double beside = s->calm != NULL || isph_is_unforced(s) ? s->near[i] : 0;
  if (deficit < 0) return RELAXATION_SPARED * calm * beside;
  return fmax(s->calm != NULL ? calm * beside : beside, s->surface[i]);
}

static inline double relaxation_source(const struct isph *s, size_t i, double relaxation_time) {
  double deficit = isph_packing_deficit(s, i), eps = s->porosity != NULL ? s->porosity[i] : 1;
  const double crowd = s->crowd_factor * relaxation_crowd(s, i, relaxation_time);
  deficit = fmax(-RELAXATION_MOST, fmin(deficit, RELAXATION_MOST));
  const bool uneven = s->porosity != NULL || (s->surface != NULL && s->on.open_sides);
  if (uneven) deficit -= fmax(-RELAXATION_FREE, fmin(deficit, RELAXATION_FREE));
  if (s->surface != NULL) deficit *= 1 - relaxation_spared(s, i, deficit);
  if (s->porosity != NULL && s->surface == NULL) {
    const double *v = s->velocity[i];
    double size = s->size[i];
    double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]) / eps;
    relaxation_time = fmax(relaxation_time, size / fmax(speed, 1e-30));
  }
  if (s->porosity != NULL && s->surface != NULL)
    relaxation_time = fmax(relaxation_time, RELAXATION_WEIGHT * time_by_weight(s, i));
  double left = s->drag_factor != NULL ? s->drag_factor[i] : 1, asked = deficit * left;
  if (deficit < 0) asked *= s->relaxation_factor;
  asked /= relaxation_time;
  if (s->porosity != NULL && s->surface != NULL) asked += left * leads(s, i);
  return eps * asked + crowd;
}

static inline bool isph_relaxation_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  double alpha = context->scene->isph.alpha;
  if (isnan(alpha))
    snprintf(why, EFFECT_WHY, "tau = %g s", context->scene->isph.relaxation_time);
  else
    snprintf(why, EFFECT_WHY, "alpha = %g", alpha);
  return isnan(alpha) || alpha > 0;
}

#endif

EFFECT(isph_relaxation, .model = "density error fades with time tau",
       .citation = "Asai et al. 2012; Morimoto et al. 2015 (26)-(31)",
       .wanted = isph_relaxation_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, relaxation),
       .budget = 1u << BUDGET_RELAXATION)
