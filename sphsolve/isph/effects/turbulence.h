/* Eddy viscosity after Smagorinsky (M15 eq. 3): nu_T = (C_s he)^2 |S|, |S|^2 = 2 S_ab S_ab. It
 * decreases with the fraction of soil, whose Forchheimer term already contains the losses by eddies
 * between grains. On where the Reynolds number U R/nu of the scene, R the hydraulic radius
 * (isph/speed_forecast.h), exceeds 500: flow in open channels is laminar below and turbulent above
 * 2000 (Chow 1959, Open-Channel Hydraulics, 1.3). */
#ifndef TOSUI_SPHSOLVE_ISPH_EFFECTS_TURBULENCE_H
#define TOSUI_SPHSOLVE_ISPH_EFFECTS_TURBULENCE_H

#include <math.h>
#include <stdio.h>

#include "sphsolve/plan/plan.h"
#include "sphsolve/isph/state.h"
#include "sphsolve/isph/constants.h"

/* |S| from g[3 a + b] = dv_a/dx_b. */
static inline double strain_rate(const float g[9]) {
  // NOLINTNEXTLINE: who asks for it has a gradient
  double xy = 0.5 * ((double)g[1] + (double)g[3]), xz = 0.5 * ((double)g[2] + (double)g[6]);
  double yz = 0.5 * ((double)g[5] + (double)g[7]);
  double xx = (double)g[0], yy = (double)g[4], zz = (double)g[8];
  return sqrt(2 * (xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)));
}

static inline double eddy_viscosity(double constant, double support, double strain, double soil) {
  double length = constant * support;
  return length * length * strain * (1 - soil);
}

/* Kinematic viscosity of the friction between a wall and water that passes it at `speed`,
 * `distance` away: nu within the viscous layer, y+ < 11.6; beyond it the value that gives the
 * stress u_*^2 = nu_wall speed / distance of the law of the wall, speed = u_* ln(9.8 distance u_* /
 * nu) / .41 (Prandtl, Nikuradse; Pope 2000, Turbulent Flows, 7.1). The boundary layer of water is
 * thinner than particles are: with the eddy viscosity of the outermost particles, and its lower
 * bound, the friction coefficient of the wall would be .03 to .3, and not .003. */
static inline double wall_viscosity(double nu, double speed, double distance) {
  double friction = sqrt(nu * speed / distance);
  if (!(friction * distance > WALL_LAYER * nu) || nu == 0) return nu;
  for (int k = 0; k < 8; k++)
    friction = WALL_KARMAN * speed / log(WALL_LOG * friction * distance / nu);
  return friction * friction * distance / speed;
}

static inline bool isph_turbulence_wanted(const struct effect_context *context,
                                          char why[EFFECT_WHY]) {
  const struct scene *scene = context->scene;
  if (scene->turbulence != SWITCH_AUTO) {
    snprintf(why, EFFECT_WHY, "the scene says so");
    return scene->turbulence == SWITCH_ON;
  }
  const bool flows = context->has_surface && context->driving > 0 && scene->isph.smagorinsky > 0;
  const bool on = flows && context->surface_reynolds > REYNOLDS_LAMINAR;
  if (on)
    snprintf(why, EFFECT_WHY, "free-surface flow under gravity of Re up to %.2g; C_s = %g",
             context->surface_reynolds, scene->isph.smagorinsky);
  else if (flows)
    snprintf(why, EFFECT_WHY, "Re is at most %.2g: up to %g, flow is laminar",
             context->surface_reynolds, REYNOLDS_LAMINAR);
  else
    snprintf(why, EFFECT_WHY, "no surface flow");
  return on;
}

#endif

EFFECT(isph_turbulence, .model = "Smagorinsky, outside soil",
       .citation = "Smagorinsky 1963; Morimoto et al. 2015 (3)", .wanted = isph_turbulence_wanted,
       .switches_on = EFFECT_SWITCH(struct isph_switches, turbulence),
       .budget = 1u << BUDGET_TURBULENCE)
